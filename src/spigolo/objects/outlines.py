"""The answer with outlines drawn again (ours)."""

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
from spigolo.objects.facts import RegionFacts, remeasure
from spigolo.objects.scene import Scene, find_above, find_inside
from spigolo.objects.segmentation import Segmentation, assemble
from spigolo.settings.additions import Additions, Refinement
from spigolo.settings.config import Config
from spigolo.stages.regions import Regions

Value = TypeVar("Value", bound=np.generic)


@stage("outlines")
def redraw_outlines(result: Segmentation, config: Additions) -> Segmentation:
    """Draw the outlines of all objects again by colour, where depth does not say where they lie.

    A pixel that leaves an object goes to the rejected region that claims it. A rejected region without pixels is gone,
    so that regions are numbered anew.
    """
    if config.refinement is None or not result.objects:
        return result
    claimed = refine_labels(result.labels, result.frame.color, result.frame.depth, config.refinement)
    return _redrawn(result, result.scene, result.regions, result.labels, claimed)


@stage("enlarging")
def enlarge(result: Segmentation, frame: Frame, config: Config, roi: Roi | None = None) -> Segmentation:
    """Return the answer for a frame from that for `halve_frame` of it, its outlines placed at full size.

    config: the parameters that the answer names. roi: where objects are wanted, in the frame.
    """
    regions = Regions(_doubled(result.regions.labels, frame.shape), result.regions.count)
    scene = _enlarged_scene(result.scene, frame, config, roi)
    ours = scene.additions
    before = _doubled(result.labels, frame.shape)
    claimed = place_outlines(before, frame.color, frame.depth, (ours and ours.refinement) or Refinement())
    return _redrawn(result, scene, regions, before, claimed)


def _enlarged_scene(scene: Scene, frame: Frame, config: Config, roi: Roi | None) -> Scene:
    """Return the scene of a frame from that of its half. Depth that was in-painted there is taken from there."""
    sized = config.at_size(frame.shape)
    ours = sized.additions
    if ours is not None:
        rules = ours.rules.model_copy(update={"min_contour": scene.rules.min_contour})
        ours = ours.model_copy(update={"rules": rules})
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
    """Repeat each value in a block of two by two, and cut the result to (H, W)."""
    return np.ascontiguousarray(values.repeat(2, axis=0).repeat(2, axis=1)[: shape[0], : shape[1]])


def _redrawn(
    result: Segmentation, scene: Scene, regions: Regions, before: npt.NDArray[np.int32], claimed: Claimed
) -> Segmentation:
    """Return the answer in a scene with the regions that the claimed pixels leave, numbered anew.

    before: (H, W), labels of the objects before they were claimed.
    """
    labels, areas = np.empty_like(regions.labels), np.zeros(regions.count, np.int64)
    kernel.follow_seeds(before, claimed.labels, claimed.source_of, regions.labels, labels, areas)
    kept = np.flatnonzero(areas)
    redrawn = Regions(labels, regions.count)
    if kept.size < regions.count:
        number = np.full(regions.count, -1, np.int32)
        number[kept] = np.arange(kept.size)
        redrawn = Regions(redrawn.spread(number), kept.size)
    facts: list[RegionFacts] = sorted((*result.objects, *result.rejected), key=lambda f: f.region)
    verdicts = result.verdicts()
    measured = remeasure([facts[k] for k in kept], redrawn, scene.frame, scene.depth)
    return assemble(scene, redrawn, measured, [verdicts[k] for k in kept])
