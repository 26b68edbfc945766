"""The method on one page: frame, cues, graph, regions, objects."""

from __future__ import annotations

from dataclasses import dataclass

from spigolo.additions.joining import join_parts
from spigolo.frames.frame import Frame, check_frame
from spigolo.frames.roi import Roi, pixel_of
from spigolo.kernels.workspace import Workspace
from spigolo.objects.segmentation import ObjectMask, Segmentation, select_objects
from spigolo.settings.config import Config, check_config
from spigolo.settings.presets import OBJECTS
from spigolo.stages.color import color_points
from spigolo.stages.cues import Cues, gather_cues
from spigolo.stages.graph import Graph, weigh
from spigolo.stages.regions import Regions, partition


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One run with every stage kept."""

    frame: Frame
    config: Config
    cues: Cues
    graph: Graph
    regions: Regions
    segmentation: Segmentation


def trace(frame: Frame, config: Config = OBJECTS, roi: Roi | None = None, workspace: Workspace | None = None) -> Trace:
    """Segments a frame and keeps what each stage made. workspace: scratch kept between frames, one per thread."""
    check_frame(frame)
    check_config(config)
    sized = config.at_size(frame.shape)  # lengths in pixels, for this image
    cues = gather_cues(frame, sized)  # eqs. 5-8, 10-21
    color = color_points(frame.color, sized.color)  # eq. 4
    graph = weigh(cues, color, config.partition.connectivity, config.depth)  # eqs. 9, 22 or 23
    del color  # three times as large as another cue, and not needed again
    regions = partition(graph, config.partition, workspace)  # eqs. 2, 3
    regions = join_parts(regions, cues, frame, sized)  # ours, off in the paper's presets
    segmentation = select_objects(regions, graph, cues, frame, config, roi)  # section III-F
    return Trace(frame, config, cues, graph, regions, segmentation)


def segment(frame: Frame, config: Config = OBJECTS, roi: Roi | None = None) -> Segmentation:
    """The objects of a frame.

    frame: colour, depth and camera. config: a preset or a configuration of your own. roi: where objects are wanted: a
    mask (H, W), a pixel box (y0, x0, y1, x1) or a MetricBox; regions outside are rejected.
    Returns the label image, the objects with their 2-D and 3-D facts, and the rejected regions with their reasons.
    """
    return trace(frame, config, roi).segmentation


def segment_at(frame: Frame, point: tuple[float, float], config: Config = OBJECTS) -> ObjectMask:
    """The object at a pixel (y, x), whatever rule its region breaks: a click says that there is one.

    Raises IndexError for a point outside the image.
    """
    check_frame(frame)
    pixel = pixel_of(point, frame.shape)  # before the work is done
    return segment(frame, config).object_at(pixel)
