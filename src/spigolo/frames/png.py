"""PNG files that decoders change: indexed colours become RGB, and grey values of 1, 2 or 4 bits are scaled to 8."""

from __future__ import annotations

import struct
import zlib
from typing import NamedTuple

SIGNATURE = b"\x89PNG\r\n\x1a\n"
GREY, INDEXED = 0, 3
DROPPED = (b"PLTE", b"tRNS", b"sBIT", b"bKGD", b"hIST", b"iCCP", b"sRGB", b"gAMA", b"cHRM")


class Header(NamedTuple):
    """Size in pixels, bits per channel, and colour type (0 grey, 2 RGB, 3 indexed, 4 and 6 with alpha)."""

    width: int
    height: int
    bits: int
    kind: int


def header_of(data: bytes) -> Header | None:
    """Return the header of a PNG file. None for other files."""
    if not data.startswith(SIGNATURE) or len(data) < 26:
        return None
    return Header(*struct.unpack(">IIBB", data[16:26]))


def as_grey(data: bytes) -> tuple[bytes, int]:
    """Return an indexed PNG file as a grey one with the indices as values, and the factor that decoders apply to them.

    Other files are returned unchanged. Decoders scale values of 1, 2 and 4 bits to 8 bits.
    """
    header = header_of(data)
    if header is None or header.kind not in (GREY, INDEXED):
        return data, 1
    factor = 255 // (2**header.bits - 1) if header.bits in (1, 2, 4) else 1
    return (data if header.kind == GREY else _without_palette(data)), factor


def _without_palette(data: bytes) -> bytes:
    kept, place = [SIGNATURE], len(SIGNATURE)
    while place + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, place)
        chunk = data[place : place + 12 + length]
        place += 12 + length
        if chunk[4:8] == b"IHDR":
            body = chunk[4:17] + bytes([GREY]) + chunk[18:21]
            chunk = chunk[:4] + body + struct.pack(">I", zlib.crc32(body))
        if chunk[4:8] not in DROPPED:
            kept.append(chunk)
    return b"".join(kept)
