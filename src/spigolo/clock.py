"""Timing of the processing stages. The function `stopwatch` measures the run time of each function that has the
decorator `stage`.

The following code measures the stage "partition" of one frame:

    with sp.clock.stopwatch() as times:
        sp.segment(frame)
    times["partition"]  # CPU time and wall time of each run, in seconds
"""

from __future__ import annotations

import functools
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class Lap(NamedTuple):
    """Duration of one run of a stage.

    - cpu_s: CPU time of the process in seconds.
    - wall_s: wall time in seconds.
    """

    cpu_s: float
    wall_s: float


Times = dict[str, list[Lap]]
"""Durations of the runs of each stage, first run first, indexed by the name of the stage."""

_times: ContextVar[Times | None] = ContextVar("times", default=None)


@contextmanager
def stopwatch() -> Iterator[Times]:
    """Collect the durations of all stages that run inside the `with` block, on the same thread."""
    times: Times = defaultdict(list)
    token = _times.set(times)
    try:
        yield times
    finally:
        _times.reset(token)


def stage(name: str) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Return a decorator for the function of a processing stage. Inside a `stopwatch` block, the decorator measures the
    duration of each call. The durations are listed under the stage name `name`.
    """

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


class Pace:
    """Frame rate and latency of the last `kept` frames of a stream."""

    def __init__(self, kept: int = 1000) -> None:
        self._latencies_s: deque[float] = deque(maxlen=kept)
        self._ends_s: deque[float] = deque(maxlen=kept)

    def add(self, latency_s: float) -> None:
        """Record a frame that was processed in `latency_s` seconds and is finished now."""
        self._latencies_s.append(latency_s)
        self._ends_s.append(time.perf_counter())

    def __len__(self) -> int:
        return len(self._latencies_s)

    @property
    def frames_per_s(self) -> float:
        """Return the mean frame rate of the last `kept` frames in frames per second, or 0 for fewer than two frames."""
        if len(self._ends_s) < 2 or self._ends_s[-1] == self._ends_s[0]:
            return 0.0
        return (len(self._ends_s) - 1) / (self._ends_s[-1] - self._ends_s[0])

    def latency_ms(self, percentile: float = 50) -> float:
        """Return the given percentile of the latencies in milliseconds, or 0 if no frame was added."""
        ordered = sorted(self._latencies_s)
        return 1000 * ordered[round(percentile / 100 * (len(ordered) - 1))] if ordered else 0.0

    def __str__(self) -> str:
        median, late = self.latency_ms(50), self.latency_ms(99)
        return f"{self.frames_per_s:.1f} frames/s, latency {median:.0f} ms (99 %: {late:.0f} ms)"
