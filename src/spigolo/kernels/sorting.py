"""Edges in the exact order of (float32 weight, edge number).

An edge is packed into 64 bits, its weight's above its number: the bits of non-negative float32 sort as the weights do.
Read as pairs of 32 bits on a little-endian machine such an array gives (number, weight).
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import kernel

DIGITS = 3
WEIGHT_SHIFT = 32


@kernel
def count_digits(packed, digit_bits, starts):
    """Where each digit's bucket starts, for the three digits of every weight.

    packed (E,) uint64; digit_bits uint64; starts (3, 2^digit_bits) int64, zero before.
    """
    mask = (np.uint64(1) << digit_bits) - np.uint64(1)
    for k in range(packed.size):
        key = packed[k] >> np.uint64(WEIGHT_SHIFT)
        starts[0, key & mask] += 1
        starts[1, (key >> digit_bits) & mask] += 1
        starts[2, (key >> (digit_bits + digit_bits)) & mask] += 1
    for digit in range(DIGITS):
        total = 0
        for bucket in range(starts.shape[1]):
            count = starts[digit, bucket]
            starts[digit, bucket] = total
            total += count


@kernel
def scatter(packed, start, shift, out):
    """One stable pass of a radix sort: puts each edge where the bucket of its digit at `shift` goes on."""
    mask = np.uint64(start.size - 1)
    for k in range(packed.size):
        bucket = (packed[k] >> shift) & mask
        out[start[bucket]] = packed[k]
        start[bucket] += 1


@kernel
def sort_edges(packed, spare, starts, digit_bits):
    """Stable radix sort by weight of packed edges (E,) uint64 that come in the order of their numbers.

    spare (E,) and starts (3, 2^digit_bits) are scratch. digit_bits uint64: 10 for weights up to 1, whose bits lie
    below 2^30, else 11.
    """
    starts[:] = 0
    count_digits(packed, digit_bits, starts)
    shift = np.uint64(WEIGHT_SHIFT)
    scatter(packed, starts[0], shift, spare)
    scatter(spare, starts[1], shift + digit_bits, packed)
    scatter(packed, starts[2], shift + digit_bits + digit_bits, spare)
    packed[:] = spare
