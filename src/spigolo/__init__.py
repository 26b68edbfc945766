"""Finds the objects in an RGB-D frame for a robot that wants to grasp them: no learning, no GPU.

The method of Toscana & Rosa 2016, "Fast Graph-Based Object Segmentation for RGB-D Images".

    import spigolo as sp

    frame = sp.read_frame("rgb.png", "depth.png", "camera.json", depth_scale=0.001)
    for o in sp.segment(frame):
        print(o.area_px, o.centroid_m)

Conventions: H, W = image rows and columns; R = regions. Colour is RGB. Depth is float32 metres, 0 = missing.
Camera axes: X right, Y down, Z forward. Image points are (y, x). Names carry their unit: _m, _px, _deg, _ns.
Importing this package loads neither numba, OpenCV nor pydantic; the first use of a name does.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spigolo import clock, errors, settings
    from spigolo.errors import SpigoloError
    from spigolo.frames.files import read_camera, read_frame
    from spigolo.frames.frame import Camera, Frame
    from spigolo.frames.intrinsics import as_camera
    from spigolo.frames.registration import register_depth
    from spigolo.frames.roi import MetricBox
    from spigolo.methods import METHODS, segment_around
    from spigolo.objects.boxes import OrientedBox
    from spigolo.objects.segmentation import ObjectMask, RejectedRegion, Segmentation
    from spigolo.objects.verdicts import Reason
    from spigolo.pipeline import Trace, segment, segment_at, trace
    from spigolo.settings.config import Config
    from spigolo.settings.presets import CLUTTER, OBJECTS, PRESETS, SHELF, TABLE, preset
    from spigolo.stream import Segmenter, warm_up

__version__ = "0.1.0"

_ROOMS = ("clock", "errors", "settings")
_HOMES = {
    "errors": "SpigoloError",
    "frames.files": "read_camera read_frame",
    "frames.frame": "Camera Frame",
    "frames.intrinsics": "as_camera",
    "frames.registration": "register_depth",
    "frames.roi": "MetricBox",
    "methods": "METHODS segment_around",
    "objects.boxes": "OrientedBox",
    "objects.segmentation": "ObjectMask RejectedRegion Segmentation",
    "objects.verdicts": "Reason",
    "pipeline": "Trace segment segment_at trace",
    "settings.config": "Config",
    "settings.presets": "CLUTTER OBJECTS PRESETS SHELF TABLE preset",
    "stream": "Segmenter warm_up",
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names.split()}

__all__ = [  # noqa: PLE0604
    "__version__",
    *_ROOMS,
    *_HOME_OF,
]


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return importlib.import_module(f"spigolo.{name}")
    if name not in _HOME_OF:
        raise AttributeError(f"module 'spigolo' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"spigolo.{_HOME_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
