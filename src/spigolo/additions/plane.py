"""Planes of a frame: heights of pixels above a plane, and masks of pixels on or above a plane (our addition, not in the
paper).

The masks of the pixels on or above a plane are computed from all pixels. The share of points that stand on a plane
(`Sample.share_standing_on`) is estimated from a sample of pixels.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Camera, DepthMap, Mask
from spigolo.kernels import planes as kernel
from spigolo.settings.support import Support

SAMPLES = 3000
"""Maximum number of pixels in a sample of a frame."""
CELLS = 24
"""Number of grid cells along the longer image side. The grid is used to test which points are surrounded by a plane."""
TALLEST_M = 0.3
"""Upper limit of the height of a point that counts as standing on a plane, in metres."""
SPECKLE_PX = 5

Points = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """Plane with a unit normal (3,) towards the camera. The height of a point p above the plane is normal . p +
    offset_m.
    """

    normal: Points
    offset_m: float

    def height_m(self, points: Points) -> Points:
        """Return the heights (N,) of points (N, 3) above the plane, in metres. Heights are positive on the camera's
        side of the plane.
        """
        return np.asarray(points @ self.normal + self.offset_m)

    def height_map_m(self, depth: DepthMap, camera: Camera) -> npt.NDArray[np.float32]:
        """Return the heights (H, W) of the pixels of a depth map (H, W) above the plane, in metres. Pixels without
        depth get the value offset_m.
        """
        out = np.empty(depth.shape, np.float32)
        kernel.measure_heights(depth, *self.slopes(depth.shape, camera), np.float32(self.offset_m), out)
        return out

    def slopes(
        self, shape: tuple[int, ...], camera: Camera
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], np.float32]:
        """Return the terms of a formula for the height above the plane: arrays s_x (W,) and s_y (H,), and a number s.
        The height of pixel (y, x) is (s_x[x] + s_y[y] + s) * depth + offset_m.
        """
        a, b, c = (float(v) for v in self.normal)
        slope_x = (np.arange(shape[1], dtype=np.float32) - np.float32(camera.cx)) * np.float32(a / camera.fx)
        slope_y = (np.arange(shape[0], dtype=np.float32) - np.float32(camera.cy)) * np.float32(b / camera.fy)
        return slope_x, slope_y, np.float32(c)


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Sample of the measured points of a frame. Planes are tested with the points of the sample."""

    points: Points
    """Points (N, 3) in the camera's frame, metres."""
    cells: npt.NDArray[np.int64]
    """Row and column (N, 2) of each point's cell in a coarse grid over the image."""

    @classmethod
    def at(cls, y: npt.NDArray[np.int64], x: npt.NDArray[np.int64], depth: DepthMap, camera: Camera) -> Sample:
        """Create a sample from the pixels with rows y (N,) and columns x (N,) of a depth map (H, W) in metres."""
        z = depth[y, x].astype(np.float64)
        points = np.stack([(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z], axis=1)
        return cls(points, np.stack([y, x], axis=1) * CELLS // max(depth.shape))

    def on(self, plane: Plane, config: Support) -> Mask:
        """Return a mask (N,) of the points that lie on a plane, within the tolerance of `tolerance_m`."""
        return np.asarray(np.abs(plane.height_m(self.points)) <= tolerance_m(self.points[:, 2], config))

    def share_on(self, plane: Plane, config: Support) -> float:
        """Return the share of the sampled points that lie on a plane."""
        return float(self.on(plane, config).mean())

    def share_standing_on(self, plane: Plane, config: Support) -> float:
        """Return the share of the sampled points that stand on a plane.

        A point stands on a plane if the plane surrounds the point on at least three sides. The height of the point
        above the plane must also be larger than the tolerance and smaller than `TALLEST_M`.
        """
        height = plane.height_m(self.points)
        above = (height > tolerance_m(self.points[:, 2], config)) & (height < TALLEST_M)
        return float((above & self.surrounded(self.on(plane, config))).mean())

    def surrounded(self, on: Mask) -> Mask:
        """Return a mask (N,) of the points that a plane surrounds on at least three of four sides.

        on: mask (N,) of the points on the plane.

        A cell of the grid belongs to the plane if most points of the cell are on the plane. The sides of a point are
        left, right, above and below in the grid. The plane surrounds a point on a side if any cell on this side, in the
        same grid row or column, belongs to the plane.
        """
        rows, columns = self.cells.T
        votes = np.zeros(self.cells.max(axis=0) + 1, np.int64)
        np.add.at(votes, (rows, columns), 2 * on - 1)
        shown, along = (votes > 0).astype(np.int64), np.maximum.accumulate
        sides = along(shown, 0) + along(shown[::-1], 0)[::-1] + along(shown, 1) + along(shown[:, ::-1], 1)[:, ::-1]
        return np.asarray((sides >= 3)[rows, columns])


def tolerance_m(depth: npt.NDArray[np.floating], config: Support) -> npt.NDArray[np.float32]:
    """Return the tolerance in metres: the maximum distance from a plane at which a pixel counts as lying on the plane.
    The tolerance is max(`min_height_m`, `noise_per_m` * depth^2).
    """
    return np.maximum(np.float32(config.min_height_m), np.float32(config.noise_per_m) * depth * depth)


def support_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the mask (H, W) of pixels that lie on the plane, within the tolerance of `tolerance_m`."""
    return np.asarray(_sides(plane, depth, camera, config) == kernel.ON)


def above_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the mask (H, W) of pixels that are above the plane by more than the tolerance of `tolerance_m`."""
    return np.asarray(_sides(plane, depth, camera, config) == kernel.ABOVE)


def foot_contour(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the mask (H, W) of the outlines of objects on a plane. An outline pixel lies above the plane, and a
    neighbouring pixel does not.

    A median filter first removes small speckles above the plane.
    """
    above = cv2.medianBlur(above_mask(plane, depth, camera, config).view(np.uint8), SPECKLE_PX)
    outside = (above == 0).view(np.uint8)
    return np.asarray((above > 0) & (cv2.dilate(outside, np.ones((3, 3), np.uint8)) > 0))


def things_on(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> float:
    """Return the share of the measured points that stand on a plane, estimated from a grid of pixels
    (`Sample.share_standing_on`).
    """
    sample = sample_frame(depth, camera)
    return sample.share_standing_on(plane, config) if len(sample.points) else 0.0


def sample_frame(depth: DepthMap, camera: Camera) -> Sample:
    """Return a sample of the measured pixels on a regular grid over a depth map (H, W) in metres."""
    step = max(round((depth.size / SAMPLES) ** 0.5), 1)
    y, x = np.nonzero(depth[::step, ::step])
    return Sample.at(y * step, x * step, depth, camera)


def _sides(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> npt.NDArray[np.uint8]:
    out = np.empty(depth.shape, np.uint8)
    least, noise = np.float32(config.min_height_m), np.float32(config.noise_per_m)
    kernel.tell_sides(depth, *plane.slopes(depth.shape, camera), np.float32(plane.offset_m), least, noise, out)
    return out
