"""The time that each stage takes: `stopwatch` measures what `stage` names.

with sp.clock.stopwatch() as times:
sp.segment(frame)
times["partition"]  # seconds of CPU time of each run
"""

from __future__ import annotations

import functools
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class Lap(NamedTuple):
    """One run of a stage. cpu_s: CPU time of the process, wall_s: wall time, both in seconds."""

    cpu_s: float
    wall_s: float


Times = dict[str, list[Lap]]
"""Laps by the name of the stage, in order."""

_times: ContextVar[Times | None] = ContextVar("times", default=None)


@contextmanager
def stopwatch() -> Iterator[Times]:
    """Collect the time of every stage that runs inside the `with` block, on this thread."""
    times: Times = defaultdict(list)
    token = _times.set(times)
    try:
        yield times
    finally:
        _times.reset(token)


def stage(name: str) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Name a function as a stage. Outside of `stopwatch` it runs as it is."""

    def named(function: Callable[P, T]) -> Callable[P, T]:
        @functools.wraps(function)
        def timed(*args: P.args, **kwargs: P.kwargs) -> T:
            times = _times.get()
            if times is None:
                return function(*args, **kwargs)
            wall, cpu = time.perf_counter(), time.process_time()
            try:
                return function(*args, **kwargs)
            finally:
                times[name].append(Lap(time.process_time() - cpu, time.perf_counter() - wall))

        return timed

    return named
