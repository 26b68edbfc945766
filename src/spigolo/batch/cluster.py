"""The same work on a Dask cluster."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from typing import Any, TypeVar

import cv2

from spigolo.batch.engine import IN_FLIGHT, Engine, Lost
from spigolo.errors import SpigoloError

T = TypeVar("T")
R = TypeVar("R")

TIMEOUT_S = 30
"""How long to wait for a scheduler."""


def dask_cluster(address: str) -> Engine:
    """Return an engine of the workers of a Dask scheduler. address: `tcp://HOST:PORT`.

    Workers need spigolo of the same version, and the input files under the same paths. Dask itself runs the work of a
    lost worker again. Raises SpigoloError without the extra `cluster` or without a scheduler at that address.
    """
    distributed = _distributed()

    def run(do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
        with _connect(distributed, address) as client:
            yield from _run(distributed, client, do, items)

    return run


def _run(distributed: Any, client: Any, do: Callable[[T], R], items: Iterable[T]) -> Iterator[tuple[T, R | Lost]]:
    waiting, in_flight = iter(items), {}

    def submit(count: int) -> list[Any]:
        futures = {client.submit(_work, do, item, pure=False): item for item in islice(waiting, count)}
        in_flight.update(futures)
        return list(futures)

    queue = distributed.as_completed(submit(_window(client)), loop=client.loop)
    for future in queue:
        item = in_flight.pop(future)
        error = future.exception()
        outcome = future.result() if error is None else Lost(_reason(error))
        future.release()
        for following in submit(1 + max(_window(client) - len(in_flight) - 1, 0)):
            queue.add(following)
        yield item, outcome


def _work(do: Callable[[Any], Any], item: Any) -> Any:
    cv2.setNumThreads(1)
    return do(item)


def _window(client: Any) -> int:
    """Return how many items to hand out at once: some for each thread of the cluster."""
    threads = sum(client.nthreads().values())
    return max(IN_FLIGHT * int(threads), IN_FLIGHT)


def _reason(error: BaseException) -> str:
    if type(error).__name__ == "KilledWorker":
        return "its worker process died again and again, probably because memory ran out"
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


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
