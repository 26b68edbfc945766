"""The dummy device of OpenNI2, driven in a process of its own: `python openni_device.py NAME` prints what it saw.

The threads of this driver use a stream for one more image after it was stopped, and crash if it is gone or the library
is unloaded. So a stop takes longer here, and the process ends without unloading.
"""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from collections.abc import Callable

from openni import openni2

import spigolo as sp

DUMMY = "openni:Dummy?width=320&height=240"


def _wait_after_stop(wait_s: float = 0.5) -> None:
    """Let the driver's threads end before their stream is destroyed."""
    stop = openni2.VideoStream.stop

    def patient(stream: openni2.VideoStream) -> None:
        stop(stream)
        time.sleep(wait_s)

    openni2.VideoStream.stop = patient


def _seen(source: sp.Source, count: int, wait_s: float = 0.0) -> dict[str, object]:
    """Facts of the first frames of a source, read with a pause after each."""
    frames = []
    with source:
        for frame in source:
            frames.append(frame)
            time.sleep(wait_s)
            if len(frames) == count:
                break
    first, report = frames[0], source.report()
    return {
        "names": [one.name for one in frames],
        "stamps_ns": [one.stamp_ns for one in frames],
        "color": [list(first.color.shape), str(first.color.dtype), int(first.color.max())],
        "depth": [list(first.depth.shape), str(first.depth.dtype), first.unit_m],
        "depths_m": sorted({round(float(z), 4) for one in frames for z in one.depth[one.depth > 0].ravel()[::97]}),
        "camera": None if first.camera is None else [first.camera.fx, first.camera.cx, first.camera.width],
        "intrinsics": source.intrinsics,
        "report": [report.frames, report.broken, report.dropped, report.tolerance_ms],
        "told": str(report),
    }


def plain() -> dict[str, object]:
    return _seen(sp.open_source(DUMMY), 10)


def again() -> dict[str, object]:
    """The same source a second time, after it was closed."""
    source = sp.open_source(DUMMY, "xtion")
    _seen(source, 3)
    return _seen(source, 3)


def slow() -> dict[str, object]:
    return _seen(sp.open_source(DUMMY), 4, wait_s=0.3)


def _refusal(name: str) -> dict[str, object]:
    try:
        with sp.open_source(name) as source:
            next(iter(source))
    except sp.errors.FileError as error:
        return {"error": str(error)}
    return {"error": None}


def size() -> dict[str, object]:
    return _refusal("openni:Dummy")


def address() -> dict[str, object]:
    return _refusal("openni:nowhere")


def unplugged() -> dict[str, object]:
    return _refusal("openni:")


NAMED: tuple[Callable[[], dict[str, object]], ...] = (plain, again, slow, size, address, unplugged)

if __name__ == "__main__":
    _wait_after_stop()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = {one.__name__: one for one in NAMED}[sys.argv[1]]()
    print(json.dumps({**found, "warnings": sorted({str(one.message) for one in caught})}), flush=True)
    os._exit(0)
