"""Engines that distribute a run to the workers of a Dask cluster."""

from __future__ import annotations

import importlib
import logging
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from statistics import median
from typing import Any, Generic, TypeVar

import cv2

from spigolo.batch.engine import IN_FLIGHT, Engine, Lost, reason_of
from spigolo.errors import SpigoloError

T = TypeVar("T")
R = TypeVar("R")

TIMEOUT_S = 30
"""Maximum time to wait for a scheduler, s."""
TASK_S = 1.0
"""Target duration of a cluster task, s. Shorter tasks have more overhead. Longer tasks lose more work with a lost
worker.
"""
MAX_GROUP = 1000
"""Maximum number of items in a task."""
LOOPBACK = "127.0.0.1"
RECENT = 15
"""Number of recent tasks whose duration determines the size of the next tasks."""


def dask_cluster(address: str, group: int | None = None) -> Engine:
    """Return an engine that uses the workers of a Dask scheduler. address: `tcp://HOST:PORT`.

    Workers need the same version of spigolo, and the input files under the same paths. Dask repeats the work of a lost
    worker.

    group: number of items in a task. None: as many as take about one second. Raises SpigoloError without the extra
    `cluster` or without a scheduler at that address.
    """
    distributed = _distributed()

    def run(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        with _connect(distributed, address) as client:
            yield from _ClusterRun(client, do, items, group).outcomes(distributed)

    return run


def dask_local(workers: int = 1, group: int | None = None) -> Engine:
    """Return an engine that starts a Dask cluster on this machine for the duration of the run.

    Each worker process has one thread. Workers and dashboard listen on the loopback interface.

    group: as for `dask_cluster`. Raises SpigoloError without the extra `cluster` or for less than one worker.
    """
    distributed = _distributed()
    if workers < 1:
        raise SpigoloError(f"expected at least one worker, got {workers}: leave it out for one per core")
    options = {"n_workers": workers, "threads_per_worker": 1, "processes": True}
    listening = {"host": LOOPBACK, "dashboard_address": f"{LOOPBACK}:0"}

    def run(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        with (
            distributed.LocalCluster(silence_logs=logging.CRITICAL, **options, **listening) as cluster,
            distributed.Client(cluster, set_as_default=False) as client,
        ):
            yield from _ClusterRun(client, do, items, group).outcomes(distributed)

    return run


class _ClusterRun(Generic[T, R]):
    """Run over the items in groups.

    If a group kills its workers, its items are repeated one by one. Dask blames every task that a lost worker held, not
    only the one that killed it. So an item is lost only if it kills its workers again when nothing else runs.
    """

    def __init__(self, client: Any, do: Callable[[T], R], items: Iterable[T], group: int | None) -> None:
        self.client, self.do, self.group = client, do, group
        self.work: Any = None
        self.items = iter(items)
        self.again: deque[T] = deque()
        self.suspects: deque[T] = deque()
        self.in_flight: dict[Any, list[T]] = {}
        self.alone = False
        self.item_s: deque[float] = deque(maxlen=RECENT)

    def outcomes(self, distributed: Any) -> Iterator[tuple[T, R | Lost]]:
        # a separate task: each worker keeps one copy, and Dask repeats the task if its worker is lost
        self.work = self.client.submit(_itself, self.do, pure=False)
        queue = distributed.as_completed(self._submit(), loop=self.client.loop)
        for future in queue:
            yield from self._collect(future)
            for following in self._submit():
                queue.add(following)

    def _submit(self) -> list[Any]:
        """Submit groups until each thread of the cluster has some."""
        window = IN_FLIGHT * max(sum(self.client.nthreads().values()), 1)
        futures = []
        while len(self.in_flight) < window and (group := self._next_group()):
            future = self.client.submit(_work, self.work, group, pure=False)
            self.in_flight[future] = group
            futures.append(future)
        return futures

    def _next_group(self) -> list[T]:
        if self.again:
            return [self.again.popleft()]
        group = list(islice(self.items, self.group or self._size()))
        if not group and self.suspects and not self.in_flight:
            self.alone = True
            return [self.suspects.popleft()]
        return group

    def _size(self) -> int:
        """Return the number of items that take about as long as a task should."""
        return min(max(int(TASK_S / max(median(self.item_s), 1e-9)), 1), MAX_GROUP) if self.item_s else 1

    def _collect(self, future: Any) -> Iterator[tuple[T, R | Lost]]:
        group, error = self.in_flight.pop(future), future.exception()
        if error is None:
            outcomes, seconds = future.result()
            self.item_s.append(seconds / len(group))
            yield from zip(group, outcomes, strict=True)
        elif len(group) > 1:
            self.again.extend(group)
        elif _was_killed(error) and not self.alone:
            self.suspects.extend(group)
        else:
            yield group[0], Lost(_reason(error))
        future.release()


def _itself(do: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return do


def _work(do: Callable[[Any], Any], group: list[Any]) -> tuple[list[Any], float]:
    """Return the outcomes of a group and its duration in seconds."""
    cv2.setNumThreads(1)
    start = time.perf_counter()
    return [_outcome(do, item) for item in group], time.perf_counter() - start


def _outcome(do: Callable[[Any], Any], item: Any) -> Any:
    try:
        return do(item)
    except Exception as error:
        return Lost(reason_of(error))


def _was_killed(error: BaseException) -> bool:
    return type(error).__name__ == "KilledWorker"


def _reason(error: BaseException) -> str:
    if _was_killed(error):
        return "its worker process died again and again, probably because memory ran out"
    return reason_of(error)


@contextmanager
def _connect(distributed: Any, address: str) -> Iterator[Any]:
    try:
        client = distributed.Client(address, timeout=TIMEOUT_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        told = " ".join(str(error).split()) or type(error).__name__
        raise SpigoloError(f"expected a Dask scheduler at {address}, but there is none: {told}") from None
    try:
        yield client
    finally:
        client.close()


def _distributed() -> Any:
    try:
        return importlib.import_module("distributed")
    except ImportError:
        raise SpigoloError('A cluster needs Dask, which is missing: pip install "spigolo[cluster]"') from None
