"""LZF, in which the Point Cloud Library packs clouds."""

from __future__ import annotations

from spigolo.kernels._jit import kernel


@kernel
def unpack_lzf(packed, out):
    """Unpack into out (M,) uint8. Returns True if packed (N,) uint8 fills it exactly.

    A byte below 32 is followed by that many bytes and one more. Any other byte holds a length minus 2 in its upper
    three bits. 7 stands for 7 and the next byte. With the byte after it, it holds how far back to copy from, minus 1.
    """
    read, written = 0, 0
    while read < packed.size:
        control = int(packed[read])
        read += 1
        if control < 32:
            length = control + 1
            if read + length > packed.size or written + length > out.size:
                return False
            out[written : written + length] = packed[read : read + length]
            read += length
        else:
            length = control >> 5
            if length == 7 and read < packed.size:
                length += int(packed[read])
                read += 1
            length += 2
            if read >= packed.size:
                return False
            source = written - 1 - (((control & 31) << 8) | int(packed[read]))
            read += 1
            if source < 0 or written + length > out.size:
                return False
            for k in range(length):  # one by one, as both parts may overlap
                out[written + k] = out[source + k]
        written += length
    return written == out.size
