"""Engines that run jobs on the workers of a Dask cluster."""

from __future__ import annotations

import importlib
import logging
import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from statistics import median
from typing import Any, Generic, TypeVar

import cv2

from spigolo.batch.engine import IN_FLIGHT, Engine, Lost, reason_of
from spigolo.errors import SpigoloError

T = TypeVar("T")
R = TypeVar("R")

TIMEOUT_S = 30
"""Maximum time to wait for the Dask scheduler, in seconds."""
TASK_S = 1.0
"""Target duration of a cluster task, in seconds. With shorter tasks, a larger share of the time is spent on
communication with the workers. With longer tasks, more work must be repeated if a worker dies.
"""
MAX_GROUP = 1000
"""Maximum number of items in a cluster task."""
LOOPBACK = "127.0.0.1"
FOREVER = "1000 days"
LOST = "the connection to the Dask scheduler is lost: check that the scheduler runs, then start the run again"
POLL_S = 0.005
"""Time between two checks for finished tasks, in seconds."""
CHECK_S = 1.0
"""Minimum time between two requests to the scheduler for its number of workers, in seconds."""
WORKERLESS_S = 600.0
"""Maximum time to wait for a worker while the cluster has none, in seconds."""
RECENT = 15
"""Number of recent cluster tasks over which the median time per item is computed. The number of items in the next task
is `TASK_S` divided by the median time per item.
"""


def dask_cluster(address: str, group: int | None = None) -> Engine:
    """Return an engine that uses the workers of a Dask scheduler.

    All workers need the same version of spigolo, and access to the input files under the same paths. If a worker dies,
    Dask repeats the tasks of this worker on other workers.

    address: address of the scheduler, `tcp://HOST:PORT`. group: number of items in a cluster task. If `group` is None,
    the number is chosen so that a task takes about one second. Raises SpigoloError if the extra `cluster` is not
    installed or no scheduler runs at the address. A run raises SpigoloError if the cluster has no worker for
    `WORKERLESS_S` seconds, or if the connection to the scheduler breaks.
    """
    distributed = _distributed()

    def run(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        with _connect(distributed, address) as client:
            yield from _ClusterRun(client, do, items, group).outcomes(distributed)

    return run


def dask_local(workers: int = 1, group: int | None = None) -> Engine:
    """Return an engine that starts a Dask cluster on this machine and stops the cluster after the run.

    Each worker process has one thread. The workers and the dashboard listen only on the loopback interface, so other
    computers cannot reach them.

    group: number of items in a cluster task, as for `dask_cluster`. Raises SpigoloError for less than one worker, or if
    the extra `cluster` is not installed.
    """
    distributed = _distributed()
    if workers < 1:
        raise SpigoloError(f"expected at least one worker, got {workers}: leave out the number for one worker per core")
    options = {"n_workers": workers, "threads_per_worker": 1, "processes": True}
    listening = {"host": LOOPBACK, "dashboard_address": f"{LOOPBACK}:0"}

    def run(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        with (
            _local_settings(),
            distributed.LocalCluster(silence_logs=logging.CRITICAL, **options, **listening) as cluster,
            distributed.Client(cluster, set_as_default=False) as client,
        ):
            yield from _ClusterRun(client, do, items, group).outcomes(distributed)

    return run


class _ClusterRun(Generic[T, R]):
    """Run of a function on all items with a Dask cluster. Each task of the cluster processes a group of items.

    If the task of a group fails, each item of the group is repeated in a separate task. If a worker dies, Dask reports
    all tasks of the worker as failed, although possibly only one task caused the crash. If the separate task of an item
    also fails because workers died, the item is repeated while no other item runs. The item counts as lost only if a
    worker dies again during this repetition.
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
        # submit the function as a separate task, so that each worker keeps one copy and Dask restores a lost copy
        self.work = self.client.submit(_itself, self.do, pure=False)
        # request the results, because a finished task starts again if its worker dies before its result is read
        queue = distributed.as_completed(self._submit(), loop=self.client.loop, with_results=True, raise_errors=False)
        watch = _Watch(self.client)
        undelivered: set[Any] = set()
        while self.in_flight:
            if queue.has_ready():
                future, result = next(queue)
                if future in self.in_flight:
                    yield from self._collect(future, result)
                    queue.update(self._submit())
            elif watch.is_due():
                watch.check_workers()
                # the queue never returns a task whose result was lost while the result was read
                ended = {future for future in self.in_flight if future.status in ("error", "finished")}
                for future in ended & undelivered:
                    if future.status == "finished":
                        queue.add(future)
                    else:
                        yield from self._collect(future, (None, future.exception(), None))
                        queue.update(self._submit())
                undelivered = ended
            else:
                time.sleep(POLL_S)

    def _submit(self) -> list[Any]:
        """Submit groups of items as tasks, until `IN_FLIGHT` tasks per thread of the cluster are running or waiting.
        Return the Dask futures of the new tasks.
        """
        window = IN_FLIGHT * max(_threads(self.client), 1)
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
        """Return the number of items in the next task, so that the task takes about `TASK_S` seconds."""
        return min(max(int(TASK_S / max(median(self.item_s), 1e-9)), 1), MAX_GROUP) if self.item_s else 1

    def _collect(self, future: Any, result: Any) -> Iterator[tuple[T, R | Lost]]:
        """Yield each item of a finished task with its outcome. If a task with several items failed, its items are
        repeated one by one.
        """
        group = self.in_flight.pop(future)
        if isinstance(result, _Done):
            self.item_s.append(result.seconds / len(group))
            yield from zip(group, result.outcomes, strict=True)
        elif isinstance(result, BaseException):  # cancelled by Dask
            raise SpigoloError(self._cancelled())
        elif len(group) > 1:
            self.again.extend(group)
        elif _was_killed(error := result[1]) and not self.alone:
            self.suspects.extend(group)
        else:
            yield group[0], Lost(_reason(error))
        future.release()

    def _cancelled(self) -> str:
        """Return the message for a task that Dask has cancelled."""
        if self.work.status != "error":
            return LOST
        return f"the Dask cluster cannot run the jobs: {reason_of(self.work.exception())}"


class _Watch:
    """Monitor of a cluster, which detects that the cluster has lost all of its workers."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.checked = time.monotonic()
        self.none_since: float | None = None

    def is_due(self) -> bool:
        """Return True if `CHECK_S` seconds have passed since the last check."""
        if time.monotonic() - self.checked < CHECK_S:
            return False
        self.checked = time.monotonic()
        return True

    def check_workers(self) -> None:
        """Raise SpigoloError if the cluster has had no worker for `WORKERLESS_S` seconds."""
        if _threads(self.client):
            self.none_since = None
            return
        if self.none_since is None:
            self.none_since = self.checked
        if self.checked - self.none_since >= WORKERLESS_S:
            raise SpigoloError(
                f"expected a worker in the Dask cluster, but there was none for {WORKERLESS_S:.0f} s: start workers"
                " with `dask worker ADDRESS`, or check why they stopped, then start the run again"
            )


@dataclass(frozen=True, slots=True)
class _Done(Generic[R]):
    """Result of a cluster task, which processes a group of items."""

    outcomes: list[R | Lost]
    """Outcomes of the items, in the order of the items in the group."""
    seconds: float
    """Duration of the processing of all items of the task, in seconds."""


def _threads(client: Any) -> int:
    """Return the number of threads of all workers. Raises SpigoloError if the scheduler does not answer."""
    if client.status in ("closing", "closed"):
        raise SpigoloError(LOST)
    try:
        return sum(client.nthreads().values())
    except OSError:
        raise SpigoloError(LOST) from None


def _itself(do: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return do


def _work(do: Callable[[Any], Any], group: list[Any]) -> _Done[Any]:
    """Apply a function to a group of items, and return the outcomes with the duration."""
    cv2.setNumThreads(1)
    start = time.perf_counter()
    return _Done([_outcome(do, item) for item in group], time.perf_counter() - start)


def _outcome(do: Callable[[Any], Any], item: Any) -> Any:
    try:
        return do(item)
    except Exception as error:
        return Lost(reason_of(error))


def _was_killed(error: BaseException) -> bool:
    return type(error).__name__ == "KilledWorker"


def _reason(error: BaseException) -> str:
    if _was_killed(error):
        return "the worker process died repeatedly, probably because memory ran out"
    return reason_of(error)


@contextmanager
def _local_settings() -> Iterator[None]:
    """Change two settings of Dask while a local cluster runs, and restore the environment variables that Dask sets.

    By default, Dask removes a worker permanently if the process of the worker is being started again 15 s after an
    earlier crash. A run with several crashes would therefore lose all of its workers. Dask also makes workers return
    freed memory to the operating system, which costs about 16,000 page faults for each frame.
    """
    config = importlib.import_module("dask").config
    changes = {
        "distributed.deploy.lost-worker-timeout": FOREVER,
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
    }
    names = ("PYTHONHASHSEED", "__DASK_PARENT_PID", *config.get("distributed.nanny.pre-spawn-environ"))
    before = {name: os.environ.get(name) for name in names}
    try:
        with config.set(changes):
            yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


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
