"""Conversion of the depth scale in a camera file to metres per unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from spigolo.errors import CameraError
from spigolo.frames.camera import is_number, shortened
from spigolo.frames.dialects import own_fields

LARGEST_SCALE_M = 0.02
"""Maximum depth scale in metres per unit. A larger `depth_scale` is probably in another unit and is rejected."""
UNITS_PER_METRE = ("DepthMapFactor", "RGBD.DepthMapFactor")
"""Names of depth-scale fields in units per metre, as used in ORB-SLAM."""
SIMILAR = (
    "scale", "factor_depth", "depth_factor", "depthscale", "depth_unit", "depth_units", "depth_map_factor",
    "depthmapfactor", "depth_map_scale", "png_depth_scale", "scale_factor", "depth_scaling_factor", "depth_scaling",
    "units_per_metre", "units_per_meter", "integer_depth_scale", "depth_divider", "depth_div",
)  # fmt: skip
"""Lower-case names of depth-scale fields whose unit is not defined."""


def scale_from_mapping(values: Mapping[str, Any]) -> float | None:
    """Return the depth scale of a camera file in metres per unit, or None if the file has no depth scale. Raises
    CameraError for a depth scale that is invalid or has an unknown unit.

    In files of BOP, which contain the field cam_K, depth_scale is in millimetres per unit. In files of Open3D, which
    contain the field intrinsic_matrix, depth_scale is in units per metre. The fields factor_depth of GraspNet and
    DepthMapFactor of ORB-SLAM are in units per metre.
    """
    values = {**values, **own_fields(values)}
    stored = values.get("depth_scale")
    if stored is not None:
        number = _number("depth_scale", stored)
        if "cam_K" in values:
            return number / 1000
        return 1 / number if "intrinsic_matrix" in values and number > 1 else number
    factor = values.get("factor_depth") if "intrinsic_matrix" in values else None
    factor = next((values[name] for name in UNITS_PER_METRE if values.get(name) is not None), factor)
    if factor is not None:
        number = _number("factor_depth", factor)
        return 1 / number if number > 0 else number
    _refuse_similar(values)
    return None


def check_scale(scale: float, where: object) -> None:
    """Raise CameraError if a depth scale is too large for metres per unit.

    where: origin of the depth scale, as named in the error message.
    """
    if scale > LARGEST_SCALE_M:
        raise CameraError(
            f"expected depth_scale in {where} as metres per unit, 0.001 for millimetres, got {scale}:"
            " divide the value by 1000 if it is in millimetres per unit, or take 1 / depth_scale if it is in units per"
            " metre"
        )


def _number(name: str, value: Any) -> float:
    alone = value.reshape(-1)[0] if isinstance(value, np.ndarray) and value.size == 1 else value
    if not is_number(alone):
        raise CameraError(f"expected {name} as a number, got {shortened(value)}")
    return float(alone)


def _refuse_similar(values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        alone = value.reshape(-1)[0] if isinstance(value, np.ndarray) and value.size == 1 else value
        plain = str(name).lower().replace("-", "_").replace(" ", "_")
        if plain in SIMILAR and is_number(alone) and alone > 0:
            raise CameraError(
                f"expected depth_scale in metres per unit, got {name} {alone:g}: replace the field with depth_scale"
                f" {_as_metres(float(alone)):g} if this is the unit"
            )


def _as_metres(number: float) -> float:
    """Convert a depth scale in an unknown unit to the most likely value in metres per unit."""
    if number > 1:
        return 1 / number
    return number if number <= LARGEST_SCALE_M else number / 1000
