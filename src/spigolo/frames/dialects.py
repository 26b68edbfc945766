"""Search for the fields of the colour camera in files in which camera fields are nested, have a prefix, or occur
several times.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from spigolo.errors import CameraError

INTRINSICS = (
    "fx", "fl_x", "FX", "K", "k", "camera_matrix", "cam_K", "intrinsic_matrix", "cameraMatrix", "mtx", "P", "p",
    "projection_matrix",
)  # fmt: skip
"""Names of fields that contain intrinsics. A dict with one of these fields describes a camera."""
ATTRIBUTES = (
    "fx", "fy", "cx", "cy", "ppx", "ppy", "k", "K", "p", "P", "intrinsic_matrix", "width", "height", "d", "D", "coeffs",
    "model", "distortion_model", "roi", "binning_x", "binning_y", "k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2",
    "intrinsic",
)  # fmt: skip
"""Names of the attributes that are read from the camera objects of pyrealsense2, ROS and Open3D."""
COLOR_NAMES = ("color", "colour", "rgb", "color_intrinsics", "rgb_intrinsics", "color_camera", "rgb_camera")
PREFIXES = ("Camera.", "Camera1.", "camera.")
SHARED = ("depth_scale", "factor_depth", "width", "height")
"""Names of camera fields that may lie outside the dict that contains the intrinsics."""


def own_fields(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the fields of the colour camera, or of the only camera, in `values`. Raises CameraError if `values`
    contains several different cameras.
    """
    values = _without_prefix(values)
    if is_camera(values):
        return values
    inner = {str(key): one for key, one in _inner(values).items() if _holds_camera(one)}
    if not inner:
        return values
    name = next((name for name in COLOR_NAMES if name in inner), next(iter(inner)))
    cameras = [own_fields(one) for one in inner.values()]
    if name not in COLOR_NAMES and any(not _equal(cameras[0], one) for one in cameras[1:]):
        images = "images" if all(key.isdecimal() for key in inner) else "cameras"
        some = ", ".join(list(inner)[:4])
        raise CameraError(
            f"expected one camera, got {len(inner)} {images} ({some}): store the fields of only one camera"
        )
    return {**{key: values[key] for key in SHARED if key in values}, **own_fields(inner[name])}


def of_image(values: Mapping[str, Any], image: str) -> Mapping[str, Any]:
    """Return the camera fields of one image from a file that is indexed by image number, such as BOP's
    scene_camera.json.

    Fields that are not indexed by image number are returned unchanged.
    """
    digits = "".join(letter for letter in image if letter.isdecimal())
    numbered = {int(key): one for key, one in values.items() if str(key).isdecimal()}
    found = numbered.get(int(digits)) if digits and len(numbered) == len(values) else None
    return found if isinstance(found, Mapping) else values


def is_camera(values: Mapping[str, Any]) -> bool:
    """Return True if the fields contain intrinsics at the top level, not nested in another field."""
    if any(values.get(name) is not None for name in INTRINSICS):
        return True
    return any(isinstance(values.get(name), list | tuple | np.ndarray) for name in ("intrinsics", "intrinsic"))


def _inner(values: Mapping[str, Any]) -> dict[Any, Mapping[str, Any]]:
    objects = {key: {"K": one.intrinsic_matrix} for key, one in values.items() if hasattr(one, "intrinsic_matrix")}
    return objects | {key: one for key, one in values.items() if isinstance(one, Mapping)}


def _holds_camera(values: Mapping[str, Any], depth: int = 3) -> bool:
    values = _without_prefix(values)
    return is_camera(values) or (depth > 0 and any(_holds_camera(one, depth - 1) for one in _inner(values).values()))


def _without_prefix(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Remove the prefix of field names such as `Camera.fx`, as used in ORB-SLAM settings."""
    prefix = next((p for p in PREFIXES if f"{p}fx" in values), None)
    if prefix is None:
        return values
    return {str(key).removeprefix(prefix): one for key, one in values.items()}


def _equal(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Return True if two cameras have equal fields, except for poses and names."""
    names = {key for key in (*one, *other) if key in (*INTRINSICS, *ATTRIBUTES, *SHARED, "intrinsics")}
    return all(_same(one.get(key), other.get(key)) for key in names)


def _same(one: Any, other: Any) -> bool:
    try:
        return bool(np.array_equal(np.asarray(one), np.asarray(other)))
    except ValueError:
        return False
