"""Search spaces: the parameters to fit for each method, with their ranges.

A search space is a dictionary from dotted parameter names to ranges, choices and switches. A switch turns an optional
stage on or off. If a switch turns a stage of the method off, the parameters of this stage are ignored.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from spigolo.errors import ConfigError
from spigolo.methods import METHODS, Method, Toscana2016
from spigolo.settings.additions import Additions
from spigolo.settings.config import Config
from spigolo.settings.paper import BoundaryCost, SaliencyCost

Setting = dict[str, Any]
"""Parameter values, indexed by dotted parameter name. `Method.replace` accepts a dictionary of this type."""


@dataclass(frozen=True, slots=True)
class Range:
    """Range of a number from `low` to `high`.

    If both limits of the range are integers, only integers are drawn.
    """

    low: float
    high: float
    log: bool = False
    """True to draw the number from a log-uniform distribution."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Choice of one value from several options."""

    options: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Switch:
    """Switch that turns an optional stage on or off."""

    on: Mapping[str, Any] = field(default_factory=dict)
    """Parameter values of the optional stage if it is switched on."""
    needs: str = ""
    """Name of another switch that must also be on. The name is empty if no other switch is required."""


Space = Mapping[str, Range | Choice | Switch]

SUPPORT, CONTOURS, JOINING = "additions.support", "additions.contours", "additions.joining"

REJECTED: Space = {
    "additions.support.min_height_m": Range(0.006, 0.012),
    "additions.support.stacked_share": Range(0.3, 0.8),
    "rejection.max_eccentricity": Range(0.975, 0.99),
}
"""Parameters of the rules that reject regions. All segmentation methods share the rules that reject regions."""

OPTIONAL: Mapping[str, Space] = {
    "additions.merging": {"additions.merging.max_mean": Range(0.2, 0.6)},
    "additions.refinement": {
        "additions.refinement.ramp_factor": Range(3.0, 8.0),
        "additions.refinement.hole_width_px": Range(10, 30),
        "additions.refinement.step_weight": Range(20.0, 80.0, log=True),
    },
    "additions.rules.wall": {
        "additions.rules.wall.min_hides": Range(0.08, 0.25),
        "additions.rules.wall.slant_deg": Range(30.0, 50.0),
    },
    "additions.rules.ledge": {"additions.rules.ledge.min_share": Range(0.35, 0.7)},
    "additions.flats": {
        "additions.flats.min_height_m": Range(0.004, 0.008),
        "additions.flats.min_ring": Range(0.85, 0.98),
    },
}
"""Parameters of optional stages, indexed by the stage's name.

Parameters of a stage are fitted only if the preset has this stage.
"""

IN_PIXELS: Space = {
    "rejection.max_lambda1_px2": Range(3000.0, 12000.0, log=True),
    "rejection.max_lambda2_px2": Range(1000.0, 4000.0, log=True),
}
IN_METRES: Space = {
    "additions.rules.max_length_m": Range(0.3, 0.6),
    "additions.rules.max_width_m": Range(0.18, 0.4),
}
"""Parameters that limit the size of objects, in metres.

If a preset has no limits in metres, the parameters in `IN_PIXELS` are fitted instead.
"""

ADDED: Space = {
    SUPPORT: Switch(),
    CONTOURS: Switch(),
    JOINING: Switch({"vessel": {}, "cap": {}, "smooth": {}, "enclosed": 0.85}, needs=SUPPORT),
}
"""Optional stages that are switched on or off at random if the preset does not have them."""

DEPTH: Space = {
    "depth.smoothing.max_radius_px": Range(4, 8),
    "depth.smoothing.step_factor": Range(6.0, 18.0, log=True),
    "additions.noise_per_m": Choice((0.0, 0.0028)),
    "partition.connectivity": Choice((4, 8)),
}

BOUNDARIES: Space = {
    "edges.contact_low_deg": Range(30.0, 56.0),
    "edges.contact_high_deg": Range(140.0, 154.0),
    "edges.blur_px": Choice((7, 9)),
    f"{CONTOURS}.step_m": Range(0.012, 0.022),
    f"{CONTOURS}.step_per_m": Range(0.006, 0.012),
    f"{CONTOURS}.crease_offset_px": Range(4, 6),
    f"{CONTOURS}.crease_high_deg": Range(138.0, 150.0),
    "additions.rules.min_contour": Range(0.3, 0.7),
}

JOINED: Space = {
    f"{JOINING}.vessel.sure_contrast": Range(0.1, 0.35),
    f"{JOINING}.vessel.sure_solidity": Range(0.65, 0.85),
    f"{JOINING}.cap.max_gap_m": Range(0.01, 0.03),
    f"{JOINING}.smooth.max_bend_m": Range(0.0, 0.002),
    f"{JOINING}.smooth.max_gap_m": Range(0.015, 0.04),
}

MERGED: Space = {
    "sigma_px": Range(0.0, 2.0),
    "k": Range(200.0, 3200.0, log=True),
    "connectivity": Choice((4, 8)),
    "min_size_px2": Range(400.0, 6000.0, log=True),
}

OTHERS: Mapping[str, Space] = {
    "felzenszwalb2004": MERGED,
    "rao2010": {**MERGED, "levels_per_m": Range(300.0, 4800.0, log=True)},
    "abramov2012": {
        "sigma_px": Range(0.0, 1.5),
        "alpha": Range(1.2, 5.0, log=True),
        "repulsion": Range(0.3, 3.0, log=True),
        "step_m": Range(0.008, 0.04, log=True),
        "step_per_m": Range(0.003, 0.015, log=True),
        "penalty": Range(5.0, 80.0, log=True),
        "piece_px2": Range(5000.0, 40000.0, log=True),
        "piece_above": Range(-5.0, -0.5),
        "min_size_px2": Range(400.0, 6000.0, log=True),
    },
    "mishra2012": {
        "blur_px": Range(0.6, 2.0),
        "gap_cost": Range(10.0, 100.0, log=True),
        "sharpness": Range(2.0, 20.0, log=True),
        "steepness": Range(3.0, 30.0, log=True),
        "step_px": Range(0.1, 0.9, log=True),
        "valley_px": Range(0.2, 1.8, log=True),
        "texture": Range(0.05, 0.4),
        "shift_px": Range(9.0, 30.0),
        "min_votes": Range(4.0, 16.0),
        "min_strong": Range(0.3, 0.8),
        "max_iou": Range(0.3, 0.7),
        "max_area": Range(0.08, 0.3),
    },
}


def space_of(method: Method) -> Space:
    """Return the search space of a method.

    Raises ConfigError for a method without a search space, or for a preset that chooses its cost function
    automatically.
    """
    if isinstance(method, Toscana2016):
        return _ours(method.config)
    if method.name not in OTHERS:
        raise ConfigError(
            f"expected a method that can be fitted, got {method.name!r}: choose from {', '.join(METHODS)}"
        )
    return {**OTHERS[method.name], **REJECTED, **IN_METRES}


def _ours(config: Config) -> Space:
    ours = config.additions or Additions()
    there = {SUPPORT: ours.support, CONTOURS: ours.contours, JOINING: ours.joining}
    added = {name: switch for name, switch in ADDED.items() if there[name] is None}
    sizes = IN_PIXELS if ours.rules.max_length_m is None else IN_METRES
    optional = {name: way for place, ways in OPTIONAL.items() if _has(config, place) for name, way in ways.items()}
    space: Space = {**added, **DEPTH, **JOINED, **REJECTED, **sizes, **optional}
    match config.cost:
        case BoundaryCost(k_b=k_b):
            unit = k_b or 1.0  # k_b is fixed, because only its ratios to k_x and gamma matter
            return {
                **space,
                **BOUNDARIES,
                "cost.k_x": Range(1.5 * unit, 12 * unit, log=True),
                "partition.gamma": Range(0.002 * unit, 0.02 * unit, log=True),
            }
        case SaliencyCost(k_x=k_x):
            unit = k_x or 1.0
            return {
                **{name: way for name, way in space.items() if name != CONTOURS},  # boundaries are not used
                "cost.k_y": Range(0.3 * unit, 3 * unit, log=True),
                "cost.k_s": Range(0.3 * unit, 3 * unit, log=True),
                "partition.gamma": Range(unit, 20 * unit, log=True),
            }
    raise ConfigError(
        f"expected a preset with one cost function, got {config.name} with kind 'auto': fit one preset for frames with"
        " large shadows and one for other frames"
    )


def _has(config: Config, place: str) -> bool:
    """Return True if a configuration has the optional stage with the dotted name `place`."""
    value: object = config
    for name in place.split("."):
        value = getattr(value, name, None)
    return value is not None


def complete(drawn: Setting, space: Space) -> Setting:
    """Replace each switch in drawn parameter values. A switch becomes the parameters of its stage, or None if the stage
    is off.
    """
    off = {name for name, way in space.items() if isinstance(way, Switch) and not drawn[name]}
    off |= {name for name, way in space.items() if isinstance(way, Switch) and way.needs in off}
    stages = {name: None if name in off else dict(way.on) for name, way in space.items() if isinstance(way, Switch)}
    numbers = {
        name: drawn[name] for name in space if name not in stages and not any(name.startswith(f"{s}.") for s in off)
    }
    return {**stages, **numbers}


def apply(setting: Setting, method: Method) -> Method:
    """Return the method with the parameter values of `setting`. Raises ConfigError for invalid values."""
    return method.replace(**setting) if setting else method
