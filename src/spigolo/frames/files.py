"""Reading of frames and cameras from files, and writing of images and JSON. A file is written completely or not at
all.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import cv2

from spigolo.errors import CameraError, FileError, FrameError
from spigolo.frames.camera import Camera
from spigolo.frames.camera_files import camera_fields, camera_of, read_camera
from spigolo.frames.frame import MAX_PIXELS, Frame
from spigolo.frames.images import (
    Image,
    PathLike,
    read_color,
    read_depth,
    read_labels,
    read_mask,
    refuse_swapped,
)
from spigolo.frames.intrinsics import CameraLike, as_camera, camera_from_mapping, fields_of
from spigolo.frames.listing import COLOR_NAMES
from spigolo.frames.scale import check_scale, scale_from_mapping

__all__ = [
    "Image",
    "PathLike",
    "append_lines",
    "known_camera",
    "read_camera",
    "read_color",
    "read_depth",
    "read_frame",
    "read_labels",
    "read_mask",
    "write_bytes",
    "write_json",
    "write_png",
]


NEARBY = "nearby"
"""Value for the argument `camera` of `read_frame`. With the value `NEARBY`, the camera file is searched for near the
images.
"""


def read_frame(
    color: PathLike,
    depth: PathLike,
    camera: CameraLike | PathLike = NEARBY,
    depth_scale: float | None = None,
    *,
    name: str | None = None,
    max_pixels: int = MAX_PIXELS,
) -> Frame:
    """Read a frame from a colour image, a depth image and a camera file. The depth image is a lossless image, such as a
    16-bit PNG, or an array file.

    - camera: a camera file (`read_camera`), or any form that `as_camera` accepts. Give None if the intrinsics are
      unknown. A string is a file name if the file exists or the string has the suffix of a camera file. Any other
      string is a camera name, a field of view or numbers, as described for `as_camera`. By default, the camera file
      next to the colour image or in a parent folder is read, such as camera.json.
    - depth_scale: metres per stored unit, 0.001 for millimetres. If depth_scale is None, integer depth is multiplied by
      the depth_scale of the camera (file or dictionary), and floating-point depth is in metres.
    - name: name of the frame. If `name` is None, the frame gets the name of the colour file without suffix. For a file
      such as rgb.png, the frame gets the name of the folder instead.

    One .npz file may contain colour, depth and camera. Raises FileError for an unreadable file, CameraError for an
    invalid camera, and FrameError for invalid images.
    """
    if isinstance(camera, str) and camera == NEARBY:
        camera = find_camera(Path(color))
    try:
        stored = read_depth(depth, max_pixels)
    except FrameError:
        refuse_swapped(color, depth, max_pixels)
        raise
    pixels = read_color(color, max_pixels)
    whole_numbers = stored.dtype.kind in "ui" and stored.dtype.itemsize > 1
    known, fields = _camera_and_fields(camera, Path(color).stem, pixels.shape[1], pixels.shape[0])
    if depth_scale is None and whole_numbers:
        depth_scale = _own_scale(fields, camera)
        if depth_scale is None:
            raise FrameError(
                f"expected depth_scale with the integers in {depth}: metres per unit, 0.001 for millimetres"
                ' (or "depth_scale" in the camera file)'
            )
    name = _name_of(Path(color)) if name is None else name
    return Frame(pixels, stored, known, name=name, depth_scale=depth_scale, max_pixels=max_pixels)


def find_camera(color: Path) -> Path:
    """Return the camera file that belongs to a colour image. The file is searched for in the folder of the image and in
    the two folders above. Raises FileError if there is no camera file.
    """
    found = camera_of(color)
    if found is None:
        raise FileError(
            f"expected a camera, or a camera file such as camera.json near {color}, found none: give camera=..., or"
            " camera=None if the intrinsics are unknown"
        )
    return found


def _name_of(color: Path) -> str:
    return color.resolve().parent.name if color.stem in COLOR_NAMES else color.stem


def known_camera(camera: CameraLike | PathLike, width: int, height: int) -> tuple[Camera | None, float | None]:
    """Convert a camera in any form that `read_frame` accepts to a `Camera` and a depth scale. If the camera or the
    depth scale is unknown, None is returned in its place.

    Raises FileError for an unreadable file, and CameraError for an invalid camera.
    """
    known, fields = _camera_and_fields(camera, "", width, height)
    return known, _own_scale(fields, camera)


def _camera_and_fields(
    camera: CameraLike | PathLike, image: str, width: int, height: int
) -> tuple[Camera | None, Mapping[str, Any] | None]:
    if not isinstance(camera, os.PathLike) and not (isinstance(camera, str) and _names_file(camera)):
        known = as_camera(camera, width, height)
        plain = camera is None or isinstance(camera, Camera | str)
        return known, None if plain else fields_of(camera)
    fields = camera_fields(camera, image)
    try:
        return camera_from_mapping(fields, width, height), fields
    except CameraError as error:
        raise CameraError(f"{os.fspath(camera)}: {error}") from None


def _own_scale(fields: Mapping[str, Any] | None, camera: object) -> float | None:
    """Return the depth_scale in the fields of a camera file or dict, or None if the fields contain no depth_scale.
    Raises CameraError for an invalid depth scale.
    """
    is_file = isinstance(camera, str | os.PathLike)
    try:
        scale = None if fields is None else scale_from_mapping(fields)
    except CameraError as error:
        raise CameraError(f"{camera}: {error}" if is_file else str(error)) from None
    if scale is not None:
        check_scale(scale, camera if is_file else "the camera")
    return scale


def _names_file(text: str) -> bool:
    return text.lower().endswith((".json", ".yaml", ".yml", ".npy", ".npz", ".mat")) or os.path.isfile(text)


def write_png(path: PathLike, image: Image) -> None:
    """Write an image as PNG.

    image: RGB (H, W, 3) uint8, or grey (H, W) with 8 or 16 bits.
    """
    bgr = cv2.cvtColor(image, cv2.COLOR_RGB2BGR) if image.ndim == 3 else image
    done, data = cv2.imencode(".png", bgr)
    if not done:
        raise FileError(f"could not encode an image of shape {image.shape} and type {image.dtype} for {path}")
    write_bytes(path, data.tobytes())


def write_json(path: PathLike, values: Any) -> None:
    """Write a value as indented JSON."""
    write_bytes(path, (json.dumps(values, indent=1, allow_nan=False) + "\n").encode())


def append_lines(path: Path) -> BinaryIO:
    """Open a text file to append lines, and create the folder of the file. An incomplete last line, which a crash may
    have left in the file, is removed.

    Raises FileError for a file that cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = path.open("ab+")
        file.seek(0)
        file.seek(file.truncate(file.read().rfind(b"\n") + 1))
    except OSError as error:
        raise FileError(f"could not write {path}: {error.strerror or error}") from None
    return file


def write_bytes(path: PathLike, data: bytes) -> None:
    """Write a file completely or not at all, by renaming a temporary file."""
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
        blocked = next((p for p in target.parents if p.is_file()), None)
        reason = f"{blocked} is a file, not a folder" if blocked else error.strerror or error
        raise FileError(f"could not write {target}: {reason}") from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
