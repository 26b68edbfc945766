"""All parameters of the method: the paper's parameters, and our additions."""

from __future__ import annotations

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
from spigolo.settings.parameters import Parameters, Settings


class Config(Parameters):
    """All parameters of the method. Instances are frozen, and `replace` returns a changed copy."""

    name: str = "custom"
    """Name of the preset. A copy made with `Config.replace` keeps the name, but has another hash (`digest`)."""
    depth: DepthConfig = DepthConfig()
    """Smoothing, in-painting and comparison of depth (equations 5-9)."""
    color: ColorConfig = ColorConfig()
    """Colour difference between neighbouring pixels (equation 4)."""
    saliency: SaliencyConfig = SaliencyConfig()
    """Saliency map (equation 10). Only the first cost function (equation 22) uses the saliency map."""
    edges: EdgesConfig = EdgesConfig()
    """Boundaries of objects (equations 12-20). Only the second cost function (equation 23) uses the boundaries of
    objects.
    """
    cost: Cost = BoundaryCost()
    """Cost function, which computes the weight of a graph edge (equations 22 and 23)."""
    partition: Partition = Partition()
    """Merging of pixels into regions (equations 2 and 3)."""
    rejection: Rejection = Rejection()
    """Rules that reject regions (paper, section III-F)."""
    additions: Additions | None = None
    """Our additions to the paper. If None, only the method of the paper is used."""

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

    def to_toml(self, base: Config | None = None) -> str:
        """Return the parameter values as TOML text that `spigolo.preset` reads from a file.

        base: one of the presets. With `base`, the text contains a line with the name of this preset, and only the
        values that differ from the preset.
        """
        import tomli_w

        if base is None:
            return tomli_w.dumps(_written(self))
        differing = _changes(base.model_dump(exclude={"name"}), self.model_dump(exclude={"name"}))
        named = {} if self.name == base.name else {"name": self.name}
        return tomli_w.dumps({"base": base.name, **named, **differing})


def _changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of `new` that differ from the values in `old`, as nested dicts. In the returned dicts, the
    value None is replaced by the string "none".
    """
    changes: dict[str, Any] = {}
    for key, value in new.items():
        before = old.get(key)
        if key in old and value == before:
            continue
        if isinstance(value, Mapping) and isinstance(before, Mapping) and value.get("kind") == before.get("kind"):
            changes[key] = _changes(before, value)
        elif isinstance(value, Mapping):
            changes[key] = _changes({}, value)
        else:
            changes[key] = "none" if value is None else value
    return changes


def _written(stage: Settings) -> dict[str, Any]:
    """Return the parameter values of a stage as a dict, indexed by field name. TOML has no null, so None becomes the
    string "none". A field is left out if both its value and its default are None.
    """
    values: dict[str, Any] = {}
    for name, field in type(stage).model_fields.items():
        value = getattr(stage, name)
        if isinstance(value, Settings):
            values[name] = _written(value)
        elif value is not None or field.default is not None:
            values[name] = "none" if value is None else value
    return values


def check_config(value: object) -> None:
    """Raise ConfigError if a value is not a `Config`, for example if it is the name of a preset."""
    if not isinstance(value, Config):
        raise ConfigError(f"expected a Config such as spigolo.TABLE or spigolo.preset(NAME), got {value!r}")
