"""Sums over the pixels of every region."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import kernel

DARK_BELOW = 24
"""The first three of 32 bins of a brightness in 0..255."""


@kernel
def sum_regions(labels, sums, boxes):
    """Count and first and second moments of the pixel coordinates, and the box of every region.

    labels (H, W) int32; sums (R, 6) float64 = n, sum y, sum x, sum yy, sum yx, sum xx, zero before;
    boxes (R, 4) int32 = first row, first column, last row + 1, last column + 1.
    """
    height, width = labels.shape
    boxes[:, 0], boxes[:, 1] = height, width
    boxes[:, 2], boxes[:, 3] = 0, 0
    for y in range(height):
        for x in range(width):
            k = labels[y, x]
            sums[k, 0] += 1.0
            sums[k, 1] += y
            sums[k, 2] += x
            sums[k, 3] += y * y
            sums[k, 4] += y * x
            sums[k, 5] += x * x
            boxes[k, 0], boxes[k, 1] = min(boxes[k, 0], y), min(boxes[k, 1], x)
            boxes[k, 2], boxes[k, 3] = max(boxes[k, 2], y + 1), max(boxes[k, 3], x + 1)


@kernel
def sum_depth(labels, depth, camera, sums):
    """Valid pixels of every region and the sum of their points in metres.

    sums (R, 4) float64 = n, sum X, sum Y, sum Z, zero before.
    """
    height, width = labels.shape
    fx, fy, cx, cy = camera
    for y in range(height):
        for x in range(width):
            z = float(depth[y, x])
            if z > 0.0:
                k = labels[y, x]
                sums[k, 0] += 1.0
                sums[k, 1] += (x - cx) * z / fx
                sums[k, 2] += (y - cy) * z / fy
                sums[k, 3] += z


@kernel
def count_dark(labels, color, counts):
    """Pixels of every region whose brightness max(R, G, B) lies in the first three of 32 bins."""
    height, width = labels.shape
    for y in range(height):
        for x in range(width):
            if max(color[y, x, 0], color[y, x, 1], color[y, x, 2]) < np.uint8(DARK_BELOW):
                counts[labels[y, x]] += 1


@kernel
def sum_contours(labels, boundary, sums):
    """How many pairs of 4-neighbours each region's border has, and the sum of the boundary there.

    boundary (H, W) in [0, 1], the larger of both ends counts for both regions; sums (R, 2) float64 = pairs, sum.
    The image border is no contour.
    """
    height, width = labels.shape
    for y in range(height):
        for x in range(width):
            here = labels[y, x]
            for dy, dx in ((0, 1), (1, 0)):
                v, u = y + dy, x + dx
                if v >= height or u >= width or labels[v, u] == here:
                    continue
                strength = float(max(boundary[y, x], boundary[v, u]))
                for region in (here, labels[v, u]):
                    sums[region, 0] += 1.0
                    sums[region, 1] += strength
