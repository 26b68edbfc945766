"""Values of all controls on the tuning page."""

from __future__ import annotations

from typing import Any

from spigolo.errors import ConfigError
from spigolo.settings.config import Config
from spigolo.settings.presets import PRESETS
from spigolo.view.tuning_fields import Leaf, Part, Stage, Variants, controls_of, first_value, value_at, walk

SHOWN = ("OBJECTS", "SHELF", "TABLE", "CLUTTER")
"""Names of the presets that can be selected on the page."""


class Values:
    """Values of all controls on the tuning page, indexed by key. The value of a control does not change while its rule
    or stage is switched off.
    """

    def __init__(self, config: Config) -> None:
        self.tree = controls_of()
        self.parts: dict[str, Part] = {part.key: part for part in walk(self.tree)}
        self.of: dict[str, Any] = {}
        """Value of each parameter, indexed by key. For a stage with alternative classes, such as the cost function, the
        value is the `kind` of the selected class.
        """
        self.on: dict[str, bool] = {}
        """State of each parameter and stage, indexed by key: True if it is switched on, and False if it is switched
        off.
        """
        self.load(config)

    def load(self, config: Config) -> None:
        """Set all controls to the values of a configuration."""
        self.name = config.name
        for part in self.parts.values():
            held = value_at(config, part.path)
            if isinstance(part, Variants):
                self.of[part.key] = held.kind
            elif isinstance(part, Stage):
                self.on[part.key] = held is not None or not part.optional
            else:
                here = held is not None and self._is_of(part, config)
                self.of[part.key] = held if here else first_value(part)
                self.on[part.key] = held is not None or not part.optional

    def set(self, key: str, value: Any) -> bool:
        """Set the value of a control. Return True if the value changes.

        The value None switches a rule off. The values True and False switch a stage on and off.
        """
        if key not in self.parts:
            raise ConfigError(f"unknown control {key!r}: expected one of {', '.join(self.parts)}")
        before = self.of.get(key), self.on.get(key)
        part = self.parts[key]
        if isinstance(part, Stage):
            self.on[key] = bool(value)
        elif value is None:
            self.on[key] = False
        else:
            self.of[key] = value
            self.on[key] = True
        if isinstance(part, Variants):  # the threshold depends on the cost function
            self.on["partition.gamma_shadows"] = value == "auto"
        return before != (self.of.get(key), self.on.get(key))

    def shown(self, key: str) -> Any:
        """Return the value of a control, or None for a rule that is switched off."""
        return self.of[key] if self.on.get(key, True) else None

    def active(self, key: str) -> bool:
        """Return True if the stage of a control, and all stages around this stage, are switched on."""
        names = key.split(".")[:-1]
        around = [".".join(names[: k + 1]) for k in range(len(names))]
        return all(self.on.get(stage, True) for stage in around)

    def config(self) -> Config:
        """Return the configuration with the values of all controls. Raises ConfigError if values contradict each
        other.
        """
        return Config(name=self.name, **self._nested(self.tree))

    def _nested(self, stage: Stage) -> dict[str, Any]:
        nested: dict[str, Any] = {}
        for part in stage.parts:
            name = part.path.rpartition(".")[2]
            if isinstance(part, Leaf):
                nested[name] = self.shown(part.key)
            elif isinstance(part, Variants):
                kind = self.of[part.key]
                nested[name] = {"kind": kind, **self._nested(part.stages[kind])}
            else:
                nested[name] = self._nested(part) if self.on[part.key] else None
        return nested

    def _is_of(self, part: Leaf, config: Config) -> bool:
        """Return False if a parameter belongs to an alternative class, such as a cost function, that the configuration
        does not use, and True for other parameters.
        """
        if part.key == part.path:
            return True
        variants = next(p for p in self.parts.values() if isinstance(p, Variants) and part.key.startswith(f"{p.key}["))
        kind = value_at(config, variants.path).kind
        return part.key.startswith(f"{variants.stages[kind].key}.")


def nearest_preset(config: Config) -> Config:
    """Return the preset that differs from a configuration in the fewest values."""
    return min((PRESETS[name] for name in SHOWN), key=lambda preset: config.to_toml(preset).count("\n"))
