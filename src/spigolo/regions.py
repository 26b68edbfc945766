"""Partition of the graph into regions by internal difference (eqs. 2, 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.config import Partition
from spigolo.graph import OFFSETS, Graph
from spigolo.kernels import merging, sorting

VGA_PX2 = 640 * 480
"""The image size that pixel areas are given for."""


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """labels (H, W) int32: every pixel belongs to one of the regions 0..count-1, numbered by their first pixel."""

    labels: npt.NDArray[np.int32]
    count: int

    @property
    def vga_scale(self) -> float:
        """What a pixel of this image counts at 640x480."""
        return VGA_PX2 / self.labels.size


def partition(graph: Graph, config: Partition) -> Regions:
    """Merges pixels over their edges in the order of (float32 weight, edge number), then joins small regions.

    I(R) of eq. 2 is the largest weight in the minimum spanning tree of R, as the cited algorithm computes it.
    """
    planes, height, width = graph.weights.shape
    pixels = height * width
    weights = graph.weights.reshape(-1)
    order = edge_order(weights)
    offsets = np.array([dy * width + dx for dy, dx in OFFSETS[:planes]], np.int64)
    gamma = config.gamma_shadows if graph.shadows and config.gamma_shadows is not None else config.gamma
    parent, size = np.arange(pixels, dtype=np.uint32), np.ones(pixels, np.int32)
    merging.merge(weights, order, offsets, float(gamma), parent, size, np.full(pixels, gamma, np.float64))
    merging.absorb_small(weights, order, offsets, config.min_size_px2 * pixels / VGA_PX2, parent, size)
    labels = np.empty(pixels, np.int32)
    count = merging.number_regions(parent, np.full(pixels, -1, np.int32), labels)
    return Regions(labels.reshape(height, width), int(count))


def edge_order(weights: npt.NDArray[np.float32]) -> npt.NDArray[np.uint32]:
    """Edge numbers (E,) sorted by weight, equal weights by number. Weights must not be negative or NaN."""
    order = np.arange(weights.size, dtype=np.uint32)
    sorting.sort_edges((weights + np.float32(0)).view(np.uint32), order, np.empty_like(order))
    return order
