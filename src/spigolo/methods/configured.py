"""Base class of segmentation methods that keep their parameters in one configuration object."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from spigolo.settings.parameters import Parameters

C = TypeVar("C", bound=Parameters)
M = TypeVar("M", bound="Configured[Any]")


@dataclass(frozen=True)
class Configured(Generic[C]):
    """Segmentation method that keeps its parameters in one configuration object."""

    config: C
    """Parameters of the method."""

    @property
    def digest(self) -> str:
        """Hash of the parameter values, eight hexadecimal digits."""
        return self.config.digest

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Parameter values as a dict that can be written as JSON."""
        return self.config.model_dump(mode="json")

    def replace(self: M, **changes: Any) -> M:
        """Return the method with changed parameters, as in `Settings.replace`. Raises ConfigError for an invalid
        parameter.
        """
        return replace(self, config=self.config.replace(**changes))
