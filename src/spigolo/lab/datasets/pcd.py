"""Reader of .pcd files of the Point Cloud Library in the formats ascii, binary and binary_compressed."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError, FileError
from spigolo.frames.camera import Camera
from spigolo.kernels.lzf import unpack_lzf

KINDS = {
    f"{kind}{size}": f"<{kind.lower()}{size}" for kind in "IUF" for size in (1, 2, 4, 8) if f"{kind}{size}" != "F1"
}
"""NumPy dtype of a field of a point cloud, indexed by the TYPE and SIZE of the field in the file header."""
STEEPEST = 1e6
"""Limit for the ratios |X| / Z and |Y| / Z of a point. If a ratio of any point is at or above the limit, no camera is
fitted.
"""
MAX_MISFIT_PX = 0.5
"""Maximum residual of the camera fit, in pixels. A larger residual of the camera fit raises CameraError."""


def read_pcd(path: Path) -> npt.NDArray[Any]:
    """Read the points (H, W) of a point cloud as a structured array.

    The number of rows H is 1 if the point cloud is not organised (has no rows and columns of pixels). Raises FileError
    if the file cannot be read.
    """
    try:
        header, body = _split(path.read_bytes())
        shape = int(header["HEIGHT"][0]), int(header["WIDTH"][0])
        return _records(header, body, shape[0] * shape[1]).reshape(shape)
    except (OSError, ValueError, KeyError, IndexError, ArithmeticError, MemoryError, struct.error) as error:
        reason = getattr(error, "strerror", None) or error
        raise FileError(f"expected a point cloud in {path}, but the file cannot be read: {reason}") from None


def colors_of(points: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Return the colours (H, W, 3) of a point cloud as RGB, from its packed field rgb or rgba."""
    name = "rgb" if "rgb" in (points.dtype.names or ()) else "rgba"
    packed = np.ascontiguousarray(points[name]).view(np.uint32)
    return np.stack([packed >> 16 & 255, packed >> 8 & 255, packed & 255], axis=-1).astype(np.uint8)


def camera_of(points: npt.NDArray[Any]) -> Camera:
    """Fit a pinhole camera to an organised point cloud (H, W). Raises CameraError if no camera fits the points well."""
    height, width = points.shape
    seen = np.isfinite(points["z"]) & (points["z"] > 0)
    y, x = np.nonzero(seen)
    with np.errstate(all="ignore"):  # a damaged cloud may contain any number
        z = points["z"][seen].astype(np.float64)
        fx, cx, x_off = _line(points["x"][seen] / z, x)
        fy, cy, y_off = _line(points["y"][seen] / z, y)
    if not max(x_off, y_off) <= MAX_MISFIT_PX:
        raise CameraError(
            f"expected an organised point cloud, with a point for each of {width}x{height} pixels of a pinhole camera,"
            f" got points up to {max(x_off, y_off):.1f} px away from their pixels"
        )
    return Camera(fx, fy, cx, cy, width, height)


def _line(slopes: npt.NDArray[np.float64], pixels: npt.NDArray[np.int64]) -> tuple[float, float, float]:
    """Fit the equation pixels = f * slopes + c by least squares. The slopes are the ratios X / Z or Y / Z of the
    points.

    Return f, c and the maximum residual of the fit in pixels. The residual is infinite if no fit is possible.
    """
    if not slopes.size or slopes.min() == slopes.max() or not np.abs(slopes).max() < STEEPEST:
        return 0.0, 0.0, np.inf
    f, c = np.polyfit(slopes, pixels, 1)
    return float(f), float(c), float(np.abs(f * slopes + c - pixels).max())


def _split(data: bytes) -> tuple[dict[str, list[str]], bytes]:
    """Split the content of a .pcd file into the header fields, indexed by name, and the bytes after the header."""
    header: dict[str, list[str]] = {}
    while "DATA" not in header:
        line, newline, data = data.partition(b"\n")
        if not newline:
            raise ValueError("the file has no line DATA")
        key, *values = line.decode("ascii", "replace").split() or ["#"]
        header[key] = values
    return header, data


def _records(header: dict[str, list[str]], body: bytes, count: int) -> npt.NDArray[Any]:
    kinds = [KINDS[kind.upper() + size] for kind, size in zip(header["TYPE"], header["SIZE"], strict=True)]
    lengths = [int(n) for n in header.get("COUNT", ["1"] * len(kinds))]
    # padding fields are called _ and may be repeated
    names = [name if name != "_" else f"_{k}" for k, name in enumerate(header["FIELDS"])]
    fields = list(zip(names, kinds, lengths, strict=True))
    record = np.dtype([(name, kind) if n == 1 else (name, kind, (n,)) for name, kind, n in fields])
    form = header["DATA"][0].lower()
    if form == "binary":
        return np.frombuffer(body, record, count)
    if form == "ascii":
        words = np.array(body.split()).reshape(count, sum(lengths))
        return _from_columns(record, [column.astype(np.float64) for column in words.T], count)
    if form == "binary_compressed":
        return _from_planes(record, _unpacked(body), count)
    raise ValueError(f"DATA is {form} instead of ascii, binary or binary_compressed")


def _from_columns(record: np.dtype[Any], columns: list[npt.NDArray[np.float64]], count: int) -> npt.NDArray[Any]:
    out = np.zeros(count, record)
    rest = iter(columns)
    with np.errstate(invalid="raise", over="raise"):  # numbers too large for their field
        for name in record.names or ():
            n = record[name].shape[0] if record[name].shape else 0
            out[name] = np.stack([next(rest) for _ in range(n)], axis=1) if n else next(rest)
    return out


def _from_planes(record: np.dtype[Any], data: npt.NDArray[np.uint8], count: int) -> npt.NDArray[Any]:
    """Return the points of a compressed point cloud, in which the values are stored field by field."""
    out, start = np.zeros(count, record), 0
    for name in record.names or ():
        out[name] = np.frombuffer(data, record[name], count, start)
        start += record[name].itemsize * count
    return out


def _unpacked(body: bytes) -> npt.NDArray[np.uint8]:
    packed_size, size = struct.unpack_from("<II", body)
    packed = np.frombuffer(body, np.uint8, packed_size, 8).copy()  # kernels do not accept read-only arrays
    out = np.zeros(size, np.uint8)
    if not unpack_lzf(packed, out):
        raise ValueError("the compressed points are damaged")
    return out
