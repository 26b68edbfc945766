"""Kernel that decompresses RVL, the compression of depth images in ROS.

RVL stores run lengths and differences in groups of three bits (Wilson 2017, "Fast Lossless Depth Image Compression").
"""

from __future__ import annotations

from spigolo.kernels._jit import inlined, kernel

MAX_GROUPS = 11
"""Maximum number of three-bit groups in a 32-bit number."""


@inlined
def _number(words, at):
    """Decode the number that starts at nibble `at` of the 32-bit words, which have eight nibbles of four bits each.
    Return the number and the index of the next nibble.

    The returned index is -1 if the words end or the number has more than 32 bits. The upper bit of a nibble is set if
    another nibble of the number follows. The other three bits belong to the number, the lowest bits first.
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
    """Decompress words (N,) uint32 into out (M,) uint16. Return True if the data contains all M values of out.

    Runs of zeros and runs of nonzero values alternate, and the length of each run is stored before the run. Each
    nonzero value is stored as the difference to the last nonzero value, with the sign in the lowest bit.
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
