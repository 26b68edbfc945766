"""Reader of camera files in the formats of drivers, calibration tools and data sets."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError, FileError, SpigoloError
from spigolo.frames.arrays import load_arrays, names_in
from spigolo.frames.camera import Camera
from spigolo.frames.dialects import of_image
from spigolo.frames.intrinsics import MATRIX_NAMES, camera_from_mapping, square_part
from spigolo.frames.listing import COLOR_NAMES
from spigolo.frames.matlab import numeric_arrays
from spigolo.frames.scale import scale_from_mapping
from spigolo.frames.yaml_text import parse_yaml

PathLike = str | os.PathLike[str]

YAML = (".yaml", ".yml")
NAMES = (
    "camera.json", "camera.yaml", "camera.yml", "camera_info.yaml", "camera_info.yml", "camera_info.json",
    "intrinsic.json", "intrinsics.json", "camera_intrinsic.json", "camera_intrinsics.json", "intrinsics.yaml",
    "intrinsics.yml", "camera.txt", "cam_K.txt", "camK.txt", "camera-intrinsics.txt", "camera_intrinsics.txt",
    "intrinsics.txt", "intrinsic.txt", "cam_K.npy", "camK.npy", "K.txt", "K.npy", "cameras.txt", "scene_camera.json",
)  # fmt: skip
"""Names of the camera files that are searched for next to the images. The first of these files that exists is used."""
FORMS = (
    "JSON or YAML with fx, fy, cx, cy or a matrix K, a 3x3 matrix as .txt, .npy or .mat, or COLMAP's cameras.txt: write"
    ' {"K": [9 numbers, row by row]} as JSON'
)
COLMAP = {
    "SIMPLE_PINHOLE": ("f", "cx", "cy"),
    "PINHOLE": ("fx", "fy", "cx", "cy"),
    "SIMPLE_RADIAL": ("f", "cx", "cy", "k1"),
    "RADIAL": ("f", "cx", "cy", "k1", "k2"),
    "OPENCV": ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"),
    "FULL_OPENCV": ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
}
"""For each COLMAP camera model whose distortion OpenCV can remove: the names of the model's parameters."""
HALF_PIXEL = 0.5
"""Coordinate of the centre of the first pixel in COLMAP. In spigolo, the centre of the first pixel has the coordinate
0.
"""


def read_camera(
    path: PathLike, width: int | None = None, height: int | None = None, *, image: str | None = None
) -> tuple[Camera, float | None]:
    """Read a camera file. Return the camera and the depth scale in metres per unit. The depth scale is None if the file
    contains no depth scale.

    The following formats are supported:

    - JSON of spigolo (fx, fy, cx, cy, width, height, depth_scale), RealSense (ppx, ppy, coeffs), Open3D
      (intrinsic_matrix) and BOP (cam_K), and JSON with a matrix K or camera_matrix
    - YAML of camera_calibration, OpenCV and kalibr, and ROS CameraInfo as printed by `ros2 topic echo`
    - text with a 3x3 or 4x4 matrix or four numbers, and COLMAP's cameras.txt
    - .npy, .npz and .mat files with a matrix

    The function `camera_from_mapping` lists the names of the supported fields.

    A depth_scale is read as millimetres per unit in BOP files and as units per metre in Open3D files.

    - width, height: image size in pixels, for camera files without an image size.
    - image: name of the colour image, for camera files that contain the cameras of many images.

    Raises FileError for an unreadable file, and CameraError for invalid intrinsics.
    """
    values = camera_fields(path, image)
    try:
        return camera_from_mapping(values, width, height), scale_from_mapping(values)
    except CameraError as error:
        raise CameraError(f"{path}: {error}") from None


def camera_fields(path: PathLike, image: str | None = None) -> Mapping[str, Any]:
    """Return the fields of a camera file of any supported format. Raises FileError for an unreadable file, and
    CameraError for other content.
    """
    suffix = Path(path).suffix.lower()
    if suffix in (".png", ".tif", ".tiff", ".jpg", ".jpeg", ".xml", ".bag", ".pkl", ".toml"):
        raise FileError(f"expected a camera file, got {path}. Supported: {FORMS}")
    read = _text if suffix in (".txt", ".csv") else READERS.get(suffix, _json)
    values = read(path)
    if not isinstance(values, Mapping):
        raise CameraError(f"{path}: expected a mapping with the fields of a camera, got {type(values).__name__}")
    return values if image is None else of_image(values, image)


def camera_in(folder: Path) -> Path | None:
    """Return the path of the camera file in a folder, or None if the folder has no camera file."""
    return next((folder / name for name in NAMES if (folder / name).is_file()), None)


def camera_for(folder: Path, top: Path) -> Path | None:
    """Return the camera file for the images in `folder`, from this folder or the nearest folder above.

    top: folder that the user gave as input. The search for a camera file ends in the parent folder of `top`.
    """
    places = [folder, *folder.parents]
    places = places[: places.index(top) + 1] if top in places else [folder]
    found = (camera_in(place) for place in (*places, top.resolve().parent))
    return next((path for path in found if path is not None), None)


def camera_of(color: Path) -> Path | None:
    """Return the camera file for a colour image, or None if no camera file is found. The camera file is searched for
    in the folder of the image and in the folders above. A .npz file with intrinsics is its own camera file.
    """
    if color.suffix.lower() == ".npz" and {name.lower() for name in (*MATRIX_NAMES, "fx")} & set(names_in(color)):
        return color
    inner = color.parent.name in COLOR_NAMES
    return camera_for(color.parent, color.parent.parent if inner else color.parent)


def _json(path: PathLike) -> Any:
    try:
        return json.loads(Path(path).read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        raise _unreadable("JSON", path, error) from None


def _yaml(path: PathLike) -> Any:
    try:
        return parse_yaml(Path(path).read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise _unreadable("YAML", path, error) from None


def _unreadable(kind: str, path: PathLike, error: Exception) -> FileError:
    sentence = " ".join((getattr(error, "strerror", None) or str(error)).split())
    return FileError(f"expected a camera in {kind} in {path}, but the file cannot be read: {sentence}")


def _text(path: PathLike) -> Mapping[str, Any]:
    """Return the camera fields of a text file with numbers, COLMAP cameras, or lines of the form `name: value`."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise _unreadable("text", path, error) from None
    lines = [line.split("#")[0].strip() for line in text.splitlines()]
    rows = [line.replace(",", " ").replace(";", " ").strip("[] ").split() for line in lines if line]
    if rows and len(rows[0]) > 3 and rows[0][0].isdecimal() and rows[0][1].isupper():
        return _colmap(path, rows)
    try:
        numbers = np.array([float(word) for row in rows for word in row])
    except ValueError:
        return _pairs(path, lines)
    return _matrix_fields(numbers, path)


def _pairs(path: PathLike, lines: list[str]) -> Mapping[str, Any]:
    """Return the camera fields of text lines of the form `name: value` or `name = value`."""
    found: dict[str, Any] = {}
    for line in lines:
        name, separator, value = line.replace("=", ":", 1).partition(":")
        try:
            found[name.strip()] = float(value) if separator else None
        except ValueError:
            found[name.strip()] = value.strip()
    if not any(isinstance(value, float) for value in found.values()):
        raise FileError(f"expected a camera in {path}, got other text. Supported: {FORMS}")
    return found


def _matrix_fields(numbers: npt.NDArray[Any], path: PathLike) -> Mapping[str, Any]:
    if numbers.size == 4 and numbers.dtype.kind in "uif":
        return dict(zip(("fx", "fy", "cx", "cy"), numbers.reshape(-1).tolist(), strict=True))
    K = square_part(numbers.astype(np.float64)) if numbers.dtype.kind in "uif" else None
    if K is None:
        raise FileError(f"expected a camera in {path}, got an array of shape {numbers.shape}. Supported: {FORMS}")
    return {"K": K}


def _colmap(path: PathLike, rows: list[list[str]]) -> Mapping[str, Any]:
    """Return the cameras of COLMAP's cameras.txt, indexed by camera number. Each line of this file has the form ID
    MODEL WIDTH HEIGHT PARAMETERS.
    """
    cameras = {}
    for row in rows:
        if len(row) < 5:
            raise FileError(f"expected lines ID MODEL WIDTH HEIGHT PARAMETERS in {path}, got {' '.join(row)[:60]!r}")
        number, model, width, height, *parameters = row
        names = COLMAP.get(model)
        if names is None:
            raise CameraError(
                f"{path}: expected one of the camera models {', '.join(COLMAP)}, got {model}: undistort the images"
                " first (colmap image_undistorter) and give their cameras.txt"
            )
        try:
            fields: dict[str, Any] = dict(zip(names, map(float, parameters), strict=True))
            fields |= {"width": int(width), "height": int(height)}
        except ValueError:
            raise FileError(
                f"expected the parameters {' '.join(names)} of {model} in {path}, got other parameters"
            ) from None
        focal = fields.pop("f", None)
        fields |= {"cx": fields["cx"] - HALF_PIXEL, "cy": fields["cy"] - HALF_PIXEL}
        cameras[f"camera {number}"] = fields if focal is None else {"fx": focal, "fy": focal, **fields}
    return cameras


def _npy(path: PathLike) -> Mapping[str, Any]:
    return _of_arrays(load_arrays(path), path)


def _mat(path: PathLike) -> Mapping[str, Any]:
    """Return the camera fields of a MATLAB file, such as GraspNet's intrinsic_matrix and factor_depth."""
    try:
        return _of_arrays(numeric_arrays(Path(path).read_bytes()), path)
    except (OSError, ValueError) as error:
        if isinstance(error, SpigoloError):
            raise
        raise _unreadable("MATLAB's format", path, error) from None


def _of_arrays(arrays: Mapping[str, Any], path: PathLike) -> Mapping[str, Any]:
    """Convert named arrays to camera fields, such as a camera matrix and a depth scale. If no array has a known name,
    the only array with 4, 9, 12 or 16 numbers is used as camera matrix.
    """
    lower = {name.lower(): name for name in MATRIX_NAMES}
    named = {lower.get(name.lower(), name): value for name, value in arrays.items()}
    if any(name in named for name in MATRIX_NAMES) or "fx" in named:
        return {name: _alone(value) for name, value in named.items()}
    if len(arrays) == 1:
        return _matrix_fields(np.asarray(next(iter(arrays.values()))), path)
    small = [value for value in arrays.values() if np.size(value) in (4, 9, 12, 16)]
    if len(small) != 1:
        raise FileError(
            f"expected a camera matrix as K in {path}, got the arrays {', '.join(arrays) or 'none'}. Supported: {FORMS}"
        )
    return {**{name: _alone(value) for name, value in arrays.items()}, **_matrix_fields(np.asarray(small[0]), path)}


def _alone(value: Any) -> Any:
    """Return the number in an array of one number, and other values unchanged."""
    array = np.asarray(value)
    return array.reshape(-1)[0].item() if array.size == 1 and array.dtype.kind in "uifU" else value


READERS: Mapping[str, Callable[[PathLike], Any]] = {
    ".yaml": _yaml,
    ".yml": _yaml,
    ".npy": _npy,
    ".npz": _npy,
    ".mat": _mat,
}
"""Reader functions of camera files that are neither JSON nor text, indexed by file suffix."""
