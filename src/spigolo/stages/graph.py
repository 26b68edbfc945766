"""Pixel grid and its edge weights (eqs. 4, 9, 22, 23).

Edges are stored as planes. Plane p holds at (y, x) the weight from that pixel to its neighbour at OFFSETS[p]. Edges are
numbered plane by plane, rows first. Edges that leave the image have the weight +inf.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import DepthMap
from spigolo.kernels import costs as kernel
from spigolo.settings.config import Config
from spigolo.stages.color import Points
from spigolo.stages.costs import COSTS, PixelCost
from spigolo.stages.cues import Cues

OFFSETS = ((0, 1), (1, 0), (1, 1), (-1, 1))
"""Offsets (dy, dx) of the planes: right, down, down-right, up-right. A 4-connected grid has only the first two."""


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Weighted pixel grid of a frame."""

    weights: npt.NDArray[np.float32]
    """Weights (P, H, W), with P = 2 planes for a 4-connected grid and 4 for an 8-connected one. Smaller: more alike."""


@stage("weights")
def weigh(cues: Cues, color: Points, cost: PixelCost, config: Config, noise_per_m: float = 0.0) -> Graph:
    """Compute the weighted graph of a frame with a cost function.

    color: points of eq. 4, (3, H, W). noise_per_m: depth differences up to this value times the squared distance count
    as zero, 1/m (our addition, 0 in the paper).
    """
    weights = np.empty((config.partition.connectivity // 2, *cues.depth.shape), np.float32)
    scale = depth_scale(cues.depth, config.depth.depth_range)
    function = COSTS[type(cost)]
    cue = cues.delta_bound if function.reads == "boundary" else cues.delta_sal
    ends = kernel.ENDS_I if cost.ends == "i" else kernel.ENDS_MAX
    for plane, (dy, dx) in zip(weights, OFFSETS, strict=False):
        function.plane(color, cues.depth, cue, scale, noise_per_m, *function.weights(cost), ends, dy, dx, plane)
    return Graph(weights)


def depth_scale(depth: DepthMap, depth_range: float | None) -> float:
    """Return 1 / range for eq. 9, from the frame's valid depths or from a fixed range in metres. 0 if all depths are
    equal.
    """
    if depth_range is not None:
        return 1.0 / depth_range
    nearest, farthest, _, _ = cv2.minMaxLoc(depth, (depth > 0).view(np.uint8))  # 0, 0 if none is valid
    return 1.0 / (farthest - nearest) if farthest > nearest else 0.0
