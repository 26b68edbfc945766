"""Partition of the graph into regions by internal difference (eqs. 2, 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import Mask
from spigolo.kernels import choosing, merging, moments, sorting
from spigolo.kernels.workspace import Workspace
from spigolo.stages.graph import OFFSETS, Graph

SAMPLE_STEP = 97
PIVOT_QUANTILES = (0.3, 0.6)
"""Quantiles of the positive weights that separate the rounds of merging. Measured: fewer rounds sort more edges, and
more rounds read every edge more often.
"""
MAX_DIGIT_BITS = 11
MANY_WEIGHTLESS = 0.25
"""Share of zero weights above which large regions exist from the start. Such regions refuse merges early."""
ONE, BOTH = 1, 2
"""Minimum numbers of flagged ends of an edge."""


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """Partition of an image. labels (H, W) int32: region 0..count-1 of each pixel, numbered by first pixel."""

    labels: npt.NDArray[np.int32]
    count: int

    def count_where(self, mask: Mask) -> npt.NDArray[np.int64]:
        """Return the number of pixels of each region (R,) where a mask (H, W) is True."""
        counts = np.zeros(self.count, np.int64)
        moments.count_marked(self.labels, mask.view(np.uint8), counts)
        return counts

    def spread(self, of_region: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        """Return an image (H, W) with the value (R,) of each pixel's region."""
        out = np.empty_like(self.labels)
        moments.spread(of_region, self.labels, out)
        return out

    def joined(self, root: npt.NDArray[np.int64]) -> Regions:
        """Return the regions after joining all regions with the same root (R,), numbered anew. The root is their first
        region.
        """
        kept, number = np.unique(root, return_inverse=True)
        return Regions(self.spread(number.astype(np.int32)), kept.size)


@stage("partition")
def partition(graph: Graph, gamma: float, min_size_px: float = 0.0, workspace: Workspace | None = None) -> Regions:
    """Merge pixels over their edges in the order of (float32 weight, edge number), then join small regions.

    gamma: threshold of eq. 3. min_size_px: smaller regions join a neighbour, in pixels of this image. I(R) of eq. 2 is
    the largest weight in the minimum spanning tree of R, as computed by the cited algorithm. Weights must not be
    negative or NaN. Edges of weight +inf are ignored.
    """
    planes, height, width = graph.weights.shape
    workspace = Workspace() if workspace is None else workspace
    offsets = np.array([dy * width + dx for dy, dx in OFFSETS[:planes]], np.int64)
    edges = SortedEdges(graph.weights, offsets, workspace)
    forest = Forest(height * width, float(gamma), workspace)
    forest.merge(edges)
    forest.absorb_small(edges, min_size_px)
    labels, count = forest.labels()
    return Regions(labels.reshape(height, width), count)


class SortedEdges:
    """Edges of a graph, with a buffer to sort as many edges as there are pixels."""

    def __init__(self, weights: npt.NDArray[np.float32], offsets: npt.NDArray[np.int64], workspace: Workspace) -> None:
        self.weights = np.ascontiguousarray(weights).reshape(len(weights), -1)
        self.offsets = offsets
        self.steps = offsets.view(np.uint64)
        self._workspace = workspace
        self._room = self.weights.shape[1]
        sample = self.weights.reshape(-1)[::SAMPLE_STEP]
        self._sample = sample[np.isfinite(sample)]

    def pivots(self) -> list[float]:
        """Return the weights that separate the rounds of merging, two quantiles of a sample. Each round sorts only the
        edges that it needs.
        """
        positive = np.sort(self._sample[self._sample > 0])
        inner = [float(positive[int(q * positive.size)]) for q in PIVOT_QUANTILES] if positive.size else []
        return [0.0, *sorted(set(inner)), np.inf]

    def weightless_share(self) -> float:
        """Return the share of edges with weight 0."""
        return float(np.mean(self._sample == 0)) if self._sample.size else 0.0

    def sort(
        self, low: float, high: float, forest: Forest, least: int, detours: bool = True
    ) -> tuple[npt.NDArray[np.uint64], float]:
        """Return the packed edges with at least `least` flagged ends and weights from `low` to below `high`, sorted.

        If the buffer is too small for all of them, stop below a smaller weight, which is returned too.

        detours: True to include the last edge of each triangle or square.
        """
        width = self.offsets[1]
        while True:
            edges = self._workspace.array("edges", self._room + 1, np.uint64)
            count = choosing.collect(
                self.weights, width, np.float32(low), np.float32(high), forest.parent, forest.flags, least,
                self.offsets, detours, edges,
            )  # fmt: skip
            if count >= 0:
                break
            high = self._make_room(low, high)
        if least == BOTH and low > 0:  # not in absorb_small, whose regions are never final
            count = choosing.drop_final(edges[:count], self.steps, forest.parent, forest.records, forest.flags)
        return self._radix_sort(edges[:count], _bits(low)) if count else edges[:0], high

    def _make_room(self, low: float, high: float) -> float:
        """Return a weight halfway between `low` and `high` to stop at. If there is none, return `high` and allocate
        more memory.
        """
        between = np.sort(self._sample[(self._sample > low) & (self._sample < high)])
        if between.size:
            return float(between[between.size // 2])
        self._room *= 2
        return high

    def _radix_sort(self, edges: npt.NDArray[np.uint64], base: int) -> npt.NDArray[np.uint64]:
        """Return the sorted edges, with only as many stable passes as the range of weights requires."""
        width = max(((int(edges.max()) >> merging.HALF_BITS) - base).bit_length(), 1)
        passes = -(-width // MAX_DIGIT_BITS)
        digit_bits = -(-width // passes)
        starts = np.empty(1 << digit_bits, np.uint32)
        spare = self._workspace.array("spare", self._room, np.uint64)[: edges.size]
        for k in range(passes):
            mask = np.uint64((1 << digit_bits) - 1)
            sorting.scatter(edges, np.uint64(base), np.uint64(k * digit_bits), mask, starts, spare)
            edges, spare = spare, edges
        return edges


class Forest:
    """Disjoint-set forest over the pixels. Every tree is a region."""

    def __init__(self, pixels: int, gamma: float, workspace: Workspace) -> None:
        self.gamma = gamma
        self.parent = workspace.array("parent", pixels, np.uint32)
        self.records = workspace.array("records", pixels, np.uint64)
        self.flags = workspace.array("flags", pixels, np.uint8)
        self._workspace = workspace

    def merge(self, edges: SortedEdges) -> None:
        """Eqs. 2, 3. Merge in rounds of increasing weights. After each round, edges that can no longer join anything
        are dropped.
        """
        merging.plant(edges.weights, edges.steps[1], self.gamma, self.parent, self.records, self.flags)
        low, *pivots = edges.pivots()
        if edges.weightless_share() < MANY_WEIGHTLESS:
            low = self._merge_freely(edges, pivots[0])
        for high in pivots:
            while low < high:
                choosing.flag_open(np.uint64(_bits(low)), self.parent, self.records, self.flags)
                lightest, low = edges.sort(low, high, self, BOTH)
                self._merge(lightest, edges, stop=False)

    def _merge_freely(self, edges: SortedEdges, high: float) -> float:
        """Merge over the edges below `high` until a merge is refused. Return the weight that was reached.

        Until then, all connected pixels are one region. An edge between two pixels that lighter edges connect has no
        effect.
        """
        lightest, high = edges.sort(0.0, high, self, BOTH, detours=False)
        done = self._merge(lightest, edges, stop=True)
        return high if done == lightest.size else _weight(lightest[done])

    def _merge(self, some: npt.NDArray[np.uint64], edges: SortedEdges, stop: bool) -> int:
        return int(merging.merge(some, edges.steps, self.gamma, stop, self.parent, self.records))

    def absorb_small(self, edges: SortedEdges, min_size: float) -> None:
        """Join each region below min_size pixels to the neighbour across its lightest edge."""
        low = 0.0
        while low < np.inf:
            choosing.flag_small(min_size, self.parent, self.records, self.flags)
            lightest, low = edges.sort(low, np.inf, self, ONE, detours=False)
            merging.absorb_small(lightest, edges.steps, min_size, self.parent, self.records)

    def labels(self) -> tuple[npt.NDArray[np.int32], int]:
        """Return the region 0..R-1 of each pixel (H W,), numbered by first pixel, and R."""
        labels = np.empty(self.parent.size, np.int32)
        number = self._workspace.array("edges", labels.size, np.uint32)  # the buffer of the edges is free now
        return labels, int(merging.number_regions(self.parent, number, labels))


def _bits(weight: float) -> int:
    return int(np.float32(weight).view(np.uint32))


def _weight(edge: np.uint64) -> float:
    return float(np.uint32(edge >> np.uint64(merging.HALF_BITS)).view(np.float32))
