"""Frames: a colour image, a registered depth map and a camera, validated and copied once.

The camera's axes are X right, Y down and Z forward. Image points are (y, x). Colour is RGB. Depth is the Z coordinate
in metres, 0 where missing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FrameError, UnitWarning, warn
from spigolo.frames.camera import Camera, is_number, shortened
from spigolo.frames.intrinsics import CameraLike, as_camera, fields_of
from spigolo.frames.limits import MAX_PIXELS, check_count
from spigolo.frames.reach import FARTHEST_M, NEAREST_M, OutOfReach, drop_out_of_reach
from spigolo.frames.scale import check_scale, scale_from_mapping

__all__ = ["MAX_PIXELS", "Camera", "Color", "DepthMap", "Frame", "Mask", "depth_in_metres"]

Color = npt.NDArray[np.uint8]
DepthMap = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False, init=False, repr=False)
class Frame:
    """Colour image with a registered depth map and a camera. A frame owns contiguous copies of the colour image and the
    depth map.

    Depth of 0 means missing depth. NaN, infinite, negative and masked depth, depth above 50 m, and the largest value of
    an integer type count as missing. If the camera has distortion, the colour image and the depth map are undistorted
    when the frame is created.

    - color: (H, W, 3) uint8 RGB.
    - depth: (H, W) floating-point metres, or integers with `depth_scale` metres per unit.
    - depth_scale: metres per unit of integer depth, which may also be a field of `camera`.
    - camera: intrinsics in any form that `as_camera` accepts, or None if the intrinsics are unknown.

    Raises FrameError if the colour image and the depth map differ in size, or have more than `max_pixels` pixels.
    Raises CameraError for an invalid camera.
    """

    color: Color
    """Colour image (H, W, 3) uint8 RGB."""
    depth: DepthMap
    """Depth map (H, W) float32 in metres, 0 where missing."""
    camera: Camera | None
    """Intrinsics of the colour image and the depth map, without distortion. The value is None if the intrinsics are
    unknown.
    """
    name: str = ""
    """Name of the frame, used in messages and file names."""
    stamp_ns: int | None = None
    """Time of capture in nanoseconds, or None if the time is unknown."""
    negative_depth: int = field(init=False, default=0)
    """Number of pixels with negative depth, which counts as missing."""
    unit_m: float | None = field(init=False, default=None)
    """Metres per unit of integer depth. The value is None for floating-point depth."""
    out_of_reach: OutOfReach | None = field(init=False, default=None)
    """Description of positive depth values that no camera can measure. Pixels with implausible values count as missing
    depth. The value is None if all depth values are plausible.
    """
    undistorted: bool = field(init=False, default=False)
    """True if the images were undistorted. If the images were undistorted, results belong to `Frame.color`, not to the
    original image.
    """

    def __init__(
        self,
        color: npt.ArrayLike,
        depth: npt.ArrayLike,
        camera: CameraLike,
        name: str = "",
        stamp_ns: int | None = None,
        depth_scale: float | None = None,
        *,
        max_pixels: int = MAX_PIXELS,
    ) -> None:
        pixels, stored = np.asarray(color), np.asarray(np.ma.filled(depth, 0))  # masked depth values count as missing
        _check_color(pixels, max_pixels)
        if depth_scale is None and stored.dtype.kind in "ui":
            depth_scale = _own_scale(camera)
        metres, negative, beyond = depth_in_metres(stored, depth_scale)
        known = _fitting_camera(pixels, metres, camera)
        if negative:
            warn(f"{negative} pixels have negative depth and count as missing")
        if beyond is not None:
            warn(str(beyond), UnitWarning)
        pixels = np.array(pixels, np.uint8, order="C")
        bent = known is not None and bool(known.distortion)
        if known is not None and bent:
            pixels, metres = known.undistort(pixels), known.undistort(metres, nearest=True)
            known = known.without_distortion()
        values: dict[str, Any] = {"color": pixels, "depth": metres, "camera": known, "name": str(name)}
        values["stamp_ns"] = _checked_stamp(stamp_ns)
        unit_m = float(depth_scale) if depth_scale is not None and stored.dtype.kind in "ui" else None
        values |= {"negative_depth": negative, "unit_m": unit_m, "out_of_reach": beyond, "undistorted": bent}
        for key, value in values.items():
            object.__setattr__(self, key, value)

    @property
    def shape(self) -> tuple[int, int]:
        """Size (H, W) of the colour image and the depth map in pixels."""
        return self.depth.shape[0], self.depth.shape[1]

    def __repr__(self) -> str:
        valid = self.depth[self.depth > 0]
        reach = f"depth {valid.min():.2f} to {valid.max():.2f} m" if valid.size else "no depth"
        name = f"{self.name!r}, " if self.name else ""
        camera = "no camera" if self.camera is None else f"fx {self.camera.fx:.1f} px"
        missing = 1 - valid.size / self.depth.size
        return f"Frame({name}{self.shape[1]}x{self.shape[0]}, {reach}, {missing:.0%} missing, {camera})"


def _own_scale(camera: CameraLike) -> float | None:
    """Return the depth scale in the fields of a camera, in metres per unit, or None if no field contains a depth scale.
    Raises CameraError for an invalid depth scale.
    """
    plain = camera is None or isinstance(camera, Camera | str)
    fields = None if plain else fields_of(camera)
    scale = None if fields is None else scale_from_mapping(fields)
    if scale is not None:
        check_scale(scale, "the camera")
    return scale


def depth_in_metres(
    depth: npt.NDArray[Any], depth_scale: float | None = None
) -> tuple[DepthMap, int, OutOfReach | None]:
    """Convert depth to metres.

    Return a depth map (H, W) in metres, the number of pixels with negative depth, and a description of implausible
    values. Missing depth is 0 in the returned depth map. NaN, infinite depth, depth below NEAREST_M, depth beyond the
    range of cameras, and the largest value of an integer type count as missing.

    depth: (H, W) floating-point metres, or integers with depth_scale metres per unit. Raises FrameError for depth of a
    wrong shape or type.
    """
    _check_depth(depth, depth_scale)
    with np.errstate(over="ignore"):  # values too large for float32 become infinite, which counts as missing
        metres = np.array(depth, np.float32, order="C")
    if depth_scale is not None:
        metres *= np.float32(depth_scale)
    negative = int(np.count_nonzero(metres < 0))
    beyond = drop_out_of_reach(depth, metres)
    metres[~((metres >= NEAREST_M) & (metres <= FARTHEST_M))] = 0
    return metres, negative, beyond


def _fitting_camera(color: npt.NDArray[Any], depth: DepthMap, value: CameraLike) -> Camera | None:
    if depth.shape != color.shape[:2]:
        raise FrameError(
            f"expected depth registered to colour, of size {_size(color)}, got {_size(depth)}:"
            " align depth to colour first (register_depth does)"
        )
    camera = as_camera(value, depth.shape[1], depth.shape[0])
    if camera is not None and (camera.width, camera.height) != (depth.shape[1], depth.shape[0]):
        raise FrameError(
            f"expected a camera of the images' size {_size(depth)}, got {camera.width}x{camera.height}:"
            " take the intrinsics of the stream that depth is aligned to"
        )
    if camera is None or isinstance(value, Camera):  # a Camera states its image size
        return camera
    if not (0 <= camera.cx < camera.width and 0 <= camera.cy < camera.height):
        warn(
            f"the principal point ({camera.cx:g}, {camera.cy:g}) lies outside the image of {_size(depth)}: the"
            " intrinsics probably belong to another image size. Positions in metres are then wrong"
        )
    return camera


def _checked_stamp(value: Any) -> int | None:
    """Return a stamp as a number of Python, because numbers of NumPy cannot be written as JSON."""
    if value is None:
        return None
    if not isinstance(value, int | np.integer):
        raise FrameError(f"expected the time of capture in whole nanoseconds as stamp_ns, got {shortened(value)}")
    return int(value)


def check_frame(value: object) -> None:
    """Raise FrameError if a value is not a Frame."""
    if not isinstance(value, Frame):
        raise FrameError(f"expected a Frame such as spigolo.Frame(color, depth, camera), got {type(value).__name__}")


def _size(image: npt.NDArray[Any]) -> str:
    return f"{image.shape[1]}x{image.shape[0]}" if image.ndim >= 2 else f"shape {image.shape}"


def _check_color(color: npt.NDArray[Any], max_pixels: int) -> None:
    if color.ndim == 2 and color.dtype != np.uint8:
        raise FrameError(
            f"expected colour as RGB of shape (H, W, 3) and type uint8, got shape {color.shape} and type {color.dtype}:"
            " give colour first and depth second, if they are swapped, and an infrared image as three 8-bit channels"
        )
    if color.ndim != 3 or color.shape[2] != 3 or color.dtype != np.uint8:
        raise FrameError(
            f"expected colour as RGB of shape (H, W, 3) and type uint8, got shape {color.shape} and type {color.dtype}"
        )
    if color.size == 0:
        raise FrameError(f"expected a colour image with pixels, got shape {color.shape}")
    check_count(color.shape[1], color.shape[0], max_pixels)


def _check_depth(depth: npt.NDArray[Any], depth_scale: float | None) -> None:
    if depth.ndim != 2:
        single = depth.ndim == 3 and 1 in depth.shape
        squeeze, no_colors = (
            "remove the axis of length 1 (np.squeeze)",
            "give distances, not a colour image of the depth",
        )
        mend = squeeze if single else no_colors
        raise FrameError(f"expected depth of shape (H, W), got {depth.shape}: {mend}")
    if depth.dtype == np.uint8:
        raise FrameError(
            "expected depth as 16-bit integers or floating-point metres, got 8 bits, which are too few for distances"
        )
    if depth.dtype.kind in "ui":
        if depth_scale is None:
            raise FrameError(
                f"expected depth_scale with integer depth ({depth.dtype}): metres per unit, 0.001 for millimetres"
            )
    elif depth.dtype.kind != "f":
        raise FrameError(f"expected depth as floating-point metres or integers with a scale, got type {depth.dtype}")
    if depth_scale is not None and not (is_number(depth_scale) and np.isfinite(depth_scale) and depth_scale > 0):
        raise FrameError(f"expected depth_scale as positive metres per unit, got {depth_scale!r}")
