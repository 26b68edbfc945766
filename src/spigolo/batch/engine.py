"""Engines, which run a function on many items in worker processes with one compute thread each."""

from __future__ import annotations

import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from typing import Any, Generic, Protocol, TypeVar, cast

import cv2

from spigolo.errors import SpigoloError

T = TypeVar("T")
R = TypeVar("R")

IN_FLIGHT = 2
"""Maximum number of items per worker that are running or waiting at a time. Waiting items keep the workers busy."""
TRIES_ALONE = 2
"""Maximum number of times that an item is repeated in a separate process after a worker process died."""


@dataclass(frozen=True, slots=True)
class Lost:
    """Outcome of an item without a result, because the worker process died or the function raised an exception."""

    reason: str
    """Error message that explains why the item has no result."""


class Engine(Protocol):
    """Callable that applies a given function to many items and yields the outcomes in any order. `here` is an engine.
    `local`, `dask_cluster` and `dask_local` return engines.
    """

    def __call__(self, do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        """Yield each item with the return value of `do(item)`, as soon as the value is ready. `do` and the items must
        be picklable.
        """
        ...


def local(workers: int = 1) -> Engine:
    """Return an engine that uses worker processes on this machine. Raises SpigoloError for less than one worker."""
    if workers < 1:
        raise SpigoloError(f"expected at least one worker, got {workers}: leave out the number for one worker per core")

    def run(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        return iter(_LocalRun(do, items, workers))

    return run


def here(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
    """Run `do` on the items in the current process with one compute thread. The function `here` is itself an engine. An
    exception in `do` ends the run.
    """
    with one_thread():
        for item in items:
            yield item, do(item)


def in_order(engine: Engine, do: Callable[[T], R], items: Iterable[T]) -> Generator[R | Lost]:
    """Yield the outcomes of an engine in the order of the items. Outcomes that arrive early are kept in memory."""
    early: dict[int, R | Lost] = {}
    following = 0
    outcomes = cast("Generator[tuple[tuple[int, T], R | Lost]]", engine(_Numbered(do), enumerate(items)))
    with closing(outcomes):
        for (number, _), outcome in outcomes:
            early[number] = outcome
            while following in early:
                yield early.pop(following)
                following += 1


@dataclass(frozen=True, slots=True)
class _Numbered(Generic[T, R]):
    """Function wrapper that receives a pair (number, item) and passes only the item to the function `do`."""

    do: Callable[[T], R]

    def __call__(self, numbered: tuple[int, T]) -> R:
        return self.do(numbered[1])


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit OpenCV to one thread inside the `with` block."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)


def cores() -> int:
    """Return the number of CPU cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _LocalRun(Generic[T, R]):
    """Run of a function on all items with a process pool. If a worker dies, the pool is replaced, and unfinished items
    are repeated one by one.
    """

    def __init__(self, do: Callable[[T], R], items: Iterable[T], workers: int) -> None:
        self.do, self.workers = do, workers
        self.items = iter(items)
        self.again: deque[T] = deque()
        self.in_flight: dict[Future[R], T] = {}
        self.pool: ProcessPoolExecutor | None = None

    def __iter__(self) -> Iterator[tuple[T, R | Lost]]:
        try:
            while self._fill():
                yield from self._collect()
        finally:
            self._stop()

    def _fill(self) -> bool:
        """Submit waiting items to the pool, up to `IN_FLIGHT` per worker. Return True if any submitted item is
        unfinished.
        """
        while len(self.in_flight) < IN_FLIGHT * self.workers:
            item = self.again.popleft() if self.again else next(self.items, None)
            if item is None:
                break
            if self.pool is None:
                self.pool = _pool(self.workers, self.do)
            try:
                self.in_flight[self.pool.submit(_work, item)] = item
            except BrokenProcessPool:
                self.again.append(item)
                if not self.in_flight:
                    self._stop()
                    continue
                break
        return bool(self.in_flight)

    def _collect(self) -> Iterator[tuple[T, R | Lost]]:
        done, _ = wait(self.in_flight, return_when=FIRST_COMPLETED)
        if any(isinstance(future.exception(), BrokenProcessPool) for future in done):
            done, _ = wait(self.in_flight)  # after a worker died, all futures are done or broken
        broken = []
        for future in done:
            item = self.in_flight.pop(future)
            if isinstance(future.exception(), BrokenProcessPool):
                broken.append(item)
            else:
                yield item, _outcome(future)
        if broken:
            self._stop()
            for item in broken:
                yield item, self._alone(item)

    def _alone(self, item: T) -> R | Lost:
        """Process an item in a separate process, because the item may be the reason why a worker died. Return the
        outcome.
        """
        for _ in range(TRIES_ALONE):
            with _pool(1, self.do) as pool:
                future = pool.submit(_work, item)
                if not isinstance(future.exception(), BrokenProcessPool):
                    outcome: R | Lost = _outcome(future)
                    return outcome
        return Lost(
            f"the worker process died {TRIES_ALONE + 1} times, probably because memory ran out: use fewer workers"
        )

    def _stop(self) -> None:
        if self.pool is not None:
            self.pool.shutdown(cancel_futures=True)
            self.pool = None


def _outcome(future: Future[Any]) -> Any:
    """Return the result of a future, or `Lost` if the future has an exception."""
    error = future.exception()
    return future.result() if error is None else Lost(reason_of(error))


def reason_of(error: BaseException) -> str:
    """Format an exception as one line of text."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _pool(workers: int, do: Callable[[Any], Any]) -> ProcessPoolExecutor:
    # use spawn, because OpenCV's threads do not survive a fork
    return ProcessPoolExecutor(workers, get_context("spawn"), initializer=_prepare, initargs=(do,))


_do: Callable[[Any], Any] | None = None


def _prepare(do: Callable[[Any], Any]) -> None:
    """Initialise a new worker process: store the function `do`, ignore Ctrl-C and limit OpenCV to one thread."""
    global _do  # noqa: PLW0603
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # only the parent process handles Ctrl-C
    threading.Thread(target=_end_with_parent, daemon=True).start()
    cv2.setNumThreads(1)
    _do = do


def _end_with_parent() -> None:
    """End this worker process when its parent process ends. Without this function, a worker process would wait forever
    after its parent process was killed.
    """
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _work(item: Any) -> Any:
    assert _do is not None
    return _do(item)
