"""Kernels that merge pixels into regions by the method of Felzenszwalb & Huttenlocher 2004 (equations 2, 3).

A packed edge has 64 bits: 32 bits for its float32 weight, 30 bits for its pixel and 2 bits for its direction. The
record of a region has 32 bits for its number of pixels and 32 bits for its merge bound. The merge bound is the maximum
weight of an edge that can merge the region with another region. The algorithm of the merging is explained in
docs/performance.md.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel, prefetch

HALF_BITS, LOW_HALF = 32, 0xFFFFFFFF
"""Number of bits in the lower half of a packed edge or record, and the mask of these bits."""
PLANE_BITS = 2
NODES_AHEAD, ROOTS_AHEAD = 24, 12
"""Index of the edge for which memory is prefetched, minus the index of the current edge. The constant `NODES_AHEAD`
applies to the parents of pixels, and `ROOTS_AHEAD` to the records of regions.
"""


@inlined
def ends(edge, offsets):
    """Return the indices y * W + x of both pixels of a packed edge."""
    pixel = (edge & np.uint64(LOW_HALF)) >> np.uint64(PLANE_BITS)
    return pixel, pixel + offsets[edge & np.uint64((1 << PLANE_BITS) - 1)]


@inlined
def weight_bits(edge):
    """Return the float32 weight of a packed edge, as the integer with the same bit pattern."""
    return edge >> np.uint64(HALF_BITS)


@inlined
def find(parent, node):
    """Return the root of a node in a union-find forest, with path halving.

    The search is fast if most nodes are children of their root.
    """
    above = np.uint64(parent[node])
    root = np.uint64(parent[above])
    while above != root:
        parent[node] = root
        node = root
        above = np.uint64(parent[node])
        root = np.uint64(parent[above])
    return above


@inlined
def find_deep(parent, node):
    """Return the root of a node in a union-find forest, and make the node a child of the root.

    The first three parents are followed without a test for the root, because a mispredicted branch costs more time.
    """
    root = np.uint64(parent[np.uint64(parent[np.uint64(parent[node])])])
    above = np.uint64(parent[root])
    while above != root:
        root = above
        above = np.uint64(parent[root])
    parent[node] = np.uint32(root)
    return root


@inlined
def may_merge(weight, bound_a, bound_b):
    """Eq. 3. Return True if the weight of an edge is at most the merge bound of both regions."""
    return weight <= bound_a and weight <= bound_b


@inlined
def merge_bound(internal, gamma, size):
    """Return the merge bound I(R) + gamma / |R| of a region R: the maximum weight of an edge that can merge R (equation
    3).
    """
    return internal + gamma / size


@inlined
def bits_below(bound):
    """Return the largest float32 that is at most equal to a merge bound, as the integer with the same bit pattern."""
    nearest = np.float32(bound)
    bits = nearest.view(np.uint32)
    return bits - np.uint32(1) if np.float64(nearest) > bound else bits


@inlined
def record(size, bound):
    """Pack the number of pixels and the merge bound of a region into a record of 64 bits."""
    return (np.uint64(size) << np.uint64(HALF_BITS)) | np.uint64(bits_below(bound))


@inlined
def size_of(node):
    """Return the number of pixels of a region from its record."""
    return node >> np.uint64(HALF_BITS)


@inlined
def bound_bits(node):
    """Return the merge bound of a region from its record, as the integer with the bit pattern of the float32 value."""
    return node & np.uint64(LOW_HALF)


@inlined
def unite(parent, records, a, b, bound):
    """Merge the regions of roots a and b. The root of the larger region becomes the root of both regions."""
    size_a, size_b = size_of(records[a]), size_of(records[b])
    if size_a < size_b:
        a, b = b, a
    parent[b] = np.uint32(a)
    records[a] = record(size_a + size_b, bound)


@inlined
def ask_ahead(edges, k, offsets, parent, records):
    """Prefetch the memory that will be read for edges after the k-th edge."""
    here, there = ends(edges[k + NODES_AHEAD], offsets)
    prefetch(parent, here)
    prefetch(parent, there)
    here, there = ends(edges[k + ROOTS_AHEAD], offsets)
    prefetch(records, np.uint64(parent[here]))
    prefetch(records, np.uint64(parent[there]))


@kernel
def plant(weights, width, gamma, parent, records, flags):
    """Merge pixels into regions along horizontal and vertical edges of weight 0.

    Edges of weight 0 always merge two regions (equation 3), so that the order of these edges does not matter.

    - weights (P, H W) float32: edge weights.
    - parent (H W,) uint32: root of the region of each pixel.
    - records (H W,) uint64: records of the roots.
    - flags (H W,) uint8: output, 1 at all pixels. The flag 1 means that the region of a pixel can still merge.
    """
    right, down = weights[0], weights[1]
    for pixel in range(np.uint64(parent.size)):
        parent[pixel], records[pixel], flags[pixel] = pixel, 0, 1
        if pixel > 0 and right[pixel - np.uint64(1)] == 0:
            parent[pixel] = parent[pixel - np.uint64(1)]
        if pixel >= width and down[pixel - width] == 0:
            hang_below_first(parent, find(parent, pixel), find(parent, pixel - width))
    for pixel in range(np.uint64(parent.size)):
        root = np.uint64(parent[np.uint64(parent[pixel])])
        parent[pixel] = root
        records[root] += np.uint64(1)
    single = record(np.uint64(1), merge_bound(0.0, gamma, 1.0))
    for pixel in range(records.size):
        size = records[pixel]
        records[pixel] = record(size, merge_bound(0.0, gamma, np.float64(size))) if size > 1 else single


@inlined
def hang_below_first(parent, a, b):
    """Merge the trees of roots a and b. The root that comes first in the image becomes the root of both trees."""
    if a != b:
        parent[max(a, b)] = np.uint32(min(a, b))


@kernel
def merge(edges, offsets, gamma, stop, parent, records):
    """Eqs. 2, 3. Merge regions along packed edges (K,), which must be sorted by weight.

    The internal difference I(R) of a region R is the weight of the last edge that merged R, because edges are sorted.

    - offsets (P,) uint64: index differences from a pixel to its neighbours, modulo 2^64.
    - stop: if True, stop at the first edge between two regions that equation 3 does not allow to merge.

    Returns the number of processed edges.
    """
    for k in range(edges.size):
        if k + NODES_AHEAD < edges.size:
            ask_ahead(edges, k, offsets, parent, records)
        here, there = ends(edges[k], offsets)
        a, b = find_deep(parent, here), find_deep(parent, there)
        if a != b:
            bits = weight_bits(edges[k])
            if may_merge(bits, bound_bits(records[a]), bound_bits(records[b])):
                weight = np.float64(np.uint32(bits).view(np.float32))
                size = np.float64(size_of(records[a]) + size_of(records[b]))
                unite(parent, records, a, b, merge_bound(weight, gamma, size))
            elif stop:
                return k
    return edges.size


@kernel
def absorb_small(edges, offsets, min_size, parent, records):
    """Merge each region of fewer than min_size pixels with the neighbouring region to which its lightest edge leads.
    The packed edges must be sorted by weight.
    """
    for k in range(edges.size):
        if k + NODES_AHEAD < edges.size:
            ask_ahead(edges, k, offsets, parent, records)
        here, there = ends(edges[k], offsets)
        a, b = find(parent, here), find(parent, there)
        if a != b and (size_of(records[a]) < min_size or size_of(records[b]) < min_size):
            unite(parent, records, a, b, 0.0)


@kernel
def number_regions(parent, number, labels):
    """Number the regions 0..R-1 in the order in which their first pixels appear in the image. Return the number of
    regions R.

    - parent (H W,) uint32: parent of each pixel in the union-find forest.
    - number (H W,) uint32: scratch memory.
    - labels (H W,): number of the region of each pixel.
    """
    number[:] = 0
    regions = np.uint32(0)
    for pixel in range(np.uint64(parent.size)):
        root = find(parent, pixel)
        if number[root] == 0:
            regions += np.uint32(1)
            number[root] = regions
        labels[pixel] = number[root] - np.uint32(1)
    return regions
