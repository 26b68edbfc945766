"""The cost functions: each names the cue that it reads and the kernel that weighs a plane of edges (eqs. 22, 23).

To add one: write its numbers as a model in `settings.paper`, its kernel in `kernels.costs`, and its entry in COSTS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from spigolo.kernels import costs as kernel
from spigolo.settings.paper import AutoCost, BoundaryCost, Cost, SaliencyCost

PixelCost = SaliencyCost | BoundaryCost
"""A cost function that weighs a frame, AutoCost resolved."""

Reads = Literal["saliency", "boundary"]


@dataclass(frozen=True, slots=True)
class CostFunction:
    """A cost function as the graph needs it."""

    reads: Reads
    """The cue of single pixels that it reads next to colour and depth."""
    plane: Callable[..., None]
    """The kernel (color, depth, cue, scale, noise, *weights, ends, dy, dx, out) that weighs a plane of edges."""
    weights: Callable[[Any], tuple[float, ...]]
    """The numbers of its model, in the kernel's order."""


COSTS: Mapping[type, CostFunction] = {
    SaliencyCost: CostFunction("saliency", kernel.saliency_plane, lambda cost: (cost.k_x, cost.k_y, cost.k_s)),
    BoundaryCost: CostFunction("boundary", kernel.boundary_plane, lambda cost: (cost.k_x, cost.k_b)),
}


def reads(cost: PixelCost, cue: Reads) -> bool:
    """Return whether a cost function reads a cue."""
    return COSTS[type(cost)].reads == cue


def possible_costs(cost: Cost) -> tuple[PixelCost, ...]:
    """Return the cost functions that a frame may be weighed by."""
    return (cost.full, cost.shadows) if isinstance(cost, AutoCost) else (cost,)


def choose_cost(cost: Cost, missing: float | None) -> PixelCost:
    """Return the cost function of a frame whose share `missing` lacks depth within the working range."""
    if not isinstance(cost, AutoCost):
        return cost
    return cost.full if missing is not None and missing <= cost.max_missing else cost.shadows
