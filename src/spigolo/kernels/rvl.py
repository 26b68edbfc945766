"""RVL, in which ROS packs depth: lengths of runs and differences, in groups of three bits (Wilson 2017)."""

from __future__ import annotations

from spigolo.kernels._jit import inlined, kernel

MAX_GROUPS = 11
"""Groups of three bits in a number of 32 bits."""


@inlined
def _number(words, at):
    """Return the number whose first nibble is `at`, and the next nibble: -1 if the words end or it has too many bits.

    The upper bit of a nibble says that another one follows. The other three are part of the number, the lowest first.
    """
    value = 0
    for group in range(MAX_GROUPS):
        if at >= 8 * words.size:
            return 0, -1
        nibble = (int(words[at >> 3]) >> (28 - 4 * (at & 7))) & 15
        at += 1
        value |= (nibble & 7) << (3 * group)
        if nibble < 8:
            return value, at
    return 0, -1


@kernel
def unpack_rvl(words, out):
    """Unpack words (N,) uint32 into out (M,) uint16. Return whether they fill it: not if they end or go beyond.

    Zeros and other values alternate, each run after its length. A value is its difference to the last one that is not
    zero, with the sign in the lowest bit.
    """
    at, written, last = 0, 0, 0
    while written < out.size:
        zeros, at = _number(words, at)
        if at < 0 or zeros > out.size - written:
            return False
        out[written : written + zeros] = 0
        written += zeros
        values, at = _number(words, at)
        if at < 0 or values > out.size - written:
            return False
        for k in range(values):
            step, at = _number(words, at)
            if at < 0:
                return False
            last = (last + ((step >> 1) ^ -(step & 1))) & 0xFFFF
            out[written + k] = last
        written += values
    return True
