"""Kernel that computes edge weights from feature vectors of pixels (equation 1), in float32."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

ZERO = np.float32(0.0)


@inlined
def squared_difference(a, b):
    """Return the squared difference of two values, or 0 if one value is missing (NaN)."""
    difference = a - b
    square = difference * difference
    return square if square >= ZERO else ZERO


@kernel
def feature_plane(features, apart, dy, dx, out):
    """Eq. 1. Compute the Euclidean distance of the features of both pixels, for all edges with the offset (dy, dx).

    - features (C, H, W) float32, NaN = missing.
    - apart: squared distance of the two pixels in the image, times a weight. The product is added to the squared
      distance of the features of both pixels.
    - out (H, W) float32, +inf where an edge leaves the image.
    """
    components, height, width = features.shape
    out[:] = np.inf
    for y in range(max(0, -dy), height - max(0, dy)):
        row = out[y, : max(width - dx, 0)]
        row[:] = apart
        for c in range(components):
            here, there = features[c, y, : row.size], features[c, y + dy, dx:]
            for x in range(row.size):
                row[x] += squared_difference(here[x], there[x])
        for x in range(row.size):
            row[x] = np.sqrt(row[x])
