"""Rounds: each contestant runs once in each, in an order drawn anew, so that what disturbs one disturbs all."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

Tell = Callable[[str, float], None]
"""Told what is being measured, and how much of it is done, 0..1."""


LEAST_MS = 1e-3
"""A coarse clock must not say 0, as times are divided by."""


@dataclass(frozen=True, slots=True)
class Sample:
    """One run. cpu_ms: CPU time of the whole process, so that hidden threads count too. wall_ms: wall time."""

    cpu_ms: float
    wall_ms: float


Run = Callable[[], Sample]
"""Runs a contestant once and says how long it took."""


def silent(what: str, done: float) -> None:
    """Report nothing."""


def timed(work: Callable[[], object]) -> Run:
    """Work of this process as a contestant."""

    def run() -> Sample:
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        return Sample(max(1e3 * cpu, LEAST_MS), max(1e3 * wall, LEAST_MS))

    return run


def run_rounds(
    contestants: Mapping[str, Run], rounds: int, tell: Tell = silent, what: str = "", seed: int = 0
) -> dict[str, list[Sample]]:
    """Samples of each contestant by round, after one run of each that does not count."""
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
