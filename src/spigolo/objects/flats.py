"""Flat objects in the segmentation result (our addition)."""

from __future__ import annotations

import numpy as np

from spigolo.additions.flats import find_flats
from spigolo.clock import stage
from spigolo.objects.segmentation import Segmentation, assemble
from spigolo.objects.verdicts import judge_flat
from spigolo.settings.additions import Additions
from spigolo.stages.edges import EdgeMaps
from spigolo.stages.regions import Regions


@stage("flat objects")
def add_flats(result: Segmentation, edges: EdgeMaps | None, config: Additions) -> Segmentation:
    """Add flat objects among the pixels that belong to no object. The pixels of a flat object are removed from the
    region to which they belonged.
    """
    scene, rule = result.scene, config.flats
    plane, camera = scene.plane, scene.frame.camera
    if rule is None or edges is None or plane is None or camera is None:
        return result
    found = find_flats(result.labels == 0, scene.frame.depth, camera, plane, edges.canny, rule)
    if not found.any():
        return result
    old = result.regions.count
    numbers = np.where(found > 0, old - 1 + found, result.regions.labels)
    numbered = Regions(numbers, old + int(found.max()))
    kept = np.flatnonzero(numbered.count_where(np.ones(numbers.shape, bool)))
    regions = numbered.only(kept)
    facts, before = scene.measure(regions), result.verdicts()
    verdicts = [
        before[k] if k < old else judge_flat(f, scene.rejection, scene.rules, scene.support)
        for k, f in zip(kept, facts, strict=True)
    ]
    return assemble(scene, regions, facts, verdicts)
