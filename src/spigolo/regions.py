"""Partition of the graph into regions by internal difference (eqs. 2, 3)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from spigolo.config import VGA_PX2, Partition
from spigolo.graph import OFFSETS, Graph
from spigolo.kernels import merging, sorting
from spigolo.workspace import Workspace

SAMPLE_STEP = 29
PIVOT_QUANTILES = (0.25, 0.5)
"""Measured to be best: fewer rounds sort more, more rounds look at every edge once more each."""


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """labels (H, W) int32: every pixel belongs to one of the regions 0..count-1, numbered by their first pixel."""

    labels: npt.NDArray[np.int32]
    count: int

    @property
    def vga_scale(self) -> float:
        """What a pixel of this image counts at 640x480."""
        return VGA_PX2 / self.labels.size


def partition(graph: Graph, config: Partition, workspace: Workspace | None = None) -> Regions:
    """Merges pixels over their edges in the order of (float32 weight, edge number), then joins small regions.

    I(R) of eq. 2 is the largest weight in the minimum spanning tree of R, as the cited algorithm computes it.
    Weights must not be negative or NaN; edges of +inf are none.
    """
    planes, height, width = graph.weights.shape
    workspace = Workspace() if workspace is None else workspace
    offsets = np.array([dy * width + dx for dy, dx in OFFSETS[:planes]], np.int64)
    edges = Edges(graph.weights, offsets, workspace)
    forest = Forest(height * width, workspace)
    gamma = config.gamma_shadows if graph.shadows and config.gamma_shadows is not None else config.gamma
    forest.merge(edges, float(gamma))
    forest.absorb_small(edges, config.min_size_px2 * height * width / VGA_PX2)
    labels, count = forest.labels()
    return Regions(labels.reshape(height, width), count)


class Edges:
    """The edges of a graph and the buffers to sort them in."""

    def __init__(self, weights: npt.NDArray[np.float32], offsets: npt.NDArray[np.int64], workspace: Workspace) -> None:
        self.weights = (np.ascontiguousarray(weights) + np.float32(0)).reshape(
            -1
        )  # -0 becomes 0, as its bits would not sort
        self.bits = self.weights.view(np.uint32)
        self.offsets = offsets
        self.packed = workspace.array("packed", self.weights.size, np.uint64)
        self.spare = workspace.array("spare", self.weights.size, np.uint64)

    def pivots(self) -> list[float]:
        """Where the rounds of merging begin and end: two quantiles of a sample, so that each sorts what it needs."""
        sample = self.weights[::SAMPLE_STEP]
        sample = np.sort(sample[np.isfinite(sample)])
        inner = [float(sample[int(q * sample.size)]) for q in PIVOT_QUANTILES] if sample.size else []
        return [0.0, *sorted({p for p in inner if p > 0}), np.inf]

    def sort(self, count: int) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.float32]]:
        """The first `count` packed edges in order, as (count, 2) pairs: numbers in column 0, weights in column 1."""
        packed = self.packed[:count]
        digit_bits = 10 if count == 0 or packed.max() >> 32 < 1 << 30 else 11
        starts = np.empty((sorting.DIGITS, 1 << digit_bits), np.int64)
        sorting.sort_edges(packed, self.spare[:count], starts, np.uint64(digit_bits))
        return packed.view(np.uint32).reshape(-1, 2), packed.view(np.float32).reshape(-1, 2)


class Forest:
    """Disjoint-set forest over the pixels: every tree is a region."""

    def __init__(self, pixels: int, workspace: Workspace) -> None:
        self.parent = workspace.array("parent", pixels, np.uint32)
        self.size = workspace.array("size", pixels, np.int32)
        self.bound = workspace.array("bound", pixels, np.float64)
        self.number = workspace.array("number", pixels, np.int32)
        self.parent[:] = np.arange(pixels, dtype=np.uint32)
        self.size[:] = 1

    def merge(self, edges: Edges, gamma: float) -> None:
        """Eqs. 2, 3 in rounds of heavier and heavier edges; between them what can do nothing any more is left out."""
        self.bound[:] = gamma
        for low, high in pairwise(edges.pivots()):
            count = merging.collect(
                edges.weights,
                edges.bits,
                np.float32(low),
                np.float32(high),
                self.parent,
                self.bound,
                edges.offsets,
                edges.packed,
            )
            numbers, weights = edges.sort(count)
            merging.merge(numbers, weights, edges.offsets, gamma, self.parent, self.size, self.bound)
            merging.flatten(self.parent)

    def absorb_small(self, edges: Edges, min_size: float) -> None:
        """Joins regions below min_size pixels to the neighbour over their lightest edge."""
        count = merging.collect_small(
            edges.weights, edges.bits, min_size, self.parent, self.size, edges.offsets, edges.packed
        )
        numbers, _ = edges.sort(count)
        merging.absorb_small(numbers, edges.offsets, min_size, self.parent, self.size)

    def labels(self) -> tuple[npt.NDArray[np.int32], int]:
        """Region of each pixel (H W,), 0..R-1 by first pixel, and R."""
        labels = np.empty(self.parent.size, np.int32)
        self.number[:] = -1
        count = merging.number_regions(self.parent, self.number, labels)
        return labels, int(count)
