"""Graph of neighbouring pixels and its edge weights (equations 4, 9, 22, 23).

Edge weights are stored in arrays (H, W) that are called planes, one for each direction. Plane p contains at (y, x) the
weight of the edge from pixel (y, x) to the neighbour at the offset OFFSETS[p]. Graph edges are numbered plane by plane,
and row by row inside each plane. Edges that leave the image have the weight +inf.
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
"""Offsets (dy, dx) from a pixel to its neighbours: right, down, down-right, up-right. With 4-connectivity, only the
offsets right and down are used.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Graph of the pixels of a frame, with weighted edges between neighbouring pixels."""

    weights: npt.NDArray[np.float32]
    """Edge weights (P, H, W), with P = 2 for 4-connectivity and P = 4 for 8-connectivity. An edge with a smaller weight
    connects pixels that are more alike.
    """


@stage("weights")
def weigh(cues: Cues, color: Points, cost: PixelCost, config: Config, noise_per_m: float = 0.0) -> Graph:
    """Compute the edge weights of a frame with a cost function.

    - color: colours as points (3, H, W), as returned by `color_points`.
    - noise_per_m: depth noise divided by the squared depth, 1/m. The noise is subtracted from depth differences (our
      addition). In the paper, the subtracted noise is 0.
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
    """Return 1 / depth range for equation 9, in 1/m, or 0 if all depths are equal.

    - depth: depth map (H, W) in metres.
    - depth_range: depth range in metres, or None for the range of the valid depths.
    """
    if depth_range is not None:
        return 1.0 / depth_range
    nearest, farthest, _, _ = cv2.minMaxLoc(depth, (depth > 0).view(np.uint8))  # both depths are 0 if no depth is valid
    return 1.0 / (farthest - nearest) if farthest > nearest else 0.0
