"""Toscana & Rosa 2016, the method of this package, as one of several."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any

from spigolo.config import Config
from spigolo.frame import Frame
from spigolo.objects import Segmentation
from spigolo.presets import OBJECTS
from spigolo.stream import Segmenter


class Toscana2016:
    """Toscana & Rosa 2016 with one configuration; every thread keeps its buffers from frame to frame."""

    name = "toscana2016"

    def __init__(self, config: Config = OBJECTS) -> None:
        self.config = config
        self._own = threading.local()

    @property
    def preset(self) -> str:
        """Name of the configuration."""
        return self.config.name

    @property
    def digest(self) -> str:
        """That of the configuration."""
        return self.config.digest

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The configuration as JSON has it."""
        return self.config.model_dump(mode="json")

    def replace(self, **changes: Any) -> Toscana2016:
        """Another configuration; names may be dotted as in `Config.replace`."""
        return Toscana2016(self.config.replace(**changes))

    def __call__(self, frame: Frame) -> Segmentation:
        """The objects of a frame."""
        if not hasattr(self._own, "segmenter"):
            self._own.segmenter = Segmenter(self.config)
        segmenter: Segmenter = self._own.segmenter
        return segmenter(frame)

    def __repr__(self) -> str:
        return f"Toscana2016({self.preset} {self.digest})"

    def __reduce__(self) -> tuple[type[Toscana2016], tuple[Config]]:
        """As a configuration: buffers stay behind."""
        return Toscana2016, (self.config,)
