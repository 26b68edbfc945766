"""Interface of a method, which takes a frame and returns a segmentation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from spigolo.frames.frame import Frame
from spigolo.objects.segmentation import Segmentation


class Method(Protocol):
    """Method with its parameters. Methods can be pickled for worker processes.

    name: name of the method. preset: name of its parameters, "" without a name. digest: text that changes with any
    parameter value. parameters: values of the parameters, ready for JSON.
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
