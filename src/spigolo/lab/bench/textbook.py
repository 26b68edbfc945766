"""Reference implementation of graph-based segmentation: a stable sort of all graph edges, then union-find.

The function `regions.partition` must give the same regions as this reference implementation.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from spigolo.stages.graph import OFFSETS, Graph


def sort_and_merge(graph: Graph, gamma: float) -> npt.NDArray[np.int32]:
    """Segment a graph with equations 2 and 3 of the paper (Toscana & Rosa 2016).

    Return region labels (H, W). Regions are numbered from 0 in the order of their first pixels.
    """
    planes, height, width = graph.weights.shape
    flat = graph.weights.reshape(-1)
    order = np.argsort(flat, kind="stable")
    steps = np.array([dy * width + dx for dy, dx in OFFSETS[:planes]], np.int64)
    labels = np.empty(height * width, np.int32)
    _merge(flat, order, steps, gamma, labels)
    return labels.reshape(height, width)


@numba.njit(nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _find(parent: Any, node: int) -> Any:
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@numba.njit(nogil=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _merge(weights: Any, order: Any, steps: Any, gamma: float, labels: Any) -> None:
    """Merge pixels along the graph edges in the given order. Edges with an infinite weight are ignored."""
    pixels = labels.size
    parent, size = np.arange(pixels, dtype=np.int32), np.ones(pixels, np.int32)
    bound = np.full(pixels, gamma)
    for edge in order:
        weight = weights[edge]
        if np.isinf(weight):
            break
        pixel = edge % pixels
        a, b = _find(parent, pixel), _find(parent, pixel + steps[edge // pixels])
        if a != b and weight <= bound[a] and weight <= bound[b]:
            if size[a] < size[b]:
                a, b = b, a
            parent[b] = a
            size[a] += size[b]
            bound[a] = weight + gamma / size[a]
    count = 0
    number = np.full(pixels, -1, np.int32)
    for pixel in range(pixels):
        root = _find(parent, pixel)
        if number[root] < 0:
            number[root] = count
            count += 1
        labels[pixel] = number[root]
