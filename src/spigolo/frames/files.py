"""Files in and out: colour, depth, camera files, and writes that leave nothing half-written."""

from __future__ import annotations

import importlib
import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError, FileError, FrameError
from spigolo.frames.camera import Camera
from spigolo.frames.frame import MAX_PIXELS, Frame, Mask
from spigolo.frames.intrinsics import CameraLike, as_camera, camera_from_mapping, check_scale, scale_from_mapping

Image = npt.NDArray[Any]
PathLike = str | os.PathLike[str]

YAML = (".yaml", ".yml")


def read_frame(
    color: PathLike,
    depth: PathLike,
    camera: CameraLike | PathLike,
    depth_scale: float | None = None,
    *,
    max_pixels: int = MAX_PIXELS,
) -> Frame:
    """A frame from a colour image, a 16-bit depth PNG (or .npy) and a camera.

    camera: a camera file (`read_camera`), or any form that `as_camera` takes, None where the intrinsics are not known;
    a string is a file if there is one of that name or it ends in .json, .yaml or .yml, and else a camera's name.
    depth_scale: metres per stored unit, 0.001 for millimetres; if None, that of the camera file or mapping for
    integers, and 1 for floating-point depth.
    Raises FileError, CameraError or FrameError.
    """
    pixels, stored = read_color(color), read_depth(depth)
    whole_numbers = stored.dtype.kind in "ui"
    known, scale = _camera_and_scale(camera, pixels.shape[1], pixels.shape[0])
    if depth_scale is None and whole_numbers and scale is not None:
        check_scale(scale, "the camera" if isinstance(camera, Mapping) else camera)
        depth_scale = scale
    if whole_numbers and stored.dtype != np.uint8 and depth_scale is None:
        raise FrameError(
            f"expected depth_scale with the integers in {depth}: metres per unit, 0.001 for millimetres"
            ' (or "depth_scale" in the camera file)'
        )
    return Frame(pixels, stored, known, name=Path(color).stem, depth_scale=depth_scale, max_pixels=max_pixels)


def _camera_and_scale(camera: CameraLike | PathLike, width: int, height: int) -> tuple[Camera | None, float | None]:
    if isinstance(camera, os.PathLike) or (isinstance(camera, str) and _names_file(camera)):
        return read_camera(camera, width, height)
    return as_camera(camera, width, height), scale_from_mapping(camera) if isinstance(camera, Mapping) else None


def _names_file(text: str) -> bool:
    return text.lower().endswith((".json", *YAML)) or os.path.isfile(text)


def read_color(path: PathLike) -> npt.NDArray[np.uint8]:
    """RGB (H, W, 3) uint8 of any image file that OpenCV reads; grey becomes RGB, transparency is dropped.

    As stored, like the depth beside it: an orientation in the file's metadata turns nothing.
    """
    stored = _decode(path, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    return np.asarray(cv2.cvtColor(stored, cv2.COLOR_BGR2RGB), np.uint8)


def read_depth(path: PathLike) -> Image:
    """Depth (H, W) as stored: integers of a PNG or TIFF, floating-point metres of a TIFF, either of a .npy file."""
    if Path(path).suffix.lower() in (".jpg", ".jpeg"):
        raise FrameError(f"expected depth without loss, got the JPEG {path}: store depth as 16-bit PNG")
    if Path(path).suffix.lower() != ".npy":
        stored = _decode(path, cv2.IMREAD_UNCHANGED)
        if stored.ndim != 2:
            raise FrameError(
                f"expected distances in one channel in {path}, got {stored.shape[2]} channels: it is a picture of depth"
                " in colours, and no depth"
            )
        return stored
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except Exception as error:  # NumPy reads the header as Python, and raises what that raises
        sentence = " ".join(str(error).split())
        raise FileError(f"expected a depth array in {path}, but it cannot be read: {sentence}") from None


def read_labels(path: PathLike) -> Image:
    """A label image (H, W) of whole numbers, as stored."""
    stored = _decode(path, cv2.IMREAD_UNCHANGED)
    if stored.ndim != 2 or stored.dtype.kind not in "ui":
        raise FrameError(
            f"expected labels in one channel of whole numbers in {path}, got {stored.dtype} of shape {stored.shape}:"
            " store label numbers, 0 for background, as a grey PNG"
        )
    return stored


def read_mask(path: PathLike) -> Mask:
    """Where an image (H, W) of any depth is not black; transparency does not count."""
    stored = _decode(path, cv2.IMREAD_UNCHANGED)
    return np.asarray(stored != 0) if stored.ndim == 2 else np.asarray(stored[..., :3].any(axis=2))


def read_camera(path: PathLike, width: int | None = None, height: int | None = None) -> tuple[Camera, float | None]:
    """Camera of a file, and its depth_scale (metres per unit) or None.

    JSON: ours (fx, fy, cx, cy, width, height, depth_scale), RealSense's (ppx, ppy, coeffs), Open3D's
    (intrinsic_matrix), a matrix K or camera_matrix, one image's cam_K of BOP. YAML: ROS's CameraInfo as
    `ros2 topic echo` prints it, and the file that camera_calibration writes; for rectified images leave out D and
    give K of P. `camera_from_mapping` lists the fields.
    BOP's depth_scale is millimetres per unit: beside cam_K it is divided by 1000.
    width, height: size of the images, for files that do not say it. Raises FileError or CameraError.
    """
    values = _read_mapping(path)
    try:
        if not isinstance(values, Mapping):
            raise CameraError(
                f"expected fields with the intrinsics of a camera, got {type(values).__name__}: not found"
            )
        _refuse_many_images(values)
        return camera_from_mapping(values, width, height), scale_from_mapping(values)
    except CameraError as error:
        raise CameraError(f"{path}: {error}") from None


def _read_mapping(path: PathLike) -> Any:
    """What a JSON or YAML file holds; of several YAML documents the first."""
    yaml = import_yaml(path) if Path(path).suffix.lower() in YAML else None
    refused = ValueError if yaml is None else yaml.YAMLError
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
        return json.loads(text) if yaml is None else next(yaml.safe_load_all(text), None)
    except (OSError, ValueError, RecursionError, refused) as error:
        kind, sentence = (
            "JSON" if yaml is None else "YAML",
            " ".join((getattr(error, "strerror", None) or str(error)).split()),
        )
        raise FileError(f"expected a camera in {kind} in {path}, but it cannot be read: {sentence}") from None


def import_yaml(path: PathLike, extra: str = "yaml") -> Any:
    """The module that reads a YAML file; raises FileError where the extra that brings it is not installed."""
    try:
        return importlib.import_module("yaml")
    except ImportError:
        raise FileError(f'expected PyYAML to read {path}, but it is missing: pip install "spigolo[{extra}]"') from None


def _refuse_many_images(values: Mapping[str, Any]) -> None:
    inner = next(iter(values.values()), None)
    if isinstance(inner, Mapping) and "cam_K" in inner:
        raise CameraError(f"expected one camera, got those of {len(values)} images: store one image's cam_K alone")


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


def append_lines(path: Path) -> BinaryIO:
    """A file of lines, open to append, its folder made; a last line without its end is what a crash left, and is cut.

    Raises FileError.
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
        blocked = next((p for p in target.parents if p.is_file()), None)
        reason = f"{blocked} is a file, not a folder" if blocked else error.strerror or error
        raise FileError(f"could not write {target}: {reason}") from None


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
