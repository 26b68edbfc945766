"""Where our own time goes: the public functions of `pipeline.trace`, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from spigolo.additions.joining import join_parts
from spigolo.additions.support import find_support
from spigolo.frames.frame import Frame
from spigolo.kernels.workspace import Workspace
from spigolo.lab.bench.timing import Sample, Tell, silent, timed
from spigolo.objects.segmentation import select_objects
from spigolo.settings.config import Config, SaliencyCost
from spigolo.stages.color import color_points
from spigolo.stages.cues import gather_cues
from spigolo.stages.depth import inpaint_small_gaps, prepare_depth, smooth
from spigolo.stages.edges import find_edges
from spigolo.stages.graph import weigh
from spigolo.stages.regions import partition
from spigolo.stages.saliency import saliency_cue

T = TypeVar("T")

STAGES = ("cues", "weights", "partition", "joining", "objects")
PARTS = ("in-painting", "smoothing", "support plane", "colour", "saliency", "edges")
"""Of the cues; the rest of the cues is the support plane's contour, where there is one, and small."""


class Clock:
    """Times named calls, one round after the other."""

    def __init__(self) -> None:
        self.samples: dict[str, list[Sample]] = {}

    def __call__(self, name: str, work: Callable[[], T]) -> T:
        """What the work returns; the time it took is added to those of the name."""
        answers: list[T] = []
        self.samples.setdefault(name, []).append(timed(lambda: answers.append(work()))())
        return answers[0]


def time_stages(
    frame: Frame, configs: Mapping[str, Config], rounds: int, tell: Tell = silent
) -> dict[str, dict[str, list[Sample]]]:
    """Samples by configuration and stage, of STAGES and those of PARTS that the configuration has."""
    clocks = {name: Clock() for name in configs}
    workspaces = {name: Workspace() for name in configs}
    for k in range(rounds + 1):
        for place, (name, config) in enumerate(configs.items()):
            tell(f"stages: {name}", (k * len(configs) + place) / ((rounds + 1) * len(configs)))
            clock = clocks[name] if k > 0 else Clock()  # the first round warms up
            _run_stages(frame, config, workspaces[name], clock)
            _run_parts(frame, config, clock)
    return {name: clock.samples for name, clock in clocks.items()}


def _run_stages(frame: Frame, config: Config, workspace: Workspace, clock: Clock) -> None:
    """As `pipeline.trace` does."""
    sized = config.at_size(frame.shape)
    cues, color = clock("cues", lambda: (gather_cues(frame, sized), color_points(frame.color, sized.color)))
    graph = clock("weights", lambda: weigh(cues, color, config.partition.connectivity, config.depth))
    regions = clock("partition", lambda: partition(graph, config.partition, workspace))
    joined = clock("joining", lambda: join_parts(regions, cues, frame, sized))
    clock("objects", lambda: select_objects(joined, graph, cues, frame, config))


def _run_parts(frame: Frame, config: Config, clock: Clock) -> None:
    """The parts of the cues; these runs come on top of those of the stages."""
    config = config.at_size(frame.shape)
    depth, rule, camera = frame.depth, config.rejection.support, frame.camera
    inpainting, smoothing = config.depth.inpainting, config.depth.smoothing
    if inpainting is not None:
        depth = clock("in-painting", lambda: inpaint_small_gaps(frame.depth, inpainting))
    if smoothing.mean != "none":
        clock("smoothing", lambda: smooth(depth, smoothing))
    if rule is not None and camera is not None:
        clock("support plane", lambda: find_support(frame.depth, camera, rule))
    clock("colour", lambda: color_points(frame.color, config.color))
    if isinstance(config.cost, SaliencyCost):
        clock("saliency", lambda: saliency_cue(frame.color, config.saliency))
    else:
        prepared = prepare_depth(frame.depth, config.depth)
        clock("edges", lambda: find_edges(frame.color, prepared, camera, config.edges))
