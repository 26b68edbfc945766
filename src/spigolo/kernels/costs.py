"""The weights of the graph: depth difference and both cost functions (eqs. 9, 22, 23).

A plane holds the edges from each pixel to the neighbour at one offset (dy, dx); edges that leave the image are +inf.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.color import color_difference
from spigolo.kernels.powers import log2_1p, power

ENDS_MAX, ENDS_I = 0, 1


@inlined
def depth_difference(depth, y, x, v, u, scale, noise):
    """Eq. 9. |difference| of two depths times `scale` (1 / range), clipped at 1; 0 where an end is missing.

    A difference within noise * d^2, d the nearer depth, counts as none; the paper has noise = 0.
    """
    a, b = depth[y, x], depth[v, u]
    if a == 0.0 or b == 0.0:
        return 0.0
    near = float(min(a, b))
    return min(max(abs(float(a) - float(b)) - noise * near * near, 0.0) * scale, 1.0)


@inlined
def at_ends(cue, y, x, v, u, ends):
    """A cue of single pixels on an edge: at its first end i as printed, or the larger of both ends."""
    here = float(cue[y, x])
    return here if ends == ENDS_I else max(here, float(cue[v, u]))


@inlined
def saliency_cost(d_hsv, d_depth, d_sal, k_x, k_y, k_s):
    """Eq. 22. First cost function, in [0, 1]."""
    alone = k_y * log2_1p(d_hsv) + k_x * log2_1p(d_depth) + k_s * log2_1p(d_sal)
    coupled = 0.0
    if d_depth > 0.0:
        coupled = d_depth * power(d_sal, 1.0 + d_depth) + d_depth * power(d_hsv, 1.0 + d_depth)
    return min((alone + coupled) / (2.0 + k_x + k_y + k_s), 1.0)


@inlined
def boundary_cost(d_hsv, d_depth, d_bound, k_x, k_b):
    """Eq. 23. Second cost function, in [0, 1]."""
    return min((k_x * d_depth * log2_1p(d_hsv) + k_b * d_bound) / (k_x + k_b), 1.0)


@kernel
def saliency_plane(color, depth, saliency, scale, noise, k_x, k_y, k_s, ends, dy, dx, out):
    """Eq. 22 on every edge of one plane: color (3, H, W) points, depth (H, W) metres, saliency (H, W), out (H, W)."""
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            v, u = y + dy, x + dx
            if v < 0 or v >= height or u < 0 or u >= width:
                out[y, x] = np.inf
                continue
            d_hsv = color_difference(color, y, x, v, u)
            d_depth = depth_difference(depth, y, x, v, u, scale, noise)
            out[y, x] = saliency_cost(d_hsv, d_depth, at_ends(saliency, y, x, v, u, ends), k_x, k_y, k_s)


@kernel
def boundary_plane(color, depth, boundary, scale, noise, k_x, k_b, ends, dy, dx, out):
    """Eq. 23 on every edge of one plane: color (3, H, W) points, depth (H, W) metres, boundary (H, W), out (H, W)."""
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            v, u = y + dy, x + dx
            if v < 0 or v >= height or u < 0 or u >= width:
                out[y, x] = np.inf
                continue
            d_hsv = color_difference(color, y, x, v, u)
            d_depth = depth_difference(depth, y, x, v, u, scale, noise)
            out[y, x] = boundary_cost(d_hsv, d_depth, at_ends(boundary, y, x, v, u, ends), k_x, k_b)
