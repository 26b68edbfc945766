"""Kernels that smooth a depth map with a window size that depends on depth (Holzer et al., 2012, equations 5-8)."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@kernel
def mark_steps(depth, error_per_m, step_factor, out):
    """Compute the inverted depth-change map of Holzer et al.: 0 at depth steps and missing depth, 1 elsewhere.

    A depth step at depth d (m) is a difference of at least step_factor * error_per_m * d^2 to the right or lower
    neighbour. The depth-change map is inverted, because `distance_to_zero` measures the distance to the nearest zero.
    """
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            d = depth[y, x]
            limit = step_factor * error_per_m * d * d
            right = x + 1 < width and abs(depth[y, x + 1] - d) >= limit
            below = y + 1 < height and abs(depth[y + 1, x] - d) >= limit
            out[y, x] = 0 if d == 0.0 or right or below else 1


@inlined
def down_and_up(mask, cap, steps):
    """Compute steps (H, W) int16, the distance of each pixel to the nearest zero of `mask` (H, W) in the same column.
    Distances are in rows and at most `cap`.
    """
    height, width = mask.shape
    for y in range(height):
        row, before = steps[y], steps[max(y - 1, 0)]
        for x in range(width):
            row[x] = 0 if mask[y, x] == 0 else (min(before[x] + 1, cap) if y > 0 else cap)
    for y in range(height - 2, -1, -1):
        row, before = steps[y], steps[y + 1]
        for x in range(width):
            row[x] = min(row[x], before[x] + 1)


@kernel
def distance_to_zero(mask, cap, steps, out):
    """Compute the Euclidean distance of each pixel to the nearest zero of `mask` (H, W) uint8, at most `cap` pixels.

    The computed distance is exact. First, the distance along the column is computed for each pixel. Then, the distances
    along the columns are combined along each row.

    steps (H, W) int16: scratch memory. out (H, W) float32.
    """
    height, width = mask.shape
    down_and_up(mask, cap, steps)
    padded = np.full(width + 2 * cap, np.float32(cap * cap), np.float32)
    here = padded[cap : cap + width]
    for y in range(height):
        row, far = out[y], np.int16(0)
        for x in range(width):
            here[x] = np.float32(steps[y, x]) * np.float32(steps[y, x])
            row[x] = here[x]
            far = max(far, steps[y, x])
        for away in range(1, far):
            left, right, square = padded[cap - away :], padded[cap + away :], np.float32(away * away)
            for x in range(width):
                row[x] = min(row[x], min(left[x], right[x]) + square)
        for x in range(width):
            row[x] = np.sqrt(row[x])


@kernel
def smoothing_radius(depth, distance, error_per_m, radius_per_error, max_radius, out):
    """Compute the half-width of the smoothing window of each pixel, in pixels: min(beta alpha d^2, T / sqrt 2).

    In this formula, alpha is error_per_m, beta is radius_per_error, and d is the depth in metres. The length T is the
    distance to the nearest depth step or missing pixel, in pixels. The half-width is rounded and limited to max_radius
    and to the image.
    """
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            d = depth[y, x]
            r = min(radius_per_error * error_per_m * d * d, distance[y, x] / np.sqrt(2.0), float(max_radius))
            out[y, x] = min(int(np.floor(r + 0.5)), y, x, height - 1 - y, width - 1 - x)


@inlined
def box_row(integral, y, x, r, n, out):
    """Compute the sums over the windows of n pixels of row y, from column x on. All windows have the half-width r.

    integral (H+1, W+1): integral image of the summed values.
    """
    above, below = integral[y - r], integral[y + r + 1]
    a, b, c, d = above[x - r :], above[x + r + 1 :], below[x - r :], below[x + r + 1 :]
    for k in range(n):
        out[k] = (d[k] - c[k]) - (b[k] - a[k])


@kernel
def mean_boxes(depth, depth_integral, left_out_integral, radius, out):
    """Eqs. 5, 7, 8. Compute the mean depth in the smoothing window of each pixel. Excluded pixels do not enter the mean
    (equation 8). The integral image of their mask gives their number gamma_0 in the window (equation 7). If no pixel is
    excluded, the mean is that of equation 5.

    Pixels without depth stay without depth. Pixels of equal radius are processed together, so that the compiler
    vectorises the loop.

    - depth_integral (H+1, W+1) float64: integral image of depth.
    - left_out_integral (H+1, W+1) int32: integral image of the mask of excluded pixels.
    - radius (H, W): half-width of each window, in pixels.
    """
    height, width = depth.shape
    total, counted = np.empty(width), np.empty(width)
    for y in range(height):
        first = 0
        while first < width:
            r, end = radius[y, first], first + 1
            while end < width and radius[y, end] == r:
                end += 1
            n = end - first
            box_row(depth_integral, y, first, r, n, total)
            box_row(left_out_integral, y, first, r, n, counted)
            here, mean, pixels = depth[y, first:end], out[y, first:end], float((2 * r + 1) * (2 * r + 1))
            for x in range(n):
                of = pixels - counted[x]
                value = total[x] / (of if of > 0.0 else 1.0)
                keep = (here[x] == 0.0) | (of == 0.0) | (r == 0)
                mean[x] = here[x] if keep else value
            first = end
