"""Kernels that measure depth and boundary values on both sides of borders between regions, and the hollowness of
regions.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.contours import hollow
from spigolo.kernels.rows import border_pixels

PAIRS, MEASURED, GAP, BEHIND, BEND, BOUNDARY = range(6)
SUMS = 6
MOST_ROUND = 0.6
"""Maximum distance between the middle of a chord and the surface, divided by the width of the chord. For a half-circle,
the ratio of distance and width is 0.5. A chord is the straight line between both ends of a region in an image row
(`sum_hollows`).
"""


@inlined
def clipped(value, limit):
    """Clip a value to -limit..limit, so that one pixel with wrong depth does not dominate a border."""
    return max(min(value, limit), -limit)


@inlined
def sample_border(labels, y, x, v, u, reach):
    """Return the two pixels that are `reach` pixels away from the border between pixel (y, x) and its neighbour (v, u),
    one on each side.

    The result is (row, column) of both samples, and a flag. The flag is True if both samples lie inside the image, each
    in the region on its side of the border.
    """
    dy, dx = v - y, u - x
    y_a, x_a, y_b, x_b = y - dy * (reach - 1), x - dx * (reach - 1), y + dy * reach, x + dx * reach
    inside = y_a >= 0 and x_a >= 0 and y_b < labels.shape[0] and x_b < labels.shape[1]
    return y_a, x_a, y_b, x_b, inside and labels[y_a, x_a] == labels[y, x] and labels[y_b, x_b] == labels[v, u]


@kernel
def sum_borders(labels, number, depth, boundary, reach, gap_limit, bend_limit, sums):
    """Sum depth differences and boundary values along the border between every two numbered regions.

    For each pair of neighbouring pixels on a border, depth is sampled `reach` pixels to both sides. A pair of pixels is
    skipped if a sample lies outside the image, or not in the region on its side of the border. Depth differences are
    clipped to gap_limit. The distance of a border pixel behind the straight line between both samples is clipped to
    bend_limit.

    - labels (H, W) int32: region of each pixel.
    - number (R,) int32: number 0..S-1 of each region, or -1 for a region that is skipped.
    - depth (H, W): depth map in metres.
    - boundary (H, W): boundary map, from 0 to 1.
    - sums (S, S, 6) float64, initially zero: six values for each pair of numbered regions.

    The array sums[a, b] contains six values of the border between regions a and b:

    - number of pairs of 4-neighbours on the border
    - number of pairs with valid depth at both samples and at the border pixel
    - sum of absolute depth differences between both samples (m)
    - sum of depth in region b minus depth in region a (m)
    - sum of distances of border pixels behind the straight line between both samples (m)
    - sum of the boundary values of the pairs: of the two pixels of a pair, the larger value is summed
    """
    height, width = labels.shape
    for p in border_pixels(labels):
        y, x = divmod(p, width)
        for v, u in ((y, x + 1), (y + 1, x)):
            if v >= height or u >= width or labels[v, u] == labels[y, x]:
                continue
            a, b = number[labels[y, x]], number[labels[v, u]]
            if a < 0 or b < 0:
                continue
            y_a, x_a, y_b, x_b, fits = sample_border(labels, y, x, v, u, reach)
            if not fits:
                continue
            here, there, between = float(depth[y_a, x_a]), float(depth[y_b, x_b]), float(depth[y, x])
            measured = here > 0.0 and there > 0.0 and between > 0.0
            behind = clipped(there - here, gap_limit)
            bend = clipped(hollow(here, between, there), bend_limit) if measured else 0.0
            for i, j, sign in ((a, b, 1.0), (b, a, -1.0)):
                sums[i, j, PAIRS] += 1.0
                sums[i, j, BOUNDARY] += max(boundary[y, x], boundary[v, u])
                if measured:
                    sums[i, j, MEASURED] += 1.0
                    sums[i, j, GAP] += abs(behind)
                    sums[i, j, BEHIND] += sign * behind
                    sums[i, j, BEND] += bend


@kernel
def sum_hollows(labels, number, depth, fx, margin, sums):
    """Sum the distances between the surface of each numbered region and the middles of its chords. A distance is
    positive where the surface is concave (behind the chord), and negative where the surface is convex.

    A chord is the straight line between the ends of a run of pixels of one region in one image row. The ends of a chord
    are `margin` pixels inside the run. Chords shorter than 8 pixels are skipped. A chord is also skipped if its middle
    is farther from the surface than MOST_ROUND times its width, because the chord then spans two surfaces.

    sums (S, 2) float64, initially zero: sum of the distances (m) and sum of the lengths of the chords (m) of each
    region.
    """
    height, width = labels.shape
    for y in range(height):
        first = 0
        while first < width:
            end = first + 1
            while end < width and labels[y, end] == labels[y, first]:
                end += 1
            k, left, right = number[labels[y, first]], first + margin, end - 1 - margin
            if k >= 0 and right - left >= 8:
                a, z, b = float(depth[y, left]), float(depth[y, (left + right) // 2]), float(depth[y, right])
                behind, across = hollow(a, z, b), (right - left) * 0.5 * (a + b) / fx
                if a > 0.0 and b > 0.0 and z > 0.0 and abs(behind) <= MOST_ROUND * across:
                    sums[k, 0] += behind
                    sums[k, 1] += np.hypot(across, a - b)
            first = end


@kernel
def collect_pairs(labels, boundary, pairs, strength):
    """Collect all pairs of 4-neighbours in different regions. Each pair has a value: the larger boundary value of its
    two pixels.

    A pair is stored as lower region number * 2^32 + higher region number.

    - labels (H, W) int32: region of each pixel.
    - boundary (H, W): boundary map, from 0 to 1.
    - pairs (K,) int64: output buffer for the pairs.
    - strength (K,): output buffer for the values of the pairs.

    Returns the number of pairs, which may exceed K. If more than K pairs exist, the pairs beyond K are counted, but not
    stored.
    """
    height, width = labels.shape
    count = 0
    for p in border_pixels(labels):
        y, x = divmod(p, width)
        for v, u in ((y, x + 1), (y + 1, x)):
            if v >= height or u >= width or labels[v, u] == labels[y, x]:
                continue
            if count < pairs.size:
                a, b = labels[y, x], labels[v, u]
                pairs[count] = (np.int64(min(a, b)) << 32) | np.int64(max(a, b))
                strength[count] = max(boundary[y, x], boundary[v, u])
            count += 1
    return count
