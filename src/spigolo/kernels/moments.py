"""Kernels that compute counts and sums over the pixels of each region."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.rows import border_pixels

DARK_BELOW = 24
"""Limit of the brightness of a pixel, from 0 to 255. A pixel with a smaller brightness is dark."""


@inlined
def sum_squares(end):
    """Return 0^2 + 1^2 + ... + (end - 1)^2."""
    return (end - 1.0) * end * (2.0 * end - 1.0) / 6.0


@kernel
def spread(of_region, labels, out):
    """Compute out (H, W) = of_region[labels], which gives every pixel the value of its region. All arrays are int32."""
    for y in range(labels.shape[0]):
        row, label = out[y], labels[y]
        for x in range(row.size):
            row[x] = of_region[label[x]]


@inlined
def add_run(sums, box, y, first, end):
    """Add the pixels first..end - 1 of row y to the moments (6,) and the bounding box (4,) of a region."""
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
    """Compute the number of pixels, the first and second moments of pixel coordinates, and the bounding box of every
    region.

    - labels (H, W) int32: region of each pixel.
    - sums (R, 6) float64, initially zero: number of pixels, sums of y, x, y^2, y x and x^2.
    - boxes (R, 4) int32: first row, first column, last row + 1, last column + 1.
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
    """Add n points of row y to the sums (4,) of a region: number of points, sums of X, Y and Z."""
    fx, fy, cx, cy = camera
    sums[0] += n
    sums[1] += (sum_xz - cx * sum_z) / fx
    sums[2] += (y - cy) * sum_z / fy
    sums[3] += sum_z


@kernel
def sum_depth(labels, depth, camera, sums):
    """Compute the number of pixels with depth, and the sum of their points in metres, for every region.

    sums (R, 4) float64, initially zero: number of pixels, sums of X, Y and Z.
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
    """Count the pixels of each region that are 1 in a mask (H, W) uint8. counts (R,) int64, initially zero."""
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
    """Count the pixels of each region whose brightness max(R, G, B) is below DARK_BELOW. counts (R,), initially
    zero.
    """
    height, width = labels.shape
    for y in range(height):
        for x in range(width):
            if max(color[y, x, 0], color[y, x, 1], color[y, x, 2]) < np.uint8(DARK_BELOW):
                counts[labels[y, x]] += 1


@kernel
def sum_contours(labels, boundary, sums):
    """Count the pairs of 4-neighbours on the border of each region, and sum the boundary values of these pairs.

    The value of a pair is the larger boundary value of both pixels. Sides of pixels on the image border are not
    counted.

    - labels (H, W) int32: region of each pixel.
    - boundary (H, W): boundary map, from 0 to 1.
    - sums (R, 2) float64: number of pairs, sum of boundary values.
    """
    height, width = labels.shape
    for p in border_pixels(labels):
        y, x = divmod(p, width)
        for v, u in ((y, x + 1), (y + 1, x)):
            if v >= height or u >= width or labels[v, u] == labels[y, x]:
                continue
            strength = float(max(boundary[y, x], boundary[v, u]))
            for region in (labels[y, x], labels[v, u]):
                sums[region, 0] += 1.0
                sums[region, 1] += strength
