"""Contestants of the rounds, and the pairs that are compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spigolo.errors import SpigoloError
from spigolo.frames.frame import Frame
from spigolo.kernels.workspace import Workspace
from spigolo.lab.bench.figures import paired_ratio
from spigolo.lab.bench.peers import Peers
from spigolo.lab.bench.textbook import sort_and_merge
from spigolo.lab.bench.timing import Run, Sample, timed
from spigolo.methods import METHODS
from spigolo.pipeline import trace
from spigolo.settings.config import Config
from spigolo.settings.presets import PRESETS, SHELF
from spigolo.stages.graph import Graph
from spigolo.stages.regions import partition
from spigolo.stages.saliency import fine_grained_saliency
from spigolo.stream import Segmenter

CONFIGS = {
    f"{name} {connectivity}c": PRESETS[name].replace(partition={"connectivity": connectivity})
    for name in ("OBJECTS", "SHELF", "TABLE", "CLUTTER")
    for connectivity in (8, 4)
}
"""Presets, 8- and 4-connected."""
MERGED = ("TABLE 8c", "SHELF 8c")
"""Configurations whose merging is also timed separately, on their graphs."""
OURS = "toscana2016"
"""Name of the method of the presets in CONFIGS. All other methods in METHODS run with their own parameters."""
SEGMENTING_PEERS = ("GraphSegmentation", "felzenszwalb")
SALIENCY, SALIENCY_PEER = "fine_grained_saliency", "StaticSaliencyFineGrained"


@dataclass(frozen=True, slots=True)
class Comparison:
    """Comparison of two contestants. ratio: CPU time of the peer divided by ours, median over rounds."""

    peer: str
    ours: str
    ratio: float


def segmenters(frame: Frame, configs: Mapping[str, Config] = CONFIGS) -> dict[str, Run]:
    """Return a Segmenter for each configuration, kept between the rounds."""
    return {name: _on(Segmenter(config), frame) for name, config in configs.items()}


def baselines(frame: Frame) -> dict[str, Run]:
    """Return the other methods of this package."""
    return {name: _on(METHODS[name], frame) for name in _others()}


def saliency(frame: Frame) -> dict[str, Run]:
    """Return our saliency, which OpenCV has too."""
    return {SALIENCY: timed(lambda: fine_grained_saliency(frame.color, SHELF.saliency))}


def mergings(frame: Frame) -> dict[str, Run]:
    """Return our merging and the textbook's on the same weights. Raises SpigoloError if their regions differ."""
    runs: dict[str, Run] = {}
    for name in MERGED:
        config = CONFIGS[name]
        graph = trace(frame, config).graph
        check_merging(graph, config)
        runs[merging_name(name)] = _merging(graph, config)
        runs[textbook_name(name)] = _textbook(graph, config)
    return runs


def merging_name(config: str) -> str:
    """Return the name of our merging of a configuration's graph."""
    return f"merging, {config}"


def textbook_name(config: str) -> str:
    """Return the name of the textbook's merging of a configuration's graph."""
    return f"textbook merging, {config}"


def check_merging(graph: Graph, config: Config) -> None:
    """Raise SpigoloError if our regions of a graph, including small ones, differ from the textbook's."""
    ours = partition(graph, config.partition.gamma).labels
    textbook = sort_and_merge(graph, config.partition.gamma)
    if not np.array_equal(ours, textbook):
        differ = np.count_nonzero(ours != textbook)
        raise SpigoloError(f"expected the regions of the textbook's merging for {config.name}, {differ} pixels differ")


def compare(samples: Mapping[str, list[Sample]]) -> list[Comparison]:
    """Return all pairs that do the same task and ran in the same rounds."""
    rivals = [name for name in (*SEGMENTING_PEERS, *_others()) if name in samples]
    pairs = [(rival, ours) for ours in CONFIGS for rival in rivals]
    pairs += [(SALIENCY_PEER, SALIENCY), *((textbook_name(name), merging_name(name)) for name in MERGED)]
    return [
        Comparison(peer, ours, paired_ratio(samples[peer], samples[ours]))
        for peer, ours in pairs
        if peer in samples and ours in samples
    ]


def everybody(frame: Frame, peers: Peers, key: str) -> dict[str, Run]:
    """Return all contestants on one frame. The peers keep its colour image as `key`."""
    peers.load(key, frame.color)
    return {**segmenters(frame), **baselines(frame), **saliency(frame), **mergings(frame), **peers.contestants(key)}


def _others() -> list[str]:
    return [name for name in METHODS if name != OURS]


def _on(method: Callable[[Frame], object], frame: Frame) -> Run:
    return timed(lambda: method(frame))


def _merging(graph: Graph, config: Config) -> Run:
    workspace = Workspace()
    return timed(lambda: partition(graph, config.partition.gamma, workspace=workspace))


def _textbook(graph: Graph, config: Config) -> Run:
    return timed(lambda: sort_and_merge(graph, config.partition.gamma))
