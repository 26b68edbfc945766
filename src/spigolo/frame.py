"""Camera and Frame: what goes in, checked and owned here, once.

Camera axes: X right, Y down, Z forward. Image points are (y, x), rows first. Colour is RGB. Depth is the Z coordinate
in metres, 0 where it is missing.
"""

from __future__ import annotations

import warnings
from dataclasses import InitVar, dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError, FrameError

Color = npt.NDArray[np.uint8]
DepthMap = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Camera:
    """Pinhole intrinsics in pixels, of the colour image that depth is registered to.

    fx, fy: focal lengths; cx, cy: principal point; width, height: image size.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int

    def __post_init__(self) -> None:
        numbers = (self.fx, self.fy, self.cx, self.cy)
        if not all(np.isfinite(n) for n in numbers) or self.fx <= 0 or self.fy <= 0:
            raise CameraError(f"expected positive finite focal lengths in pixels, got fx={self.fx}, fy={self.fy}")
        if self.width < 1 or self.height < 1:
            raise CameraError(f"expected an image size of at least 1x1, got {self.width}x{self.height}")
        for name in ("fx", "fy", "cx", "cy"):  # whole numbers would be another type to the kernels
            object.__setattr__(self, name, float(getattr(self, name)))

    @property
    def matrix(self) -> npt.NDArray[np.float64]:
        """K, (3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def back_project(self, depth: npt.NDArray[Any], where: Mask | None = None) -> npt.NDArray[np.float32]:
        """Points (N, 3) in metres of the pixels of `depth` (H, W) that are valid and, if given, in `where`."""
        valid = depth > 0 if where is None else (depth > 0) & where
        y, x = np.nonzero(valid)
        z = depth[y, x]
        return np.stack([(x - self.cx) / self.fx * z, (y - self.cy) / self.fy * z, z], axis=1).astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One colour image with its registered depth; owns contiguous copies of both.

    color (H, W, 3) uint8 RGB. depth (H, W): floating-point metres, or integers with `depth_scale` metres per unit;
    0, NaN, infinite and negative depth is missing, and is 0 here. negative_depth: how many pixels were negative.
    Raises FrameError where they do not fit together.
    """

    color: Color
    depth: DepthMap
    camera: Camera
    name: str = ""
    stamp_ns: int | None = None
    depth_scale: InitVar[float | None] = None
    negative_depth: int = field(init=False, default=0)

    def __post_init__(self, depth_scale: float | None) -> None:
        color, depth = np.asarray(self.color), np.asarray(self.depth)
        _check_color(color)
        _check_depth(depth, depth_scale)
        if depth.shape != color.shape[:2]:
            raise FrameError(
                f"expected depth registered to colour, of its size {_size(color)}, got {_size(depth)}:"
                " align depth to colour first"
            )
        if (self.camera.width, self.camera.height) != (depth.shape[1], depth.shape[0]):
            raise FrameError(
                f"expected a camera of the images' size {_size(depth)}, got {self.camera.width}x{self.camera.height}:"
                " take the intrinsics of the stream that depth is aligned to"
            )
        metres, negative = _metres(depth, depth_scale)
        if negative:
            warnings.warn(f"{negative} pixels have negative depth and count as missing", stacklevel=3)
        object.__setattr__(self, "color", np.array(color, np.uint8, order="C"))
        object.__setattr__(self, "depth", metres)
        object.__setattr__(self, "negative_depth", negative)

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W)."""
        return self.camera.height, self.camera.width


def _size(image: npt.NDArray[Any]) -> str:
    return f"{image.shape[1]}x{image.shape[0]}" if image.ndim >= 2 else f"shape {image.shape}"


def _check_color(color: npt.NDArray[Any]) -> None:
    if color.ndim != 3 or color.shape[2] != 3 or color.dtype != np.uint8:
        raise FrameError(
            f"expected colour as RGB of shape (H, W, 3) and type uint8, got shape {color.shape} and type {color.dtype}"
        )
    if color.size == 0:
        raise FrameError(f"expected a colour image with pixels, got shape {color.shape}")


def _check_depth(depth: npt.NDArray[Any], depth_scale: float | None) -> None:
    if depth.ndim != 2:
        raise FrameError(
            f"expected depth of shape (H, W), got {depth.shape}: a picture of depth in colours is no depth"
        )
    if depth.dtype == np.uint8:
        raise FrameError(
            "expected depth as 16-bit integers or floating-point metres, got 8 bits: distances are lost in it"
        )
    if depth.dtype.kind in "ui":
        if depth_scale is None:
            raise FrameError(
                f"expected depth_scale with integer depth ({depth.dtype}): metres per unit, 0.001 for millimetres"
            )
    elif depth.dtype.kind != "f":
        raise FrameError(f"expected depth as floating-point metres or integers with a scale, got type {depth.dtype}")
    if depth_scale is not None and not (np.isfinite(depth_scale) and depth_scale > 0):
        raise FrameError(f"expected depth_scale as positive metres per unit, got {depth_scale}")


def _metres(depth: npt.NDArray[Any], depth_scale: float | None) -> tuple[DepthMap, int]:
    with np.errstate(over="ignore"):  # beyond float32 is infinite, and that is missing
        metres = np.array(depth, np.float32, order="C")
    if depth_scale is not None:
        metres *= np.float32(depth_scale)
    negative = int(np.count_nonzero(metres < 0))
    metres[~(np.isfinite(metres) & (metres > 0))] = 0
    return metres, negative
