"""Segmentation of a frame: the pipeline computes cues, a graph, regions and finally objects.

Comments in `_run` give the equations of each step, or "ours" for our additions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from spigolo.additions.contours import Contours, add_contours
from spigolo.additions.heights import lower_heights
from spigolo.additions.joining import join_parts
from spigolo.additions.merging import merge_regions
from spigolo.additions.packing import warn_of_packing
from spigolo.additions.plane import Plane
from spigolo.additions.support import find_support
from spigolo.frames.frame import Frame, check_frame
from spigolo.frames.halving import halve_frame, halve_roi, uncropped
from spigolo.frames.roi import Roi, pixel_of
from spigolo.kernels.workspace import Workspace
from spigolo.objects.flats import add_flats
from spigolo.objects.outlines import enlarge, redraw_outlines
from spigolo.objects.scene import find_above, find_inside
from spigolo.objects.segmentation import ObjectMask, Segmentation
from spigolo.objects.selection import reject_outside, select_objects, set_scene
from spigolo.settings.additions import Additions
from spigolo.settings.config import Config, check_config
from spigolo.settings.presets import OBJECTS
from spigolo.stages.color import color_points
from spigolo.stages.cues import Cues, Weighing, choose_weighing, gather_cues
from spigolo.stages.depth import prepare_depth
from spigolo.stages.edges import EdgeMaps, find_edges
from spigolo.stages.graph import Graph, weigh
from spigolo.stages.regions import Regions, partition


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Trace:
    """Results of all stages of one segmentation. If `additions.resolution` is "half", the maps of the stages have half
    the width and height of the frame.
    """

    frame: Frame
    """Input frame."""
    config: Config
    """Parameters of the segmentation. The lengths and areas in the parameters are given for an image of 640x480, and
    not scaled to the frame.
    """
    plane: Plane | None
    """Support plane (our addition). The value is None if no plane was found."""
    weighing: Weighing
    """Cost function and threshold gamma that were chosen for the frame."""
    edges: EdgeMaps | None
    """Image edges and boundaries. The value is None if the cost function does not read the boundary map."""
    contours: Contours | None
    """Contours from the depth map (our addition). None if `edges` is None."""
    cues: Cues
    """Cues from which the edge weights were computed."""
    graph: Graph
    """Graph of the pixels with edge weights."""
    regions: Regions
    """Regions after the parts of objects were joined. The final outlines are in `segmentation.regions`."""
    segmentation: Segmentation
    """Segmentation result: objects and rejected regions."""

    def __repr__(self) -> str:
        return f"Trace({self.frame!r}, {self.regions.count} regions, {self.segmentation!r})"


def trace(frame: Frame, config: Config = OBJECTS, roi: Roi | None = None, workspace: Workspace | None = None) -> Trace:
    """Segment a frame and return the results of all stages.

    - frame, config, roi: the same arguments as those of `segment`.
    - workspace: scratch memory to reuse from frame to frame. Use a separate workspace for each thread.
    """
    check_frame(frame)
    check_config(config)
    if config.additions and config.additions.resolution == "half":  # ours
        small = halve_frame(frame)  # a wide image is scaled as a crop of a 4:3 image
        run = _run(small, config, config.at_size(uncropped(small.shape)), halve_roi(roi, frame), workspace)
        run = replace(run, frame=frame, segmentation=enlarge(run.segmentation, frame, config, roi))
    else:
        run = _run(frame, config, config.at_size(frame.shape), roi, workspace)
    return replace(run, segmentation=reject_outside(run.segmentation))  # ours


def _run(frame: Frame, config: Config, sized: Config, roi: Roi | None, workspace: Workspace | None) -> Trace:
    """Run all stages on a frame. sized: parameters with lengths and areas scaled to the image size."""
    inside = find_inside(frame, roi)
    reach_m = sized.rejection.max_distance_m
    plane = find_support(frame.depth, frame.camera, _ours(sized).support, reach_m, inside and inside[0])  # ours
    sized = lower_heights(sized, plane, frame.depth, frame.camera)  # ours
    ours = _ours(sized)
    depth = prepare_depth(frame.depth, sized.depth)  # equations 5-8
    weighing = choose_weighing(depth, sized)  # equation 22 or 23
    edges = find_edges(frame.color, depth, frame.camera, sized.edges) if weighing.reads_boundary else None  # eqs. 12-20
    contours = add_contours(edges, depth, frame.camera, plane, ours)  # ours
    warn_of_packing(edges, frame.depth, frame.camera, plane, ours)  # ours
    lines = contours.lines if contours else None
    cues = gather_cues(frame.color, depth, lines, weighing, sized)  # equations 10, 11, 21
    color = color_points(frame.color, sized.color)  # equation 4
    graph = weigh(cues, color, weighing.cost, sized, ours.noise_per_m)  # equations 9, 22 or 23
    del color  # frees the memory of three images
    regions = partition(graph, weighing.gamma, sized.partition.min_size_px2, workspace)  # equations 2, 3
    regions = merge_regions(regions, cues.boundary, depth, find_above(frame, plane, ours), ours.merging)  # ours
    regions = join_parts(regions, cues, plane, frame.camera, ours)  # ours
    scene = set_scene(frame, cues, graph, plane, contours, config, sized, inside)
    segmentation = select_objects(regions, scene)  # section III-F, and ours
    segmentation = add_flats(segmentation, edges, ours)  # ours
    segmentation = redraw_outlines(segmentation, ours)  # ours
    return Trace(frame, config, plane, weighing, edges, contours, cues, graph, regions, segmentation)


def _ours(config: Config) -> Additions:
    """Return our additions to the method. In the presets of the paper, all additions are switched off."""
    return config.additions or Additions()


def segment(frame: Frame, config: Config = OBJECTS, roi: Roi | None = None) -> Segmentation:
    """Segment a frame into objects.

    - frame: colour image, depth map and camera.
    - config: a preset or your own configuration.
    - roi: mask (H, W), pixel box (y0, x0, y1, x1) or MetricBox of the region of interest. Regions outside the region of
      interest are rejected.

    Returns the label image, the objects with their measurements in the image and in space, and the rejected regions
    with reasons.
    """
    return trace(frame, config, roi).segmentation


def segment_at(frame: Frame, point: tuple[float, float], config: Config = OBJECTS) -> ObjectMask:
    """Segment a frame and return the region at a pixel (y, x) as an object, even if a rule rejects the region.

    Raises IndexError for a point outside the image.
    """
    check_frame(frame)
    pixel = pixel_of(point, frame.shape)  # check the point before the slow segmentation
    return segment(frame, config).object_at(pixel)
