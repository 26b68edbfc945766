"""Options of a source, given as keywords or after `?` in the name of the source."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from spigolo.errors import FileError
from spigolo.frames.frame import MAX_PIXELS
from spigolo.frames.intrinsics import CameraLike

NUMBERS: Mapping[str, type[int] | type[float]] = {
    "depth_scale": float, "tolerance_ms": float, "max_pixels": int, "width": int, "height": int, "fps": int,
    "queue": int,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Options:
    """Options for reading a source. Each kind of source ignores the options that do not apply to it."""

    camera: CameraLike = None
    """Intrinsics in any form that `read_frame` accepts. If None, the intrinsics of the source are used."""
    depth_scale: float | None = None
    """Metres per unit of depth. If None, the unit that the source gives is used for integer depth, and floating-point
    depth is in metres.
    """
    max_pixels: int = MAX_PIXELS
    """Maximum number of pixels of an image."""
    color: str | None = None
    """Topic of the colour images of a bag. If None, the topic is chosen automatically."""
    depth: str | None = None
    """Topic of the depth images of a bag. If None, the topic is chosen automatically."""
    info: str | None = None
    """Topic of the CameraInfo of a bag. If None, the CameraInfo topic that belongs to the colour topic is used."""
    tolerance_ms: float = 20.0
    """Maximum difference between the stamps of a colour and a depth image that form a frame, in milliseconds."""
    width: int = 640
    """Width of the colour and depth streams of a live camera, in pixels."""
    height: int = 480
    """Height of the colour and depth streams of a live camera, in pixels."""
    fps: int = 30
    """Frames per second of a live camera."""
    queue: int = 1
    """Maximum number of frames of a live camera that wait while the caller is busy. Newer frames replace older ones.
    With the value 1, each step of the iteration yields the newest frame. With larger values, no frame is lost if the
    caller is busy for a short time.
    """
    filters: tuple[str, ...] = field(default=())
    """Names of RealSense SDK filters, applied in the given order: decimation, threshold, spatial, temporal, holes."""
    device: Any = None
    """Device object of the RealSense SDK, such as a software device. If None, a connected camera is used."""


def options_from(words: Mapping[str, str], given: Mapping[str, Any]) -> Options:
    """Create the options from text values (`words`) and Python values (`given`). If an option has both values, the
    Python value is used.

    Raises FileError for an unknown option or an invalid value.
    """
    known = [one.name for one in fields(Options)]
    values = {name: _value(name, text) for name, text in words.items()}
    values |= {name: value for name, value in given.items() if value is not None}
    unknown = next((name for name in values if name not in known), None)
    if unknown is not None:
        raise FileError(f"unknown option {unknown} of a source: expected one of {', '.join(known)}")
    if isinstance(values.get("filters"), str):
        values["filters"] = tuple(values["filters"].split(","))
    options = Options(**values)
    if type(options.queue) is not int or options.queue < 1:
        raise FileError(f"expected a queue of at least one frame, got queue={options.queue}")
    if options.depth_scale is not None and not 0 < options.depth_scale < math.inf:
        raise FileError(f"expected depth_scale as positive metres per unit, got {options.depth_scale}")
    return options


def _value(name: str, text: str) -> Any:
    kind = NUMBERS.get(name)
    try:
        return text if kind is None else kind(text)
    except ValueError:
        raise FileError(f"expected a number as {name} of a source, got {text!r}") from None
