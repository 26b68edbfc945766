"""Timing of several functions that run alternately.

In each round, all functions run once in random order, so that other load on the machine affects all functions equally.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

Tell = Callable[[str, float], None]
"""Progress callback.

The arguments of the callback are the name of the current measurement and a progress value from 0 to 1. The progress
value starts again at 0 for each kind of measurement, such as the measurement of the start-up time.
"""


LEAST_MS = 1e-3
"""Minimum time of a sample, in milliseconds.

Measured times below `LEAST_MS` are set to `LEAST_MS`, to avoid a division by zero.
"""


@dataclass(frozen=True, slots=True)
class Sample:
    """Times of one run, in milliseconds."""

    cpu_ms: float
    """CPU time of all threads of the process, in milliseconds."""
    wall_ms: float
    """Wall time, in milliseconds."""


Run = Callable[[], Sample]
"""Function that does one timed run and returns its CPU and wall time."""


def silent(what: str, done: float) -> None:
    """Ignore the reported progress (default progress callback)."""


def timed(work: Callable[[], object]) -> Run:
    """Return a function that calls `work` once and returns its CPU and wall time."""

    def run() -> Sample:
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        return Sample(max(1e3 * cpu, LEAST_MS), max(1e3 * wall, LEAST_MS))

    return run


def run_rounds(
    contestants: Mapping[str, Run], rounds: int, tell: Tell = silent, what: str = "", seed: int = 0
) -> dict[str, list[Sample]]:
    """Time each function `rounds` times, after one warm-up run.

    In each round, all functions run once in random order. Return the measured times of each function, one per round.
    """
    samples: dict[str, list[Sample]] = {name: [] for name in contestants}
    order, rng = list(contestants), random.Random(seed)
    for k in range(rounds + 1):
        rng.shuffle(order)
        for place, name in enumerate(order):
            tell(f"{what}: {name}", (k * len(order) + place) / ((rounds + 1) * len(order)))
            sample = contestants[name]()
            if k > 0:
                samples[name].append(sample)
    return samples
