"""Kernels that compute the centre-surround saliency of Montabone & Soto 2010, which compares pixels with their
surroundings.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def whole_quotient(dividend, inverse):
    """Return the integer quotient dividend // divisor, computed from inverse = 1 / divisor."""
    return np.int32((dividend + 0.5) * inverse)


@inlined
def lay_strip(above, below, pad, strip):
    """Compute, for each column, the sum of a band of image rows over all columns before this column. The arguments
    `above` and `below` are two rows of an integral image.

    pad: number of values that are added at each end of the result. The added values are 0 at the beginning, and the
    total sum at the end.
    """
    columns = above.size
    strip[:pad] = 0
    inner = strip[pad : pad + columns]
    for x in range(columns):
        inner[x] = below[x] - above[x]
    strip[pad + columns :] = inner[columns - 1]


@inlined
def measure_areas(rows, half, width, areas, inverses):
    """Compute the number of pixels in the clipped window around each column, and 1 / (number of pixels without the
    centre).
    """
    for x in range(width):
        areas[x] = rows * (min(x + half + 1, width) - max(x - half + 1, 0))
        inverses[x] = 1.0 / max(areas[x] - 1.0, 1.0)


@inlined
def difference_row(gray, left, right, areas, inverses, out):
    """Compute the grey value of each pixel minus the mean of the other pixels in its window. The differences are
    truncated to whole grey levels.
    """
    for x in range(out.size):
        excess = areas[x] * gray[x] - (right[x] - left[x])
        level = whole_quotient(abs(excess), inverses[x])
        out[x] = level if excess > 0.0 else -level


@kernel
def center_surround(gray, integral, surrounds, on, off):
    """Compute the grey-level difference between each pixel and its surround, summed over several window sizes. The map
    `on` contains the sum of the positive differences, and `off` the sum of the absolute values of the negative
    differences.

    The surround of size n of a pixel (y, x) is the window of rows y-n+1..y+n and columns x-n+1..x+n. Each window is
    clipped to the image, and the pixel itself is excluded. Each difference is truncated to whole grey levels.

    - gray (H, W) uint8: grey image.
    - integral (H+1, W+1) int32: integral image of the grey image.
    - surrounds (S,): half the side lengths n of the windows around a pixel.
    - on, off (H, W) int32: results.
    """
    height, width = gray.shape
    pad = min(surrounds.max(), width)
    strip, difference = np.empty(width + 1 + 2 * pad, np.int32), np.empty(width, np.int32)
    rows_of = np.zeros(surrounds.size, np.int64)
    areas, inverses = np.empty((surrounds.size, width)), np.empty((surrounds.size, width))
    on[:], off[:] = 0, 0
    for y in range(height):
        for k in range(surrounds.size):
            half = surrounds[k]
            top, bottom = max(y - half + 1, 0), min(y + half + 1, height)
            if rows_of[k] != bottom - top:
                rows_of[k] = bottom - top
                measure_areas(rows_of[k], half, width, areas[k], inverses[k])
            lay_strip(integral[top], integral[bottom], pad, strip)
            reach = min(half, width)
            left, right = strip[pad + 1 - reach :], strip[pad + 1 + reach :]
            difference_row(gray[y], left, right, areas[k], inverses[k], difference)
            bright, dark = on[y], off[y]
            for x in range(width):
                bright[x] += max(difference[x], np.int32(0))
                dark[x] += max(-difference[x], np.int32(0))


@kernel
def join_levels(on, off, out):
    """Scale two maps on and off (H, W) int32 to a maximum of 255 each, and add both, clipped to 255.

    out (H, W) uint8: sum of both maps. A map that is 0 everywhere adds 0.
    """
    inverse_on, inverse_off = 1.0 / max(on.max(), 1), 1.0 / max(off.max(), 1)
    for y in range(on.shape[0]):
        bright, dark, row = on[y], off[y], out[y]
        for x in range(row.size):
            both = whole_quotient(255.0 * bright[x], inverse_on) + whole_quotient(255.0 * dark[x], inverse_off)
            row[x] = min(both, 255)
