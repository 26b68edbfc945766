"""Partition of the graph of pixels into regions. Edge weights inside the regions are compared with the weights of edges
between regions (equations 2, 3).
"""

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
"""Quantiles of the positive edge weights at which a new round of merging begins. Regions are merged in several rounds
with edges of increasing weight.
"""
MAX_DIGIT_BITS = 11
MANY_WEIGHTLESS = 0.25
"""Minimum share of edges with weight 0 at which merging begins directly with the normal rounds. If the share of edges
with weight 0 is smaller, one more round comes first. This round ends at the first pair of regions that may not merge.
"""
ONE, BOTH = 1, 2
"""Minimum number of flagged pixels of an edge. A pixel is flagged if its region can still merge, or if its region is
too small. Edges with fewer flagged pixels are not sorted.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """Partition of an image into regions.

    - labels: (H, W) int32, region number of each pixel, from 0 to count - 1. Regions are numbered in the order in which
      their first pixels appear in the image.
    - count: number of regions.
    """

    labels: npt.NDArray[np.int32]
    count: int

    def count_where(self, mask: Mask) -> npt.NDArray[np.int64]:
        """Return the number of pixels (R,) of each region that lie inside a mask (H, W)."""
        counts = np.zeros(self.count, np.int64)
        moments.count_marked(self.labels, mask.view(np.uint8), counts)
        return counts

    def spread(self, of_region: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        """Return an image (H, W) in which each pixel has the value of its region.

        of_region: values (R,) of the regions.
        """
        out = np.empty_like(self.labels)
        moments.spread(of_region, self.labels, out)
        return out

    def joined(self, root: npt.NDArray[np.int64]) -> Regions:
        """Join all regions of each group into one region, and renumber the regions.

        root: (R,), smallest region number in the group of each region.
        """
        kept, number = np.unique(root, return_inverse=True)
        return Regions(self.spread(number.astype(np.int32)), kept.size)

    def only(self, kept: npt.NDArray[np.int64]) -> Regions:
        """Remove regions without pixels, and renumber the other regions.

        kept: (K,), numbers of all regions with pixels, in ascending order.
        """
        number = np.full(self.count, -1, np.int32)
        number[kept] = np.arange(kept.size)
        return Regions(self.spread(number), kept.size)


@stage("partition")
def partition(graph: Graph, gamma: float, min_size_px: float = 0.0, workspace: Workspace | None = None) -> Regions:
    """Merge pixels into regions along edges of increasing weight, and then join small regions with their neighbours.

    Edges of equal weight are processed in the order of their numbers. The internal difference I(R) of equation 2 is the
    largest weight in the minimum spanning tree of region R, as in Felzenszwalb & Huttenlocher 2004.

    - graph: edge weights, not negative and not NaN. Edges of weight +inf are ignored.
    - gamma: threshold of equation 3. A larger gamma gives larger regions.
    - min_size_px: minimum number of pixels of a region.
    - workspace: scratch memory to reuse from frame to frame.
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
    """Edges of a graph, which are selected and sorted in several rounds to save time."""

    def __init__(self, weights: npt.NDArray[np.float32], offsets: npt.NDArray[np.int64], workspace: Workspace) -> None:
        self.weights = np.ascontiguousarray(weights).reshape(len(weights), -1)
        self.offsets = offsets
        self.steps = offsets.view(np.uint64)
        self._workspace = workspace
        self._room = self.weights.shape[1]
        sample = self.weights.reshape(-1)[::SAMPLE_STEP]
        self._sample = sample[np.isfinite(sample)]

    def pivots(self) -> list[float]:
        """Return the edge weights at which the rounds of merging begin and end, smallest first."""
        positive = np.sort(self._sample[self._sample > 0])
        inner = [float(positive[int(q * positive.size)]) for q in PIVOT_QUANTILES] if positive.size else []
        return [0.0, *sorted(set(inner)), np.inf]

    def weightless_share(self) -> float:
        """Return the share of edges with weight 0, estimated from a sample."""
        return float(np.mean(self._sample == 0)) if self._sample.size else 0.0

    def sort(
        self, low: float, high: float, forest: Forest, least: int, detours: bool = True
    ) -> tuple[npt.NDArray[np.uint64], float]:
        """Return the sorted packed edges with low <= weight < high, and the upper limit of their weights.

        If these edges do not fit into the buffer, only the lightest edges are returned, and the returned upper limit is
        smaller than `high`.

        - forest: union-find forest of the current regions.
        - least: minimum number of flagged pixels of an edge, 1 or 2.
        - detours: True to include the heaviest edge of each triangle or square of neighbouring pixels.
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
        if least == BOTH and low > 0:  # absorb_small merges regions without a merge bound
            count = choosing.drop_final(edges[:count], self.steps, forest.parent, forest.records, forest.flags)
        return self._radix_sort(edges[:count], _bits(low)) if count else edges[:0], high

    def _make_room(self, low: float, high: float) -> float:
        """Return a smaller upper limit of weights, so that fewer edges are selected.

        If no smaller limit exists, return `high` and allocate a larger buffer.
        """
        between = np.sort(self._sample[(self._sample > low) & (self._sample < high)])
        if between.size:
            return float(between[between.size // 2])
        self._room *= 2
        return high

    def _radix_sort(self, edges: npt.NDArray[np.uint64], base: int) -> npt.NDArray[np.uint64]:
        """Sort packed edges by weight.

        base: bit pattern of the smallest possible weight, as an integer.
        """
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
    """Union-find forest over the pixels, in which every tree is a region."""

    def __init__(self, pixels: int, gamma: float, workspace: Workspace) -> None:
        self.gamma = gamma
        self.parent = workspace.array("parent", pixels, np.uint32)
        self.records = workspace.array("records", pixels, np.uint64)
        self.flags = workspace.array("flags", pixels, np.uint8)
        self._workspace = workspace

    def merge(self, edges: SortedEdges) -> None:
        """Eqs. 2, 3. Merge regions in several rounds of increasing edge weights."""
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
        """Merge regions along edges lighter than `high`, until equation 3 rejects a merge. Return the lower limit of
        weights for the next round.

        Before the first rejected merge, an edge has no effect if its two pixels are also connected by lighter edges.
        Edges that have no effect are not sorted.
        """
        lightest, high = edges.sort(0.0, high, self, BOTH, detours=False)
        done = self._merge(lightest, edges, stop=True)
        return high if done == lightest.size else _weight(lightest[done])

    def _merge(self, some: npt.NDArray[np.uint64], edges: SortedEdges, stop: bool) -> int:
        return int(merging.merge(some, edges.steps, self.gamma, stop, self.parent, self.records))

    def absorb_small(self, edges: SortedEdges, min_size: float) -> None:
        """Join each region of fewer than min_size pixels with the neighbour to which its lightest edge leads."""
        low = 0.0
        while low < np.inf:
            choosing.flag_small(min_size, self.parent, self.records, self.flags)
            lightest, low = edges.sort(low, np.inf, self, ONE, detours=False)
            merging.absorb_small(lightest, edges.steps, min_size, self.parent, self.records)

    def labels(self) -> tuple[npt.NDArray[np.int32], int]:
        """Return the region number 0..R - 1 of each pixel (H W,), and the number of regions R."""
        labels = np.empty(self.parent.size, np.int32)
        number = self._workspace.array("edges", labels.size, np.uint32)  # the edges are no longer needed
        return labels, int(merging.number_regions(self.parent, number, labels))


def _bits(weight: float) -> int:
    return int(np.float32(weight).view(np.uint32))


def _weight(edge: np.uint64) -> float:
    return float(np.uint32(edge >> np.uint64(merging.HALF_BITS)).view(np.float32))
