"""Kernels that find steps of depth and height across the outlines of regions. Missing depth, such as a shadow, may lie
between both sides of an outline.
"""

from __future__ import annotations

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.rows import border_pixels

PAIRS, KNOWN, FARTHER, NEARER, LEDGE, EDGE = range(6)
SUMS = 6


@inlined
def first_measured(depth, y, x, dy, dx, most):
    """Return the first pixel with depth on the line from (y, x) in the direction (dy, dx), within at most `most` steps.

    If no pixel with depth is found, the result is (-1, -1).
    """
    height, width = depth.shape
    for _ in range(most + 1):
        if y < 0 or x < 0 or y >= height or x >= width:
            break
        if depth[y, x] > 0.0:
            return y, x
        y, x = y + dy, x + dx
    return -1, -1


@inlined
def count_sides(labels, sums):
    """Count the pixel sides of each region that lie on the image border, in column EDGE of the array `sums`."""
    height, width = labels.shape
    for y in range(height):
        sums[labels[y, 0], EDGE] += 1.0
        sums[labels[y, width - 1], EDGE] += 1.0
    for x in range(width):
        sums[labels[0, x], EDGE] += 1.0
        sums[labels[height - 1, x], EDGE] += 1.0


@inlined
def height_at(depth, slope_x, slope_y, slope, offset, y, x):
    """Return the height of a pixel above the support plane in metres."""
    return (slope_x[x] + slope_y[y] + slope) * depth[y, x] + offset


@kernel
def sum_outlines(
    labels, depth, slope_x, slope_y, slope, offset, near, deep, shadow, step_m, step_share, ledge_m, ledge_per_m, sums
):
    """Count the steps of depth and of height across the outline of each region.

    At each outline pixel, depth is compared between an inner and an outer sample. The inner sample lies `near` pixels
    inside the outline, or on the outline if the region has no depth there. The outer sample is the first pixel with
    depth that lies between `near` and `near` + `shadow` pixels outside. The slope of the region is measured between the
    inner sample and the pixel `deep` pixels inside the outline. The height above the support plane is (slope_x[x] +
    slope_y[y] + slope) * depth + offset. The slopes and the offset are coefficients of the plane.

    - labels (H, W) int32: region of each pixel.
    - depth (H, W) float32: depth map in metres.
    - sums (R, 6) float64, initially zero: six counts for each region.

    The columns of the array `sums` count the following pairs and pixel sides:

    - pairs of 4-neighbours across the outline
    - pairs with depth at both samples
    - pairs whose outer sample is farther than the inner sample by more than step_m + step_share * depth + depth change
      along the slope
    - pairs whose outer sample is nearer than the inner sample by more than step_m + step_share * depth + depth change
      along the slope
    - pairs whose samples differ in height by more than max(ledge_m, ledge_per_m * depth^2)
    - pixel sides of the region that lie on the image border
    """
    height, width = labels.shape
    count_sides(labels, sums)
    for p in border_pixels(labels):
        y, x = divmod(p, width)
        k = labels[y, x]
        for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            v, u = y + dy, x + dx
            if v < 0 or u < 0 or v >= height or u >= width or labels[v, u] == k:
                continue
            sums[k, PAIRS] += 1.0
            y_in, x_in = y - dy * (near - 1), x - dx * (near - 1)
            inside = 0 <= y_in < height and 0 <= x_in < width and labels[y_in, x_in] == k
            if not inside or depth[y_in, x_in] <= 0.0:
                y_in, x_in = y, x
            y_out, x_out = first_measured(depth, y + dy * near, x + dx * near, dy, dx, shadow)
            if y_out < 0 or depth[y_in, x_in] <= 0.0:
                continue
            inner, outer = float(depth[y_in, x_in]), float(depth[y_out, x_out])
            y_deep, x_deep, own = y - dy * (deep - 1), x - dx * (deep - 1), 0.0
            inside = 0 <= y_deep < height and 0 <= x_deep < width and labels[y_deep, x_deep] == k
            if inside and depth[y_deep, x_deep] > 0.0:
                own = abs(inner - float(depth[y_deep, x_deep])) * 2.0 * near / (deep - near)
            least = step_m + step_share * inner + own
            rise = height_at(depth, slope_x, slope_y, slope, offset, y_in, x_in)
            rise -= height_at(depth, slope_x, slope_y, slope, offset, y_out, x_out)
            sums[k, KNOWN] += 1.0
            sums[k, FARTHER] += outer - inner > least
            sums[k, NEARER] += inner - outer > least
            sums[k, LEDGE] += abs(rise) > max(ledge_m, ledge_per_m * inner * inner)
