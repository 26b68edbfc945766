"""Intrinsics in any common form: numbers, the name of a camera model, fields of a camera file, or a driver's object."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError
from spigolo.frames.camera import Camera, as_coefficients, as_numbers, is_number
from spigolo.frames.dialects import ATTRIBUTES, own_fields
from spigolo.frames.lens import MEND, check_model
from spigolo.frames.window import Window, window_of

MATRIX_NAMES = (
    "K",
    "k",
    "camera_matrix",
    "cam_K",
    "intrinsic_matrix",
    "cameraMatrix",
    "mtx",
    "intrinsics",
    "intrinsic",
)
PROJECTION_NAMES = ("P", "p", "projection_matrix")
FOCAL_NAMES = {
    "fx": ("fx", "fl_x", "focal_x", "FX"),
    "fy": ("fy", "fl_y", "focal_y", "FY"),
    "cx": ("cx", "ppx", "CX"),
    "cy": ("cy", "ppy", "CY"),
}
WIDTH_NAMES = ("width", "image_width", "img_width", "w")
HEIGHT_NAMES = ("height", "image_height", "img_height", "h")
DISTORTION_NAMES = (
    "distortion", "distortion_coefficients", "distortion_coeffs", "dist_coeffs", "distCoeffs", "dist", "coeffs", "D",
    "d",
)  # fmt: skip
POLYNOMIAL_NAMES = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
MODEL_NAMES = ("distortion_model", "lens_model", "model")
CAMERA_KINDS = ("camera_model", "projection_model", "type")
"""Names of fields whose value can show that a camera is a fisheye camera."""
FORMS = (
    "a Camera, a 3x3 matrix K, (fx, fy, cx, cy), a name, a mapping, or an object with fx, fy, ppx, ppy, with k or K, or"
    " with intrinsic_matrix"
)

CameraLike = Camera | str | Mapping[str, Any] | npt.NDArray[Any] | Sequence[Sequence[float]] | Sequence[float] | Any
"""Type of all forms of intrinsics that `as_camera` accepts. None means unknown intrinsics."""


def as_camera(value: CameraLike, width: int, height: int) -> Camera | None:
    """Convert intrinsics in any common form to a Camera for images of width x height pixels. If `value` is None, the
    result is None.

    value: one of the following

    - an object of the class Camera, which is returned unchanged
    - a matrix K (3, 3), the nine numbers of K row by row, a matrix P (3, 4), or the numbers (fx, fy, cx, cy). Numbers
      may also be text, such as "927.2,927.4,651.3,349.6"
    - a name of a camera model or a field of view, as in `Camera.named`
    - a dict of the fields that `camera_from_mapping` lists, or a camera object of pyrealsense2, ROS or Open3D

    Raises CameraError for invalid intrinsics and for any other value.
    """
    if value is None or isinstance(value, Camera):
        return value
    if isinstance(value, os.PathLike) or (isinstance(value, str) and os.path.isfile(value)):
        raise CameraError(f"expected a camera, got the file {os.fspath(value)}: read it with spigolo.read_camera")
    if isinstance(value, str):
        listed = numbers_of(value)
        return Camera.named(value, width, height) if listed is None else as_camera(listed, width, height)
    fields = fields_of(value)
    if fields is not None:
        return camera_from_mapping(fields, width, height)
    numbers = as_numbers(value)
    if numbers.shape == (4,):
        fx, fy, cx, cy = numbers.tolist()
        return Camera(fx, fy, cx, cy, width, height)
    K = square_part(numbers)
    if K is None:
        raise CameraError(f"expected {FORMS}, got shape {numbers.shape}")
    return Camera.from_matrix(K, width, height)


def fields_of(value: object) -> Mapping[str, Any] | None:
    """Return the camera fields of a dict or of a driver's object, or None for numbers."""
    if isinstance(value, Mapping):
        return value
    if isinstance(value, Sequence | np.ndarray) or is_number(value):
        return None
    found = {name: getattr(value, name) for name in ATTRIBUTES if hasattr(value, name)}
    found = {name: one for name, one in found.items() if not callable(one)}
    if not found and not hasattr(value, "__array__"):
        raise CameraError(f"expected {FORMS}, got {type(value).__name__}")
    return found or None


def numbers_of(text: str) -> list[float] | None:
    """Return the four or nine numbers of a text such as "927.2,927.4,651.3,349.6", or None for text without numbers."""
    try:
        numbers = [float(word) for word in re.split(r"[,;\s]+", text.strip("()[] \t\n"))]
    except ValueError:
        return None
    if len(numbers) not in (4, 9):
        raise CameraError(f"expected four numbers fx, fy, cx, cy or nine of a matrix, got {len(numbers)} in {text!r}")
    return numbers


def square_part(numbers: npt.NDArray[np.float64]) -> npt.NDArray[np.float64] | None:
    """Return the first three rows and columns of a 3x3, 3x4 or 4x4 matrix as the camera matrix K, or None for other
    shapes.

    numbers: the matrix, or its numbers row by row.
    """
    shapes = {(9,): (3, 3), (12,): (3, 4), (16,): (4, 4)}
    matrix = numbers.reshape(shapes.get(numbers.shape, numbers.shape))
    if matrix.shape == (4, 4) and matrix[3].tolist() == [0, 0, 0, 1]:
        matrix = matrix[:3]
    return matrix[:, :3] if matrix.shape in ((3, 3), (3, 4)) else None


def camera_from_mapping(values: Mapping[str, Any], width: int | None = None, height: int | None = None) -> Camera:
    """Return a camera from the fields of a camera file.

    The following fields are supported:

    - intrinsics as numbers: fx, fy, cx, cy, or fx, fy, ppx, ppy of RealSense, or the field intrinsics of kalibr
    - intrinsics as a matrix: K, k, camera_matrix or cam_K row by row, or Open3D's intrinsic_matrix column by column
    - projection matrix P of ROS, which is read only if K is empty
    - image size: width, height, or image_width, image_height, or resolution
    - crop and binning of a ROS CameraInfo: roi, binning_x, binning_y
    - distortion: distortion, distortion_coefficients, dist_coeffs, coeffs, D or d, or k1, k2, p1, p2, k3
    - lens model: distortion_model or model

    The fields of the colour camera may be nested in another field.

    width, height: image size in pixels, used if the fields contain no image size. Raises CameraError for invalid or
    missing fields.
    """
    values = own_fields(values)
    window = window_of(values)
    sizes = _size(values, None if window else width, None if window else height)
    K = _matrix(values)
    if K is None:
        found = {name: _first(values, names) for name, names in FOCAL_NAMES.items()} | sizes
        _require(found)
        camera = Camera(**found)
    else:
        _require(sizes)
        camera = Camera.from_matrix(K, sizes["width"], sizes["height"])
    camera = _distorted(camera, values)
    return camera if window is None else _through(window, camera, width, height)


def _through(window: Window, camera: Camera, width: int | None, height: int | None) -> Camera:
    """Return the camera of the cropped or decimated image. Raises CameraError if the cropped or decimated image is not
    width x height pixels large.
    """
    seen = window.of(camera)
    if None not in (width, height) and (seen.width, seen.height) != (width, height):
        raise CameraError(
            f"expected images of {seen.width}x{seen.height} for {window} of {camera.width}x{camera.height}, got"
            f" {width}x{height}: set these fields to 0 if K and the camera size belong to the given images"
        )
    return seen


def _require(found: Mapping[str, Any]) -> None:
    lacking = [name for name, value in found.items() if value is None]
    if lacking:
        raise CameraError(
            "expected fx, fy, cx, cy, width, height of a camera (or a camera matrix as one of"
            f" {', '.join(MATRIX_NAMES[:5])}): {', '.join(lacking)} not found"
        )


def _size(values: Mapping[str, Any], width: int | None, height: int | None) -> dict[str, Any]:
    """Return the image width and height in pixels from the fields of a camera. An image size of 0 in the fields is
    ignored.
    """
    resolution = values.get("resolution")
    if isinstance(resolution, Sequence) and not isinstance(resolution, str) and len(resolution) == 2:
        return {"width": resolution[0], "height": resolution[1]}
    stored = _first(values, WIDTH_NAMES), _first(values, HEIGHT_NAMES)
    if any(isinstance(one, bool) or one != 0 for one in stored):
        width, height = (own if own is not None else one for own, one in zip(stored, (width, height), strict=True))
    return {"width": width, "height": height}


def _matrix(values: Mapping[str, Any]) -> npt.NDArray[np.float64] | None:
    name = next((name for name in MATRIX_NAMES if values.get(name) is not None), None)
    K = None if name is None else _stored_matrix(name, values[name])
    if K is not None and K.any():
        return K
    other = next((name for name in PROJECTION_NAMES if values.get(name) is not None), None)
    P = None if other is None else square_part(as_numbers(_data(values[other])))
    if P is None or not P.any():
        return K
    if any(_coefficients(values)):
        raise CameraError(
            f"expected a camera matrix K, got zeros, distortion coefficients and {other}: give K of the images, or"
            " leave out the coefficients if the images are rectified"
        )
    return P


def _stored_matrix(name: str, value: Any) -> npt.NDArray[np.float64] | None:
    stored = as_numbers(_data(value))
    if stored.size == 4 and name.startswith("intrinsic"):  # kalibr
        fx, fy, cx, cy = stored.reshape(-1).tolist()
        return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    if stored.size == 0:
        return None
    by_columns = name == "intrinsic_matrix" and stored.shape == (9,)
    K = stored.reshape(3, 3).T if by_columns else square_part(stored if stored.size != 9 else stored.reshape(3, 3))
    if K is None:
        raise CameraError(f"expected nine numbers in {name}, got shape {stored.shape}")
    return K


def _coefficients(values: Mapping[str, Any]) -> tuple[float, ...]:
    named = _first(values, DISTORTION_NAMES)
    if named is not None:
        stored = _data(named)
        lens = {str(key).lower(): one for key, one in named.items()} if isinstance(named, Mapping) else {}
        return as_coefficients(stored) if not lens.keys() & set(POLYNOMIAL_NAMES) else _polynomial(lens)
    return _polynomial(values)


def _polynomial(values: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the distortion coefficients of the fields k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order."""
    found = [values.get(name) for name in POLYNOMIAL_NAMES]
    last = max((k for k, value in enumerate(found) if value is not None), default=-1)
    length = 0 if last < 0 else 4 if last < 4 else 5 if last < 5 else 8
    return as_coefficients([0.0 if value is None else value for value in found[:length]])


def _distorted(camera: Camera, values: Mapping[str, Any]) -> Camera:
    """Return a copy of the camera with the distortion coefficients that are stored in `values`. Raises CameraError if
    OpenCV does not support the lens model.
    """
    coefficients = _coefficients(values)
    for name in MODEL_NAMES:
        if values.get(name) is not None:
            check_model(values[name], name == "distortion_model", coefficients, camera)
    for name in CAMERA_KINDS:
        if values.get(name) is not None:
            check_model(values[name], False, (), camera)
    if any(values.get(name) is True for name in ("fisheye", "is_fisheye")):
        raise CameraError(f"expected a pinhole camera, got a fisheye: {MEND}")
    return replace(camera, distortion=coefficients)


def _first(values: Mapping[str, Any], names: Sequence[str], default: Any = None) -> Any:
    return next((values[name] for name in names if values.get(name) is not None), default)


def _data(value: Any) -> Any:
    return value.get("data", ()) if isinstance(value, Mapping) else value
