"""The intrinsics of a frame in whatever form a user has them: as numbers, by name, as the fields of a camera file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError
from spigolo.frames.camera import Camera, as_coefficients, as_numbers, is_number, shortened

MATRIX_NAMES = ("K", "k", "camera_matrix", "cam_K", "intrinsic_matrix")
DISTORTION_NAMES = ("distortion", "distortion_coefficients", "dist_coeffs", "coeffs", "D", "d")
OPENCV_MODELS = ("", "none", "brown_conrady", "plumb_bob", "rational_polynomial", "opencv")
REALSENSE_MODELS = ("none", "modified_brown_conrady", "inverse_brown_conrady", "ftheta", "brown_conrady")
"""librealsense's numbers of its models."""
LARGEST_SCALE_M = 0.02
"""Metres per unit beyond which 16 bits would reach farther than a kilometre: the scale has another unit."""

CameraLike = Camera | str | Mapping[str, Any] | npt.NDArray[Any] | Sequence[Sequence[float]] | Sequence[float] | None
"""What `as_camera` takes."""


def as_camera(value: CameraLike, width: int, height: int) -> Camera | None:
    """The camera of images of width x height, from any form; None stays None.

    value: a Camera (kept as it is); K as (3, 3) or as nine numbers row by row; (fx, fy, cx, cy); a name or a field of
    view that `Camera.named` knows; a mapping as in `camera_from_mapping`. Raises CameraError.
    """
    if value is None or isinstance(value, Camera):
        return value
    if isinstance(value, os.PathLike) or (isinstance(value, str) and os.path.isfile(value)):
        raise CameraError(f"expected a camera, got the file {os.fspath(value)}: read it with spigolo.read_camera")
    if isinstance(value, str):
        return Camera.named(value, width, height)
    if isinstance(value, Mapping):
        return camera_from_mapping(value, width, height)
    numbers = as_numbers(value)
    if numbers.shape == (4,):
        fx, fy, cx, cy = numbers.tolist()
        return Camera(fx, fy, cx, cy, width, height)
    if numbers.shape in ((3, 3), (9,)):
        return Camera.from_matrix(numbers, width, height)
    raise CameraError(
        f"expected a camera as Camera, 3x3 matrix, (fx, fy, cx, cy), name or mapping, got shape {numbers.shape}"
    )


def camera_from_mapping(values: Mapping[str, Any], width: int | None = None, height: int | None = None) -> Camera:
    """A camera of the fields of a camera file, with width and height where it has none of its own.

    Intrinsics: fx, fy, cx, cy (or ppx, ppy); or K, k, camera_matrix or cam_K, nine numbers row by row; or Open3D's
    intrinsic_matrix, column by column; matrices may be 3x3 and may lie in a field "data". Size: width, height or
    image_width, image_height. Distortion: distortion, distortion_coefficients, dist_coeffs, coeffs, D or d, of the
    model in distortion_model or model. Raises CameraError.
    """
    found = {
        "width": _first(values, ("width", "image_width"), width),
        "height": _first(values, ("height", "image_height"), height),
    }
    K = _matrix(values)
    if K is None:
        names = {"fx": ("fx",), "fy": ("fy",), "cx": ("cx", "ppx"), "cy": ("cy", "ppy")}
        found = {name: _first(values, others) for name, others in names.items()} | found
    lacking = [name for name, value in found.items() if value is None]
    if lacking:
        raise CameraError(
            f"expected {', '.join(found)} of a camera (or its matrix as one of {', '.join(MATRIX_NAMES)}):"
            f" {', '.join(lacking)} not found"
        )
    distortion = _distortion(values)
    if K is None:
        return Camera(**found, distortion=distortion)
    return Camera.from_matrix(K, found["width"], found["height"], distortion)


def scale_from_mapping(values: Mapping[str, Any]) -> float | None:
    """depth_scale of the fields of a camera file, metres per unit; None where it has none. Raises CameraError.

    BOP's is millimetres per unit: beside cam_K it is divided by 1000.
    """
    stored = values.get("depth_scale")
    if stored is None:
        return None
    if not is_number(stored):
        raise CameraError(f"expected depth_scale as a number, got {shortened(stored)}")
    return stored / 1000 if "cam_K" in values else float(stored)


def check_scale(scale: float, where: object) -> None:
    """Raises CameraError for a depth_scale, found there, that can hardly be metres per unit."""
    if scale > LARGEST_SCALE_M:
        raise CameraError(
            f"expected depth_scale in {where} as metres per unit, 0.001 for millimetres, got {scale}:"
            " divide it by 1000 if it is millimetres per unit, take 1 / depth_scale if it is units per metre"
        )


def _matrix(values: Mapping[str, Any]) -> npt.NDArray[np.float64] | None:
    name = next((name for name in MATRIX_NAMES if values.get(name) is not None), None)
    if name is None:
        return None
    stored = as_numbers(_data(values[name]))
    if stored.size != 9:
        raise CameraError(f"expected nine numbers in {name}, got shape {stored.shape}")
    by_columns = name == "intrinsic_matrix" and stored.ndim == 1
    return stored.reshape(3, 3).T if by_columns else stored.reshape(3, 3)


def _distortion(values: Mapping[str, Any]) -> tuple[float, ...]:
    coefficients = as_coefficients(_data(_first(values, DISTORTION_NAMES, ())))
    model = _first(values, ("distortion_model", "model"), "")
    if isinstance(model, int) and 0 <= model < len(REALSENSE_MODELS):
        model = REALSENSE_MODELS[model]
    known = str(model).lower().removeprefix("distortion.").replace(" ", "_").replace("-", "_") in OPENCV_MODELS
    if coefficients and not known:
        raise CameraError(
            f"expected the distortion model plumb_bob or rational_polynomial, got {model}: undistort the images first"
            " and give their camera without distortion"
        )
    return coefficients


def _first(values: Mapping[str, Any], names: Sequence[str], default: Any = None) -> Any:
    return next((values[name] for name in names if values.get(name) is not None), default)


def _data(value: Any) -> Any:
    return value.get("data", ()) if isinstance(value, Mapping) else value
