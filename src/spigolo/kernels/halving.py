"""Kernel that computes a depth map of half the width and height."""

from __future__ import annotations

from spigolo.kernels._jit import kernel


@kernel
def halve_depth(depth, out):
    """Set each output pixel to the lower median of the valid depths in a block of 2x2 pixels, or to 0 if all depths are
    missing.

    The mean depth of a block could lie between an object and the surface behind it, but the lower median is a measured
    depth.

    depth (H, W) float32 metres, 0 = missing. out (ceil(H / 2), ceil(W / 2)) float32.
    """
    height, width = depth.shape
    for y in range(out.shape[0]):
        top, bottom = 2 * y, min(2 * y + 1, height - 1)
        for x in range(out.shape[1]):
            left, right = 2 * x, min(2 * x + 1, width - 1)
            a, b, c, d = depth[top, left], depth[top, right], depth[bottom, left], depth[bottom, right]
            missing = (a == 0) + (b == 0) + (c == 0) + (d == 0)
            inner, outer = max(min(a, b), min(c, d)), min(max(a, b), max(c, d))
            median = min(inner, outer) if missing == 0 else max(inner, outer)  # missing depth, 0, sorts first
            out[y, x] = max(a, b, c, d) if missing >= 3 else median
