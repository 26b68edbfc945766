"""Conversion of the ROS messages sensor_msgs/Image and CompressedImage to arrays.

Any object with the fields of the message is accepted, so ROS is not required.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import FrameError
from spigolo.frames.images import Image
from spigolo.frames.limits import MAX_PIXELS, check_count
from spigolo.frames.png import header_of
from spigolo.sources.compressed_depth import CONFIG, metres_of, unpacked_rvl

MILLIMETRES = 0.001
"""Unit of integer depth in ROS messages, in metres, as defined in REP 118."""
DEPTH_ENCODINGS = {"16UC1": np.uint16, "mono16": np.uint16, "32FC1": np.float32, "64FC1": np.float64}
"""ROS encodings of depth images, with the NumPy type of a pixel."""
COLOR_ENCODINGS = {
    "rgb8": (3, None),
    "bgr8": (3, cv2.COLOR_BGR2RGB),
    "8UC3": (3, cv2.COLOR_BGR2RGB),
    "rgba8": (4, cv2.COLOR_RGBA2RGB),
    "bgra8": (4, cv2.COLOR_BGRA2RGB),
    "8UC4": (4, cv2.COLOR_BGRA2RGB),
    "mono8": (1, cv2.COLOR_GRAY2RGB),
    "8UC1": (1, cv2.COLOR_GRAY2RGB),
    "yuv422_yuy2": (2, cv2.COLOR_YUV2RGB_YUY2),
    "yuyv": (2, cv2.COLOR_YUV2RGB_YUY2),
    "yuv422": (2, cv2.COLOR_YUV2RGB_UYVY),
    "uyvy": (2, cv2.COLOR_YUV2RGB_UYVY),
}
"""ROS encodings of colour images, with the bytes per pixel and OpenCV's conversion to RGB."""
PNG = b"\x89PNG"


def stamp_ns(message: Any) -> int:
    """Return the stamp of a message's header in nanoseconds."""
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def encoding_of(message: Any) -> str:
    """Return the pixel encoding of an image message, such as "16UC1" or "rgb8". The text is empty if the encoding is
    unknown.
    """
    if hasattr(message, "encoding"):
        return str(message.encoding)
    first = str(message.format).partition(";")[0].strip()
    return first if first in DEPTH_ENCODINGS or first in COLOR_ENCODINGS else ""


def is_depth(message: Any) -> bool:
    """Return True if an image message contains depth."""
    packed = "compresseddepth" in str(getattr(message, "format", "")).lower()
    return packed or encoding_of(message) in DEPTH_ENCODINGS


def color_of(message: Any, max_pixels: int = MAX_PIXELS) -> npt.NDArray[np.uint8]:
    """Return the RGB image (H, W, 3) of an Image or CompressedImage message. Raises FrameError."""
    if not hasattr(message, "encoding"):
        stored = _decoded(_bytes(message), cv2.IMREAD_COLOR, str(message.format), max_pixels)
        return np.asarray(cv2.cvtColor(stored, cv2.COLOR_BGR2RGB), np.uint8)
    if message.encoding not in COLOR_ENCODINGS:
        raise FrameError(
            f"expected colour as {', '.join(COLOR_ENCODINGS)}, got the encoding {message.encoding!r}: name another"
            " colour topic, or convert the images"
        )
    channels, conversion = COLOR_ENCODINGS[message.encoding]
    rows = _rows(message, np.dtype(np.uint8), channels)
    pixels = rows.reshape(message.height, message.width, channels)
    return np.asarray(pixels if conversion is None else cv2.cvtColor(pixels, conversion), np.uint8)


def depth_of(message: Any, max_pixels: int = MAX_PIXELS) -> Image:
    """Return the depth map (H, W) of a message: integers as stored, or floating-point metres. Raises FrameError."""
    if not hasattr(message, "encoding"):
        return _compressed_depth(message, max_pixels)
    if message.encoding not in DEPTH_ENCODINGS:
        raise FrameError(
            f"expected depth as {', '.join(DEPTH_ENCODINGS)}, got the encoding {message.encoding!r}: name another"
            " depth topic"
        )
    return _rows(message, np.dtype(DEPTH_ENCODINGS[message.encoding]), 1)


def _rows(message: Any, kind: np.dtype[Any], channels: int) -> Image:
    """Return the pixel values (H, W * channels) of an Image message, without row padding."""
    height, width, data = int(message.height), int(message.width), _bytes(message)
    length = width * channels * kind.itemsize
    step = int(message.step) or length
    if height < 1 or width < 1 or step < length or data.size < step * (height - 1) + length:
        raise FrameError(
            f"expected {height} rows of {max(step, length)} bytes in a {message.encoding} image of {width}x{height},"
            f" got {data.size} bytes"
        )
    whole = np.zeros(step * height, np.uint8)  # the last row may lack its padding
    whole[: min(data.size, whole.size)] = data[: whole.size]
    rows = np.ascontiguousarray(whole.reshape(height, step)[:, :length])
    stored = kind.newbyteorder(">") if message.is_bigendian else kind.newbyteorder("<")
    return rows.view(stored).astype(kind, copy=False)


def _compressed_depth(message: Any, max_pixels: int) -> Image:
    """Decode the depth map of a CompressedImage message: RVL, or PNG with or without the header of compressedDepth."""
    data, told = _bytes(message), str(message.format)
    if "rvl" in told.lower():
        stored: Image = unpacked_rvl(data, max_pixels)
        return metres_of(stored, data) if told.strip().startswith("32FC1") else stored
    start = next((k for k in (0, CONFIG.size) if data[k : k + 4].tobytes() == PNG), None)
    if start is None:
        raise FrameError(f"expected depth as PNG or RVL, got the format {told!r}: record the raw depth topic")
    stored = _decoded(data[start:], cv2.IMREAD_UNCHANGED, told, max_pixels)
    if stored.ndim != 2 or stored.dtype != np.uint16:
        raise FrameError(f"expected depth of 16 bits in one channel, got {stored.dtype} of shape {stored.shape}")
    if not told.strip().startswith("32FC1"):
        return stored
    if start == 0:
        raise FrameError("expected the header of compressedDepth with 32FC1, got a PNG without it")
    return metres_of(stored, data)


def _decoded(data: npt.NDArray[np.uint8], flags: int, told: str, max_pixels: int) -> Image:
    header = header_of(data[:26].tobytes())
    if header is not None:
        check_count(header.width, header.height, max_pixels)
    try:
        image = cv2.imdecode(data, flags) if data.size else None
    except cv2.error:
        image = None
    if image is None:
        raise FrameError(f"not a readable image of format {told!r} ({data.size} bytes)")
    return image


def _bytes(message: Any) -> npt.NDArray[np.uint8]:
    data = message.data
    return data.view(np.uint8) if isinstance(data, np.ndarray) else np.frombuffer(bytes(data), np.uint8)
