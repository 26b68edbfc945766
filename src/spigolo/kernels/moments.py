"""Kernels for sums over the pixels of each region."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

DARK_BELOW = 24
"""Upper end of the three darkest of 32 bins of a brightness in 0..255."""


@inlined
def sum_squares(end):
    """Return 0^2 + 1^2 + ... + (end - 1)^2."""
    return (end - 1.0) * end * (2.0 * end - 1.0) / 6.0


@kernel
def spread(of_region, labels, out):
    """Give every pixel the number of its region: out (H, W) = of_region[labels], all int32."""
    for y in range(labels.shape[0]):
        row, label = out[y], labels[y]
        for x in range(row.size):
            row[x] = of_region[label[x]]


@inlined
def add_run(sums, box, y, first, end):
    """Add columns first..end - 1 of row y to the moments (6,) and the box (4,) of their region, in closed form."""
    n = float(end - first)
    sum_x = n * (first + end - 1.0) / 2.0
    sums[0] += n
    sums[1] += n * y
    sums[2] += sum_x
    sums[3] += n * y * y
    sums[4] += y * sum_x
    sums[5] += sum_squares(end) - sum_squares(first)
    box[0], box[1], box[2], box[3] = min(box[0], y), min(box[1], first), y + 1, max(box[3], end)


@kernel
def sum_regions(labels, sums, boxes):
    """Count and first and second moments of the pixel coordinates, and the box of every region.

    labels (H, W) int32. sums (R, 6) float64 = n, sum y, sum x, sum yy, sum yx, sum xx, zero before.
    Boxes (R, 4) int32 = first row, first column, last row + 1, last column + 1. Run of equal labels by run.
    """
    height, width = labels.shape
    boxes[:, 0], boxes[:, 1] = height, width
    boxes[:, 2], boxes[:, 3] = 0, 0
    for y in range(height):
        row, first = labels[y], 0
        region = row[0]
        for x in range(1, width):
            if row[x] != region:
                add_run(sums[region], boxes[region], y, first, x)
                region, first = row[x], x
        add_run(sums[region], boxes[region], y, first, width)


@inlined
def add_points(sums, y, n, sum_z, sum_xz, camera):
    """Add the n points of a run in row y to the sums (4,) of their region."""
    fx, fy, cx, cy = camera
    sums[0] += n
    sums[1] += (sum_xz - cx * sum_z) / fx
    sums[2] += (y - cy) * sum_z / fy
    sums[3] += sum_z


@kernel
def sum_depth(labels, depth, camera, sums):
    """Valid pixels of every region and the sum of their points in metres.

    sums (R, 4) float64 = n, sum X, sum Y, sum Z, zero before.
    """
    for y in range(labels.shape[0]):
        row, along = labels[y], depth[y]
        region, n, sum_z, sum_xz = row[0], 0, 0.0, 0.0
        for x in range(row.size):
            if row[x] != region:
                add_points(sums[region], y, n, sum_z, sum_xz, camera)
                region, n, sum_z, sum_xz = row[x], 0, 0.0, 0.0
            z = float(along[x])
            n += z > 0.0
            sum_z += z
            sum_xz += x * z
        add_points(sums[region], y, n, sum_z, sum_xz, camera)


@kernel
def count_marked(labels, mask, counts):
    """Count the pixels of each region in a mask (H, W) uint8 of 0 and 1. counts (R,) int64, initially zero."""
    for y in range(labels.shape[0]):
        row, marks = labels[y], mask[y]
        region, marked = row[0], 0
        for x in range(row.size):
            if row[x] != region:
                counts[region] += marked
                region, marked = row[x], 0
            marked += marks[x]
        counts[region] += marked


@kernel
def count_dark(labels, color, counts):
    """Count the pixels of each region with a brightness max(R, G, B) in the three darkest of 32 bins."""
    height, width = labels.shape
    for y in range(height):
        for x in range(width):
            if max(color[y, x, 0], color[y, x, 1], color[y, x, 2]) < np.uint8(DARK_BELOW):
                counts[labels[y, x]] += 1


@kernel
def sum_contours(labels, boundary, sums):
    """Count the pairs of 4-neighbours on each region's border, and sum the boundary there.

    boundary (H, W) in [0, 1]: the larger of both ends counts for both regions. sums (R, 2) float64 = pairs, sum. The
    image border is no contour.
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
