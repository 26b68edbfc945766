"""Oriented boxes around the visible surface of an object."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import SpigoloError
from spigolo.frames.frame import Camera, DepthMap, Mask

Vectors = npt.NDArray[np.float64]

STEEPEST_DEG = 78.0
"""Maximum angle between a surface and the image plane, in degrees. Where depth changes faster, the pixels are flying
pixels, whose depth lies between object and background.
"""
NOISE_M = 0.004
"""Depth differences between neighbouring pixels up to this value, in metres, count as noise and not as flying pixels.
"""
TRIM_PERCENT, LAST_PERCENT = 1.0, 0.25
"""Percentages of the points that are ignored at each end of each axis of the box: of the inner points, and finally of
all points near the inner points.
"""
NEAR_SHARE, NEAR_M, NEAR_PX = 0.03, 0.002, 2.0
"""Terms of the maximum distance of a point from the box around the inner points: a share of the side length, a length
in metres, and a number of pixels at the distance of the object. Points farther from the box are ignored.
"""
LEAST_POINTS = 10


@dataclass(frozen=True, slots=True, eq=False)
class OrientedBox:
    """Oriented box around the visible surface of an object, in the camera's frame."""

    center_m: Vectors
    """Centre (3,) of the box in metres."""
    size_m: Vectors
    """Side lengths (3,) of the box in metres, longest first."""
    R_camera_box: Vectors
    """Rotation matrix (3, 3) whose columns are the axes of the box in the camera's frame."""

    def to_dict(self) -> dict[str, Any]:
        """Return the box as a dict that can be written as JSON."""
        return {name: getattr(self, name).tolist() for name in ("center_m", "size_m", "R_camera_box")}

    def contains(self, points_m: npt.NDArray[np.floating], margin_m: float = 0.0) -> Mask:
        """Return a mask (N,) that is True for points (N, 3) inside the box or at most `margin_m` outside, in metres."""
        if not margin_m >= 0:
            raise SpigoloError(f"expected a distance from the box of at least 0 m, got {margin_m}")
        inside = np.abs((points_m - self.center_m) @ self.R_camera_box) <= self.size_m / 2 + margin_m
        return np.asarray(inside.all(axis=1))

    def corners_m(self) -> Vectors:
        """Return the corners (8, 3) of the box in metres in the camera's frame."""
        signs = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
        return np.asarray(self.center_m + signs * self.size_m @ self.R_camera_box.T)


def fit_box(mask: Mask, depth: DepthMap, camera: Camera, up: Vectors | None = None) -> OrientedBox | None:
    """Fit an oriented box to the measured depth inside a mask.

    The box covers only the visible surface. Flying pixels are ignored. The directions of the sides come from the inner
    points, which are more than one pixel away from the outline of the mask. The lengths of the sides come from all
    points near the box around the inner points.

    - mask: mask (H, W) of the pixels of the object.
    - depth: depth map (H, W) in metres.
    - up: unit vector (3,) that one axis of the box must be parallel to, such as the normal of the support plane. If
      `up` is None, this axis is the direction in which the points have the smallest variance.

    Returns None if fewer than 10 pixels have depth.
    """
    measured = np.asarray(mask & (depth > 0))
    if np.count_nonzero(measured) < LEAST_POINTS:
        return None
    left, top, width, height = cv2.boundingRect(measured.view(np.uint8))
    here = slice(top, top + height), slice(left, left + width)
    solid, core = np.zeros_like(measured), np.zeros_like(measured)
    solid[here] = measured[here] & ~_is_steep(measured[here], depth[here], camera)
    core[here] = cv2.erode(solid[here].view(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
    inner, points = camera.back_project(depth, core), camera.back_project(depth, solid)
    if len(points) < LEAST_POINTS:
        points = camera.back_project(depth, measured)
    if len(inner) < LEAST_POINTS:
        inner = points
    cloud = inner.astype(np.float64)
    return _tight_box(cloud, points.astype(np.float64), _flattest(cloud) if up is None else up, camera)


def _is_steep(measured: Mask, depth: DepthMap, camera: Camera) -> Mask:
    """Return the mask (H, W) of the pixels around which depth changes faster than on a surface tilted by
    `STEEPEST_DEG`.

    measured: mask (H, W) of the pixels with depth. Other pixels are not compared.
    """
    around = np.ones((3, 3), np.uint8)
    farthest = cv2.dilate(np.where(measured, depth, np.float32(0)), around)
    nearest = cv2.erode(np.where(measured, depth, depth.max(initial=0)), around)
    # the window spans two pixels from its first to its last row and column
    steepest = 2 * np.tan(np.radians(STEEPEST_DEG)) / camera.fx * depth
    return np.asarray(farthest - nearest > np.maximum(steepest, NOISE_M)) & measured


def _flattest(points: Vectors) -> Vectors:
    """Return the unit vector (3,) of the direction in which points (N, 3) have the smallest variance."""
    return np.asarray(np.linalg.eigh(np.cov(points.T))[1][:, 0])


def _tight_box(inner: Vectors, points: Vectors, axis: Vectors, camera: Camera) -> OrientedBox:
    """Return the smallest oriented box around points. One axis of the box is parallel to the vector `axis` (3,).

    - inner: points (M, 3) that give the directions of the sides.
    - points: points (N, 3) that give the lengths of the sides.
    """
    middle = np.median(inner, axis=0)
    across = np.linalg.svd(axis[None, :])[2][1:].T
    plane = (inner - middle) @ across
    inside = np.all([_within_trim(p) for p in plane.T], axis=0)
    angle = np.deg2rad(cv2.minAreaRect(plane[inside].astype(np.float32))[2])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    axes = np.column_stack([across @ turn, axis])
    low, high = _ends((inner - middle) @ axes, (points - middle) @ axes, NEAR_PX * middle[2] / camera.fx)
    center = middle + axes @ ((low + high) / 2)
    longest_first = np.argsort(low - high, kind="stable")
    axes = axes[:, longest_first]
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    return OrientedBox(center, (high - low)[longest_first], axes)


def _ends(inner: Vectors, points: Vectors, pixels_m: float) -> tuple[Vectors, Vectors]:
    """Return the ends (3,) of the box along its three axes.

    - inner, points: coordinates (M, 3) and (N, 3) of the points along the axes.
    - pixels_m: length of `NEAR_PX` pixels at the distance of the object, in metres.
    """
    low, high = np.percentile(inner, [TRIM_PERCENT, 100 - TRIM_PERCENT], axis=0)
    more = NEAR_SHARE * (high - low) + NEAR_M + pixels_m
    near = points[((points >= low - more) & (points <= high + more)).all(axis=1)]
    low, high = np.percentile(near, [LAST_PERCENT, 100 - LAST_PERCENT], axis=0)
    return low, high


def _within_trim(values: Vectors) -> Mask:
    low, high = np.percentile(values, [TRIM_PERCENT, 100 - TRIM_PERCENT])
    return np.asarray((values >= low) & (values <= high))
