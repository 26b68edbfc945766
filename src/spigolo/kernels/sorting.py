"""Kernels that sort edges by weight, and edges of equal weight by edge number.

A graph edge is packed into 64 bits, with its float32 weight in the upper half. The bit patterns of non-negative float32
numbers, read as integers, have the same order as the numbers.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.merging import weight_bits


@inlined
def digit_of(edge, base, shift, mask):
    """Return one digit of a packed edge for the radix sort. The digits are those of an integer: the bit pattern of the
    weight minus `base`.
    """
    return ((weight_bits(edge) - base) >> shift) & mask


@kernel
def scatter(edges, base, shift, mask, starts, out):
    """Run one stable pass of a radix sort, which sorts packed edges (E,) by one digit of their weight.

    - base: bit pattern of the smallest possible weight, as uint64. The number `base` is subtracted from the bit pattern
      of each weight.
    - shift: position of the digit in bits.
    - mask: 2^b - 1 for digits of b bits.
    - starts (2^b,) uint32: scratch memory.
    - out (E,): sorted edges.
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
