"""The method on one page: frame, cues, graph, regions, objects."""

from __future__ import annotations

from dataclasses import dataclass

from spigolo.config import Config
from spigolo.cues import Cues, gather_cues
from spigolo.frame import Frame
from spigolo.graph import Graph, weigh
from spigolo.objects import Segmentation, select_objects
from spigolo.presets import OBJECTS
from spigolo.regions import Regions, partition


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One run with every stage kept."""

    frame: Frame
    cues: Cues
    graph: Graph
    regions: Regions
    segmentation: Segmentation


def trace(frame: Frame, config: Config = OBJECTS) -> Trace:
    """Segments a frame and keeps what each stage made."""
    cues = gather_cues(frame, config)  # eqs. 5-21
    graph = weigh(cues, config.partition.connectivity, config.depth)  # eqs. 4, 9, 22 or 23
    regions = partition(graph, config.partition)  # eqs. 2, 3
    segmentation = select_objects(regions, cues, frame, config)  # section III-F
    return Trace(frame, cues, graph, regions, segmentation)


def segment(frame: Frame, config: Config = OBJECTS) -> Segmentation:
    """The objects of a frame.

    frame: colour, depth and camera. config: a preset or a configuration of your own.
    Returns the label image, the objects with their 2-D and 3-D facts, and the rejected regions with their reasons.
    """
    return trace(frame, config).segmentation
