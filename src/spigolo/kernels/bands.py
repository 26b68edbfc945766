"""Kernels that mark a band of pixels along the borders of objects. The kernels in `kernels.seeding` give the pixels of
the band new labels.

The width of the band depends on the width of the ramps (blurred depth steps) at the borders. A ramp is a run of pixels
at a blurred depth step. The depths of ramp pixels lie between the depths of both sides of the step. Pixels of the band
are called open, because they get new labels.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.rows import border_pixels

f32 = np.float32
LOW_PART, HIGH_PART = f32(0.15), f32(0.85)
"""Limits (exclusive) of the relative depth of a pixel on a ramp, which is a blurred depth step. At a depth step, the
relative depth of the nearer side is 0, and that of the farther side is 1.
"""
UNREACHED = 255
OPEN, FIRST_COLUMN, LAST_COLUMN = 1, 2, 4
"""Bit flags of a pixel: the pixel is open, is in the first image column, or is in the last image column."""


@inlined
def outermost(depth, start, step, count):
    """Return the first valid depth at the `count` indices start, start + step, ..., or 0 if depth is missing at all of
    them.
    """
    for k in range(count):
        z = depth[start + k * step]
        if z > f32(0.0):
            return z
    return f32(0.0)


@kernel
def count_ramps(labels, depth, reach_px, step_m, step_share, sums):
    """Count the depth steps on the borders of objects, and the pixels on the ramps of these steps.

    For each pair of neighbouring pixels with different labels, a depth profile is read along the image row or column.
    The profile has reach_px pixels on each side of the border. A profile is a depth step if the depths at its two ends
    differ by more than max(step_m, step_share * nearer depth).

    - labels (H, W) int32, 0 = background.
    - depth (H, W) float32 metres, 0 = missing.
    - sums (2,) int64, initially zero: number of depth steps, number of pixels on their ramps.
    """
    height, width = labels.shape
    flat = depth.reshape(-1)
    for p in border_pixels(labels):
        y, x = divmod(p, width)
        if x + 1 < width and labels[y, x + 1] != labels[y, x]:
            count_profile(flat, p, 1, x, width, reach_px, step_m, step_share, sums)
        if y + 1 < height and labels[y + 1, x] != labels[y, x]:
            count_profile(flat, p, width, y, height, reach_px, step_m, step_share, sums)


@inlined
def count_profile(flat, p, step, place, length, reach_px, step_m, step_share, sums):
    """Read the depth profile across the border between the pixels p and p + step. Add the numbers of depth steps and of
    ramp pixels to the array `sums` of `count_ramps`.

    - flat (H * W,): depth map.
    - place: position of pixel p in its image row or column.
    - length: length of the image row or column.
    """
    if place + 1 < reach_px or place + 1 + reach_px > length:
        return
    ends, first = max(reach_px // 3, 1), p - (reach_px - 1) * step
    last = first + (2 * reach_px - 1) * step
    a, b = outermost(flat, first, step, ends), outermost(flat, last, -step, ends)
    near, far = min(a, b), max(a, b)
    if near == f32(0.0) or far - near <= max(step_m, step_share * near):
        return
    low, high = near + LOW_PART * (far - near), near + HIGH_PART * (far - near)
    sums[0] += 1
    for k in range(ends, 2 * reach_px - ends):
        z = flat[first + k * step]
        sums[1] += (z > low) & (z < high)


@kernel
def measure_layers(labels, near_hole, width_px, hole_width_px, layer, inner):
    """Give each pixel near a border a layer number, which grows with the distance to the border. Pixels of layer 1
    touch another label, pixels of layer 2 touch layer 1, and so on.

    The maximum layer is width_px, or hole_width_px where near_hole is nonzero.

    - labels (H, W) int32: label of each pixel.
    - near_hole (H, W) uint8: nonzero near missing depth.
    - layer (H, W) uint8: layer of each pixel, from 1, or 255 for pixels beyond the maximum layer.
    - inner (N,) int32: number of layers of each label, or 255 if the label has pixels beyond the maximum layer.
    """
    height, width = labels.shape
    layer[:] = UNREACHED
    inner[:] = 0
    queue = border_pixels(labels)
    for p in queue:
        layer[p // width, p % width] = 1
    size, number = queue.size, 1
    while size > 0:
        following = np.empty(8 * size, np.int32)
        found = 0
        for k in range(size):
            y = queue[k] // width
            x = queue[k] - y * width
            here = labels[y, x]
            inner[here] = max(inner[here], number)
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    if number % 2 == 0 and dy != 0 and dx != 0:
                        continue  # 8-neighbours and 4-neighbours alternate, so that layers are nearly round
                    v, u = y + dy, x + dx
                    if v < 0 or u < 0 or v >= height or u >= width or layer[v, u] != UNREACHED:
                        continue
                    if number >= (hole_width_px if near_hole[v, u] else width_px):
                        inner[labels[v, u]] = UNREACHED
                        continue
                    layer[v, u] = number + 1
                    following[found] = v * width + u
                    found += 1
        queue, size = following, found
        number += 1


@kernel
def open_layers(labels, layer, inner, share, opened):
    """Mark the pixels of each label as open if their layer is at most `share` times the number of layers of the label.
    Return the number of open pixels.

    If a label has pixels beyond the maximum layer, all layers up to the maximum become open.

    - labels (H, W) int32: label of each pixel.
    - layer (H, W) uint8, inner (N,) int32: results of the kernel `measure_layers`.
    - opened (H, W) uint8: flags of open pixels, 0 for other pixels.
    """
    height, width = labels.shape
    count = 0
    for y in range(height):
        for x in range(width):
            k = layer[y, x]
            limit = inner[labels[y, x]]
            is_open = k != UNREACHED and (limit == UNREACHED or k <= share * limit)
            sides = (FIRST_COLUMN if x == 0 else 0) | (LAST_COLUMN if x == width - 1 else 0)
            opened[y, x] = (OPEN | sides) if is_open else 0
            count += is_open
    return count


@kernel
def flag_columns(opened):
    """Set the column flags of the open pixels in the first and last image column. opened (H, W) uint8."""
    last = opened.shape[1] - 1
    for y in range(opened.shape[0]):
        if opened[y, 0]:
            opened[y, 0] |= FIRST_COLUMN
        if opened[y, last]:
            opened[y, last] |= LAST_COLUMN
