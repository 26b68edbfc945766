"""Presets (named configurations): SHELF, TABLE and CLUTTER of the paper, and OBJECTS for all other data.

SHELF, TABLE and CLUTTER use the values that the paper prints for its three data sets. Values that the paper does not
print come from the code that its authors published, or are our choice. The preset OBJECTS uses our additions to the
paper's method. The values of OBJECTS are fitted to real frames of several sensors. OBJECTS is the newest of the
versions OBJECTS_1, OBJECTS_2 and so on. The values of a numbered version, such as OBJECTS_1, never change.
"""

from __future__ import annotations

from pathlib import Path

from spigolo.errors import ConfigError
from spigolo.settings.additions import Additions, DepthContours, Merging, Refinement
from spigolo.settings.config import Config
from spigolo.settings.joining import Cap, Joining, Smooth, Vessel
from spigolo.settings.paper import (
    BoundaryCost,
    DepthConfig,
    EdgesConfig,
    Inpainting,
    Partition,
    Rejection,
    SaliencyCost,
    Smoothing,
)
from spigolo.settings.parameters import parse_toml
from spigolo.settings.rules import Ledge, Rim, Rules, Wall
from spigolo.settings.support import Facing, Flats, Packing, Support

_RELEASE = Rejection(max_distance_m=1.8, max_lambda1_px2=3800.0, max_lambda2_px2=950.0, max_eccentricity=0.978)

SHELF = Config(
    name="SHELF",
    cost=SaliencyCost(k_x=1.05, k_y=1.5, k_s=0.5),
    partition=Partition(gamma=5.0),
    rejection=_RELEASE.replace(max_missing=0.3, max_dark=0.3),
)
"""Preset for the data set Rutgers APC, which shows shelves in low light with large shadows (paper, section IV-A)."""

TABLE = Config(
    name="TABLE",
    depth=DepthConfig(inpainting=Inpainting()),
    cost=BoundaryCost(k_x=7.5, k_b=0.66),
    partition=Partition(gamma=0.0016),
    rejection=_RELEASE,
)
"""Preset for the data set RGB-D Scenes, which shows table-tops with little missing depth (paper, section IV-B)."""

CLUTTER = Config(
    name="CLUTTER",
    depth=DepthConfig(inpainting=Inpainting()),
    cost=BoundaryCost(k_x=1.2, k_b=0.05),
    partition=Partition(gamma=0.001),
    rejection=_RELEASE,
)
"""Preset for clutter with several objects of the same kind (paper, section IV-C)."""

OBJECTS_1 = Config(
    name="OBJECTS_1",
    depth=DepthConfig(smoothing=Smoothing(max_radius_px=5, step_factor=7.5), inpainting=Inpainting()),
    edges=EdgesConfig(step_offset_px=5, step_m=0.025, contact_low_deg=35.0, contact_high_deg=146.0, blur_px=9),
    cost=BoundaryCost(k_x=2.0, k_b=0.66),
    partition=Partition(gamma=0.0065),
    rejection=Rejection(max_lambda1_px2=7000.0, max_lambda2_px2=2400.0, max_eccentricity=0.98, max_missing=0.5),
    additions=Additions(
        support=Support(),
        contours=DepthContours(step_m=0.018, step_per_m=0.0083, crease_offset_px=4, crease_high_deg=144.0),
        rules=Rules(min_contour=0.65),
        noise_per_m=0.0028,
    ),
)
"""First version of the preset OBJECTS, fitted to real frames of several sensors (docs/objects.md)."""

OBJECTS_2 = OBJECTS_1.replace(
    name="OBJECTS_2",
    partition={"connectivity": 4},
    rejection={"max_distance_m": 2.5, "max_eccentricity": 0.99},
    additions={
        "support": Support(
            noise_factor=3.5,
            stacked_share=0.5,
            opaque=True,
            max_below=0.1,
            facing=Facing(),
            min_things=0.02,
            near_roi=0.5,
            within_reach=True,
        ),
        "packing": Packing(),
        "contours": {"crease_noise": 4.0, "holes_from": 0.4},
        "merging": Merging(),
        "joining": Joining(vessel=Vessel(), cap=Cap(), smooth=Smooth(), enclosed=0.85),
        "rules": Rules(
            wall=Wall(),
            ledge=Ledge(),
            rim=Rim(),
            min_contour=0.6,
            min_contour_holes=0.75,
            metric=True,
            max_length_m=0.6,
            max_width_m=0.4,
        ),
        "flats": Flats(),
        "refinement": Refinement(),
        "lengths_grow": True,
    },
)
"""Second version of the preset OBJECTS. Compared to OBJECTS_1, OBJECTS_2 also joins the parts of an object, rejects
walls, limits sizes in metres, and refines outlines by colour.
"""

OBJECTS = OBJECTS_2

PRESETS = {
    "OBJECTS": OBJECTS,
    "OBJECTS_1": OBJECTS_1,
    "OBJECTS_2": OBJECTS_2,
    "SHELF": SHELF,
    "TABLE": TABLE,
    "CLUTTER": CLUTTER,
}

SUMMARIES = {
    "OBJECTS": "for your own data: the newest of OBJECTS_1, OBJECTS_2, ...",
    "OBJECTS_1": "fitted to real frames of several sensors, with depth contours and support plane",
    "OBJECTS_2": "like OBJECTS_1, but joins the parts of objects such as cups, bowls and boxes",
    "SHELF": "the paper's preset for Rutgers APC: shelves, low light, large shadows (first cost function)",
    "TABLE": "the paper's preset for RGB-D Scenes: table-tops, nearly full depth (second cost function)",
    "CLUTTER": "the paper's preset for several instances of an object in clutter (second cost function)",
}


WHOLE = {"depth", "color", "edges", "cost", "partition", "rejection"}
"""Names of the TOML tables that a preset file without a line `base` must contain."""


def preset(name: str | Path) -> Config:
    """Return a preset by its name, in upper or lower case, or read a preset from a TOML file.

    A preset file may contain a line such as `base = "TABLE"`. A file with the line `base` contains only the values that
    differ from the named preset. The value "none" switches a rule off. A file without a line `base` contains all
    fields, as written by `Config.to_toml`. Raises ConfigError for an unknown name or key.
    """
    if str(name).upper() in PRESETS:
        return PRESETS[str(name).upper()]
    path = Path(name)
    if path.suffix.lower() != ".toml":
        raise ConfigError(f"unknown preset {str(name)!r}: expected one of {', '.join(PRESETS)} or a .toml file")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "the file is not text"
        raise ConfigError(f"expected a preset in {path}, but the file cannot be read: {reason}") from None
    try:
        return from_toml(text, path.stem)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None


def from_toml(text: str, name: str = "mine") -> Config:
    """Read a preset from TOML text, as written by `Config.to_toml`. Raises ConfigError for an unknown key or base.

    name: name of the preset if the text contains no name.
    """
    values = parse_toml(text)
    values.setdefault("name", name)
    base = values.pop("base", None)
    if base is not None:
        return _base(base).replace(**values)
    config = Config(**values)
    if not values.keys() >= WHOLE:
        raise ConfigError(
            'expected base = "OBJECTS" (or another preset) as the first line of a file that does not set all'
            " parameters: add the line"
        )
    return config


def _base(name: object) -> Config:
    if str(name).upper() not in PRESETS:
        raise ConfigError(f"unknown preset {str(name)!r} as base: expected one of {', '.join(PRESETS)}")
    return PRESETS[str(name).upper()]
