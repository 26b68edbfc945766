"""Conversion of indexed PNG files to grey, so that decoders return the indices instead of colours."""

from __future__ import annotations

import struct
import zlib
from typing import NamedTuple

SIGNATURE = b"\x89PNG\r\n\x1a\n"
GREY, INDEXED = 0, 3
DROPPED = (b"PLTE", b"tRNS", b"sBIT", b"bKGD", b"hIST", b"iCCP", b"sRGB", b"gAMA", b"cHRM")


class Header(NamedTuple):
    """Header of a PNG file.

    - width, height: image size in pixels.
    - bits: bits per channel.
    - kind: colour type (0 grey, 2 RGB, 3 indexed, 4 grey with alpha, 6 RGB with alpha).
    """

    width: int
    height: int
    bits: int
    kind: int


def header_of(data: bytes) -> Header | None:
    """Return the header of a PNG file, or None for other files."""
    if not data.startswith(SIGNATURE) or len(data) < 26:
        return None
    return Header(*struct.unpack(">IIBB", data[16:26]))


def as_grey(data: bytes) -> tuple[bytes, int]:
    """Return a PNG file with indexed colours as a grey PNG file with the indices as values.

    Files of other kinds are returned unchanged. The second returned value is the factor by which decoders multiply grey
    values that are stored with 1, 2 or 4 bits.
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
