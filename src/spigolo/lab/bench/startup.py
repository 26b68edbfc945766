"""Time from the start of a Python process to its first segmentation."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from spigolo.errors import SpigoloError
from spigolo.frames.frame import Frame
from spigolo.lab.bench.timing import Tell, silent

CODE = """
import json, sys, time
start = time.time()
import cv2
cv2_s = time.time() - start
import numpy as np
import spigolo as sp
camera = sp.Camera(**json.loads(sys.argv[3])) if sys.argv[3] != "null" else None
frame = sp.Frame(np.load(sys.argv[1]), np.load(sys.argv[2]), camera)
sp.segment(frame)
print(json.dumps([time.time(), cv2_s]))
"""


@dataclass(frozen=True, slots=True)
class Startup:
    """Start-up time: wall time from the start of a Python process to its first segmentation, in seconds."""

    warm_s: float
    """Median start-up time if the cache contains all compiled kernels (Numba functions), in seconds."""
    opencv_s: float
    """Median time of `import cv2`, in seconds."""
    cold_s: float | None
    """Start-up time if the cache contains no compiled kernels (Numba functions), in seconds. The value is None if this
    time was not measured.
    """
    samples: list[tuple[float, float]]
    """Start-up time and time of `import cv2` in each repeat, in seconds."""


def measure_startup(frame: Frame, repeats: int, cold: bool, tell: Tell = silent) -> Startup:
    """Measure the start-up time of new Python processes that load a frame and segment it with the preset `OBJECTS`."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        np.save(folder / "color.npy", frame.color)
        np.save(folder / "depth.npy", frame.depth)
        camera = json.dumps(None if frame.camera is None else asdict(frame.camera))
        words = [str(folder / "color.npy"), str(folder / "depth.npy"), camera]
        samples = []
        for k in range(repeats):
            tell("start of a new process", k / (repeats + cold))
            samples.append(_start(words))
        if cold:
            tell("start without compiled kernels", repeats / (repeats + 1))
        cold_s = _start(words, folder / "cache")[0] if cold else None
    totals, opencv = zip(*samples, strict=True)
    return Startup(statistics.median(totals), statistics.median(opencv), cold_s, samples)


def _start(words: list[str], cache: Path | None = None) -> tuple[float, float]:
    """Start one Python process, and return its start-up time and the time of `import cv2`, in seconds."""
    surroundings = dict(os.environ) if cache is None else os.environ | {"SPIGOLO_CACHE_DIR": str(cache)}
    start = time.time()
    done = subprocess.run(
        [sys.executable, "-c", CODE, *words], env=surroundings, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise SpigoloError(f"a new process could not segment the frame: {last}")
    end, opencv = json.loads(done.stdout)
    return end - start, opencv
