"""The cues of every pixel beside its colour: depth, and saliency or boundary (eqs. 11, 21).

The cost function decides what is needed: the first one reads saliency, the second one the boundary.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.additions.support import Plane, find_support, foot_contour
from spigolo.frames.frame import DepthMap, Frame
from spigolo.settings.config import AutoCost, BoundaryCost, Config, SaliencyCost
from spigolo.stages.depth import missing_share, prepare_depth
from spigolo.stages.edges import EdgeMaps, find_edges
from spigolo.stages.saliency import saliency_cue


@dataclass(frozen=True, slots=True, eq=False)
class Cues:
    """What the graph is weighed by; every map is (H, W).

    depth: D_s in metres, 0 where missing. missing: share of the frame without depth inside the working range, None
    where no AutoCost asks. cost: the function this frame is weighed by, AutoCost resolved. saliency: for SaliencyCost,
    else None. edges: for BoundaryCost, else None. support: the plane that objects stand on, where the rejection asks
    for it and there is one.
    """

    depth: DepthMap
    missing: float | None
    cost: SaliencyCost | BoundaryCost
    saliency: npt.NDArray[np.float32] | None
    edges: EdgeMaps | None
    support: Plane | None = None

    @property
    def delta_sal(self) -> npt.NDArray[np.float32]:
        """Eq. 11. delta_sal of each pixel: the power-law saliency there."""
        assert self.saliency is not None
        return self.saliency

    @property
    def delta_bound(self) -> npt.NDArray[np.float32]:
        """Eq. 21. delta_bound of each pixel: the final boundary map there, soft or thin."""
        assert self.edges is not None
        return self.edges.boundary


def gather_cues(frame: Frame, config: Config) -> Cues:
    """All cues that the frame's cost function reads."""
    depth = prepare_depth(frame.depth, config.depth)
    missing, cost = None, config.cost
    if isinstance(cost, AutoCost):
        missing = missing_share(depth, config.rejection.max_distance_m)
        cost = cost.choose(missing)
    rule = config.rejection.support
    camera = frame.camera
    support = None if rule is None or camera is None else find_support(frame.depth, camera, rule)
    return Cues(
        depth=depth,
        missing=missing,
        cost=cost,
        support=support,
        saliency=saliency_cue(frame.color, config.saliency) if isinstance(cost, SaliencyCost) else None,
        edges=_edges(frame, depth, support, config) if isinstance(cost, BoundaryCost) else None,
    )


def _edges(frame: Frame, depth: DepthMap, support: Plane | None, config: Config) -> EdgeMaps:
    rule = config.rejection.support
    foot = None
    if support is not None and rule is not None and rule.contour and frame.camera is not None:
        foot = foot_contour(support, depth, frame.camera, rule)
    return find_edges(frame.color, depth, frame.camera, config.edges, foot)
