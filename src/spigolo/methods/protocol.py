"""The interface of a method: a frame in, a segmentation out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from spigolo.frames.frame import Frame
from spigolo.objects.segmentation import Segmentation


class Method(Protocol):
    """A method with its parameters. It can be pickled, because worker processes get a copy each.

    name: of the method. preset: of its parameters, "" for those without a name. digest: changes with any of their
    values. parameters: the values, as JSON has them.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def preset(self) -> str: ...  # noqa: D102
    @property
    def digest(self) -> str: ...  # noqa: D102
    @property
    def parameters(self) -> Mapping[str, Any]: ...  # noqa: D102

    def replace(self, **changes: Any) -> Method:
        """Return the same method with other parameters. Raises ConfigError for a parameter that it does not have."""

    def __call__(self, frame: Frame) -> Segmentation:
        """Return the objects of a frame. Raises SpigoloError for a frame that the method cannot use."""
