"""Merging of neighbouring regions by the boundary values along their common border (`settings.Merging`).

Equation 3 compares two regions by the graph edge of smallest weight between them. Noise at a short part of the border
can therefore split one surface into two regions. In this module, two regions merge if the mean boundary value along
their whole common border is small. Regions with the weakest common border merge first. A small mean boundary value does
not merge regions above the support plane with regions on the support plane. In the last step, each region with few
pixels outside of boundary lines merges with a neighbour.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import DepthMap, Mask
from spigolo.kernels import borders as kernel
from spigolo.settings.additions import Merging
from spigolo.stages.regions import Regions

Boundary = npt.NDArray[np.float32]
Labels = npt.NDArray[np.int32]
Sums = npt.NDArray[np.float64]


@stage("merging")
def merge_regions(
    regions: Regions, boundary: Boundary | None, depth: DepthMap, above: Mask | None, config: Merging | None
) -> Regions:
    """Merge neighbouring regions if the mean boundary value along their common border is small. The regions are
    returned unchanged if `boundary` or `config` is None.

    - boundary: boundary map (H, W) with values from 0 to 1.
    - depth: depth map (H, W) in metres.
    - above: mask (H, W) of the pixels above the support plane, or None if the frame has no support plane.
    """
    if config is None or boundary is None:
        return regions
    graph = _Borders(regions, boundary, depth, above, config.line)
    graph.merge(lambda mean, a, b: mean < config.max_mean and graph.are_alike(a, b))
    graph.merge(lambda mean, a, b: min(graph.open_px[a], graph.open_px[b]) < config.min_open_px2)
    return regions.joined(np.array([graph.find(k) for k in range(regions.count)], np.int64))


def find_borders(labels: Labels, boundary: Boundary) -> tuple[Labels, Labels, Sums, Sums]:
    """Return the borders between all pairs of neighbouring regions as four arrays (E,), for E borders. The arrays
    contain the first region, the second region, the length in pixel pairs, and the sum of the boundary values.
    """
    size = labels.size // 4
    while True:
        pairs, strength = np.empty(size, np.int64), np.empty(size, np.float32)
        count = int(kernel.collect_pairs(labels, boundary, pairs, strength))
        if count <= size:
            break
        size = count
    found, index = np.unique(pairs[:count], return_inverse=True)
    length = np.bincount(index, minlength=found.size).astype(np.float64)
    total = np.bincount(index, strength[:count], minlength=found.size).astype(np.float64)
    return (found >> 32).astype(np.int32), (found & 0xFFFFFFFF).astype(np.int32), length, total


class _Borders:
    """Regions of a frame, with the measurements of their common borders. For every two neighbouring regions, the length
    of their common border and the sum of the boundary map along this border are stored.
    """

    def __init__(self, regions: Regions, boundary: Boundary, depth: DepthMap, above: Mask | None, line: float) -> None:
        self.root = list(range(regions.count))
        self.open_px: list[int] = regions.count_where(np.asarray(boundary < line)).tolist()
        measured = regions.count_where(np.asarray(depth > 0))
        self.measured: list[int] = measured.tolist()
        self.above: list[int] = (measured if above is None else regions.count_where(above)).tolist()
        self.beside: list[dict[int, tuple[float, float]]] = [{} for _ in self.root]
        columns = (column.tolist() for column in find_borders(regions.labels, boundary))
        for a, b, n, t in zip(*columns, strict=True):
            self.beside[a][b] = self.beside[b][a] = n, t

    def find(self, k: int) -> int:
        """Return the root of region k in the union-find forest."""
        while self.root[k] != k:
            self.root[k] = self.root[self.root[k]]
            k = self.root[k]
        return k

    def are_alike(self, a: int, b: int) -> bool:
        """Return True if two regions both lie above the support plane, or both lie on the support plane.

        If one of the two regions has no measured depth, the result is True.
        """
        if not (self.measured[a] and self.measured[b]):
            return True
        stands_a, stands_b = (2 * self.above[k] > self.measured[k] for k in (a, b))
        return stands_a == stands_b

    def merge(self, may_merge: Callable[[float, int, int], bool]) -> None:
        """Merge neighbouring regions for which `may_merge` returns True. Regions with the weakest common border are
        merged first.
        """
        heap = [(t / n, a, b) for a, beside in enumerate(self.beside) for b, (n, t) in beside.items() if a < b]
        heapq.heapify(heap)
        while heap:
            mean, a, b = heapq.heappop(heap)
            n, t = self.beside[a].get(b, (1.0, -1.0))
            if t / n != mean or not may_merge(mean, a, b):  # this heap entry is outdated: a merge changed the border
                continue
            for c, (n_c, t_c) in self._join(a, b):
                heapq.heappush(heap, (t_c / n_c, min(a, c), max(a, c)))

    def _join(self, a: int, b: int) -> Iterator[tuple[int, tuple[float, float]]]:
        """Merge region b into region a. Yield each former neighbour of b, with the length in pixel pairs and the sum of
        boundary values of its new border to a.
        """
        self.root[b] = a
        for counts in (self.open_px, self.measured, self.above):
            counts[a] += counts[b]
        del self.beside[a][b]
        for c, (n, t) in self.beside[b].items():
            if c != a:
                del self.beside[c][b]
                n_a, t_a = self.beside[a].get(c, (0.0, 0.0))
                self.beside[a][c] = self.beside[c][a] = n + n_a, t + t_a
                yield c, self.beside[a][c]
        self.beside[b] = {}
