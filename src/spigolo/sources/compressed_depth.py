"""Decoder of depth images of ROS's compressed_depth_image_transport, in PNG or RVL format."""

from __future__ import annotations

import struct

import numpy as np
import numpy.typing as npt

from spigolo.errors import FrameError
from spigolo.frames.images import Image
from spigolo.frames.limits import check_count
from spigolo.kernels.rvl import unpack_rvl

CONFIG = struct.Struct("<i2f")
"""Layout of the header of a message: format, and two parameters of the depth quantisation."""
SIZE = struct.Struct("<2i")
"""Layout of the image width and height, which are stored between the header and the RVL data."""

Bytes = npt.NDArray[np.uint8]


def unpacked_rvl(data: Bytes, max_pixels: int) -> npt.NDArray[np.uint16]:
    """Decode a depth image in RVL format, including its headers, to integers (H, W). Raises FrameError."""
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
    """Convert quantised inverse depth (H, W) to metres with the parameters in the message header. The value 0 means
    missing depth.
    """
    _, a, b = CONFIG.unpack(header[: CONFIG.size].tobytes())
    with np.errstate(divide="ignore", invalid="ignore"):
        metres = np.float32(a) / (stored.astype(np.float32) - np.float32(b))
    return np.asarray(np.where(stored > 0, metres, 0), np.float32)
