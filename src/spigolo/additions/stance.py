"""Measurements that separate objects from walls: depth steps along the outline, slant of the surface, and the part of
the outline on the image border.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane
from spigolo.frames.camera import Camera, kernel_numbers
from spigolo.frames.frame import DepthMap, Mask
from spigolo.kernels import outlines, planes
from spigolo.settings.rules import Ledge, Wall
from spigolo.stages.regions import Regions

TALL_SHARE = 0.05
"""Minimum share of a region's measured pixels that are higher than `Wall.min_height_m` above the support plane. Lower
regions are not tested for being a wall.
"""
SLOPES_SHARE = 0.1
"""Minimum share of a region's measured pixels for which a surface normal can be computed. If fewer pixels have a
normal, the mean normal of the region is not computed.
"""
REACH_INSIDE = 2.5
"""Distance from the outline at which a region's slope is measured, as a multiple of `Wall.reach_px`."""
FLAT = Plane(np.zeros(3), 0.0)
"""Placeholder for a missing support plane. Heights above the placeholder plane are always 0."""


@dataclass(frozen=True, slots=True, eq=False)
class Stance:
    """Measurements of each region for the rule `Wall`, which rejects walls, and the rule `Ledge`, which keeps low
    objects. Values that could not be measured are NaN.
    """

    cut: npt.NDArray[np.float64]
    """Share (R,) of each region's outline that lies on the image border."""
    hides: npt.NDArray[np.float64]
    """Share (R,) of each region's outline along which the depth outside is larger than the depth inside by a step.
    Parts of the outline next to a nearer object are not counted.
    """
    ledge: npt.NDArray[np.float64]
    """Share (R,) of each region's outline along which the height above the support plane changes by a step."""
    lean_deg: npt.NDArray[np.float64]
    """Angle (R,) between each region's mean surface normal and the line of sight, in degrees."""


def measure_stance(
    regions: Regions, depth: DepthMap, camera: Camera, plane: Plane | None, tall: Mask, rule: Wall, ledge: Ledge | None
) -> Stance:
    """Measure the depth steps along the outline, and the slant, of every region.

    tall: mask (H, W) of the pixels that are high enough to belong to a wall. Regions with few high pixels get NaN for
    `cut`, `hides` and `lean_deg`. Without a support plane, the measurement `ledge` is NaN.
    """
    valid, high = regions.count_where(np.asarray(depth > 0)), regions.count_where(tall)
    asked = (high >= TALL_SHARE * valid) & (high > 0)
    slopes = FLAT.slopes(depth.shape, camera) if plane is None else plane.slopes(depth.shape, camera)
    offset, low = np.float32(0 if plane is None else plane.offset_m), Ledge() if ledge is None else ledge
    near, numbers = rule.reach_px, (rule.step_m, rule.step_share, low.step_m, low.step_per_m)
    sums = np.zeros((regions.count, outlines.SUMS))
    outlines.sum_outlines(
        regions.labels, depth, *slopes, offset, near, round(REACH_INSIDE * near), rule.shadow_px, *numbers, sums
    )
    pairs, known, farther, nearer, stepped, edge = sums.T
    enough = (known >= rule.min_measured * pairs) & (known > 0)
    hides = np.where(asked & enough, farther / np.maximum(known - nearer + edge, 1), np.nan)
    cut = np.where(asked, edge / np.maximum(pairs + edge, 1), np.nan)
    ledges = np.where(enough & (plane is not None), stepped / np.maximum(known, 1), np.nan)
    return Stance(cut, hides, ledges, _lean_deg(regions, depth, camera, asked, near, valid))


def _lean_deg(
    regions: Regions, depth: DepthMap, camera: Camera, asked: Mask, reach_px: int, valid: npt.NDArray[np.int64]
) -> npt.NDArray[np.float64]:
    sums = np.zeros((regions.count, 7))
    planes.sum_normals(regions.labels, depth, asked.view(np.uint8), kernel_numbers(camera), reach_px, sums)
    count, normal, sight = sums[:, 0], sums[:, 1:4], sums[:, 4:]
    lengths = np.linalg.norm(normal, axis=1) * np.linalg.norm(sight, axis=1)
    known = asked & (count >= SLOPES_SHARE * valid) & (lengths > 0)
    cosine = np.sum(normal * sight, axis=1) / np.where(known, lengths, 1)
    return np.where(known, np.degrees(np.arccos(np.clip(cosine, -1, 1))), np.nan)
