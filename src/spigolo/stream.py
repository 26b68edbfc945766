"""Segmentation of streams of frames, with reused memory and kernels that are compiled before the first frame."""

from __future__ import annotations

import threading
import time
import warnings

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


class Segmenter:
    """Callable object that segments frames like `segment`, and reuses memory from frame to frame.

    Create one Segmenter for each thread. Segmenters on several threads run in parallel, because the kernels release
    Python's global interpreter lock.

    - config: parameters of the segmentation.
    - ids: True to give objects ids that stay the same while the objects are in view (`ObjectMask.id`).

    Raises SpigoloError if two threads call one Segmenter at the same time.
    """

    def __init__(self, config: Config = OBJECTS, ids: bool = False) -> None:
        self.config = config
        self.ids = ids
        self.pace = Pace()
        """Frame rate and latency of the last frames."""
        self._tracker = Tracker() if ids else None
        self.workspace = Workspace()
        self._busy = threading.Lock()

    def __reduce__(self) -> tuple[type[Segmenter], tuple[Config, bool]]:
        """Pickle the configuration without memory and tracked objects, so that ids start at 1 in a worker process."""
        return type(self), (self.config, self.ids)

    def __call__(self, frame: Frame, roi: Roi | None = None) -> Segmentation:
        """Segment a frame into objects. The result shares no memory with later results.

        roi: region of interest, as for `segment`.
        """
        if not self._busy.acquire(blocking=False):
            raise SpigoloError("expected one thread at a time in a Segmenter, got two: make one Segmenter per thread")
        start = time.perf_counter()
        try:
            result = trace(frame, self.config, roi, self.workspace).segmentation
            if self._tracker is not None:
                result = self._tracker.follow(result)
            self.pace.add(time.perf_counter() - start)
            return result
        finally:
            self._busy.release()


def warm_up(config: Config | None = None) -> None:
    """Compile the kernels for one configuration, or for all configurations if `config` is None.

    The first call on a machine takes about 20 s. Later calls load the compiled kernels in less than a second.
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
