"""How regions stand: whether they hide what is behind, lean away, and how the image cuts them (ours; `Wall`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.frames.camera import Camera, kernel_numbers
from spigolo.frames.frame import DepthMap, Mask
from spigolo.kernels import borders, planes
from spigolo.settings.additions import Wall
from spigolo.stages.regions import Regions

TALL_SHARE = 0.05
"""Least share of a region's measured pixels among the tall ones for it to be asked whether it is a wall."""
SLOPES_SHARE = 0.1
"""Least share of a region's measured pixels whose slope must be known for its mean normal to say something."""
REACH_INSIDE = 2.5
"""Where a region's own slope is measured, as a multiple of the reach."""


@dataclass(frozen=True, slots=True, eq=False)
class Stance:
    """How regions stand. cut, hides, lean_deg: (R,) as `RegionFacts` has them, NaN where nothing can be said."""

    cut: npt.NDArray[np.float64]
    hides: npt.NDArray[np.float64]
    lean_deg: npt.NDArray[np.float64]


def measure_stance(regions: Regions, depth: DepthMap, camera: Camera, tall: Mask, rule: Wall) -> Stance:
    """How every region stands; only those with enough pixels among the tall ones (H, W) are asked."""
    valid, high = regions.count_where(np.asarray(depth > 0)), regions.count_where(tall)
    asked = (high >= TALL_SHARE * valid) & (high > 0)
    sums = np.zeros((regions.count, borders.STEPS))
    near = rule.reach_px
    deep, steps = round(REACH_INSIDE * near), (rule.step_m, rule.step_share)
    borders.sum_steps(regions.labels, depth, asked.view(np.uint8), near, deep, *steps, sums)
    pairs, known, back, edge = sums.T
    enough = asked & (known + edge >= rule.min_measured * (pairs + edge)) & (known + edge > 0)
    hides = np.where(enough, back / np.maximum(known + edge, 1), np.nan)
    cut = np.where(asked, edge / np.maximum(pairs + edge, 1), np.nan)
    return Stance(cut, hides, _lean_deg(regions, depth, camera, asked, near, valid))


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
