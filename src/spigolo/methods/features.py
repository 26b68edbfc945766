"""Feature vectors of pixels, and a graph whose edge weights are distances of features (equation 1)."""

from __future__ import annotations

import math

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color, DepthMap
from spigolo.kernels import features as kernel
from spigolo.stages.graph import OFFSETS, Graph

Features = npt.NDArray[np.float32]


def color_features(image: Color, sigma_px: float) -> Features:
    """Return the RGB channels (3, H, W) of an image as features from 0 to 255. The channels are smoothed by a Gaussian
    with a standard deviation of `sigma_px` pixels.
    """
    return np.ascontiguousarray(smooth(image.astype(np.float32), sigma_px).transpose(2, 0, 1))


def depth_feature(depth: DepthMap, sigma_px: float, levels_per_m: float) -> Features:
    """Return depth as a feature (H, W). Valid pixels are smoothed by a Gaussian with a standard deviation of `sigma_px`
    pixels. The value NaN marks missing depth.

    depth: (H, W) in metres. levels_per_m: number of colour levels with the same weight as one metre of depth.
    """
    valid = (depth > 0).astype(np.float32)
    mean = smooth(depth, sigma_px) / np.maximum(smooth(valid, sigma_px), np.float32(1e-6))
    return np.where(valid > 0, mean * np.float32(levels_per_m), np.float32(np.nan))


def smooth(image: npt.NDArray[np.float32], sigma_px: float) -> npt.NDArray[np.float32]:
    """Smooth an image (H, W) or (H, W, C) by a Gaussian with a radius of 4 sigma and replicated image borders."""
    if sigma_px == 0:
        return image
    size = 2 * math.ceil(4 * sigma_px) + 1
    blurred = cv2.GaussianBlur(image, (size, size), sigma_px, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(blurred, np.float32)


def feature_graph(features: Features, connectivity: int, k_xy: float = 0.0) -> Graph:
    """Return the graph whose edge weights are the distances of features (C, H, W) of neighbours (equation 1).

    connectivity: number of neighbours of a pixel, 4 or 8. k_xy: feature difference with the same effect on an edge
    weight as a distance of one pixel.
    """
    weights = np.empty((connectivity // 2, *features.shape[1:]), np.float32)
    for plane, (dy, dx) in zip(weights, OFFSETS, strict=False):
        kernel.feature_plane(features, np.float32(k_xy**2 * (dy**2 + dx**2)), dy, dx, plane)
    return Graph(weights)
