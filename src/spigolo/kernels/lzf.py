"""Kernel that decompresses LZF, the compression of point clouds in the Point Cloud Library."""

from __future__ import annotations

from spigolo.kernels._jit import kernel


@kernel
def unpack_lzf(packed, out):
    """Decompress the array packed (N,) uint8 into the array out (M,) uint8. Return True if the decompressed data has
    exactly M bytes.

    A control byte b below 32 is followed by b + 1 literal bytes. Any other control byte starts a copy of earlier
    output. The upper three bits of the control byte are the length of the copy minus 2. If the upper three bits are 7,
    the next byte is added to the length. The lower five bits and the following byte form one number: the distance back
    to the first copied byte, minus 1.
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
            for k in range(length):  # one byte at a time, as source and target may overlap
                out[written + k] = out[source + k]
        written += length
    return written == out.size
