"""The support: the largest plane of a frame, on which objects stand (our addition, not in the paper)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.config import Support
from spigolo.frame import Camera, DepthMap, Mask

SAMPLES = 3000
HYPOTHESES = 200
REFINEMENTS = 3
SPECKLE_PX = 5
SEED = 7
"""RANSAC draws from a fixed seed: the same frame gives the same plane."""

Points = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """normal (3,) of length 1, towards the camera; height of a point p above the plane = normal . p + offset_m."""

    normal: Points
    offset_m: float

    def height_m(self, points: Points) -> Points:
        """Heights (N,) of points (N, 3); the camera's side counts as above."""
        return np.asarray(points @ self.normal + self.offset_m)

    def height_map_m(self, depth: DepthMap, camera: Camera) -> npt.NDArray[np.float32]:
        """Height (H, W) of every pixel of a depth map (H, W) in metres; offset_m where depth is missing."""
        height, width = depth.shape
        a, b, c = (float(v) for v in self.normal)
        slope_x = (np.arange(width, dtype=np.float32) - np.float32(camera.cx)) * np.float32(a / camera.fx)
        slope_y = (np.arange(height, dtype=np.float32) - np.float32(camera.cy)) * np.float32(b / camera.fy)
        return np.asarray((slope_x + slope_y[:, None] + np.float32(c)) * depth + np.float32(self.offset_m))


def tolerance_m(depth: npt.NDArray[np.floating], config: Support) -> npt.NDArray[np.float32]:
    """How far a pixel may lie off the plane: the height that counts, or the depth error where that is larger."""
    return np.maximum(np.float32(config.min_height_m), np.float32(config.noise_per_m) * depth * depth)


def find_support(depth: DepthMap, camera: Camera, config: Support) -> Plane | None:
    """The plane with the most measured pixels; None where no plane has `min_share` of them.

    RANSAC on a sample of the pixels, then least squares on what lies within the tolerance.
    """
    valid = np.flatnonzero(depth)
    if valid.size < 3:
        return None
    rng = np.random.default_rng(SEED)
    y, x = np.divmod(valid[rng.integers(valid.size, size=min(SAMPLES, valid.size))], depth.shape[1])
    z = depth[y, x].astype(np.float64)
    sample = np.stack([(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z], axis=1)
    plane = _best_hypothesis(sample, rng, config)
    for _ in range(REFINEMENTS):
        inliers = sample[_on(plane, sample, config)]
        if len(inliers) < 3:
            return None
        plane = _fit(inliers)
    return plane if _on(plane, sample, config).mean() >= config.min_share else None


def support_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Pixels (H, W) that lie on the plane, within the tolerance."""
    return np.asarray((depth > 0) & (np.abs(plane.height_map_m(depth, camera)) <= tolerance_m(depth, config)))


def above_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Pixels (H, W) that stand above the plane by more than the tolerance."""
    return np.asarray((depth > 0) & (plane.height_map_m(depth, camera) > tolerance_m(depth, config)))


def foot_contour(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Pixels (H, W) above the plane with a neighbour that is not, or has no depth: where objects end.

    Speckles of a pixel or two are smoothed away first.
    """
    above = cv2.medianBlur(above_mask(plane, depth, camera, config).view(np.uint8), SPECKLE_PX)
    beside = (above == 0).view(np.uint8)
    return np.asarray((above > 0) & (cv2.dilate(beside, np.ones((3, 3), np.uint8)) > 0))


def _on(plane: Plane, points: Points, config: Support) -> Mask:
    return np.asarray(np.abs(plane.height_m(points)) <= tolerance_m(points[:, 2], config))


def _best_hypothesis(sample: Points, rng: np.random.Generator, config: Support) -> Plane:
    a, b, c = sample[rng.integers(len(sample), size=(3, HYPOTHESES))]
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 1e-9)
    offsets = -(normals * a).sum(1)
    x, y, z = sample.astype(np.float32).T[:, :, None]
    nx, ny, nz, d = np.column_stack([normals, offsets]).astype(np.float32).T[:, None, :]
    # written out: a matrix product of this size would start the threads of BLAS
    near = np.abs(x * nx + y * ny + z * nz + d) <= tolerance_m(z, config)
    near[:, lengths[:, 0] <= 1e-9] = False
    best = int(near.sum(0).argmax())
    return _towards_camera(normals[best], float(offsets[best]))


def _fit(points: Points) -> Plane:
    """The plane of least squares through points (N, 3)."""
    middle = points.mean(0)
    normal = np.linalg.eigh(np.cov((points - middle).T))[1][:, 0]
    return _towards_camera(normal, -float(normal @ middle))


def _towards_camera(normal: Points, offset_m: float) -> Plane:
    """The camera stands at the origin, so the side where the offset is positive is its side."""
    return Plane(normal, offset_m) if offset_m >= 0 else Plane(-normal, -offset_m)
