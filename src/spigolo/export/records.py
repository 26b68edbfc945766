"""Segmentations in the words of other programs."""

from __future__ import annotations

from typing import Any

from spigolo.objects.facts import RegionFacts
from spigolo.objects.segmentation import Segmentation


def to_json(result: Segmentation) -> dict[str, Any]:
    """The whole answer but its pixels, ready for json.dumps: objects by label, rejected regions with their reasons.

    Metres in the camera's frame (X right, Y down, Z forward), pixels as (y, x); the rest is as in
    RegionFacts: its missing, unfilled, above and inside have longer names here.
    """
    return {
        "preset": result.preset,
        "digest": result.digest,
        "image_size_px": list(result.labels.shape),
        "left_out": list(result.left_out),
        "objects": [{"label": o.label, **_facts(o), "oriented_box": _box(o)} for o in result],
        "rejected": [{"reason": r.reason.value, "why": r.why, **_facts(r)} for r in result.rejected],
    }


def _facts(region: RegionFacts) -> dict[str, Any]:
    return {
        "score": region.score,
        "area_px": region.area_px,
        "box_px": list(region.box_px),
        "centroid_px": list(region.centroid_px),
        "centroid_m": None if region.centroid_m is None else list(region.centroid_m),
        "spread_px2": list(region.spread_px2),
        "eccentricity": region.eccentricity,
        "missing_depth": region.missing,
        "unfilled_depth": region.unfilled,
        "dark": region.dark,
        "above_support": region.above,
        "inside_roi": region.inside,
        "contour": region.contour,
        "cut": region.cut,
        "hides": region.hides,
        "lean_deg": region.lean_deg,
    }


def _box(region: RegionFacts) -> dict[str, Any] | None:
    box = region.oriented_box()
    if box is None:
        return None
    return {
        "center_m": box.center_m.tolist(),
        "size_m": box.size_m.tolist(),
        "R_camera_box": box.R_camera_box.tolist(),
    }
