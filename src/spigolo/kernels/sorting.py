"""Kernels that sort edges exactly by (float32 weight, edge number).

An edge is packed into 64 bits, with the bits of its weight above those of its pixel and plane. Bits of non-negative
float32 numbers sort in the order of the numbers.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.merging import weight_bits


@inlined
def digit_of(edge, base, shift, mask):
    """Return one digit of an edge's weight, with bits counted from `base`."""
    return ((weight_bits(edge) - base) >> shift) & mask


@kernel
def scatter(edges, base, shift, mask, starts, out):
    """Run one stable pass of a radix sort: sort packed edges (E,) by the digit at `shift`, 2^b - 1 = mask.

    base, shift, mask uint64. starts (2^b,) uint32 is scratch memory. out (E,).
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
