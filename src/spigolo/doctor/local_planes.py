"""Planes that are fitted to the inverse depth in a square of pixels around every pixel.

For a pinhole camera, the inverse depth 1 / Z of a plane is linear in pixel coordinates. The fits therefore need no
intrinsics. The noise of 1 / Z is the noise of Z divided by Z^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Camera, DepthMap, Mask

RADIUS_PX = 3

Map = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LocalPlanes:
    """Planes fitted to inverse depth, as maps (H, W): slopes in 1/(m px), mean and root-mean-square residual in 1/m.

    whole: True at a pixel if the square of 7x7 pixels around it has no missing depth. The other maps are valid only
    where `whole` is True.
    """

    slope_x: Map
    slope_y: Map
    mean: Map
    residual: Map
    whole: Mask

    def normals(self, y: npt.NDArray[np.intp], x: npt.NDArray[np.intp], camera: Camera) -> Map:
        """Return the normals (N, 3) of the planes at the pixels (y, x), not normalised."""
        a, b = self.slope_x[y, x], self.slope_y[y, x]
        c = self.mean[y, x] - (x - camera.cx) * a - (y - camera.cy) * b
        return np.stack([camera.fx * a, camera.fy * b, c], axis=1)


def fit_local_planes(depth: DepthMap) -> LocalPlanes:
    """Fit a plane to the inverse depth in the square of 7x7 pixels around each pixel, by least squares."""
    size = 2 * RADIUS_PX + 1
    inverse = np.divide(1.0, depth, out=np.zeros(depth.shape), where=depth > 0)
    whole = cv2.erode((depth > 0).astype(np.uint8), np.ones((size, size), np.uint8), borderValue=0) > 0
    along, across = np.arange(-RADIUS_PX, RADIUS_PX + 1.0), np.ones(size)
    spread = float((along**2).mean())
    slope_x = cv2.sepFilter2D(inverse, -1, along / (size * size * spread), across)
    slope_y = cv2.sepFilter2D(inverse, -1, across, along / (size * size * spread))
    mean = cv2.boxFilter(inverse, -1, (size, size))
    variance = cv2.boxFilter(inverse * inverse, -1, (size, size)) - mean * mean
    residual = np.sqrt(np.maximum(variance - (slope_x**2 + slope_y**2) * spread, 0))
    x, y, middle = (np.asarray(m, np.float64) for m in (slope_x, slope_y, mean))
    return LocalPlanes(x, y, middle, residual, np.asarray(whole))
