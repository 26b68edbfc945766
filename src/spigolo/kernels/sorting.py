"""Edges in the exact order of (float32 weight, edge number)."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import kernel

DIGIT_BITS = 11
BUCKETS = 1 << DIGIT_BITS


@kernel
def count_digits(keys, starts):
    """Where each digit's bucket starts, for the three digits of every key. starts (3, BUCKETS) int64, zero before."""
    for k in range(keys.size):
        key = keys[k]
        starts[0, key & np.uint32(BUCKETS - 1)] += 1
        starts[1, (key >> np.uint32(DIGIT_BITS)) & np.uint32(BUCKETS - 1)] += 1
        starts[2, key >> np.uint32(2 * DIGIT_BITS)] += 1
    for digit in range(3):
        total = 0
        for bucket in range(BUCKETS):
            count = starts[digit, bucket]
            starts[digit, bucket] = total
            total += count


@kernel
def scatter(keys, order, start, shift, out):
    """One stable pass of a radix sort: puts `order` into `out` by the digit of its keys at `shift`."""
    for k in range(order.size):
        edge = order[k]
        bucket = (keys[edge] >> shift) & np.uint32(BUCKETS - 1)
        out[start[bucket]] = edge
        start[bucket] += 1


@kernel
def sort_edges(keys, order, spare):
    """Stable radix sort. keys (E,) uint32: bits of non-negative float32 weights, which sort as the weights do.

    order (E,) uint32 holds the edge numbers 0..E-1 and comes back sorted; spare (E,) is scratch.
    """
    starts = np.zeros((3, BUCKETS), np.int64)
    count_digits(keys, starts)
    scatter(keys, order, starts[0], np.uint32(0), spare)
    scatter(keys, spare, starts[1], np.uint32(DIGIT_BITS), order)
    scatter(keys, order, starts[2], np.uint32(2 * DIGIT_BITS), spare)
    order[:] = spare
