"""Points near planes."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import kernel

MISSING, BELOW, ON, ABOVE = range(4)


@kernel
def count_near(points, planes, tolerance, counts):
    """How many points lie within their tolerance of each plane; counts (P,) int64.

    points (3, N) and tolerance (N,) float32 metres; planes (P, 4) float32: unit normal and offset.
    """
    xs, ys, zs = points
    for k in range(len(planes)):
        a, b, c, d = planes[k]
        near = 0
        for i in range(xs.size):
            near += abs(xs[i] * a + ys[i] * b + zs[i] * c + d) <= tolerance[i]
        counts[k] = near


@kernel
def tell_sides(depth, slope_x, slope_y, slope, offset, least, noise, out):
    """On which side of a plane every pixel lies: out (H, W) uint8 is MISSING, BELOW, ON or ABOVE.

    Its height is (slope_x[x] + slope_y[y] + slope) * depth + offset, all float32 in metres; it lies on the plane within
    max(least, noise * depth^2).
    """
    for y in range(depth.shape[0]):
        row, side, of_row = depth[y], out[y], slope_y[y]
        for x in range(row.size):
            d = row[x]
            height, tolerance = (slope_x[x] + of_row + slope) * d + offset, noise * d * d
            tolerance = tolerance if tolerance > least else least
            known = np.uint8(ABOVE if height > tolerance else (ON if height >= -tolerance else BELOW))
            side[x] = known if d > np.float32(0) else np.uint8(MISSING)
