"""What the methods that ours is compared with have in common: parameters, and how their regions become an answer."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from spigolo.additions.support import find_support
from spigolo.frames.frame import Frame, check_frame
from spigolo.objects.segmentation import Evidence, Segmentation, judge_regions, warn_of_depth
from spigolo.settings.config import Inpainting, Rejection
from spigolo.settings.parameters import Parameters
from spigolo.settings.presets import OBJECTS_2
from spigolo.stages.depth import inpaint_small_gaps
from spigolo.stages.regions import Regions

REJECTION = Rejection(**{**OBJECTS_2.rejection.model_dump(), "min_contour": None})
"""The rules of OBJECTS_2 but for the one that asks for a boundary map, which no other method has."""

C = TypeVar("C", bound="MethodConfig")
B = TypeVar("B", bound="Baseline[Any]")


class MethodConfig(Parameters):
    """The parameters of a method.

    Lengths and areas in pixels are those of a 640x480 image; areas (`_px2`) scale with the number of pixels.
    """

    rejection: Rejection = REJECTION
    """Which regions are no objects: the same rules for all methods, so that their regions are what is compared."""


class Division(NamedTuple):
    """What a method makes of a frame: regions, and how strong the borders are, (H, W) float32 in [0, 1]."""

    regions: Regions
    contour: npt.NDArray[np.float32]


@dataclass(frozen=True)
class Baseline(ABC, Generic[C]):
    """A method that divides a frame into regions; which of them are objects is decided by the rules for all methods."""

    name: ClassVar[str]
    preset: ClassVar[str] = ""
    config: C

    @property
    def digest(self) -> str:
        """That of the parameters."""
        return self.config.digest

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The values as JSON has them."""
        return self.config.model_dump(mode="json")

    def replace(self: B, **changes: Any) -> B:
        """The same method with other parameters, as `Parameters.replace` makes them. Raises ConfigError."""
        return replace(self, config=self.config.replace(**changes))

    @abstractmethod
    def divide(self, frame: Frame) -> Division:
        """Regions of the whole frame, background and objects alike."""

    def __call__(self, frame: Frame) -> Segmentation:
        """The objects of a frame."""
        check_frame(frame)
        warn_of_depth(frame)
        regions, contour = self.divide(frame)
        rules, camera = self.config.rejection, frame.camera
        support = rules.support
        evidence = Evidence(
            depth=inpaint_small_gaps(frame.depth, Inpainting()),  # as OBJECTS has it when it counts what is missing
            contour=contour,
            plane=None if camera is None or support is None else find_support(frame.depth, camera, support),
            rules=rules,
            preset=self.name,
            digest=self.digest,
        )
        return judge_regions(regions, frame, evidence)
