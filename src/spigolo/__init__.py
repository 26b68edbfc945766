"""Object segmentation of RGB-D frames for robotic grasping, without learning and without a GPU.

The method is that of Toscana & Rosa 2016, "Fast Graph-Based Object Segmentation for RGB-D Images".

    import spigolo as sp

    frame = sp.read_frame("rgb.png", "depth.png", "camera.json", depth_scale=0.001)
    for o in sp.segment(frame):
        print(o.area_px, o.centroid_m)

Conventions: H, W = image rows and columns, R = number of regions. Colour is RGB. Depth is float32 in metres, 0 where
missing. The camera's axes are X right, Y down and Z forward. Image points are (y, x). Names of variables and fields end
with their unit, such as _m, _px, _deg or _ns. Numba, OpenCV and pydantic are loaded on first use, so that `import
spigolo` is fast.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spigolo import clock as clock
    from spigolo import errors as errors
    from spigolo import export as export
    from spigolo import settings as settings
    from spigolo.errors import SpigoloError as SpigoloError
    from spigolo.frames.files import read_camera as read_camera
    from spigolo.frames.files import read_frame as read_frame
    from spigolo.frames.frame import Camera as Camera
    from spigolo.frames.frame import Frame as Frame
    from spigolo.frames.intrinsics import as_camera as as_camera
    from spigolo.frames.intrinsics import camera_from_mapping as camera_from_mapping
    from spigolo.frames.registration import register_depth as register_depth
    from spigolo.frames.roi import MetricBox as MetricBox
    from spigolo.methods import METHODS as METHODS
    from spigolo.methods import segment_around as segment_around
    from spigolo.objects.boxes import OrientedBox as OrientedBox
    from spigolo.objects.segmentation import ObjectMask as ObjectMask
    from spigolo.objects.segmentation import RejectedRegion as RejectedRegion
    from spigolo.objects.segmentation import Segmentation as Segmentation
    from spigolo.objects.verdicts import Reason as Reason
    from spigolo.pipeline import Trace as Trace
    from spigolo.pipeline import segment as segment
    from spigolo.pipeline import segment_at as segment_at
    from spigolo.pipeline import trace as trace
    from spigolo.settings.config import Config as Config
    from spigolo.settings.presets import CLUTTER as CLUTTER
    from spigolo.settings.presets import OBJECTS as OBJECTS
    from spigolo.settings.presets import PRESETS as PRESETS
    from spigolo.settings.presets import SHELF as SHELF
    from spigolo.settings.presets import TABLE as TABLE
    from spigolo.settings.presets import preset as preset
    from spigolo.sources.base import Report as Report
    from spigolo.sources.base import Source as Source
    from spigolo.sources.opening import open_source as open_source
    from spigolo.stream import Segmenter as Segmenter
    from spigolo.stream import warm_up as warm_up

__version__ = "0.2.0"

_ROOMS = ("clock", "errors", "export", "settings")
_HOMES = {
    "errors": "SpigoloError",
    "frames.files": "read_camera read_frame",
    "frames.frame": "Camera Frame",
    "frames.intrinsics": "as_camera camera_from_mapping",
    "frames.registration": "register_depth",
    "frames.roi": "MetricBox",
    "methods": "METHODS segment_around",
    "objects.boxes": "OrientedBox",
    "objects.segmentation": "ObjectMask RejectedRegion Segmentation",
    "objects.verdicts": "Reason",
    "pipeline": "Trace segment segment_at trace",
    "settings.config": "Config",
    "settings.presets": "CLUTTER OBJECTS PRESETS SHELF TABLE preset",
    "sources.base": "Report Source",
    "sources.opening": "open_source",
    "stream": "Segmenter warm_up",
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names.split()}

__all__ = [  # noqa: PLE0604
    "__version__",
    *_ROOMS,
    *_HOME_OF,
]


if not TYPE_CHECKING:  # type checkers read the imports above, so that they report unknown names

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
