"""The pixel grid and its weights (eqs. 4, 9, 22, 23).

Edges are kept as planes: plane p holds, at (y, x), the weight from that pixel to the one at OFFSETS[p]. The number of
an edge counts plane by plane, rows first. Edges that leave the image weigh +inf.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import DepthMap
from spigolo.kernels import costs
from spigolo.settings.config import BoundaryCost, Depth, SaliencyCost
from spigolo.stages.color import Points
from spigolo.stages.cues import Cues

Plane = npt.NDArray[np.float32]

OFFSETS = ((0, 1), (1, 0), (1, 1), (-1, 1))
"""(dy, dx) of the planes: right, down, down-right, up-right; a 4-connected grid has the first two."""


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """weights (P, H, W) float32: P = 2 planes for a 4-connected grid, 4 for an 8-connected one. Smaller = more alike.

    shadows: the weights are those of the first cost function (eq. 22).
    """

    weights: npt.NDArray[np.float32]
    shadows: bool = False


def weigh(cues: Cues, color: Points, connectivity: int, config: Depth) -> Graph:
    """The graph of a frame, weighed by `cues.cost`.

    color: the points of eq. 4 (3, H, W). `depth_range` and `noise_per_m` of the config shape eq. 9.
    """
    weights = np.empty((connectivity // 2, *cues.depth.shape), np.float32)
    scale = depth_scale(cues.depth, config.depth_range)
    for plane, offset in zip(weights, OFFSETS, strict=False):
        _weigh_plane(cues, color, scale, config.noise_per_m, offset, plane)
    return Graph(weights, shadows=isinstance(cues.cost, SaliencyCost))


def depth_scale(depth: DepthMap, depth_range: float | None) -> float:
    """1 / range of eq. 9: of the valid depths of the frame, or of a fixed range in metres. 0 where no depth differs."""
    if depth_range is not None:
        return 1.0 / depth_range
    nearest, farthest, _, _ = cv2.minMaxLoc(depth, (depth > 0).view(np.uint8))  # 0, 0 where none is valid
    return 1.0 / (farthest - nearest) if farthest > nearest else 0.0


def _weigh_plane(cues: Cues, color: Points, scale: float, noise: float, offset: tuple[int, int], out: Plane) -> None:
    cost = cues.cost
    ends = costs.ENDS_I if cost.ends == "i" else costs.ENDS_MAX
    if isinstance(cost, BoundaryCost):
        costs.boundary_plane(color, cues.depth, cues.delta_bound, scale, noise, cost.k_x, cost.k_b, ends, *offset, out)
    else:
        costs.saliency_plane(
            color, cues.depth, cues.delta_sal, scale, noise, cost.k_x, cost.k_y, cost.k_s, ends, *offset, out
        )
