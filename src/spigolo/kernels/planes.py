"""Kernels that count points near planes, classify pixels relative to a plane, and sum surface normals."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import kernel

MISSING, BELOW, ON, ABOVE = range(4)


@kernel
def count_near(points, planes, tolerance, counts):
    """Count the points within a tolerance of each of P planes.

    - points (3, N) float32: X, Y and Z of each point in metres.
    - planes (P, 4) float32: unit normal and offset in metres.
    - tolerance (N,) float32: maximum distance of each point from a plane, in metres.
    - counts (P,) int64: number of points within the tolerance of each plane.
    """
    xs, ys, zs = points
    for k in range(len(planes)):
        a, b, c, d = planes[k]
        near = 0
        for i in range(xs.size):
            near += abs(xs[i] * a + ys[i] * b + zs[i] * c + d) <= tolerance[i]
        counts[k] = near


@kernel
def measure_heights(depth, slope_x, slope_y, slope, offset, out):
    """Compute the height out (H, W) of every pixel above a plane, in metres.

    The height of a pixel is (slope_x[x] + slope_y[y] + slope) * depth + offset, in float32. The slopes and the offset
    are coefficients of the plane.
    """
    for y in range(depth.shape[0]):
        row, height, of_row = depth[y], out[y], slope_y[y]
        for x in range(row.size):
            height[x] = (slope_x[x] + of_row + slope) * row[x] + offset


@kernel
def tell_sides(depth, slope_x, slope_y, slope, offset, least, noise, out):
    """Classify the position of every pixel relative to a plane in out (H, W) uint8: MISSING, BELOW, ON or ABOVE.

    A pixel is ON the plane if its absolute height is at most max(least, noise * depth^2). A pixel without depth is
    MISSING. The height of a pixel above the plane is (slope_x[x] + slope_y[y] + slope) * depth + offset, in float32
    metres. The slopes and the offset are coefficients of the plane.
    """
    for y in range(depth.shape[0]):
        row, side, of_row = depth[y], out[y], slope_y[y]
        for x in range(row.size):
            d = row[x]
            height, tolerance = (slope_x[x] + of_row + slope) * d + offset, noise * d * d
            tolerance = tolerance if tolerance > least else least
            known = np.uint8(ABOVE if height > tolerance else (ON if height >= -tolerance else BELOW))
            side[x] = known if d > np.float32(0) else np.uint8(MISSING)


@kernel
def sum_normals(labels, depth, wanted, camera, reach, sums):
    """Sum the surface normals and the directions of the lines of sight over the pixels of each region.

    The normal of a pixel is computed from depth samples `reach` pixels away in the same region. Normals and lines of
    sight point away from the camera.

    - labels (H, W) int32: region of each pixel.
    - depth (H, W) float32: depth map in metres.
    - wanted (R,) uint8: 0 for regions that are skipped.
    - camera (4,): fx, fy, cx, cy.
    - sums (R, 7) float64, initially zero: number of pixels with a normal, sum of normals (X, Y, Z), sum of unit vectors
      along the lines of sight.
    """
    fx, fy, cx, cy = camera
    for y in range(reach, labels.shape[0] - reach):
        for x in range(reach, labels.shape[1] - reach):
            k = labels[y, x]
            if not wanted[k]:
                continue
            left, right, up, down = (
                labels[y, x - reach],
                labels[y, x + reach],
                labels[y - reach, x],
                labels[y + reach, x],
            )
            if left != k or right != k or up != k or down != k:
                continue
            z = float(depth[y, x])
            a, b, c, d = depth[y, x - reach], depth[y, x + reach], depth[y - reach, x], depth[y + reach, x]
            if a <= 0.0 or b <= 0.0 or c <= 0.0 or d <= 0.0 or z <= 0.0:
                continue
            across, along = (b - a) / (2.0 * reach), (d - c) / (2.0 * reach)
            nx, ny = -fx * across, -fy * along
            nz = z + (x - cx) * across + (y - cy) * along
            u, v = (x - cx) / fx, (y - cy) / fy
            normal, sight = np.sqrt(nx * nx + ny * ny + nz * nz), np.sqrt(1.0 + u * u + v * v)
            sums[k, 0] += 1.0
            sums[k, 1] += nx / normal
            sums[k, 2] += ny / normal
            sums[k, 3] += nz / normal
            sums[k, 4] += u / sight
            sums[k, 5] += v / sight
            sums[k, 6] += 1.0 / sight
