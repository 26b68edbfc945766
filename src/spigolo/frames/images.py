"""Reading of images: colour images, depth maps, label images and masks."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError, FrameError, warn
from spigolo.frames.arrays import load_arrays, pick
from spigolo.frames.limits import MAX_PIXELS, check_count
from spigolo.frames.listing import OPENED, RECORDINGS
from spigolo.frames.png import as_grey, header_of

Image = npt.NDArray[Any]
PathLike = str | os.PathLike[str]

ARRAYS = (".npy", ".npz")
READABLE = "PNG, TIFF, BMP, PGM, EXR, .npy or .npz; colour also JPEG or WebP"
LOSSY = (".jpg", ".jpeg")
COLOR_KEYS = ("rgb", "color", "colour", "image", "color_image", "rgb_image", "img")
DEPTH_KEYS = ("depth", "depth_image", "depth_map", "depth_m", "depth_raw", "depth_mm")


def read_color(path: PathLike, max_pixels: int = MAX_PIXELS) -> npt.NDArray[np.uint8]:
    """Read a colour image from an image file or an array file as RGB (H, W, 3) uint8.

    Grey images are converted to RGB, and transparency is ignored.

    Images of more than 8 bits are converted to 8 bits by dropping the lowest bits. Orientation metadata is ignored, so
    that colour and depth keep the same order of pixels. Raises FileError for an unreadable file, and FrameError for an
    image that is not a colour image.
    """
    if Path(path).suffix.lower() in ARRAYS:
        return _as_color(pick(load_arrays(path), COLOR_KEYS, "a colour image", path), path)
    stored = decode(path, cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH | cv2.IMREAD_IGNORE_ORIENTATION, max_pixels)
    if stored.dtype == np.uint16:
        _tell_of_one_channel(path, max_pixels)
    return _as_color(np.asarray(cv2.cvtColor(stored, cv2.COLOR_BGR2RGB)), path)


def _as_color(stored: Image, path: PathLike) -> npt.NDArray[np.uint8]:
    if stored.dtype.kind not in "ui" or stored.ndim not in (2, 3):
        raise FrameError(
            f"expected colour of 8 or 16 bits in {path}, got {stored.dtype} of shape {stored.shape}: store it as"
            " 8-bit RGB"
        )
    rgb = np.repeat(stored[..., None], 3, axis=2) if stored.ndim == 2 else stored[..., :3]
    if stored.dtype == np.uint8:
        return np.asarray(rgb, np.uint8)
    bits = max(int(rgb.max(initial=0)).bit_length(), 8)
    return (rgb >> (bits - 8)).astype(np.uint8)


def _tell_of_one_channel(path: PathLike, max_pixels: int) -> None:
    stored = decode(path, cv2.IMREAD_UNCHANGED, max_pixels)
    if stored.ndim == 2:
        bits = max(int(stored.max(initial=0)).bit_length(), 8)
        warn(
            f"{path}: the colour image has one channel of 16 bits and is read as a grey image of {bits} bits. If"
            " the file is the depth image, give colour first and depth second"
        )


def read_depth(path: PathLike, max_pixels: int = MAX_PIXELS) -> Image:
    """Read a depth map (H, W) as stored: integers, or floating-point metres.

    Raises FileError for an unreadable file, and FrameError for an image that is not a depth map.
    """
    suffix = Path(path).suffix.lower()
    if suffix in LOSSY:
        raise FrameError(f"expected a lossless depth image, got the JPEG {path}: store depth as 16-bit PNG")
    if suffix in ARRAYS:
        return pick(load_arrays(path, "a depth array"), DEPTH_KEYS, "a depth array", path)
    stored = decode(path, cv2.IMREAD_UNCHANGED, max_pixels)
    if stored.ndim == 2:
        return stored
    if stored.dtype.kind == "f" and all(np.array_equal(stored[..., 0], one) for one in np.moveaxis(stored, 2, 0)[1:3]):
        return np.ascontiguousarray(stored[..., 0])
    raise FrameError(
        f"expected distances in one channel in {path}, got {stored.shape[2]} channels: give distances, not a colour"
        " image of the depth"
    )


def refuse_swapped(color: PathLike, depth: PathLike, max_pixels: int = MAX_PIXELS) -> None:
    """Raise FrameError if the colour file contains depth, because colour file and depth file are then probably
    swapped.
    """
    is_array = Path(color).suffix.lower() in ARRAYS
    stored = read_depth(color) if is_array else decode(color, cv2.IMREAD_UNCHANGED, max_pixels)
    if stored.ndim == 2 and stored.dtype != np.uint8:
        raise FrameError(
            f"expected colour first and depth second, got them swapped: {color} holds one channel of {stored.dtype},"
            f" {depth} holds a colour image"
        )


def read_labels(path: PathLike) -> Image:
    """Read a label image (H, W) of integers. In a PNG with indexed colours, the label of a pixel is its colour index.
    Raises FileError for an unreadable file, and FrameError for an image that is not a label image.
    """
    data, factor = as_grey(read_bytes(path).tobytes())
    stored = decode_bytes(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED, path)
    if stored.ndim != 2 or stored.dtype.kind not in "ui":
        raise FrameError(
            f"expected labels in one channel of whole numbers in {path}, got {stored.dtype} of shape {stored.shape}:"
            " store label numbers, 0 for background, as a grey PNG"
        )
    return stored // np.array(factor, stored.dtype) if factor > 1 else stored


def read_mask(path: PathLike, max_pixels: int = MAX_PIXELS) -> npt.NDArray[np.bool_]:
    """Read a mask (H, W) from an image of any bit depth. The mask is True where the image is not black. Raises
    FileError for an unreadable file.
    """
    stored = decode(path, cv2.IMREAD_UNCHANGED, max_pixels)
    return np.asarray(stored != 0) if stored.ndim == 2 else np.asarray(stored[..., :3].any(axis=2))


def decode(path: PathLike, flags: int, max_pixels: int = MAX_PIXELS) -> Image:
    """Read the pixels of an image file. Raises FileError if the file cannot be decoded. Raises FrameError if the image
    has more than max_pixels pixels.
    """
    return decode_bytes(read_bytes(path), flags, path, max_pixels)


def decode_bytes(data: npt.NDArray[np.uint8], flags: int, path: PathLike, max_pixels: int = MAX_PIXELS) -> Image:
    """Decode the bytes of an image file and return the pixels.

    A PNG image of more than max_pixels pixels is rejected before decoding, to limit memory.

    path: name of the file in error messages. Raises FileError if the data cannot be decoded, and FrameError for a PNG
    image with too many pixels.
    """
    header = header_of(data[:32].tobytes())
    if header is not None:
        check_count(header.width, header.height, max_pixels)
    try:
        image = cv2.imdecode(data, flags) if data.size else None
    except (cv2.error, MemoryError, OverflowError, ValueError) as error:
        told = " ".join(str(getattr(error, "err", "") or error).split())
        raise FileError(f"expected an image in {path}, but the file cannot be read: {told}") from None
    if image is None:
        raise FileError(f"expected an image in {path}, got {data.size} bytes that OpenCV cannot read{_advice(path)}")
    return image


def read_bytes(path: PathLike) -> npt.NDArray[np.uint8]:
    """Return the bytes of an image file as an array. Raises FileError for a file that cannot be read."""
    try:
        return np.fromfile(path, np.uint8)
    except OSError as error:
        raise FileError(
            f"expected an image in {path}, but the file cannot be read: {error.strerror or error}"
        ) from None


def _advice(path: PathLike) -> str:
    suffix = Path(path).suffix.lower()
    if suffix in RECORDINGS:
        return f". The file is a recording: {how_to_extract(suffix)}"
    if suffix == ".exr":
        return (
            ". EXR needs an OpenCV build with EXR (opencv-python-headless before 5) and OPENCV_IO_ENABLE_OPENEXR=1."
            " Or save the array as .npy"
        )
    kinds = f". Supported: {READABLE}"
    if suffix in (".raw", ".bin", ".z16", ".dat"):
        kinds += ". Convert raw numbers first: numpy.save(NAME.npy, numpy.fromfile(FILE, numpy.uint16).reshape(H, W))"
    return kinds


def how_to_extract(suffix: str) -> str:
    """Return instructions for the user to extract frames from a recording.

    suffix: file suffix of the recording.
    """
    if suffix in OPENED:
        return "read the frames with sp.open_source or `spigolo segment RECORDING`"
    tool = "Open3D or k4arecorder" if suffix == ".mkv" else "the recorder or driver of the camera"
    return f"extract the colour and depth images first (with {tool})"
