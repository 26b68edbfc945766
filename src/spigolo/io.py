"""Files in and out: colour, depth, camera files, and writes that leave nothing half-written."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError, FileError, FrameError
from spigolo.frame import Camera, Frame

Image = npt.NDArray[Any]
PathLike = str | os.PathLike[str]


def read_frame(color: PathLike, depth: PathLike, camera: Camera | PathLike, depth_scale: float | None = None) -> Frame:
    """A frame from a colour image, a 16-bit depth PNG (or .npy) and a camera or camera file.

    depth_scale: metres per stored unit, 0.001 for millimetres; if None, that of the camera file.
    Raises FileError, CameraError or FrameError.
    """
    if not isinstance(camera, Camera):
        camera, scale = read_camera(camera)
        depth_scale = scale if depth_scale is None else depth_scale
    stored = read_depth(depth)
    if stored.dtype.kind in "ui" and stored.dtype != np.uint8 and depth_scale is None:
        raise FrameError(
            f"expected depth_scale with the integers in {depth}: metres per unit, 0.001 for millimetres"
            ' (or "depth_scale" in the camera file)'
        )
    return Frame(
        read_color(color),
        stored,
        camera,
        name=Path(color).stem,
        depth_scale=depth_scale if stored.dtype.kind in "ui" else None,
    )


def read_color(path: PathLike) -> npt.NDArray[np.uint8]:
    """RGB (H, W, 3) uint8 of any image file that OpenCV reads; grey becomes RGB, transparency is dropped."""
    return np.asarray(cv2.cvtColor(_decode(path, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB), np.uint8)


def read_depth(path: PathLike) -> Image:
    """Depth as stored: integers of a PNG or TIFF, floating-point metres of a TIFF, either of a .npy file."""
    if Path(path).suffix.lower() in (".jpg", ".jpeg"):
        raise FrameError(f"expected depth without loss, got the JPEG {path}: store depth as 16-bit PNG")
    if Path(path).suffix.lower() != ".npy":
        return _decode(path, cv2.IMREAD_UNCHANGED)
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except (OSError, ValueError, EOFError) as error:
        raise FileError(f"expected a depth array in {path}, but it cannot be read: {error}") from None


def read_camera(path: PathLike) -> tuple[Camera, float | None]:
    """Camera of a JSON file with fx, fy, cx, cy, width, height, and its depth_scale (metres per unit) or None."""
    try:
        values = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise FileError(f"expected a camera in JSON in {path}, but it cannot be read: {error}") from None
    names = ("fx", "fy", "cx", "cy", "width", "height")
    lacking = [name for name in names if not isinstance(values, dict) or not isinstance(values.get(name), int | float)]
    if lacking:
        raise CameraError(f"expected numbers {', '.join(names)} in {path}: {', '.join(lacking)} not found")
    numbers = {name: float(values[name]) for name in names[:4]}
    scale = values.get("depth_scale")
    return Camera(
        **numbers, width=int(values["width"]), height=int(values["height"])
    ), None if scale is None else float(scale)


def write_png(path: PathLike, image: Image) -> None:
    """Writes an image as PNG: (H, W, 3) uint8 RGB, or (H, W) of 8 or 16 bits."""
    bgr = cv2.cvtColor(image, cv2.COLOR_RGB2BGR) if image.ndim == 3 else image
    done, data = cv2.imencode(".png", bgr)
    if not done:
        raise FileError(f"could not encode an image of shape {image.shape} and type {image.dtype} for {path}")
    write_bytes(path, data.tobytes())


def write_json(path: PathLike, values: Any) -> None:
    """Writes JSON, indented."""
    write_bytes(path, (json.dumps(values, indent=1, allow_nan=False) + "\n").encode())


def write_bytes(path: PathLike, data: bytes) -> None:
    """Writes a file at once: beside its place first, then renamed, so that nobody ever sees half of it."""
    target = Path(path)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, beside = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}-")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.chmod(beside, 0o666 & ~_umask())
            os.replace(beside, target)
        except BaseException:
            os.unlink(beside)
            raise
    except OSError as error:
        raise FileError(f"could not write {target}: {error.strerror or error}") from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _decode(path: PathLike, flags: int) -> Image:
    try:
        data = np.fromfile(path, np.uint8)
    except OSError as error:
        raise FileError(f"expected an image in {path}, but it cannot be read: {error.strerror or error}") from None
    image = cv2.imdecode(data, flags) if data.size else None
    if image is None:
        raise FileError(f"expected an image in {path}, but its {data.size} bytes are none that OpenCV reads")
    return image
