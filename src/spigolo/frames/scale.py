"""Depth scale of a camera file in metres per stored unit, whichever unit the file uses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from spigolo.errors import CameraError
from spigolo.frames.camera import is_number, shortened
from spigolo.frames.dialects import own_fields

LARGEST_SCALE_M = 0.02
"""Maximum depth scale in metres per unit. Above it, 16 bits would reach farther than a kilometre."""
UNITS_PER_METRE = ("DepthMapFactor", "RGBD.DepthMapFactor")
"""Names of fields in units per metre (ORB-SLAM)."""
SIMILAR = (
    "scale", "factor_depth", "depth_factor", "depthscale", "depth_unit", "depth_units", "depth_map_factor",
    "depthmapfactor", "depth_map_scale", "png_depth_scale", "scale_factor", "depth_scaling_factor", "depth_scaling",
    "units_per_metre", "units_per_meter", "integer_depth_scale", "depth_divider", "depth_div",
)  # fmt: skip
"""Names of depth scales with an unknown unit, in lower case."""


def scale_from_mapping(values: Mapping[str, Any]) -> float | None:
    """Return the depth_scale of a camera file's fields in metres per unit, or None. Raises CameraError.

    BOP gives millimetres per unit next to cam_K. Open3D gives units per metre next to intrinsic_matrix. GraspNet
    (factor_depth) and ORB-SLAM (DepthMapFactor) give units per metre too.
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
    """Raise CameraError if depth_scale is unlikely to be in metres per unit. where: its origin in the message."""
    if scale > LARGEST_SCALE_M:
        raise CameraError(
            f"expected depth_scale in {where} as metres per unit, 0.001 for millimetres, got {scale}:"
            " divide it by 1000 if it is millimetres per unit, take 1 / depth_scale if it is units per metre"
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
                f"expected depth_scale in metres per unit, got {name} {alone:g}: did you mean depth_scale"
                f" {_as_metres(float(alone)):g}? Write that field"
            )


def _as_metres(number: float) -> float:
    """Return the most likely metres per unit for a number in an unknown unit."""
    if number > 1:
        return 1 / number
    return number if number <= LARGEST_SCALE_M else number / 1000
