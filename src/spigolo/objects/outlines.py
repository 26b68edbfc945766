"""Refinement of object outlines in the segmentation result (our addition)."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from spigolo.additions.refinement import Claimed, place_outlines, refine_labels
from spigolo.clock import stage
from spigolo.frames.frame import Frame
from spigolo.frames.roi import Roi
from spigolo.kernels import seeding as kernel
from spigolo.objects.facts import remeasure
from spigolo.objects.scene import Scene, find_above, find_inside
from spigolo.objects.segmentation import Segmentation, assemble
from spigolo.settings.additions import Additions, Refinement
from spigolo.settings.config import Config
from spigolo.stages.regions import Regions

Value = TypeVar("Value", bound=np.generic)


@stage("outlines")
def redraw_outlines(result: Segmentation, config: Additions) -> Segmentation:
    """Move the outlines of all objects to nearby colour differences. Only pixels within a band along the outlines get
    new labels. The band along the outlines is wider where depth is smeared or missing.

    A pixel that is removed from an object is added to a neighbouring region. Regions that lose all their pixels are
    removed, and the other regions are numbered again.
    """
    if config.refinement is None or not result.objects:
        return result
    claimed = refine_labels(result.labels, result.frame.color, result.frame.depth, config.refinement)
    return _redrawn(result, result.scene, result.regions, result.labels, claimed)


@stage("enlarging")
def enlarge(result: Segmentation, frame: Frame, config: Config, roi: Roi | None = None) -> Segmentation:
    """Convert the result of a frame at half resolution (`halve_frame`) to full resolution, with refined outlines.

    - frame: frame at full resolution.
    - config: parameters of the segmentation.
    - roi: region of interest at full resolution.
    """
    regions = Regions(_doubled(result.regions.labels, frame.shape), result.regions.count)
    scene = _enlarged_scene(result.scene, frame, config, roi)
    ours = scene.additions
    before = _doubled(result.labels, frame.shape)
    claimed = place_outlines(before, frame.color, frame.depth, (ours and ours.refinement) or Refinement())
    return _redrawn(result, scene, regions, before, claimed)


def _enlarged_scene(scene: Scene, frame: Frame, config: Config, roi: Roi | None) -> Scene:
    """Convert the input of the rejection rules (`Scene`) from half resolution to full resolution.

    Missing depth at full resolution is filled with the in-painted depth at half resolution.
    """
    sized = config.at_size(frame.shape)
    ours = sized.additions
    if ours is not None:
        measured = {"min_contour": scene.rules.min_contour, "ledge": scene.rules.ledge}  # limits set by this frame
        rules = ours.rules.model_copy(update=measured)
        ours = ours.model_copy(update={"rules": rules, "support": scene.support})
    return replace(
        scene,
        frame=frame,
        depth=np.where(frame.depth > 0, frame.depth, _doubled(scene.depth, frame.shape)),
        contour=_doubled(scene.contour, frame.shape),
        rejection=sized.rejection,
        additions=ours,
        digest=config.digest,
        above=find_above(frame, scene.plane, ours),
        inside=find_inside(frame, roi),
    )


def _doubled(values: npt.NDArray[Value], shape: tuple[int, int]) -> npt.NDArray[Value]:
    """Enlarge an array to twice its size by repeating values in blocks of 2x2, and crop the result to shape (H, W)."""
    return np.ascontiguousarray(values.repeat(2, axis=0).repeat(2, axis=1)[: shape[0], : shape[1]])


def _redrawn(
    result: Segmentation, scene: Scene, regions: Regions, before: npt.NDArray[np.int32], claimed: Claimed
) -> Segmentation:
    """Return a segmentation result with the new labels of pixels near borders. Regions that have lost all their pixels
    are removed.

    - before: labels (H, W) before the refinement.
    - claimed: labels after the refinement.
    """
    labels, areas = np.empty_like(regions.labels), np.zeros(regions.count, np.int64)
    kernel.follow_seeds(before, claimed.labels, claimed.source_of, regions.labels, labels, areas)
    kept = np.flatnonzero(areas)
    redrawn = Regions(labels, regions.count)
    if kept.size < regions.count:
        redrawn = redrawn.only(kept)
    facts, verdicts = result.by_region(), result.verdicts()
    measured = remeasure([facts[k] for k in kept], redrawn, scene.frame, scene.depth)
    return assemble(scene, redrawn, measured, [verdicts[k] for k in kept])
