"""Selection of objects. All regions are measured, and the rules accept or reject each region (section III-F)."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.additions.contours import Contours
from spigolo.additions.plane import Plane
from spigolo.clock import stage
from spigolo.errors import UnitWarning, warn
from spigolo.frames.frame import Frame, Mask
from spigolo.objects.scene import Scene, find_above
from spigolo.objects.scores import contour_cue
from spigolo.objects.segmentation import Segmentation, assemble
from spigolo.objects.verdicts import Reason, judge, judge_place
from spigolo.settings.additions import Additions
from spigolo.settings.config import Config
from spigolo.stages.cues import Cues
from spigolo.stages.graph import Graph
from spigolo.stages.regions import Regions

NEAREST_M, FARTHEST_M = 0.03, 50.0
"""Minimum and maximum plausible median depth of a frame, in metres. No RGB-D camera measures depth outside this
range.
"""
CLOSE_M, FAR_M = 0.15, 3.0
"""Minimum and maximum median depth of a usual frame, in metres. If no object is found, a median depth below `CLOSE_M`
gives a warning. A median depth above `FAR_M` gives a warning only if the median depth is also above `max_distance_m`.
"""
SAMPLED = 8


@stage("scene")
def set_scene(
    frame: Frame,
    cues: Cues,
    graph: Graph,
    plane: Plane | None,
    contours: Contours | None,
    config: Config,
    sized: Config,
    inside: tuple[Mask, Mask] | None = None,
) -> Scene:
    """Collect the maps and parameters by which the rules accept or reject the regions of a frame.

    - sized: `config` with lengths and areas scaled to the image size.
    - inside: masks of the region of interest, as in `Scene.inside`.
    """
    return Scene(
        frame=frame,
        depth=cues.depth,
        contour=_contour(cues, graph, sized.additions),
        plane=plane,
        rejection=sized.rejection,
        additions=_for_holes(sized.additions, contours),
        preset=config.name,
        digest=config.digest,
        left_out=("contact boundary",) if frame.camera is None and cues.boundary is not None else (),
        above=find_above(frame, plane, sized.additions),
        inside=inside,
    )


def _contour(cues: Cues, graph: Graph, additions: Additions | None) -> npt.NDArray[np.float32]:
    """Return the map (H, W) of boundary values that is averaged along the border of each region.

    At half resolution, the border of a region and the boundary may lie one pixel apart. Each value of the map at half
    resolution is therefore replaced by the maximum of its 3x3 neighbourhood.
    """
    contour = contour_cue(cues, graph)
    if additions is None or additions.resolution == "full":
        return contour
    return np.asarray(cv2.dilate(contour, np.ones((3, 3), np.uint8)), np.float32)


def _for_holes(additions: Additions | None, contours: Contours | None) -> Additions | None:
    """Return the parameters of our additions, adapted to one frame. If hole outlines are contours in the frame, the
    limit `min_contour` gets the value of `min_contour_holes`.
    """
    if additions is None or contours is None or not contours.in_holes or additions.rules.min_contour_holes is None:
        return additions
    rules = additions.rules.model_copy(update={"min_contour": additions.rules.min_contour_holes})
    return additions.model_copy(update={"rules": rules})


@stage("objects")
def select_objects(regions: Regions, scene: Scene) -> Segmentation:
    """Measure all regions, and accept or reject each region. Return the segmentation result: accepted regions are its
    objects.

    regions: regions from any segmentation method.
    """
    warn_of_depth(scene.frame)
    facts = scene.measure(regions)
    if not scene.frame.depth.any():
        return assemble(
            scene, regions, facts, [(Reason.NO_DEPTH, "no depth: the frame has no measured depth")] * len(facts)
        )
    verdicts = [judge(f, scene.rejection, scene.rules, scene.support) for f in facts]
    if None not in verdicts:
        warn_of_reach(scene)
    warn_of_plane(scene)
    return assemble(scene, regions, facts, verdicts)


def reject_outside(result: Segmentation) -> Segmentation:
    """Reject the regions outside the region of interest.

    This is the last step of a segmentation, so that a region of interest does not change the masks of the objects
    inside.
    """
    if result.scene.inside is None:
        return result
    regions = result.by_region()
    verdicts = [judge_place(r) or v for r, v in zip(regions, result.verdicts(), strict=True)]
    return assemble(result.scene, result.regions, regions, verdicts)


def warn_of_depth(frame: Frame) -> None:
    """Warn if a frame has no depth, or if its median depth is implausible. The median is estimated from a few thousand
    pixels.
    """
    if not frame.depth.any():
        warn("the frame has no measured depth, so no objects are returned: check the depth image")
        return
    median = _median_m(frame)
    if median > FARTHEST_M:
        warn(f"the median depth is {median:.0f} m: if it is stored in millimetres, give depth_scale=0.001", UnitWarning)
    if 0 < median < NEAREST_M:
        found = f"the median depth is {1000 * median:.2g} mm"
        warn(f"{found}: do not apply depth_scale twice, because floating-point depth is in metres already", UnitWarning)


def warn_of_plane(scene: Scene) -> None:
    """Warn if a preset requires a support plane, but a frame with plausible depth has none."""
    missing = scene.support is not None and scene.plane is None and scene.frame.camera is not None
    if missing and CLOSE_M <= _median_m(scene.frame) <= max(scene.rejection.max_distance_m or FARTHEST_M, FAR_M):
        warn(
            "no support plane was found, so the table or the floor may be returned as an object: pass the direction"
            " that points up (additions.support.facing.up), or check the frame with spigolo doctor"
        )


def warn_of_reach(scene: Scene) -> None:
    """Warn if a frame without objects has an unusual median depth: above `max_distance_m`, or below the minimum
    distance of most cameras.
    """
    median, reach_m = _median_m(scene.frame), scene.rejection.max_distance_m
    if reach_m is not None and max(reach_m, FAR_M) < median <= FARTHEST_M:
        why = f"more than the maximum of {reach_m:g} m (rejection.max_distance_m)"
    elif NEAREST_M <= median < CLOSE_M:
        why = "nearer than most cameras measure"
    else:
        return
    warn(f"no object was found, and the median depth is {median:.2f} m, {why}: check depth_scale", UnitWarning)


def _median_m(frame: Frame) -> float:
    """Return the median of the measured depth, estimated from a few thousand pixels, in metres. Returns 0 for a frame
    without depth.
    """
    few = frame.depth[::SAMPLED, ::SAMPLED]
    return float(np.median(few[few > 0])) if few.any() else 0.0
