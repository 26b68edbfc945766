"""Merging pixels into regions by internal difference (Felzenszwalb & Huttenlocher 2004; eqs. 2, 3).

docs/performance.md explains the rounds.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def ends(edge, pixels, offsets):
    """Both pixels of an edge. Plane by comparison, as a division would cost more than the rest of a merge."""
    plane = np.int64(edge >= pixels) + np.int64(edge >= 2 * pixels) + np.int64(edge >= 3 * pixels)
    pixel = np.int64(edge) - plane * pixels
    return np.uint32(pixel), np.uint32(pixel + offsets[plane])


@inlined
def find(parent, node):
    """Root of a node's tree; the path behind is halved. Unsigned, so that no index is tested for its sign."""
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@inlined
def unite(parent, size, a, b):
    """Joins two roots, the smaller below the larger, and returns the root of both."""
    if size[a] < size[b]:
        a, b = b, a
    parent[b] = a
    size[a] += size[b]
    return a


@inlined
def may_merge(weight, bound_a, bound_b):
    """Eq. 3. Two regions merge if their edge weighs at most I(R) + gamma / |R| of both."""
    return weight <= bound_a and weight <= bound_b


@inlined
def merge_bound(internal, gamma, size):
    """I(R) + gamma / |R|, the bound that eq. 3 sets to a region's edges."""
    return internal + gamma / size


@kernel
def collect(weights, bits, low, high, parent, bound, offsets, out):
    """Packs the edges with low <= weight < high that may still merge something, in the order of their numbers.

    Once an edge of weight w fails at a region, that region's bound is below w and all later edges are heavier: it has
    its final extent. So an edge of at least `low` does nothing inside a region, or at one whose bound is below `low`.
    weights, bits (E,): the same memory as float32 and uint32. Every pixel's parent must be its root.
    out (E,) uint64; returns how many were packed.
    """
    pixels, count = parent.size, 0
    for plane in range(weights.size // pixels):
        first, offset = plane * pixels, offsets[plane]
        for pixel in range(pixels):
            weight = weights[first + pixel]
            if weight >= low and weight < high:
                a, b = parent[pixel], parent[pixel + offset]
                if a != b and bound[a] >= low and bound[b] >= low:
                    out[count] = (np.uint64(bits[first + pixel]) << np.uint64(32)) | np.uint64(first + pixel)
                    count += 1
    return count


@kernel
def collect_small(weights, bits, min_size, parent, size, offsets, out):
    """Packs the edges at regions smaller than min_size, in the order of their numbers. As `collect` else."""
    pixels, count = parent.size, 0
    for plane in range(weights.size // pixels):
        first, offset = plane * pixels, offsets[plane]
        for pixel in range(pixels):
            if weights[first + pixel] < np.inf:
                a, b = parent[pixel], parent[pixel + offset]
                if a != b and (size[a] < min_size or size[b] < min_size):
                    out[count] = (np.uint64(bits[first + pixel]) << np.uint64(32)) | np.uint64(first + pixel)
                    count += 1
    return count


@kernel
def merge(numbers, weights, offsets, gamma, parent, size, bound):
    """Eqs. 2, 3. Merges regions over sorted edges.

    numbers (K, 2) uint32 and weights (K, 2) float32: the same packed edges, number in column 0 and weight in column 1;
    offsets (P,) from a pixel to its neighbour. parent (H W,) uint32 and size start as 0..N-1 and 1; bound (H W,)
    float64 starts as gamma. I(R) of eq. 2 is the weight of the last merge: the edges come sorted, so it is the largest
    one in the minimum spanning tree of R.
    """
    pixels = parent.size
    for k in range(numbers.shape[0]):
        weight = float(weights[k, 1])
        here, there = ends(numbers[k, 0], pixels, offsets)
        a, b = find(parent, here), find(parent, there)
        if a != b and may_merge(weight, bound[a], bound[b]):
            root = unite(parent, size, a, b)
            bound[root] = merge_bound(weight, gamma, size[root])


@kernel
def absorb_small(numbers, offsets, min_size, parent, size):
    """Joins regions smaller than min_size to the neighbour over their lightest edge; sorted edges as in `merge`."""
    pixels = parent.size
    for k in range(numbers.shape[0]):
        here, there = ends(numbers[k, 0], pixels, offsets)
        a, b = find(parent, here), find(parent, there)
        if a != b and (size[a] < min_size or size[b] < min_size):
            unite(parent, size, a, b)


@kernel
def flatten(parent):
    """Makes the root of every pixel its parent."""
    for pixel in range(parent.size):
        parent[pixel] = find(parent, np.uint32(pixel))


@kernel
def number_regions(parent, number, labels):
    """Labels 0..R-1 in the order of each region's first pixel. number (H W,) starts at -1; returns R."""
    regions = 0
    for pixel in range(parent.size):
        root = find(parent, np.uint32(pixel))
        if number[root] < 0:
            number[root] = regions
            regions += 1
        labels[pixel] = number[root]
    return regions
