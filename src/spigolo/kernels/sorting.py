"""Edges in the exact order of (float32 weight, edge number).

An edge is packed into 64 bits, its weight's above what names its ends: the bits of non-negative float32 sort as the
weights do.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.merging import weight_bits


@inlined
def digit_of(edge, base, shift, mask):
    """One digit of an edge's weight, whose bits count from `base`."""
    return ((weight_bits(edge) - base) >> shift) & mask


@kernel
def scatter(edges, base, shift, mask, starts, out):
    """One stable pass of a radix sort: orders packed edges (E,) by the digit at `shift`, 2^b - 1 = mask.

    base, shift, mask uint64. starts (2^b,) uint32 is scratch. out (E,).
    """
    starts[:] = 0
    for k in range(edges.size):
        starts[digit_of(edges[k], base, shift, mask)] += np.uint32(1)
    total = np.uint32(0)
    for digit in range(starts.size):
        count = starts[digit]
        starts[digit] = total
        total += count
    for k in range(edges.size):
        digit = digit_of(edges[k], base, shift, mask)
        place = starts[digit]
        out[np.uint64(place)] = edges[k]
        starts[digit] = place + np.uint32(1)
