"""Cues from which edge weights are computed: depth, and saliency or boundary (equations 11, 21).

Only the cues that the cost function reads are computed. The cost function of equation 22 reads saliency. The cost
function of equation 23 reads the boundary map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import Color, DepthMap, Mask
from spigolo.settings.config import Config
from spigolo.settings.paper import AutoCost
from spigolo.stages.costs import PixelCost, choose_cost, reads
from spigolo.stages.depth import missing_share
from spigolo.stages.edges import boundary_cue
from spigolo.stages.saliency import saliency_cue


@dataclass(frozen=True, slots=True, eq=False)
class Weighing:
    """Cost function and threshold gamma that were chosen for a frame."""

    cost: PixelCost
    """Parameters of the cost function that was chosen for the frame."""
    missing: float | None
    """Share of missing depth, as returned by `stages.depth.missing_share`. The value is None if the preset fixes the
    cost function.
    """
    gamma: float
    """Threshold gamma of equation 3 for the chosen cost function."""

    @property
    def reads_boundary(self) -> bool:
        """True if the cost function reads the boundary map."""
        return reads(self.cost, "boundary")


@dataclass(frozen=True, slots=True, eq=False)
class Cues:
    """Cues from which the edge weights are computed."""

    depth: DepthMap
    """Smoothed depth map D_s (H, W) float32 in metres, 0 where missing."""
    saliency: npt.NDArray[np.float32] | None
    """Saliency map (H, W) from 0 to 1, after a power law. The value is None if the cost function does not read
    saliency.
    """
    boundary: npt.NDArray[np.float32] | None
    """Boundary map (H, W) from 0 to 1. The value is None if the cost function does not read the boundary map."""

    @property
    def delta_sal(self) -> npt.NDArray[np.float32]:
        """Eq. 11. Return delta_sal (H, W), the saliency of each pixel after a power law."""
        assert self.saliency is not None
        return self.saliency

    @property
    def delta_bound(self) -> npt.NDArray[np.float32]:
        """Eq. 21. Return delta_bound (H, W), the boundary value of each pixel."""
        assert self.boundary is not None
        return self.boundary


def choose_weighing(depth: DepthMap, config: Config) -> Weighing:
    """Choose the cost function and the threshold gamma for a frame (paper, section III-E).

    depth: depth map (H, W) in metres, as returned by `prepare_depth`.
    """
    missing = missing_share(depth, config.rejection.max_distance_m) if isinstance(config.cost, AutoCost) else None
    cost, gamma = choose_cost(config.cost, missing), config.partition.gamma
    if config.partition.gamma_shadows is not None and not reads(cost, "boundary"):
        gamma = config.partition.gamma_shadows
    return Weighing(cost, missing, gamma)


@stage("cues")
def gather_cues(image: Color, depth: DepthMap, lines: Mask | None, weighing: Weighing, config: Config) -> Cues:
    """Compute the cues that the cost function of a frame reads.

    - image: (H, W, 3) RGB.
    - depth: depth map (H, W) in metres, as returned by `prepare_depth`.
    - lines: mask (H, W) of the boundary lines E_F, or None if the cost function does not read the boundary map.
    """
    return Cues(
        depth=depth,
        saliency=saliency_cue(image, config.saliency) if reads(weighing.cost, "saliency") else None,
        boundary=None if lines is None else boundary_cue(lines, config.edges),
    )
