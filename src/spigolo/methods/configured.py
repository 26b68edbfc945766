"""A method with one configuration: its digest, its values, and copies with other values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from spigolo.settings.parameters import Parameters

C = TypeVar("C", bound=Parameters)
M = TypeVar("M", bound="Configured[Any]")


@dataclass(frozen=True)
class Configured(Generic[C]):
    """A method with one configuration."""

    config: C
    """The configuration."""

    @property
    def digest(self) -> str:
        """Hash of the configuration's values."""
        return self.config.digest

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The configuration's values as JSON has them."""
        return self.config.model_dump(mode="json")

    def replace(self: M, **changes: Any) -> M:
        """Return the method with other values, by the rules of `Settings.replace`. Raises ConfigError."""
        return replace(self, config=self.config.replace(**changes))
