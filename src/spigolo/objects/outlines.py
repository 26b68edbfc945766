"""The answer with outlines drawn again (ours)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from spigolo.additions.refinement import refine_labels
from spigolo.clock import stage
from spigolo.objects.facts import RegionFacts, remeasure
from spigolo.objects.segmentation import Segmentation, assemble
from spigolo.settings.additions import Additions, Refinement
from spigolo.stages.regions import Regions


@stage("outlines")
def redraw_outlines(result: Segmentation, config: Additions) -> Segmentation:
    """Draw the outlines of all objects again by colour, where depth does not say where they lie.

    A pixel that leaves an object goes to the rejected region that claims it. A rejected region without pixels is gone,
    so that regions are numbered anew.
    """
    if config.refinement is None or not result.objects:
        return result
    labels = _claim(result, config.refinement)
    kept = np.flatnonzero(np.bincount(labels.reshape(-1), minlength=result.regions.count))
    number = np.full(result.regions.count, -1, np.int32)
    number[kept] = np.arange(kept.size)
    regions = Regions(Regions(labels, result.regions.count).spread(number), kept.size)
    facts: list[RegionFacts] = sorted((*result.objects, *result.rejected), key=lambda f: f.region)
    verdicts = result.verdicts()
    measured = remeasure([facts[k] for k in kept], regions, result.scene.depth)
    return assemble(result.scene, regions, measured, [verdicts[k] for k in kept])


def _claim(result: Segmentation, config: Refinement) -> npt.NDArray[np.int32]:
    """Return the number of the region (H, W) that each pixel belongs to with the outlines of objects drawn again."""
    old = result.regions
    object_of = np.zeros(old.count, np.int32)
    for o in result:
        object_of[o.region] = o.label
    before = old.spread(object_of)
    claimed = refine_labels(before, result.frame.color, result.frame.depth, config)
    moved = np.flatnonzero(claimed.labels != before)
    labels = old.labels.copy()
    labels.reshape(-1)[moved] = old.labels.reshape(-1)[claimed.source_of[moved]]
    return labels
