"""Kernels that merge pixels into regions by internal difference (Felzenszwalb & Huttenlocher 2004, eqs. 2, 3).

A packed edge has 64 bits: 32 of its float32 weight, 30 of its pixel, and 2 of its plane. The record of a root has 64
bits too: the size of its region, then the bits of its merge bound. docs/performance.md explains the rounds.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel, prefetch

HALF_BITS, LOW_HALF = 32, 0xFFFFFFFF
"""Shift and mask of the halves of an edge and of a record."""
PLANE_BITS = 2
NODES_AHEAD, ROOTS_AHEAD = 24, 12
"""Number of edges ahead at which memory is prefetched: first a pixel's parent, then the record of that parent."""


@inlined
def ends(edge, offsets):
    """Return both pixels of a packed edge. All values are unsigned, so that no index is tested for its sign."""
    pixel = (edge & np.uint64(LOW_HALF)) >> np.uint64(PLANE_BITS)
    return pixel, pixel + offsets[edge & np.uint64((1 << PLANE_BITS) - 1)]


@inlined
def weight_bits(edge):
    """Return the bits of a packed edge's weight."""
    return edge >> np.uint64(HALF_BITS)


@inlined
def find(parent, node):
    """Return the root of a node's tree, with path halving. For trees in which most nodes are children of the root."""
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
    """Return the root of a node's tree and make the node its child. For trees that grow.

    Three steps are taken without a test. A mispredicted end of the path costs more time than a step.
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
    """Eq. 3. Return True if the weight of an edge is at most I(R) + gamma / |R| of both regions."""
    return weight <= bound_a and weight <= bound_b


@inlined
def merge_bound(internal, gamma, size):
    """Return I(R) + gamma / |R|, the maximum weight of an edge at which a region merges (eq. 3)."""
    return internal + gamma / size


@inlined
def bits_below(bound):
    """Return the bits of the largest float32 that is not above a bound >= 0. No weight lies between the two."""
    nearest = np.float32(bound)
    bits = nearest.view(np.uint32)
    return bits - np.uint32(1) if np.float64(nearest) > bound else bits


@inlined
def record(size, bound):
    """Pack the size and the merge bound of a region into the record of its root."""
    return (np.uint64(size) << np.uint64(HALF_BITS)) | np.uint64(bits_below(bound))


@inlined
def size_of(node):
    """Return the number of pixels of the region whose root has this record."""
    return node >> np.uint64(HALF_BITS)


@inlined
def bound_bits(node):
    """Return the bits of the merge bound of the region whose root has this record."""
    return node & np.uint64(LOW_HALF)


@inlined
def unite(parent, records, a, b, bound):
    """Join two roots, the smaller below the larger."""
    size_a, size_b = size_of(records[a]), size_of(records[b])
    if size_a < size_b:
        a, b = b, a
    parent[b] = np.uint32(a)
    records[a] = record(size_a + size_b, bound)


@inlined
def ask_ahead(edges, k, offsets, parent, records):
    """Prefetch the memory that the edges after the k-th will need."""
    here, there = ends(edges[k + NODES_AHEAD], offsets)
    prefetch(parent, here)
    prefetch(parent, there)
    here, there = ends(edges[k + ROOTS_AHEAD], offsets)
    prefetch(records, np.uint64(parent[here]))
    prefetch(records, np.uint64(parent[there]))


@kernel
def plant(weights, width, gamma, parent, records, flags):
    """Make regions of the pixels that are connected by straight edges of weight 0. The regions may merge later.

    Edges of weight 0 are never refused (eq. 3), so their order does not matter.

    weights (P, H W) float32. parent (H W,) uint32, root of each pixel. records (H W,) uint64. flags (H W,) uint8.
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
    """Join two roots to the one that comes first in the image."""
    if a != b:
        parent[max(a, b)] = np.uint32(min(a, b))


@kernel
def merge(edges, offsets, gamma, stop, parent, records):
    """Eqs. 2, 3. Merge regions over sorted packed edges (K,). With `stop`, end at the first edge that is refused.

    I(R) of eq. 2 is the weight of the last merge. As edges are sorted, it is the largest weight in the minimum spanning
    tree of R.

    offsets (P,) uint64: index differences from a pixel to its neighbours, modulo 2^64. Returns the number of edges that
    were processed.
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
    """Join regions smaller than min_size to the neighbour across their lightest edge. Edges are sorted as in
    `merge`.
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
    """Compute labels 0..R-1 in the order of each region's first pixel. number (H W,) uint32 is scratch. Return R."""
    number[:] = 0
    regions = np.uint32(0)
    for pixel in range(np.uint64(parent.size)):
        root = find(parent, pixel)
        if number[root] == 0:
            regions += np.uint32(1)
            number[root] = regions
        labels[pixel] = number[root] - np.uint32(1)
    return regions
