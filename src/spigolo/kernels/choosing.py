"""Which edges are sorted: all but those that can join nothing. docs/performance.md says why each kind may be left out.

Three kinds are: edges inside a region or of one that is final, edges whose ends others connect before (detours), edges
between regions of which one can no longer merge.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.merging import PLANE_BITS, bound_bits, ends, find, find_deep, size_of

SIGN_BIT = 0x80000000
SAMPLE_STEP = 16


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


@kernel
def drop_detours(weights, width, chosen):
    """Takes back the edges that come last of a triangle of neighbours or, on a 4-connected grid, of a square.

    weights (P, H W) float32; width of a row; chosen (P, H W or more) uint8. Of equal weights the higher edge number
    comes later: downwards after right, diagonals after both. Some at the image border stay.
    """
    right, down = weights[0], weights[1]
    if len(weights) == 2:
        drop_right(right, down, width, chosen[0])
        drop_down(right, down, width, chosen[1])
    else:
        falling, rising = weights[2], weights[3]
        drop_diagonal(falling, right, down[1:], down, right[width:], chosen[2])
        drop_diagonal(rising[width:], right[width:], down[1:], down, right, chosen[3][width:])
        drop_right_8(right, down, falling, rising, width, chosen[0])
        drop_down_8(right, down, falling, rising, width, chosen[1])


@inlined
def drop_right(right, down, width, chosen):
    """In the square above, the one below. Slices let the compiler make vectors of it."""
    weight, kept = right[width:], chosen[width:]
    above, below = right, right[2 * width :]
    left_above, right_above, left_below, right_below = down, down[1:], down[width:], down[width + 1 :]
    for k in range(below.size):
        first = (weight[k] < above[k]) | (weight[k] <= max(left_above[k], right_above[k]))
        second = (weight[k] <= below[k]) | (weight[k] <= max(left_below[k], right_below[k]))
        kept[k] &= first & second


@inlined
def drop_down(right, down, width, chosen):
    """In the square on the left, the one on the right."""
    weight, kept = down[1:], chosen[1:]
    before, after = down, down[2:]
    left_above, left_below, right_above, right_below = right, right[width:], right[1:], right[width + 1 :]
    for k in range(right_below.size):
        first = (weight[k] < before[k]) | (weight[k] < max(left_above[k], left_below[k]))
        second = (weight[k] <= after[k]) | (weight[k] < max(right_above[k], right_below[k]))
        kept[k] &= first & second


@inlined
def drop_diagonal(weight, first, second, third, fourth, kept):
    """Two pairs of straight edges lead where a diagonal does."""
    for k in range(min(weight.size, second.size, fourth.size)):
        kept[k] &= (weight[k] < max(first[k], second[k])) & (weight[k] < max(third[k], fourth[k]))


@inlined
def drop_right_8(right, down, falling, rising, width, chosen):
    """Over both pixels above, both below."""
    weight, kept, rising_here = right[width:], chosen[width:], rising[width:]
    falling_here, rising_below = falling[width:], rising[2 * width :]
    left_above, right_above, left_below, right_below = down, down[1:], down[width:], down[width + 1 :]
    for k in range(rising_below.size):
        above = (weight[k] <= max(left_above[k], falling[k])) & (weight[k] <= max(right_above[k], rising_here[k]))
        below = weight[k] <= max(left_below[k], rising_below[k])
        kept[k] &= above & below & (weight[k] <= max(right_below[k], falling_here[k]))


@inlined
def drop_down_8(right, down, falling, rising, width, chosen):
    """Over both pixels on the left, both on the right."""
    weight, kept, falling_here = down[1:], chosen[1:], falling[1:]
    rising_left, rising_here = rising[width:], rising[width + 1 :]
    left_above, left_below, right_above, right_below = right, right[width:], right[1:], right[width + 1 :]
    for k in range(right_below.size):
        first = (weight[k] < left_above[k]) | (weight[k] <= falling[k])
        second = (weight[k] < left_below[k]) | (weight[k] <= rising_left[k])
        third = (weight[k] < right_above[k]) | (weight[k] <= rising_here[k])
        fourth = (weight[k] < right_below[k]) | (weight[k] <= falling_here[k])
        kept[k] &= first & second & third & fourth


@inlined
def is_heavy(edge, offsets, parent, records):
    """Whether an edge is heavier than the bound of the region at its first and at its second end, and both roots."""
    here, there = ends(edge, offsets)
    a, b, bits = np.uint64(parent[here]), np.uint64(parent[there]), edge >> np.uint64(32)
    return bits > bound_bits(records[a]), bits > bound_bits(records[b]), a, b


@kernel
def drop_final(edges, offsets, parent, records, useful):
    """Keeps of packed edges (K,) those between regions that one of them can still merge; returns how many.

    A region whose lightest edge is heavier than its bound is final. parent (H W,) every pixel's root; useful (H W,)
    uint8 is scratch. Where few edges are heavy it does nothing, as too few would go.
    """
    heavy = 0
    for k in range(0, edges.size, SAMPLE_STEP):
        heavy_a, heavy_b, _, _ = is_heavy(edges[k], offsets, parent, records)
        heavy += heavy_a | heavy_b
    if 2 * heavy * SAMPLE_STEP < edges.size:
        return edges.size
    useful[:] = 0
    for k in range(edges.size):
        heavy_a, heavy_b, a, b = is_heavy(edges[k], offsets, parent, records)
        if not heavy_a:
            useful[a] = 1
        if not heavy_b:
            useful[b] = 1
    count = 0
    for k in range(edges.size):
        here, there = ends(edges[k], offsets)
        edges[count] = edges[k]
        count += useful[np.uint64(parent[here])] & useful[np.uint64(parent[there])]
    return count


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
