"""Parameters of the method. Each stage of the method has one model class with its parameters. Each parameter has a
documented unit, range and origin.
"""

from __future__ import annotations

from spigolo.settings.additions import Additions, DepthContours, Merging, Refinement
from spigolo.settings.config import Config
from spigolo.settings.joining import Cap, Joining, Smooth, Vessel
from spigolo.settings.paper import (
    AutoCost,
    BoundaryCost,
    ColorConfig,
    DepthConfig,
    EdgesConfig,
    Inpainting,
    Partition,
    Rejection,
    SaliencyConfig,
    SaliencyCost,
    Smoothing,
)
from spigolo.settings.parameters import Parameters, Settings
from spigolo.settings.rules import Ledge, Rim, Rules, Wall
from spigolo.settings.support import Facing, Flats, Packing, Support

__all__ = [
    "Additions",
    "AutoCost",
    "BoundaryCost",
    "Cap",
    "ColorConfig",
    "Config",
    "DepthConfig",
    "DepthContours",
    "EdgesConfig",
    "Facing",
    "Flats",
    "Inpainting",
    "Joining",
    "Ledge",
    "Merging",
    "Packing",
    "Parameters",
    "Partition",
    "Refinement",
    "Rejection",
    "Rim",
    "Rules",
    "SaliencyConfig",
    "SaliencyCost",
    "Settings",
    "Smooth",
    "Smoothing",
    "Support",
    "Vessel",
    "Wall",
]
