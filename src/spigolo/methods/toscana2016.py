"""Toscana & Rosa 2016, the method of this package, with the same interface as the methods for comparison."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import ClassVar

from spigolo.frames.frame import Frame
from spigolo.methods.configured import Configured
from spigolo.objects.segmentation import Segmentation
from spigolo.settings.config import Config
from spigolo.settings.presets import OBJECTS
from spigolo.stream import Segmenter


@dataclass(frozen=True, repr=False)
class Toscana2016(Configured[Config]):
    """Method of Toscana & Rosa 2016 with one configuration. Each thread reuses its memory buffers for all frames."""

    name: ClassVar[str] = "toscana2016"
    config: Config = OBJECTS
    _own: threading.local = field(default_factory=threading.local, init=False, compare=False)

    @property
    def preset(self) -> str:
        """Name of the preset from which the configuration comes."""
        return self.config.name

    def __call__(self, frame: Frame) -> Segmentation:
        """Segment a frame into objects."""
        if not hasattr(self._own, "segmenter"):
            self._own.segmenter = Segmenter(self.config)
        segmenter: Segmenter = self._own.segmenter
        return segmenter(frame)

    def __repr__(self) -> str:
        return f"Toscana2016({self.preset} {self.digest})"

    def __reduce__(self) -> tuple[type[Toscana2016], tuple[Config]]:
        """Pickle the configuration without the memory buffers."""
        return type(self), (self.config,)
