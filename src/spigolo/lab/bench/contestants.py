"""Functions whose time the benchmark measures, and a comparison of their CPU times."""

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
"""Configurations whose time is measured: each preset with 8-connected and with 4-connected pixels."""
MERGED = ("TABLE 8c", "SHELF 8c")
"""Names of the configurations for which the step that merges pixels into regions is also timed separately."""
OURS = "toscana2016"
"""Name of the segmentation method that runs with the presets in `CONFIGS`.

All methods in `METHODS` except `toscana2016` run with their default parameters.
"""
SEGMENTING_PEERS = ("GraphSegmentation", "felzenszwalb")
SALIENCY, SALIENCY_PEER = "fine_grained_saliency", "StaticSaliencyFineGrained"


@dataclass(frozen=True, slots=True)
class Comparison:
    """Comparison of a function of spigolo (`ours`) with another function for the same task (`peer`).

    The peer is a function of another library, another segmentation method in `METHODS`, or the textbook algorithm that
    merges pixels into regions.
    """

    peer: str
    ours: str
    ratio: float
    """CPU time of `peer` divided by CPU time of `ours`, as the median of several measured ratios.

    The ratio is above 1 if `ours` is faster than `peer`.
    """


def segmenters(frame: Frame, configs: Mapping[str, Config] = CONFIGS) -> dict[str, Run]:
    """Return one timed function for each configuration.

    Each returned function segments the frame with its own `Segmenter`, and returns the CPU and wall time.
    """
    return {name: _on(Segmenter(config), frame) for name, config in configs.items()}


def baselines(frame: Frame) -> dict[str, Run]:
    """Return one timed function for each segmentation method in `METHODS` except `toscana2016`.

    Each returned function segments the frame, and returns the CPU and wall time.
    """
    return {name: _on(METHODS[name], frame) for name in _others()}


def saliency(frame: Frame) -> dict[str, Run]:
    """Return a function that computes the saliency map with spigolo, and returns the CPU and wall time."""
    return {SALIENCY: timed(lambda: fine_grained_saliency(frame.color, SHELF.saliency))}


def mergings(frame: Frame) -> dict[str, Run]:
    """Return two timed functions for each configuration in `MERGED`.

    Both functions merge the pixels of the same graph into regions, and return their CPU and wall time. One function
    calls `regions.partition`, and the other function calls the textbook algorithm `sort_and_merge`. Raises SpigoloError
    if `partition` and `sort_and_merge` give different regions.
    """
    runs: dict[str, Run] = {}
    for name in MERGED:
        config = CONFIGS[name]
        graph = trace(frame, config).graph
        check_merging(graph, config)
        runs[merging_name(name)] = _merging(graph, config)
        runs[textbook_name(name)] = _textbook(graph, config)
    return runs


def merging_name(config: str) -> str:
    """Return the name of the timed function that calls `regions.partition` with the configuration `config`."""
    return f"merging, {config}"


def textbook_name(config: str) -> str:
    """Return the name of the timed function that calls the textbook algorithm with the configuration `config`."""
    return f"textbook merging, {config}"


def check_merging(graph: Graph, config: Config) -> None:
    """Raise SpigoloError if `partition` and `sort_and_merge` segment the graph into different regions."""
    ours = partition(graph, config.partition.gamma).labels
    textbook = sort_and_merge(graph, config.partition.gamma)
    if not np.array_equal(ours, textbook):
        differ = np.count_nonzero(ours != textbook)
        raise SpigoloError(
            f"expected equal regions from our merging and the textbook's merging for {config.name}, got {differ}"
            " different pixels"
        )


def compare(samples: Mapping[str, list[Sample]]) -> list[Comparison]:
    """Compare the CPU times of each pair of functions that do the same task."""
    rivals = [name for name in (*SEGMENTING_PEERS, *_others()) if name in samples]
    pairs = [(rival, ours) for ours in CONFIGS for rival in rivals]
    pairs += [(SALIENCY_PEER, SALIENCY), *((textbook_name(name), merging_name(name)) for name in MERGED)]
    return [
        Comparison(peer, ours, paired_ratio(samples[peer], samples[ours]))
        for peer, ours in pairs
        if peer in samples and ours in samples
    ]


def everybody(frame: Frame, peers: Peers, key: str) -> dict[str, Run]:
    """Return all functions whose time is measured on one frame.

    key: name under which the worker processes store the colour image of the frame.
    """
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
