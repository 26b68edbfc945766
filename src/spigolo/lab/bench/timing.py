"""Rounds of timing. Each contestant runs once per round, in random order, so that disturbances affect all."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

Tell = Callable[[str, float], None]
"""Function that is called with the current measurement and the share that is done, 0..1."""


LEAST_MS = 1e-3
"""Minimum time in ms, as times are divisors and a coarse clock may give 0."""


@dataclass(frozen=True, slots=True)
class Sample:
    """Times of one run. cpu_ms: CPU time of the whole process, including all threads. wall_ms: wall time."""

    cpu_ms: float
    wall_ms: float


Run = Callable[[], Sample]
"""Function that runs a contestant once and returns its times."""


def silent(what: str, done: float) -> None:
    """Report nothing."""


def timed(work: Callable[[], object]) -> Run:
    """Return a contestant that runs work in this process."""

    def run() -> Sample:
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        return Sample(max(1e3 * cpu, LEAST_MS), max(1e3 * wall, LEAST_MS))

    return run


def run_rounds(
    contestants: Mapping[str, Run], rounds: int, tell: Tell = silent, what: str = "", seed: int = 0
) -> dict[str, list[Sample]]:
    """Return the samples of each contestant in all rounds, after one warm-up run."""
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
