"""Kernels that compute edge weights in float32. The kernels compute the depth difference (equation 9 of the paper) and
the two cost functions (equations 22 and 23).

A plane is an array (H, W) with the weight of the edge from each pixel to its neighbour at the offset (dy, dx). The
column offset dx is 0 or 1. Edges that leave the image have the weight +inf. Each cue is computed for a whole image row
before the next cue, so that the compiler vectorises all loops.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.color import color_difference
from spigolo.kernels.powers import f32, log2_1p, power

ENDS_MAX, ENDS_I = 0, 1
ZERO, ONE, TWO = f32(0.0), f32(1.0), f32(2.0)


@inlined
def depth_difference(a, b, scale, noise):
    """Eq. 9. Return the depth difference of an edge, from 0 to 1. The depth difference is 0 if depth is missing at a
    pixel of the edge.

    - a, b: depths of both pixels, in metres.
    - scale: 1 / depth range of the frame, 1/m.
    - noise: depth noise divided by the squared depth, 1/m. The noise is subtracted from the depth difference. The paper
      uses a noise of 0.
    """
    near = a if a < b else b
    beyond = abs(a - b) - noise * near * near
    difference = (beyond if beyond > ZERO else ZERO) * scale
    clipped = difference if difference < ONE else ONE
    return clipped if near > ZERO else ZERO


@inlined
def saliency_cost(d_hsv, d_depth, d_sal, k_x, k_y, k_s):
    """Eq. 22. Return the weight of an edge, from 0 to 1, with the cost function that includes saliency."""
    alone = k_y * log2_1p(d_hsv) + k_x * log2_1p(d_depth) + k_s * log2_1p(d_sal)
    coupled = d_depth * (power(d_sal, ONE + d_depth) + power(d_hsv, ONE + d_depth))
    cost = (alone + coupled) / (TWO + k_x + k_y + k_s)
    return cost if cost < ONE else ONE


@inlined
def boundary_cost(d_hsv, d_depth, d_bound, k_x, k_b):
    """Eq. 23. Return the weight of an edge, from 0 to 1, with the cost function that includes the boundary map."""
    cost = (k_x * d_depth * log2_1p(d_hsv) + k_b * d_bound) / (k_x + k_b)
    return cost if cost < ONE else ONE


@inlined
def color_row(color, y, v, dx, out):
    """Eq. 4. Compute the colour differences of the edges from row y to row v. The second pixel of an edge is dx columns
    to the right of the first.
    """
    edges = out.size
    a_here, b_here, c_here = color[0, y, :edges], color[1, y, :edges], color[2, y, :edges]
    a_there, b_there, c_there = color[0, v, dx:], color[1, v, dx:], color[2, v, dx:]
    for x in range(edges):
        out[x] = color_difference(a_here[x], b_here[x], c_here[x], a_there[x], b_there[x], c_there[x])


@inlined
def depth_row(depth, y, v, dx, scale, noise, out):
    """Eq. 9. Compute the depth differences of the edges from row y to row v. The second pixel of an edge is dx columns
    to the right of the first.
    """
    here, there = depth[y, : out.size], depth[v, dx:]
    for x in range(out.size):
        out[x] = depth_difference(here[x], there[x], scale, noise)


@inlined
def cue_row(cue, y, v, dx, ends, out):
    """Compute the value of a cue for the edges from row y to row v. The second pixel of an edge is dx columns to the
    right of the first.

    ends: ENDS_I for the value at the first pixel of the edge, as in the paper, or ENDS_MAX for the larger value of both
    pixels.
    """
    here, there = cue[y, : out.size], cue[v, dx:]
    if ends == ENDS_I:
        out[:] = here
        return
    for x in range(out.size):
        out[x] = here[x] if here[x] > there[x] else there[x]


@kernel
def saliency_plane(color, depth, saliency, scale, noise, k_x, k_y, k_s, ends, dy, dx, out):
    """Eq. 22. Compute the weights of all edges with the offset (dy, dx).

    - color (3, H, W): colours as points of `hsv_points`.
    - depth (H, W): depth map in metres.
    - saliency (H, W): saliency map.
    - out (H, W): weights, +inf where an edge leaves the image.
    """
    height, width = depth.shape
    scale, noise, k_x, k_y, k_s = f32(scale), f32(noise), f32(k_x), f32(k_y), f32(k_s)
    d_hsv, d_depth, d_sal = np.empty((3, width - dx), np.float32)
    out[:] = np.inf
    for y in range(max(0, -dy), height - max(0, dy)):
        color_row(color, y, y + dy, dx, d_hsv)
        depth_row(depth, y, y + dy, dx, scale, noise, d_depth)
        cue_row(saliency, y, y + dy, dx, ends, d_sal)
        row = out[y, : width - dx]
        for x in range(row.size):
            row[x] = saliency_cost(d_hsv[x], d_depth[x], d_sal[x], k_x, k_y, k_s)


@kernel
def boundary_plane(color, depth, boundary, scale, noise, k_x, k_b, ends, dy, dx, out):
    """Eq. 23. Compute the weights of all edges with the offset (dy, dx).

    - color (3, H, W): colours as points of `hsv_points`.
    - depth (H, W): depth map in metres.
    - boundary (H, W): boundary map.
    - out (H, W): weights, +inf where an edge leaves the image.
    """
    height, width = depth.shape
    scale, noise, k_x, k_b = f32(scale), f32(noise), f32(k_x), f32(k_b)
    d_hsv, d_depth, d_bound = np.empty((3, width - dx), np.float32)
    out[:] = np.inf
    for y in range(max(0, -dy), height - max(0, dy)):
        color_row(color, y, y + dy, dx, d_hsv)
        depth_row(depth, y, y + dy, dx, scale, noise, d_depth)
        cue_row(boundary, y, y + dy, dx, ends, d_bound)
        row = out[y, : width - dx]
        for x in range(row.size):
            row[x] = boundary_cost(d_hsv[x], d_depth[x], d_bound[x], k_x, k_b)
