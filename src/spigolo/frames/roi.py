"""Region of interest: the part of the image or of space in which the method looks for objects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FrameError
from spigolo.frames.camera import is_number, shortened
from spigolo.frames.frame import Frame, Mask
from spigolo.frames.registration import rigid_transform

FARTHEST_M = 100.0
"""Maximum distance between camera and robot base in metres. A longer translation from the camera to the robot base is
probably in millimetres and is rejected.
"""
LEAST_INSIDE = 0.5
"""Minimum share of a region's pixels that lie inside the region of interest. Regions with a smaller share of pixels
inside are rejected.
"""


@dataclass(frozen=True, slots=True, eq=False)
class MetricBox:
    """Box in space whose edges are parallel to the axes of the camera's frame. If T_base_camera is given, the edges are
    parallel to the axes of the robot's base frame instead.

    - low_m, high_m: minimum (X, Y, Z) and maximum (X, Y, Z) of the box, in metres.
    - T_base_camera: transform (4, 4) from the camera's frame to the robot's base frame.

    Raises FrameError for an invalid box, and CameraError for an invalid transform.
    """

    low_m: Sequence[float]
    high_m: Sequence[float]
    T_base_camera: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        try:
            low, high = np.asarray(self.low_m, float), np.asarray(self.high_m, float)
            fits = low.shape == high.shape == (3,) and bool((low < high).all())
        except (TypeError, ValueError):
            fits = False
        if not fits:
            raise FrameError(
                f"expected a metric box with low < high in X, Y and Z (metres), got {self.low_m} and {self.high_m}"
            )
        if self.T_base_camera is not None:
            rigid_transform(self.T_base_camera, "T_base_camera", FARTHEST_M)


Roi = npt.NDArray[np.bool_] | Sequence[int] | MetricBox
"""Region of interest: a mask (H, W), a pixel box (y0, x0, y1, x1) with y1 and x1 exclusive, or a box in metres."""


def pixel_of(point: Any, shape: tuple[int, int]) -> tuple[int, int]:
    """Return the pixel (row, column) that contains a point (y, x). Raises IndexError if the point lies outside an image
    of size (H, W).

    The centre of the first pixel is (0, 0), so coordinates are rounded to the nearest integers.
    """
    height, width = shape
    try:
        y, x = point
    except (TypeError, ValueError):
        y = x = None
    if all(is_number(v) and -0.5 <= v < end - 0.5 for v, end in ((y, height), (x, width))):
        return math.floor(y + 0.5), math.floor(x + 0.5)
    raise IndexError(f"expected a pixel (y, x) inside {height} rows and {width} columns, got {shortened(point)}")


def roi_mask(roi: Roi, frame: Frame) -> tuple[Mask, Mask]:
    """Return two masks (H, W): the pixels inside a region of interest, and the pixels that are known to be inside or
    outside.

    If the region of interest is a mask or a pixel box, all pixels are known to be inside or outside. If the region of
    interest is a box in metres, only pixels with depth are known to be inside or outside. The share of a region inside
    the region of interest is computed only from pixels that are known to be inside or outside.
    """
    counted = np.ones(frame.shape, bool)
    if isinstance(roi, MetricBox):
        return _inside_box(roi, frame), frame.depth > 0
    try:
        mask = np.asarray(roi)
    except ValueError:
        raise FrameError(f"expected a mask or a pixel box (y0, x0, y1, x1), got {shortened(roi)}") from None
    if mask.shape == (4,):
        return _inside_pixels(mask, frame.shape), counted
    if mask.shape != frame.shape:
        raise FrameError(
            f"expected a mask of the image's shape {frame.shape} or a pixel box (y0, x0, y1, x1) as region of interest,"
            f" got shape {mask.shape}"
        )
    return mask.astype(bool), counted


def _inside_pixels(box: npt.NDArray[np.generic], shape: tuple[int, int]) -> Mask:
    y0, x0, y1, x1 = box.tolist()
    if box.dtype.kind not in "ui" or not (0 <= y0 < y1 <= shape[0] and 0 <= x0 < x1 <= shape[1]):
        raise FrameError(
            f"expected a pixel box (y0, x0, y1, x1) of whole numbers inside {shape[0]} rows and {shape[1]} columns, got"
            f" {(y0, x0, y1, x1)}"
        )
    mask = np.zeros(shape, bool)
    mask[y0:y1, x0:x1] = True
    return mask


def _inside_box(box: MetricBox, frame: Frame) -> Mask:
    if frame.camera is None:
        raise FrameError("expected intrinsics with a metric region of interest, got a frame without a camera")
    points = frame.camera.back_project(frame.depth).astype(np.float64)
    if box.T_base_camera is not None:
        T = np.asarray(box.T_base_camera, np.float64)
        points = points @ T[:3, :3].T + T[:3, 3]
    mask = np.zeros(frame.shape, bool)
    mask[frame.depth > 0] = ((points >= np.asarray(box.low_m)) & (points <= np.asarray(box.high_m))).all(axis=1)
    return mask
