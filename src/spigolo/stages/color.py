"""Conversion of colour to points whose Euclidean distances are colour differences (eq. 4)."""

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
    """Return the points (3, H, W) of an RGB image (H, W, 3) in the HSV cone, smoothed before the conversion.

    The Euclidean distance of two points, clipped at 1, is eq. 4. Hue wraps around and grey has no hue, both without
    special cases. Smoothing comes first, as a mean of hues on both sides of 0 degrees has no meaning.
    """
    rgb = image.astype(np.float32)
    if config.sigma_px > 0:
        rgb = np.asarray(cv2.GaussianBlur(rgb, (0, 0), config.sigma_px, borderType=cv2.BORDER_REPLICATE), np.float32)
    points = np.empty((3, *image.shape[:2]), np.float32)
    kernel.hsv_points(rgb, config.k_dv, config.k_ds, points)
    return points
