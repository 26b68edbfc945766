"""Conversion of RGB colours to points whose Euclidean distances are colour differences (equation 4)."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames import frame
from spigolo.kernels import color as kernel
from spigolo.settings.paper import ColorConfig

Points = npt.NDArray[np.float32]


@stage("colour")
def color_points(image: frame.Color, config: ColorConfig) -> Points:
    """Smooth an RGB image (H, W, 3) and convert its colours to points (3, H, W) in the HSV cone.

    The Euclidean distance of two points, clipped to 1, is the colour difference of equation 4. The image is smoothed
    before the conversion, because hues are angles: the mean of 1 and 359 degrees would be 180 degrees instead of 0.
    """
    rgb = image.astype(np.float32)
    if config.sigma_px > 0:
        rgb = np.asarray(cv2.GaussianBlur(rgb, (0, 0), config.sigma_px, borderType=cv2.BORDER_REPLICATE), np.float32)
    points = np.empty((3, *image.shape[:2]), np.float32)
    kernel.hsv_points(rgb, config.k_dv, config.k_ds, points)
    return points
