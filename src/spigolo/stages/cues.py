"""Cues of every pixel in addition to its colour: depth, and saliency or boundary (eqs. 11, 21).

The cost function decides which cues are computed. The first cost function reads saliency, the second one the boundary.
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
    """Cost function and gamma that were chosen for a frame."""

    cost: PixelCost
    """Cost function, with AutoCost resolved."""
    missing: float | None
    """Share of the frame without depth within the working range. None without AutoCost."""
    gamma: float
    """Threshold gamma of eq. 3 for this cost function."""

    @property
    def reads_boundary(self) -> bool:
        """True if the cost function reads the boundary map."""
        return reads(self.cost, "boundary")


@dataclass(frozen=True, slots=True, eq=False)
class Cues:
    """Cues from which the edge weights are computed."""

    depth: DepthMap
    """Smoothed depth D_s (H, W) float32 in metres, 0 where missing."""
    saliency: npt.NDArray[np.float32] | None
    """Power-law saliency (H, W) in [0, 1]. None if the cost function does not read it."""
    boundary: npt.NDArray[np.float32] | None
    """Boundary map (H, W) in [0, 1]. None if the cost function does not read it."""

    @property
    def delta_sal(self) -> npt.NDArray[np.float32]:
        """Eq. 11. Return delta_sal (H, W), the power-law saliency of each pixel."""
        assert self.saliency is not None
        return self.saliency

    @property
    def delta_bound(self) -> npt.NDArray[np.float32]:
        """Eq. 21. Return delta_bound (H, W), the boundary value of each pixel."""
        assert self.boundary is not None
        return self.boundary


def choose_weighing(depth: DepthMap, config: Config) -> Weighing:
    """Choose the cost function and gamma for a frame with prepared depth (H, W) (section III-E)."""
    missing = missing_share(depth, config.rejection.max_distance_m) if isinstance(config.cost, AutoCost) else None
    cost, gamma = choose_cost(config.cost, missing), config.partition.gamma
    if config.partition.gamma_shadows is not None and not reads(cost, "boundary"):
        gamma = config.partition.gamma_shadows
    return Weighing(cost, missing, gamma)


@stage("cues")
def gather_cues(image: Color, depth: DepthMap, lines: Mask | None, weighing: Weighing, config: Config) -> Cues:
    """Compute the cues that the frame's cost function reads.

    image: (H, W, 3) RGB. depth: (H, W) prepared, in metres. lines: (H, W), the lines of E_F, for a cost function that
    reads the boundary.
    """
    return Cues(
        depth=depth,
        saliency=saliency_cue(image, config.saliency) if reads(weighing.cost, "saliency") else None,
        boundary=None if lines is None else boundary_cue(lines, config.edges),
    )
