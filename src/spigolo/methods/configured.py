"""Base of methods with a single configuration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from spigolo.settings.parameters import Parameters

C = TypeVar("C", bound=Parameters)
M = TypeVar("M", bound="Configured[Any]")


@dataclass(frozen=True)
class Configured(Generic[C]):
    """Method with a single configuration."""

    config: C
    """Configuration of the method."""

    @property
    def digest(self) -> str:
        """Digest of the configuration's values."""
        return self.config.digest

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Values of the configuration, ready for JSON."""
        return self.config.model_dump(mode="json")

    def replace(self: M, **changes: Any) -> M:
        """Return the method with other values, as in `Settings.replace`. Raises ConfigError."""
        return replace(self, config=self.config.replace(**changes))
