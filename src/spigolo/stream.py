"""Segmentation of streams of frames, with reused memory and kernels that are compiled before the first frame."""

from __future__ import annotations

import threading
import time
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from queue import SimpleQueue
from typing import Any

import numpy as np

from spigolo.clock import Pace
from spigolo.errors import SpigoloError
from spigolo.frames.frame import Camera, Frame
from spigolo.frames.roi import Roi
from spigolo.kernels.workspace import Workspace
from spigolo.objects.segmentation import Segmentation
from spigolo.objects.tracking import Tracker
from spigolo.pipeline import trace
from spigolo.settings.config import Config
from spigolo.settings.presets import OBJECTS, SHELF, TABLE
from spigolo.stages.costs import possible_costs

Timed = tuple[Segmentation, float, Workspace]
END: Any = object()
"""Mark after the last frame."""
"""Segmentation of a frame, its duration in seconds, and the scratch memory that was used."""


class Segmenter:
    """Callable object that segments frames like `segment`, and reuses memory from frame to frame.

    The method `map` segments several frames at the same time, because the kernels release Python's global interpreter
    lock. If your own threads segment frames, create one Segmenter for each thread.

    - config: parameters of the segmentation.
    - ids: if True, each object gets an id that stays the same while the object is in view (`ObjectMask.id`).

    Raises SpigoloError if two threads call one Segmenter at the same time.
    """

    def __init__(self, config: Config = OBJECTS, ids: bool = False) -> None:
        self.config = config
        self.ids = ids
        self.pace = Pace()
        """Frame rate and latency of the last segmented frames."""
        self._tracker = Tracker() if ids else None
        self.workspace = Workspace()
        self._busy = threading.Lock()

    def __reduce__(self) -> tuple[type[Segmenter], tuple[Config, bool]]:
        """Pickle the configuration without memory and tracked objects, so that ids start at 1 in a worker process."""
        return type(self), (self.config, self.ids)

    def __call__(self, frame: Frame, roi: Roi | None = None) -> Segmentation:
        """Segment a frame into objects. The returned result shares no memory with later results.

        roi: region of interest, in any form that the function `segment` accepts.
        """
        with self._alone():
            return self._finish(*self._segment(frame, roi, self.workspace))

    def map(self, frames: Iterable[Frame], roi: Roi | None = None, threads: int = 2) -> Iterator[Segmentation]:
        """Segment frames on several threads, and yield the results in the order of the frames.

        Each of the threads segments one frame at a time. The next frame is requested only when a thread is free. A live
        camera therefore delivers its newest frame, and frames do not wait in a queue. Each result contains its frame as
        `Segmentation.frame`.

        - frames: a source or any other iterable. A separate thread reads the frames.
        - roi: region of interest in all frames, in any form that the function `segment` accepts.
        - threads: number of frames that are segmented at the same time.

        Raises SpigoloError if `threads` is below 1.
        """
        if type(threads) is not int or threads < 1:
            raise SpigoloError(f"expected at least one thread, got threads={threads}")
        return self._map(frames, roi, threads)

    def _map(self, frames: Iterable[Frame], roi: Roi | None, threads: int) -> Iterator[Segmentation]:
        free: SimpleQueue[Workspace | None] = SimpleQueue()  # None ends the reading of frames
        results: SimpleQueue[Future[Timed] | None] = SimpleQueue()  # None after the last frame
        free.put(self.workspace)
        for _ in range(threads - 1):
            free.put(Workspace())

        def read(pool: ThreadPoolExecutor) -> None:
            try:
                iterator = iter(frames)
                while (space := free.get()) is not None and (frame := next(iterator, END)) is not END:
                    results.put(pool.submit(self._segment, frame, roi, space))
            except BaseException as error:  # raised again on the thread of the caller
                failed: Future[Timed] = Future()
                failed.set_exception(error)
                results.put(failed)
            results.put(None)

        with self._alone(), ThreadPoolExecutor(threads + 1, thread_name_prefix="spigolo segmenter") as pool:
            pool.submit(read, pool)
            try:
                while (result := results.get()) is not None:
                    segmentation, seconds, space = result.result()
                    free.put(space)
                    yield self._finish(segmentation, seconds, space)
            finally:
                free.put(None)

    def _segment(self, frame: Frame, roi: Roi | None, workspace: Workspace) -> Timed:
        """Segment a frame. Return the segmentation, its duration in seconds, and the scratch memory."""
        start = time.perf_counter()
        return trace(frame, self.config, roi, workspace).segmentation, time.perf_counter() - start, workspace

    def _finish(self, result: Segmentation, seconds: float, _: Workspace) -> Segmentation:
        """Give ids to the objects of a result, and record the time of the frame."""
        start = time.perf_counter()
        if self._tracker is not None:
            result = self._tracker.follow(result)
        self.pace.add(seconds + time.perf_counter() - start)
        return result

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Reserve the segmenter for one caller. Raises SpigoloError if the segmenter is in use."""
        if not self._busy.acquire(blocking=False):
            raise SpigoloError("expected one thread at a time in a Segmenter, got two: make one Segmenter per thread")
        try:
            yield
        finally:
            self._busy.release()


def warm_up(config: Config | None = None) -> None:
    """Compile the kernels that one configuration requires, or the kernels of all presets if `config` is None.

    The first call on a machine takes up to a minute. Later calls load the compiled kernels in less than a second.
    """
    rng = np.random.default_rng(0)
    depth = np.full((48, 64), 1.0, np.float32)
    depth[16:32, 20:40] = 0.8
    depth[5, 5] = 0
    frame = Frame(rng.integers(0, 255, (48, 64, 3), dtype=np.uint8), depth, Camera(60, 60, 31.5, 23.5, 64, 48))
    halved = OBJECTS.replace(additions={"resolution": "half"})
    configs = (OBJECTS, halved, SHELF, TABLE) if config is None else (config,)
    for one in configs:
        for cost in possible_costs(one.cost):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                trace(frame, one.replace(cost=cost, partition={"gamma_shadows": None}))
