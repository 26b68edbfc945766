"""Selection of the graph edges that are sorted and used to merge regions. Edges that cannot merge two regions are
skipped to save time (see docs/performance.md). The merge bound of a region is the maximum weight of an edge that can
merge the region with another region (`kernels.merging.merge_bound`).

Three kinds of edges cannot merge two regions:

- edges between two pixels of one region
- edges of a final region: a region whose remaining edges are all heavier than its merge bound
- detours, which are edges between two pixels that are also connected by a chain of lighter edges
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.merging import HALF_BITS, PLANE_BITS, bound_bits, ends, find, find_deep, size_of, weight_bits

SIGN_BIT = 0x80000000
SAMPLE_STEP = 16
BLOCK = 4096
"""Number of edges that are processed together, to stay in the processor's cache. The number BLOCK must be a multiple of
8.
"""


@kernel
def collect(weights, width, low, high, parent, flags, least, offsets, detours, out):
    """Select and pack the edges that connect two regions and have low <= weight < high. At least `least` of the two
    pixels of an edge must be flagged in `flags`.

    The packed edges are ordered by plane, then by pixel. With `detours=False`, the heaviest edge of each triangle or
    square of neighbouring pixels is skipped.

    - weights (P, H W) float32: edge weights.
    - width: number of image columns.
    - parent (H W,): root of the region of every pixel.
    - flags (H W,) uint8: 1 for flagged pixels, 0 for other pixels (see `flag_open` and `flag_small`).
    - offsets (P,) int64: index difference from a pixel to its neighbour in each direction.
    - out: buffer for the packed edges. The buffer must have room for one more edge than is packed.

    Returns the number of packed edges, or -1 if the buffer `out` is too small.
    """
    count, pixels = np.uint64(0), parent.size
    chosen = np.empty(BLOCK, np.uint8)
    eights = chosen.view(np.uint64)
    for plane in range(len(weights)):
        bits = weights[plane].view(np.uint32)
        for first in range(0, pixels, BLOCK):
            last = min(first + BLOCK, pixels)
            choose(weights[plane], low, high, parent, flags, least, offsets[plane], first, last, chosen)
            if not detours:
                drop_detours(weights, plane, width, first, last, chosen)
            if count + np.uint64(last - first) >= out.size and count + np.uint64(chosen.sum()) >= out.size:
                return -1
            count = pack(bits[first:last], plane, np.uint64(first), np.uint64(last), chosen, eights, count, out)
    return np.int64(count)


@inlined
def choose(weights, low, high, parent, flags, least, offset, first, last, chosen):
    """Mark the edges first..last - 1 of one direction that can merge two regions. chosen (BLOCK,) uint8."""
    begin = min(max(first, -offset), last)
    end = max(min(last, parent.size - max(0, offset)), begin)
    chosen[: begin - first] = 0
    chosen[end - first :] = 0
    out, weight = chosen[begin - first : end - first], weights[begin:end]
    root_a, root_b = parent[begin:end], parent[begin + offset : end + offset]
    flag_a, flag_b = flags[begin:end], flags[begin + offset : end + offset]
    for k in range(out.size):
        inside = (weight[k] >= low) & (weight[k] < high)
        out[k] = inside & (root_a[k] != root_b[k]) & (flag_a[k] + flag_b[k] >= least)


@inlined
def drop_detours(weights, plane, width, first, last, chosen):
    """Unmark the heaviest edge of each triangle of neighbouring pixels or, with 4-connectivity, of each square.

    Among edges of equal weight, the edge with the highest number is unmarked. Edges to the right have lower numbers
    than downward edges, and diagonal edges have the highest numbers. Some edges near the image border are not tested
    and stay marked.
    """
    right, down, pixels = weights[0], weights[1], weights.shape[1]
    begin = max(first, 1 if plane == 1 else 0 if plane == 2 else width)
    end = max(min(last, pixels if plane == 3 else pixels - width), begin)
    kept, n = chosen[begin - first :], end - begin
    before, here, after = begin - width, begin, begin + width
    if plane == 2:
        drop_diagonal(weights[2][here:], right[here:], down[here + 1 :], down[here:], right[after:], n, kept)
    elif plane == 3:
        drop_diagonal(weights[3][here:], right[here:], down[before + 1 :], down[before:], right[before:], n, kept)
    elif len(weights) == 2 and plane == 0:
        drop_right(right[before:], down[before:], width, n, kept)
    elif len(weights) == 2:
        drop_down(right[here - 1 :], down[here - 1 :], width, n, kept)
    elif plane == 0:
        drop_right_8(right[before:], down[before:], weights[2][before:], weights[3][before:], width, n, kept)
    else:
        drop_down_8(right[here - 1 :], down[here - 1 :], weights[2][here - 1 :], weights[3][here - 1 :], width, n, kept)


@inlined
def drop_right(right, down, width, n, kept):
    """Unmark each edge to the right that is the heaviest edge of a square of 2x2 pixels above or below the edge.

    The arrays `right` and `down` of edge weights begin one image row before the first of the n tested edges.
    """
    weight, above, below = right[width:], right, right[2 * width :]
    left_above, right_above, left_below, right_below = down, down[1:], down[width:], down[width + 1 :]
    for k in range(n):
        first = (weight[k] < above[k]) | (weight[k] <= max(left_above[k], right_above[k]))
        second = (weight[k] <= below[k]) | (weight[k] <= max(left_below[k], right_below[k]))
        kept[k] &= first & second


@inlined
def drop_down(right, down, width, n, kept):
    """Unmark each downward edge that is the heaviest edge of a square of 2x2 pixels on its left or right side.

    The arrays `right` and `down` of edge weights begin one pixel before the first of the n tested edges.
    """
    weight, before, after = down[1:], down, down[2:]
    left_above, left_below, right_above, right_below = right, right[width:], right[1:], right[width + 1 :]
    for k in range(n):
        first = (weight[k] < before[k]) | (weight[k] < max(left_above[k], left_below[k]))
        second = (weight[k] <= after[k]) | (weight[k] < max(right_above[k], right_below[k]))
        kept[k] &= first & second


@inlined
def drop_diagonal(weight, first, second, third, fourth, n, kept):
    """Unmark each diagonal edge whose two pixels are also connected by a horizontal and a vertical edge that are not
    heavier.
    """
    for k in range(n):
        kept[k] &= (weight[k] < max(first[k], second[k])) & (weight[k] < max(third[k], fourth[k]))


@inlined
def drop_right_8(right, down, falling, rising, width, n, kept):
    """Unmark each edge to the right whose two pixels are also connected by two lighter edges, through a pixel in the
    row above or below.

    All arrays of edge weights begin one image row before the first of the n tested edges.
    """
    weight, falling_here = right[width:], falling[width:]
    rising_here, rising_below = rising[width:], rising[2 * width :]
    left_above, right_above, left_below, right_below = down, down[1:], down[width:], down[width + 1 :]
    for k in range(n):
        above = (weight[k] <= max(left_above[k], falling[k])) & (weight[k] <= max(right_above[k], rising_here[k]))
        below = weight[k] <= max(left_below[k], rising_below[k])
        kept[k] &= above & below & (weight[k] <= max(right_below[k], falling_here[k]))


@inlined
def drop_down_8(right, down, falling, rising, width, n, kept):
    """Unmark each downward edge whose two pixels are also connected by two lighter edges, through a pixel in the column
    on the left or right.

    All arrays of edge weights begin one pixel before the first of the n tested edges.
    """
    weight, falling_here, rising_left, rising_here = down[1:], falling[1:], rising[width:], rising[width + 1 :]
    left_above, left_below, right_above, right_below = right, right[width:], right[1:], right[width + 1 :]
    for k in range(n):
        first = (weight[k] < left_above[k]) | (weight[k] <= falling[k])
        second = (weight[k] < left_below[k]) | (weight[k] <= rising_left[k])
        third = (weight[k] < right_above[k]) | (weight[k] <= rising_here[k])
        fourth = (weight[k] < right_below[k]) | (weight[k] <= falling_here[k])
        kept[k] &= first & second & third & fourth


@inlined
def pack_edge(bits, plane, pixel):
    """Pack an edge into 64 bits: the weight in the upper 32 bits, then the number of the pixel, then the number of the
    direction.
    """
    without_sign = np.uint64(bits) & np.uint64(SIGN_BIT - 1)  # a weight of -0 must sort like 0
    return (without_sign << np.uint64(HALF_BITS)) | (pixel << np.uint64(PLANE_BITS)) | np.uint64(plane)


@inlined
def pack(bits, plane, first, last, chosen, eights, count, out):
    """Append the marked edges among the edges first..last - 1 of one direction to out, which contains `count` edges.
    Return the new number of edges in out.

    Unmarked edges are written too, and the next edge overwrites them, so that the loop needs few branches.
    """
    whole = np.uint64(last - first) // np.uint64(8)
    for eight in range(whole):
        if eights[eight] != 0:
            for k in range(np.uint64(8)):
                at = eight * np.uint64(8) + k
                out[count] = pack_edge(bits[at], plane, first + at)
                count += np.uint64(chosen[at])
    for at in range(whole * np.uint64(8), last - first):
        out[count] = pack_edge(bits[at], plane, first + at)
        count += np.uint64(chosen[at])
    return count


@inlined
def is_heavy(edge, offsets, parent, records):
    """Test if a graph edge is heavier than the merge bounds of the two regions that it connects.

    The result is a flag for the first region, a flag for the second region, and the roots of both regions. The flag of
    a region is True if the edge is heavier than the merge bound of the region.
    """
    here, there = ends(edge, offsets)
    a, b, bits = np.uint64(parent[here]), np.uint64(parent[there]), weight_bits(edge)
    return bits > bound_bits(records[a]), bits > bound_bits(records[b]), a, b


@kernel
def drop_final(edges, offsets, parent, records, useful):
    """Remove the packed edges (K,) at final regions. Return the number of edges that remain.

    A region is final if its lightest edge is heavier than its merge bound. To save time, no edge is removed if only few
    edges are heavier than the merge bound of one of their two regions.

    - parent (H W,): root of the region of every pixel.
    - useful (H W,) uint8: scratch memory.
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


@kernel
def flag_open(low_bits, parent, records, flags):
    """Set the parent of every pixel to the root of its region, and flag the regions that can still merge.

    - low_bits: bit pattern of a float32 weight, as an integer.
    - flags (H W,): 1 for pixels of regions whose merge bound is at least the weight `low_bits`, else 0.
    """
    for pixel in range(np.uint64(parent.size)):
        root = find_deep(parent, pixel)
        parent[pixel] = np.uint32(root)
        flags[pixel] = bound_bits(records[root]) >= low_bits


@kernel
def flag_small(min_size, parent, records, flags):
    """Set the parent of every pixel to the root of its region, and flag small regions.

    flags (H W,): 1 for pixels of regions with fewer than min_size pixels, else 0.
    """
    for pixel in range(np.uint64(parent.size)):
        root = find(parent, pixel)
        parent[pixel] = np.uint32(root)
        flags[pixel] = size_of(records[root]) < min_size
