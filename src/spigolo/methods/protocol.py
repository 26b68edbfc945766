"""Interface of a segmentation method, which is called with a frame and returns a Segmentation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from spigolo.frames.frame import Frame
from spigolo.objects.segmentation import Segmentation


class Method(Protocol):
    """Interface of a segmentation method with its parameters. Methods can be pickled for worker processes.

    - name: name of the method.
    - preset: name of the preset that the parameters come from, or "".
    - digest: hash of the parameter values.
    - parameters: parameter values as a dict that can be written as JSON.
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
        """Return the method with changed parameters. Raises ConfigError for an unknown parameter."""

    def __call__(self, frame: Frame) -> Segmentation:
        """Segment a frame into objects. Raises SpigoloError if the method cannot use the frame."""
