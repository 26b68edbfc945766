"""The plain weight of a pixel grid: how far apart the features of two pixels lie (eq. 1), in float32."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

ZERO = np.float32(0.0)


@inlined
def squared_difference(a, b):
    """Squared difference of one component. It is 0 if either end lacks it (NaN)."""
    difference = a - b
    square = difference * difference
    return square if square >= ZERO else ZERO


@kernel
def feature_plane(features, apart, dy, dx, out):
    """Eq. 1. Euclidean distance of the features of both ends of every edge of one plane, from pixels to (dy, dx).

    features (C, H, W) float32, NaN = missing. apart: what the coordinates of both ends add to the square, the same for
    all edges of a plane. out (H, W) float32, +inf where an edge leaves the image.
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
