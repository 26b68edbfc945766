"""Plane of a frame: heights above it, and the pixels that lie on it or stand on it (ours, not in the paper).

Two tests are exact and return a mask: pixels on the plane and pixels above it. Objects that stand on the plane are
estimated on a sample of the pixels.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Camera, DepthMap, Mask
from spigolo.kernels import planes as kernel
from spigolo.settings.additions import Support

SAMPLES = 3000
"""Number of pixels in a sample of a frame."""
CELLS = 24
"""Number of grid cells along the longer image side, to find points that a plane surrounds."""
TALLEST_M = 0.3
"""Maximum height above a plane at which points count as things standing on it, metres."""
SPECKLE_PX = 5

Points = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """Plane with unit normal (3,) towards the camera. The height of point p is normal . p + offset_m."""

    normal: Points
    offset_m: float

    def height_m(self, points: Points) -> Points:
        """Return the heights (N,) of points (N, 3) above the plane. The side of the camera is positive."""
        return np.asarray(points @ self.normal + self.offset_m)

    def height_map_m(self, depth: DepthMap, camera: Camera) -> npt.NDArray[np.float32]:
        """Return the height (H, W) of every pixel of a depth map (H, W) in metres. Missing depth gives offset_m."""
        out = np.empty(depth.shape, np.float32)
        kernel.measure_heights(depth, *self.slopes(depth.shape, camera), np.float32(self.offset_m), out)
        return out

    def slopes(
        self, shape: tuple[int, ...], camera: Camera
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], np.float32]:
        """Return slopes for columns, for rows and a constant slope. height = (sum of the three) * depth + offset_m."""
        a, b, c = (float(v) for v in self.normal)
        slope_x = (np.arange(shape[1], dtype=np.float32) - np.float32(camera.cx)) * np.float32(a / camera.fx)
        slope_y = (np.arange(shape[0], dtype=np.float32) - np.float32(camera.cy)) * np.float32(b / camera.fy)
        return slope_x, slope_y, np.float32(c)


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Measured points of a frame, to test planes on."""

    points: Points
    """Points (N, 3) in the camera's frame, metres."""
    cells: npt.NDArray[np.int64]
    """Row and column (N, 2) of each point in a coarse grid over the image."""

    @classmethod
    def at(cls, y: npt.NDArray[np.int64], x: npt.NDArray[np.int64], depth: DepthMap, camera: Camera) -> Sample:
        """Return the sample of pixels with rows y and columns x (N,) of a depth map (H, W) in metres."""
        z = depth[y, x].astype(np.float64)
        points = np.stack([(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z], axis=1)
        return cls(points, np.stack([y, x], axis=1) * CELLS // max(depth.shape))

    def on(self, plane: Plane, config: Support) -> Mask:
        """Return True for the points (N,) on a plane, within the tolerance."""
        return np.asarray(np.abs(plane.height_m(self.points)) <= tolerance_m(self.points[:, 2], config))

    def share_on(self, plane: Plane, config: Support) -> float:
        """Return the share of the points that lie on a plane."""
        return float(self.on(plane, config).mean())

    def share_standing_on(self, plane: Plane, config: Support) -> float:
        """Return the share of the points that stand on a plane.

        These points are at most `TALLEST_M` above the plane, and the plane surrounds them on three sides.
        """
        height = plane.height_m(self.points)
        above = (height > tolerance_m(self.points[:, 2], config)) & (height < TALLEST_M)
        return float((above & self.surrounded(self.on(plane, config))).mean())

    def surrounded(self, on: Mask) -> Mask:
        """Return True for points (N,) in grid cells with the plane on at least three sides. on (N,): points on the
        plane.

        A cell belongs to the plane if most of its points do.
        """
        rows, columns = self.cells.T
        votes = np.zeros(self.cells.max(axis=0) + 1, np.int64)
        np.add.at(votes, (rows, columns), 2 * on - 1)
        shown, along = (votes > 0).astype(np.int64), np.maximum.accumulate
        sides = along(shown, 0) + along(shown[::-1], 0)[::-1] + along(shown, 1) + along(shown[:, ::-1], 1)[:, ::-1]
        return np.asarray((sides >= 3)[rows, columns])


def tolerance_m(depth: npt.NDArray[np.floating], config: Support) -> npt.NDArray[np.float32]:
    """Return the maximum distance of plane pixels from the plane: `min_height_m`, or the depth error if that is
    larger.
    """
    return np.maximum(np.float32(config.min_height_m), np.float32(config.noise_per_m) * depth * depth)


def support_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the pixels (H, W) that lie on the plane, within the tolerance."""
    return np.asarray(_sides(plane, depth, camera, config) == kernel.ON)


def above_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the pixels (H, W) that are above the plane by more than the tolerance."""
    return np.asarray(_sides(plane, depth, camera, config) == kernel.ABOVE)


def foot_contour(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the pixels (H, W) above the plane that have a neighbour on the plane or without depth: object outlines.

    Speckles of one or two pixels are removed first.
    """
    above = cv2.medianBlur(above_mask(plane, depth, camera, config).view(np.uint8), SPECKLE_PX)
    beside = (above == 0).view(np.uint8)
    return np.asarray((above > 0) & (cv2.dilate(beside, np.ones((3, 3), np.uint8)) > 0))


def things_on(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> float:
    """Return the share of the measured pixels that stand on a plane, estimated on a grid of pixels."""
    sample = sample_frame(depth, camera)
    return sample.share_standing_on(plane, config) if len(sample.points) else 0.0


def sample_frame(depth: DepthMap, camera: Camera) -> Sample:
    """Return the measured pixels of a grid over a depth map (H, W) in metres."""
    step = max(round((depth.size / SAMPLES) ** 0.5), 1)
    y, x = np.nonzero(depth[::step, ::step])
    return Sample.at(y * step, x * step, depth, camera)


def _sides(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> npt.NDArray[np.uint8]:
    out = np.empty(depth.shape, np.uint8)
    least, noise = np.float32(config.min_height_m), np.float32(config.noise_per_m)
    kernel.tell_sides(depth, *plane.slopes(depth.shape, camera), np.float32(plane.offset_m), least, noise, out)
    return out
