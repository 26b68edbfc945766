"""Merging pixels into regions by internal difference (Felzenszwalb & Huttenlocher 2004; eqs. 2, 3).

A packed edge is 64 bits: those of its float32 weight, then 30 for its pixel, then 2 for its plane. A root's record is
64 bits as well: the size of its region, then the bits of its merge bound. docs/performance.md explains the rounds.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel, prefetch

LOW_HALF = 0xFFFFFFFF
SIGN_BIT = 0x80000000
PLANE_BITS = 2
NODES_AHEAD, ROOTS_AHEAD = 24, 12
"""How many edges ahead memory is asked for: first a pixel's parent, then the record of that parent."""


@inlined
def ends(edge, offsets):
    """Both pixels of a packed edge. All is unsigned, so that no index is tested for its sign."""
    pixel = (edge & np.uint64(LOW_HALF)) >> np.uint64(PLANE_BITS)
    return pixel, pixel + offsets[edge & np.uint64((1 << PLANE_BITS) - 1)]


@inlined
def find(parent, node):
    """Root of a node's tree; the path behind is halved. For trees of which most nodes stand one step below the root."""
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
    """Root of a node's tree, below which the node is hung. For trees that grow: three steps are taken unasked, as a
    processor guesses wrongly where a path ends and loses more by that than by a step."""
    root = np.uint64(parent[np.uint64(parent[np.uint64(parent[node])])])
    above = np.uint64(parent[root])
    while above != root:
        root = above
        above = np.uint64(parent[root])
    parent[node] = np.uint32(root)
    return root


@inlined
def may_merge(weight, bound_a, bound_b):
    """Eq. 3. Two regions merge if their edge weighs at most I(R) + gamma / |R| of both."""
    return weight <= bound_a and weight <= bound_b


@inlined
def merge_bound(internal, gamma, size):
    """I(R) + gamma / |R|, the bound that eq. 3 sets to a region's edges."""
    return internal + gamma / size


@inlined
def bits_below(bound):
    """Bits of the largest float32 that is not above a bound >= 0: no float32 weight lies between the two."""
    nearest = np.float32(bound)
    bits = nearest.view(np.uint32)
    return bits - np.uint32(1) if np.float64(nearest) > bound else bits


@inlined
def record(size, bound):
    """What the root of a region keeps, in one word."""
    return (np.uint64(size) << np.uint64(32)) | np.uint64(bits_below(bound))


@inlined
def size_of(node):
    """Pixels of the region whose root has this record."""
    return node >> np.uint64(32)


@inlined
def bound_bits(node):
    """Bits of the merge bound of the region whose root has this record."""
    return node & np.uint64(LOW_HALF)


@inlined
def unite(parent, records, a, b, bound):
    """Joins two roots, the smaller below the larger."""
    size_a, size_b = size_of(records[a]), size_of(records[b])
    if size_a < size_b:
        a, b = b, a
    parent[b] = np.uint32(a)
    records[a] = record(size_a + size_b, bound)


@inlined
def ask_ahead(edges, k, offsets, parent, records):
    """Asks for what the edges after the k-th will need."""
    here, there = ends(edges[k + NODES_AHEAD], offsets)
    prefetch(parent, here)
    prefetch(parent, there)
    here, there = ends(edges[k + ROOTS_AHEAD], offsets)
    prefetch(records, np.uint64(parent[here]))
    prefetch(records, np.uint64(parent[there]))


@kernel
def plant(weights, width, gamma, parent, records, flags):
    """Makes regions, which may still merge, of the pixels that straight edges of weight 0 connect.

    No such edge is ever refused (eq. 3), so that their order is free. weights (P, H W) float32; parent (H W,) uint32, each
    pixel's root; records (H W,) uint64; flags (H W,) uint8.
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
    """Joins two roots to the one that comes first in the image."""
    if a != b:
        parent[max(a, b)] = np.uint32(min(a, b))


@kernel
def choose(weights, low, high, parent, flags, least, offsets, chosen):
    """Marks the edges with low <= weight < high between two regions of which `least` or more ends carry a flag.

    weights (P, H W) float32; parent (H W,) every pixel's root; flags (H W,) uint8, 0 or 1; offsets (P,) int64;
    chosen (P, H W or more) uint8, 0 from H W on.
    """
    pixels = parent.size
    for plane in range(len(weights)):
        offset = offsets[plane]
        begin = min(max(0, -offset), pixels)
        end = max(pixels - max(0, offset), begin)
        chosen[plane, :begin] = 0
        chosen[plane, end:] = 0
        out, weight = chosen[plane, begin:end], weights[plane, begin:end]
        root_a, root_b = parent[begin:end], parent[begin + offset : end + offset]
        flag_a, flag_b = flags[begin:end], flags[begin + offset : end + offset]
        for k in range(out.size):
            inside = (weight[k] >= low) & (weight[k] < high)
            out[k] = inside & (root_a[k] != root_b[k]) & (flag_a[k] + flag_b[k] >= least)


@inlined
def pack_edge(weight_bits, plane, pixel):
    """64 bits of an edge: its weight's, its pixel, its plane."""
    without_sign = np.uint64(weight_bits) & np.uint64(SIGN_BIT - 1)  # -0 sorts as 0
    return (without_sign << np.uint64(32)) | (pixel << np.uint64(PLANE_BITS)) | np.uint64(plane)


@kernel
def pack(weight_bits, chosen, eights, out):
    """Packs the chosen edges in the order of their numbers; out holds one more than there are.

    weight_bits (P, H W) uint32; chosen as `choose` leaves it, eights the same memory as uint64, to skip what holds
    none. Without a branch otherwise: what is not chosen is overwritten.
    """
    count, pixels = np.uint64(0), np.uint64(weight_bits.shape[1])
    whole = pixels // np.uint64(8)
    for plane in range(len(weight_bits)):
        bits, wanted, some = weight_bits[plane], chosen[plane], eights[plane]
        for eight in range(whole):
            if some[eight] != 0:
                for k in range(np.uint64(8)):
                    pixel = eight * np.uint64(8) + k
                    out[count] = pack_edge(bits[pixel], plane, pixel)
                    count += np.uint64(wanted[pixel])
        for pixel in range(whole * np.uint64(8), pixels):
            out[count] = pack_edge(bits[pixel], plane, pixel)
            count += np.uint64(wanted[pixel])


@kernel
def drop_detours(weights, width, chosen):
    """Takes back the edges that come last of a square of four pixels or, on an 8-connected grid, of three of them.

    weights (P, H W) float32; width of a row; chosen (P, H W or more) uint8. Of equal weights the higher edge number
    comes later: downwards after right, diagonals after both.
    """
    right, down = weights[0], weights[1]
    if len(weights) == 2:
        keep_right(right[width:], right, right[2 * width :], down, down[width:], chosen[0][width:])
        keep_down(down[1:], down, down[2:], right, right[1:], width, chosen[1][1:])
    else:
        falling, rising = weights[2], weights[3]
        keep_diagonal(falling, right, down[1:], down, right[width:], chosen[2])
        keep_diagonal(rising[width:], right[width:], down[1:], down, right, chosen[3][width:])
        keep_right_8(right[width:], down, down[1:], falling, rising[width:], width, chosen[0][width:])
        keep_down_8(down[1:], right, right[1:], falling, rising, width, chosen[1][1:])


@inlined
def keep_right_8(weight, down, next_down, falling, rising, width, chosen):
    low, next_low, low_falling, low_rising = down[width:], next_down[width:], falling[width:], rising[width:]
    for k in range(low_rising.size):
        above = (weight[k] <= max(down[k], falling[k])) & (weight[k] <= max(next_down[k], rising[k]))
        below = (weight[k] <= max(next_low[k], low_falling[k])) & (weight[k] <= max(low[k], low_rising[k]))
        chosen[k] &= above & below


@inlined
def keep_down_8(weight, before, after, falling, rising, width, chosen):
    low_before, low_after, right_falling = before[width:], after[width:], falling[1:]
    low_rising, right_rising = rising[width:], rising[width + 1 :]
    for k in range(low_after.size):
        first = (weight[k] < before[k]) | (weight[k] <= falling[k])
        first &= (weight[k] < low_before[k]) | (weight[k] <= low_rising[k])
        second = (weight[k] < after[k]) | (weight[k] <= right_rising[k])
        second &= (weight[k] < low_after[k]) | (weight[k] <= right_falling[k])
        chosen[k] &= first & second


@inlined
def keep_right(weight, above, below, down_above, down_below, chosen):
    """Of edges to the right those that come before another one in the squares above and below."""
    next_above, next_below = down_above[1:], down_below[1:]
    for k in range(below.size):
        first = (weight[k] < above[k]) | (weight[k] <= max(down_above[k], next_above[k]))
        second = (weight[k] <= below[k]) | (weight[k] <= max(down_below[k], next_below[k]))
        chosen[k] &= first & second


@inlined
def keep_down(weight, before, after, right_before, right_after, width, chosen):
    """Of edges downwards those that come before another one in the squares on both sides."""
    low_before, low_after = right_before[width:], right_after[width:]
    for k in range(min(low_after.size, after.size)):
        first = (weight[k] < before[k]) | (weight[k] < max(right_before[k], low_before[k]))
        second = (weight[k] <= after[k]) | (weight[k] < max(right_after[k], low_after[k]))
        chosen[k] &= first & second


@inlined
def keep_diagonal(weight, first, second, third, fourth, chosen):
    """Of diagonals those that come before an edge of each of the two pairs that lead to the same pixel."""
    for k in range(min(weight.size, second.size, fourth.size)):
        chosen[k] &= (weight[k] < max(first[k], second[k])) & (weight[k] < max(third[k], fourth[k]))


@kernel
def merge(edges, offsets, gamma, stop, parent, records):
    """Eqs. 2, 3. Merges regions over sorted packed edges (K,); if it shall `stop`, up to the first that it refuses.

    Returns how many edges are done.
    offsets (P,) uint64 from a pixel to its neighbour, modulo 2^64. I(R) of eq. 2 is the weight of the last merge: the
    edges come sorted, so it is the largest one in the minimum spanning tree of R.
    """
    for k in range(edges.size):
        if k + NODES_AHEAD < edges.size:
            ask_ahead(edges, k, offsets, parent, records)
        here, there = ends(edges[k], offsets)
        a, b = find_deep(parent, here), find_deep(parent, there)
        if a != b:
            bits = edges[k] >> np.uint64(32)
            if may_merge(bits, bound_bits(records[a]), bound_bits(records[b])):
                weight = np.float64(np.uint32(bits).view(np.float32))
                size = np.float64(size_of(records[a]) + size_of(records[b]))
                unite(parent, records, a, b, merge_bound(weight, gamma, size))
            elif stop:
                return k
    return edges.size


@kernel
def absorb_small(edges, offsets, min_size, parent, records):
    """Joins regions smaller than min_size to the neighbour over their lightest edge; sorted edges as in `merge`."""
    for k in range(edges.size):
        if k + NODES_AHEAD < edges.size:
            ask_ahead(edges, k, offsets, parent, records)
        here, there = ends(edges[k], offsets)
        a, b = find(parent, here), find(parent, there)
        if a != b and (size_of(records[a]) < min_size or size_of(records[b]) < min_size):
            unite(parent, records, a, b, 0.0)


@kernel
def flag_open(low_bits, parent, records, flags):
    """Makes every pixel's root its parent; flags (H W,) the pixels of regions whose bound is at least `low_bits`."""
    for pixel in range(np.uint64(parent.size)):
        root = find_deep(parent, pixel)
        parent[pixel] = np.uint32(root)
        flags[pixel] = bound_bits(records[root]) >= low_bits


@kernel
def flag_small(min_size, parent, records, flags):
    """Makes every pixel's root its parent; flags (H W,) the pixels of regions smaller than min_size."""
    for pixel in range(np.uint64(parent.size)):
        root = find(parent, pixel)
        parent[pixel] = np.uint32(root)
        flags[pixel] = size_of(records[root]) < min_size


@kernel
def number_regions(parent, number, labels):
    """Labels 0..R-1 in the order of each region's first pixel. number (H W,) uint32 is scratch; returns R."""
    number[:] = 0
    regions = np.uint32(0)
    for pixel in range(np.uint64(parent.size)):
        root = find(parent, pixel)
        if number[root] == 0:
            regions += np.uint32(1)
            number[root] = regions
        labels[pixel] = number[root] - np.uint32(1)
    return regions
