"""Cost functions. Each names the cue that it reads and the kernel that computes a plane of edge weights (eqs. 22, 23).

To add one, write its parameters as a model in `settings.paper`, its kernel in `kernels.costs`, and its entry in COSTS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from spigolo.kernels import costs as kernel
from spigolo.settings.paper import AutoCost, BoundaryCost, Cost, SaliencyCost

PixelCost = SaliencyCost | BoundaryCost
"""Cost function of a single frame. AutoCost is already resolved to one of these."""

Reads = Literal["saliency", "boundary"]


@dataclass(frozen=True, slots=True)
class CostFunction:
    """Description of a cost function for the graph."""

    reads: Reads
    """Name of the cue that it reads in addition to colour and depth."""
    plane: Callable[..., None]
    """Kernel (color, depth, cue, scale, noise, *weights, ends, dy, dx, out) that computes a plane of edge weights."""
    weights: Callable[[Any], tuple[float, ...]]
    """Function that returns the weights of a cost model, in the kernel's order."""


COSTS: Mapping[type, CostFunction] = {
    SaliencyCost: CostFunction("saliency", kernel.saliency_plane, lambda cost: (cost.k_x, cost.k_y, cost.k_s)),
    BoundaryCost: CostFunction("boundary", kernel.boundary_plane, lambda cost: (cost.k_x, cost.k_b)),
}


def reads(cost: PixelCost, cue: Reads) -> bool:
    """Return True if a cost function reads the cue."""
    return COSTS[type(cost)].reads == cue


def possible_costs(cost: Cost) -> tuple[PixelCost, ...]:
    """Return the cost functions that may be used for a frame."""
    return (cost.full, cost.shadows) if isinstance(cost, AutoCost) else (cost,)


def choose_cost(cost: Cost, missing: float | None) -> PixelCost:
    """Return the cost function for a frame. missing: share of missing depth within the working range."""
    if not isinstance(cost, AutoCost):
        return cost
    return cost.full if missing is not None and missing <= cost.max_missing else cost.shadows
