"""All parameters of the method: the paper's parameters, and our additions."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from pydantic import model_validator

from spigolo.errors import ConfigError
from spigolo.settings.additions import Additions
from spigolo.settings.paper import (
    AutoCost,
    BoundaryCost,
    ColorConfig,
    Cost,
    DepthConfig,
    EdgesConfig,
    Partition,
    Rejection,
    SaliencyConfig,
)
from spigolo.settings.parameters import Parameters, Settings, parse_toml


class Config(Parameters):
    """All parameters of the method. Instances are frozen, and `replace` returns a changed copy."""

    name: str = "custom"
    """Name of the preset. `replace` keeps the name, but `digest` changes with the values."""
    depth: DepthConfig = DepthConfig()
    """Preparation and comparison of depth (eqs. 5-9)."""
    color: ColorConfig = ColorConfig()
    """Colour difference (eq. 4)."""
    saliency: SaliencyConfig = SaliencyConfig()
    """Saliency map (eq. 10), which only some cost functions use."""
    edges: EdgesConfig = EdgesConfig()
    """Object boundaries (eqs. 12-20), which only some cost functions use."""
    cost: Cost = BoundaryCost()
    """Weight of a graph edge (eqs. 22, 23)."""
    partition: Partition = Partition()
    """Merging of pixels into regions (eqs. 2, 3)."""
    rejection: Rejection = Rejection()
    """Rejection of regions (section III-F)."""
    additions: Additions | None = None
    """Our additions to the paper. If None, the method is the paper's."""

    @model_validator(mode="after")
    def _gamma_of_each_cost(self) -> Config:
        if isinstance(self.cost, AutoCost) != (self.partition.gamma_shadows is not None):
            raise ValueError(
                "partition.gamma_shadows is required with an AutoCost, and must be None with any other cost"
            )
        return self

    def at_size(self, shape: tuple[int, int], lengths: bool = False) -> Config:
        """Return a copy with lengths and areas in pixels scaled to images of shape (H, W). Lengths that are not marked
        with `Grows.always` are scaled only if `additions.lengths_grow` is set.
        """
        return super().at_size(shape, lengths or (self.additions is not None and self.additions.lengths_grow))

    def to_toml(self, base: str | None = None) -> str:
        """Return the parameter values as TOML text that `from_toml` reads.

        base: name of a preset. With `base`, the text has a line `base` and only the values that differ from that
        preset.
        """
        import tomli_w

        if base is None:
            return tomli_w.dumps(_written(self))
        start = base_preset(base)
        differing = _changes(start.model_dump(exclude={"name"}), self.model_dump(exclude={"name"}))
        named = {} if self.name in (start.name, base) else {"name": self.name}
        return tomli_w.dumps({"base": base.upper(), **named, **differing})

    @classmethod
    def from_toml(cls, text: str, base: Config | None = None) -> Config:
        """Read TOML text as written by `to_toml`. Raises ConfigError for unknown keys.

        base: the configuration that the text changes. A line `base = "TABLE"` in the text takes precedence and names a
        preset. Without a base, missing keys get their default values.
        """
        values = parse_toml(text)
        named = values.pop("base", None)
        start = base if named is None else base_preset(named)
        return cls(**values) if start is None else start.replace(**values)


def _changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of `new` that differ from the values in `old`, as nested dicts. The string "none" stands for
    None.
    """
    changes: dict[str, Any] = {}
    for key, value in new.items():
        before = old.get(key)
        if value == before:
            continue
        if isinstance(value, Mapping) and isinstance(before, Mapping) and value.get("kind") == before.get("kind"):
            changes[key] = _changes(before, value)
        elif isinstance(value, Mapping):
            changes[key] = _changes({}, value)
        else:
            changes[key] = "none" if value is None else value
    return changes


def _written(stage: Settings) -> dict[str, Any]:
    """Return the values of a stage, indexed by field name. TOML has no null, so None becomes the string "none". A field
    is left out if both its value and its default are None.
    """
    values: dict[str, Any] = {}
    for name, field in type(stage).model_fields.items():
        value = getattr(stage, name)
        if isinstance(value, Settings):
            values[name] = _written(value)
        elif value is not None or field.default is not None:
            values[name] = "none" if value is None else value
    return values


BASES: dict[str, Config] = {}
"""Presets, indexed by name, which the line `base` of a preset file can name. The module `presets` fills this dict."""


def base_preset(name: object) -> Config:
    """Return the preset that the line `base` of a preset file names. Raises ConfigError with the valid names for an
    unknown name.
    """
    importlib.import_module("spigolo.settings.presets")  # `presets` imports this module and fills BASES
    if str(name).upper() not in BASES:
        raise ConfigError(f"unknown preset {str(name)!r} as base: expected one of {', '.join(BASES)}")
    return BASES[str(name).upper()]


def check_config(value: object) -> None:
    """Raise ConfigError if a value is not a configuration, for example a preset's name."""
    if not isinstance(value, Config):
        raise ConfigError(f"expected a Config such as spigolo.TABLE or spigolo.preset(NAME), got {value!r}")
