"""Selection of objects: every region is measured and judged (section III-F)."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.additions.contours import Contours
from spigolo.additions.plane import Plane
from spigolo.clock import stage
from spigolo.errors import UnitWarning, warn
from spigolo.frames.frame import Frame
from spigolo.frames.roi import Roi
from spigolo.objects.scene import Scene, find_above, find_inside
from spigolo.objects.scores import contour_cue
from spigolo.objects.segmentation import Segmentation, assemble
from spigolo.objects.verdicts import Reason, judge
from spigolo.settings.additions import Additions
from spigolo.settings.config import Config
from spigolo.stages.cues import Cues
from spigolo.stages.graph import Graph
from spigolo.stages.regions import Regions

NEAREST_M, FARTHEST_M = 0.03, 50.0
"""Depth range that covers the range of every RGB-D camera, metres."""
CLOSE_M, FAR_M = 0.15, 3.0
"""Range of the median depth outside which the unit of a frame without objects is doubtful, metres."""
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
    roi: Roi | None = None,
) -> Scene:
    """Collect the maps and parameters by which the regions of a frame are judged.

    sized: parameters in pixels of this image. roi: regions outside it are rejected.
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
        inside=find_inside(frame, roi),
    )


def _contour(cues: Cues, graph: Graph, additions: Additions | None) -> npt.NDArray[np.float32]:
    """Return the map that measures borders.

    In a halved frame, an offset of one pixel between border and boundary is two pixels of the full frame. The map
    therefore takes the maximum over neighbouring pixels. The mean along a border is then equal to that of the full
    frame.
    """
    contour = contour_cue(cues, graph)
    if additions is None or additions.resolution == "full":
        return contour
    return np.asarray(cv2.dilate(contour, np.ones((3, 3), np.uint8)), np.float32)


def _for_holes(additions: Additions | None, contours: Contours | None) -> Additions | None:
    """Return the additions. If hole outlines are contours in this frame, use the minimum contour for such frames."""
    if additions is None or contours is None or not contours.in_holes or additions.rules.min_contour_holes is None:
        return additions
    rules = additions.rules.model_copy(update={"min_contour": additions.rules.min_contour_holes})
    return additions.model_copy(update={"rules": rules})


@stage("objects")
def select_objects(regions: Regions, scene: Scene) -> Segmentation:
    """Measure all regions, from any method. Return each one as an object or with the reason for its rejection."""
    warn_of_depth(scene.frame)
    facts = scene.measure(regions)
    if not scene.frame.depth.any():
        return assemble(scene, regions, facts, [(Reason.NO_DEPTH, "no depth: the frame has none at all")] * len(facts))
    verdicts = [judge(f, scene.rejection, scene.rules, scene.support) for f in facts]
    if None not in verdicts:
        warn_of_reach(scene)
    return assemble(scene, regions, facts, verdicts)


def warn_of_depth(frame: Frame) -> None:
    """Warn of implausible depth in which no object can be found, judged from a few thousand pixels."""
    if not frame.depth.any():
        warn("the frame has no depth at all, so nothing in it is an object")
        return
    median = _median_m(frame)
    if median > FARTHEST_M:
        warn(f"the median depth is {median:.0f} m: if it is stored in millimetres, give depth_scale=0.001", UnitWarning)
    if 0 < median < NEAREST_M:
        found = f"the median depth is {1000 * median:.2g} mm"
        warn(f"{found}: is depth_scale applied twice? Floating-point depth is in metres already", UnitWarning)


def warn_of_reach(scene: Scene) -> None:
    """Warn if most of a frame without objects lies beyond the reach, or nearer than most cameras measure."""
    median, reach_m = _median_m(scene.frame), scene.rejection.max_distance_m
    if reach_m is not None and max(reach_m, FAR_M) < median <= FARTHEST_M:
        why = f"beyond the reach of {reach_m:g} m (rejection.max_distance_m)"
    elif NEAREST_M <= median < CLOSE_M:
        why = "nearer than most cameras measure"
    else:
        return
    warn(f"no object is found, and the median depth is {median:.2f} m, {why}: check depth_scale", UnitWarning)


def _median_m(frame: Frame) -> float:
    """Return the median measured depth, estimated from a few thousand pixels. 0 without depth."""
    few = frame.depth[::SAMPLED, ::SAMPLED]
    return float(np.median(few[few > 0])) if few.any() else 0.0
