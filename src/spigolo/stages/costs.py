"""Cost functions, which compute edge weights from the cues (equations 22, 23).

To add a cost function, add a class of parameters to `settings.paper`, a kernel to `kernels.costs`, and an entry to
COSTS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from spigolo.kernels import costs as kernel
from spigolo.settings.paper import AutoCost, BoundaryCost, Cost, SaliencyCost

PixelCost = SaliencyCost | BoundaryCost
"""Parameters of a cost function that can be used for a frame. AutoCost chooses SaliencyCost or BoundaryCost for each
frame.
"""

Reads = Literal["saliency", "boundary"]


@dataclass(frozen=True, slots=True)
class CostFunction:
    """Description of a cost function: its cue, its kernel and its weights."""

    reads: Reads
    """Name of the cue that the cost function reads in addition to colour and depth."""
    plane: Callable[..., None]
    """Kernel (color, depth, cue, scale, noise, *weights, ends, dy, dx, out) that computes the weights of all edges in
    one direction.
    """
    weights: Callable[[Any], tuple[float, ...]]
    """Function that returns the weights of the cues, such as k_x and k_b, in the order of the kernel's arguments."""


COSTS: Mapping[type, CostFunction] = {
    SaliencyCost: CostFunction("saliency", kernel.saliency_plane, lambda cost: (cost.k_x, cost.k_y, cost.k_s)),
    BoundaryCost: CostFunction("boundary", kernel.boundary_plane, lambda cost: (cost.k_x, cost.k_b)),
}


def reads(cost: PixelCost, cue: Reads) -> bool:
    """Return True if a cost function reads a cue."""
    return COSTS[type(cost)].reads == cue


def possible_costs(cost: Cost) -> tuple[PixelCost, ...]:
    """Return the cost functions that can be chosen for a frame: two for AutoCost, and one for any other cost
    function.
    """
    return (cost.full, cost.shadows) if isinstance(cost, AutoCost) else (cost,)


def choose_cost(cost: Cost, missing: float | None) -> PixelCost:
    """Return the cost function for a frame.

    missing: share of missing depth, as returned by `stages.depth.missing_share`.
    """
    if not isinstance(cost, AutoCost):
        return cost
    return cost.full if missing is not None and missing <= cost.max_missing else cost.shadows
