"""Decoder of compressed_depth_image_transport: PNG or RVL, of millimetres or of quantised inverse metres."""

from __future__ import annotations

import struct

import numpy as np
import numpy.typing as npt

from spigolo.errors import FrameError
from spigolo.frames.images import Image
from spigolo.frames.limits import check_count
from spigolo.kernels.rvl import unpack_rvl

CONFIG = struct.Struct("<i2f")
"""Layout of the header: format, and the two parameters of the quantisation."""
SIZE = struct.Struct("<2i")
"""Layout of width and height, between the header and the RVL data."""

Bytes = npt.NDArray[np.uint8]


def unpacked_rvl(data: Bytes, max_pixels: int) -> npt.NDArray[np.uint16]:
    """Return the integers (H, W) of an RVL message including its headers. Raises FrameError."""
    start = CONFIG.size + SIZE.size
    if data.size < start:
        raise FrameError(f"expected at least {start} bytes of RVL depth, got {data.size}")
    width, height = SIZE.unpack(data[CONFIG.size : start].tobytes())
    if width < 1 or height < 1:
        raise FrameError(f"expected the size of RVL depth in its header, got {width}x{height}")
    check_count(width, height, max_pixels)
    whole = (data.size - start) // 4 * 4
    words = np.frombuffer(data[start : start + whole].tobytes(), "<u4").astype(np.uint32)
    out = np.zeros(height * width, np.uint16)
    if not unpack_rvl(words, out):
        raise FrameError(f"the RVL depth of {width}x{height} is damaged or cut off ({data.size} bytes)")
    return out.reshape(height, width)


def metres_of(stored: Image, header: Bytes) -> npt.NDArray[np.float32]:
    """Return metres from quantised inverse depth (H, W) and its header. 0 is missing."""
    _, a, b = CONFIG.unpack(header[: CONFIG.size].tobytes())
    with np.errstate(divide="ignore", invalid="ignore"):
        metres = np.float32(a) / (stored.astype(np.float32) - np.float32(b))
    return np.asarray(np.where(stored > 0, metres, 0), np.float32)
