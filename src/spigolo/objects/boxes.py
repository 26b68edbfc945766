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

TRIM_PERCENT = 1.0
"""Percentage of the points that are ignored at each end of each axis of the box. The ignored points are often flying
pixels, whose depth lies between object and background.
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

    The box covers only the visible surface. Pixels at the outline of the mask and the outermost points along each axis
    are ignored. Depth at the outline often lies between the depths of object and background (flying pixels).

    - mask: mask (H, W) of the pixels of the object.
    - depth: depth map (H, W) in metres.
    - up: unit vector (3,) that one axis of the box must be parallel to, such as the normal of the support plane. If
      `up` is None, this axis is the direction in which the points have the smallest variance.

    Returns None if fewer than 10 pixels have depth.
    """
    core = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
    points = camera.back_project(depth, core)
    if len(points) < LEAST_POINTS:
        points = camera.back_project(depth, mask)
    if len(points) < LEAST_POINTS:
        return None
    cloud = points.astype(np.float64)
    return _tight_box(cloud, _flattest(cloud) if up is None else up)


def _flattest(points: Vectors) -> Vectors:
    """Return the unit vector (3,) of the direction in which points (N, 3) have the smallest variance."""
    return np.asarray(np.linalg.eigh(np.cov(points.T))[1][:, 0])


def _tight_box(points: Vectors, axis: Vectors) -> OrientedBox:
    """Return the smallest oriented box around points (N, 3). One axis of the box is parallel to the vector `axis`
    (3,).
    """
    middle = np.median(points, axis=0)
    across = np.linalg.svd(axis[None, :])[2][1:].T
    plane = (points - middle) @ across
    inside = np.all([_within_trim(p) for p in plane.T], axis=0)
    angle = np.deg2rad(cv2.minAreaRect(plane[inside].astype(np.float32))[2])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    axes = np.column_stack([across @ turn, axis])
    low, high = np.percentile((points - middle) @ axes, [TRIM_PERCENT, 100 - TRIM_PERCENT], axis=0)
    center = middle + axes @ ((low + high) / 2)
    longest_first = np.argsort(low - high, kind="stable")
    axes = axes[:, longest_first]
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    return OrientedBox(center, (high - low)[longest_first], axes)


def _within_trim(values: Vectors) -> Mask:
    low, high = np.percentile(values, [TRIM_PERCENT, 100 - TRIM_PERCENT])
    return np.asarray((values >= low) & (values <= high))
