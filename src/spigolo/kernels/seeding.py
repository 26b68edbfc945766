"""Kernels that give open pixels new labels, by a spanning forest that grows from the other pixels. Open pixels are the
pixels in the band along borders that `kernels.bands` marks.

Labelled pixels next to open pixels are called seeds.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.bands import FIRST_COLUMN, LAST_COLUMN

f32 = np.float32
LEVELS = 2048
"""Number of different edge weights: whole grey levels from 0 to LEVELS - 1. Larger edge weights are clipped to LEVELS -
1.
"""
MARGIN = f32(0.01)
"""Upper bound of the rounding error of an edge weight, in grey levels."""


@inlined
def distance_2(red, green, blue, color, p):
    """Return the squared distance in RGB between a colour and the colour of pixel p."""
    red, green, blue = red - f32(color[p, 0]), green - f32(color[p, 1]), blue - f32(color[p, 2])
    return red * red + green * green + blue * blue


@inlined
def step_cost(z, other, full, step_weight):
    """Return the cost of a depth step between two depths, from 0 to step_weight. The cost is 0 if one depth is missing.

    full: smallest depth difference, in metres, with the full cost step_weight.
    """
    if z <= f32(0.0) or other <= f32(0.0):
        return f32(0.0)
    step = abs(z - other)
    return step_weight if step >= full else step_weight * step / full


@inlined
def neighbour(p, k, flags, width, size):
    """Return the index of the k-th of the four neighbours of an open pixel p, or a negative number outside the image.

    flags: flags of pixel p, which mark pixels in the first and last image column (`kernels.bands`).
    """
    if k == 0:
        return -1 if flags & LAST_COLUMN else p + 1
    if k == 1:
        return p + width if p + width < size else -1
    if k == 2:
        return -1 if flags & FIRST_COLUMN else p - 1
    return p - width


@inlined
def bucket_of(weight):
    """Return the weight of an edge, rounded down to a whole grey level and limited to `LEVELS` - 1."""
    return int(min(weight, f32(LEVELS - 1)))


@inlined
def offer(bucket, p, s, size, least, head, tail, edges):
    """Add the edge from labelled pixel s to open pixel p to the queue. Nothing is added if the queue had an edge to p
    with an equal or smaller weight.

    - bucket: weight of the edge in whole grey levels.
    - size: number of edges in the queue.

    Returns the new number of edges in the queue.
    """
    if bucket >= least[p]:
        return size
    least[p] = bucket
    edges[size, 0], edges[size, 1], edges[size, 2] = p, s, -1
    if head[bucket] < 0:
        head[bucket] = size
    else:
        edges[tail[bucket], 2] = size
    tail[bucket] = size
    return size + 1


@inlined
def sow(points, flat, state, step_m, step_per_m, step_weight, width, least, head, tail, edges, tree, source_of):
    """Add all edges from labelled to open pixels to the queue. Return the number of edges in the queue, and the
    smallest weight of these edges.
    """
    size, level = 0, LEVELS
    for p in range(state.size):
        for k in range(4 if state[p] else 0):
            q = neighbour(p, k, state[p], width, state.size)
            if q < 0 or state[q]:
                continue
            red, green, blue = f32(points[q, 0]), f32(points[q, 1]), f32(points[q, 2])
            tree[q, 0], tree[q, 1], tree[q, 2] = red, green, blue
            source_of[q] = q
            full = max(step_m, step_per_m * flat[q] * flat[q])
            weight = np.sqrt(distance_2(red, green, blue, points, p)) + step_cost(flat[q], flat[p], full, step_weight)
            bucket = bucket_of(weight)
            size = offer(bucket, p, q, size, least, head, tail, edges)
            level = min(level, bucket)
    return size, level


@kernel
def grow_seeds(color, depth, labels, opened, count, memory, carry, step_m, step_per_m, step_weight, source_of):
    """Give each open pixel the label of a seed, by a spanning forest whose roots are the seeds.

    The forest grows by Prim's algorithm, always along the lightest edge from a labelled to an open pixel. The weight of
    an edge is a sum of three terms:

    - the RGB distance between the open pixel and the mean colour of the tree
    - the cost of a depth step between both pixels of the edge
    - `carry` times the weight of the previous edge of the tree, so that a blurred image edge is as heavy as a sharp one

    The mean colour of a tree is `memory` times the previous mean plus (1 - memory) times the colour of the new pixel.
    With memory = carry = 0 the result is a minimum spanning forest. Weights are rounded down to whole grey levels.
    Among edges of equal weight, the edge that was found first is used.

    - color (H, W, 3) uint8: RGB image.
    - depth (H, W) float32 metres, 0 = missing.
    - labels (H, W) int32: changed at open pixels.
    - opened (H, W) uint8: flags of `open_layers`, set to 0 at pixels that get a label.
    - count: number of open pixels.
    - step_m, step_per_m float32: a depth step of max(step_m, step_per_m z^2) costs step_weight.
    - source_of (H * W,) int32: index y * W + x of the seed of each open pixel.
    """
    width = labels.shape[1]
    points, flat, label, state = color.reshape(-1, 3), depth.reshape(-1), labels.reshape(-1), opened.reshape(-1)
    head, tail = np.full(LEVELS, -1, np.int32), np.empty(LEVELS, np.int32)
    edges = np.empty((4 * count + 1, 3), np.int32)  # open pixel, labelled pixel, next edge of equal weight
    least = np.full(label.size, LEVELS, np.int16)  # weight of the lightest edge to each pixel so far
    tree = np.empty((label.size, 3), np.float32)  # mean colour of the tree at each labelled pixel
    keep, own, carried = f32(memory), f32(1.0 - memory), f32(carry)
    size, level = sow(
        points, flat, state, step_m, step_per_m, step_weight, width, least, head, tail, edges, tree, source_of
    )
    while level < LEVELS:
        edge = head[level]
        if edge < 0:
            level += 1
            continue
        head[level] = edges[edge, 2]
        p, s = edges[edge, 0], edges[edge, 1]
        if not state[p]:
            continue
        flags, state[p] = state[p], 0
        source_of[p], label[p] = source_of[s], label[s]
        red = keep * tree[s, 0] + own * f32(points[p, 0])
        green = keep * tree[s, 1] + own * f32(points[p, 1])
        blue = keep * tree[s, 2] + own * f32(points[p, 2])
        tree[p, 0], tree[p, 1], tree[p, 2] = red, green, blue
        z, before = flat[p], carried * f32(level)
        full = max(step_m, step_per_m * z * z)
        for k in range(4):
            q = neighbour(p, k, flags, width, state.size)
            if q < 0 or not state[q]:
                continue
            room = f32(least[q]) - before
            colors_2 = distance_2(red, green, blue, points, q)
            if room <= f32(0.0) or colors_2 > (room + MARGIN) * (room + MARGIN):
                continue  # the edge is heavier than a known edge, even without the cost of a depth step
            bucket = bucket_of(before + np.sqrt(colors_2) + step_cost(z, flat[q], full, step_weight))
            size = offer(bucket, q, p, size, least, head, tail, edges)
            level = min(level, bucket)


@kernel
def follow_seeds(before, after, source_of, regions, out, areas):
    """Give each pixel whose label changed the region number of its seed, and count the pixels of each region.

    - before, after: labels (H, W) int32 before and after `grow_seeds`.
    - source_of (H * W,) int32: result of `grow_seeds`.
    - regions, out: old and new region numbers (H, W) int32.
    - areas (R,) int64, initially zero: number of pixels of each region.
    """
    width, flat = before.shape[1], regions.reshape(-1)
    for y in range(before.shape[0]):
        for x in range(width):
            here = regions[y, x] if after[y, x] == before[y, x] else flat[source_of[y * width + x]]
            out[y, x] = here
            areas[here] += 1
