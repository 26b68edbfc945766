"""Common base of the methods for comparison: parameters, and the way from regions to a result."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from spigolo.additions.support import find_support
from spigolo.frames.frame import Frame, check_frame
from spigolo.methods.configured import Configured
from spigolo.objects.scene import Scene, find_above
from spigolo.objects.segmentation import Segmentation
from spigolo.objects.selection import select_objects
from spigolo.settings.additions import Additions
from spigolo.settings.paper import Inpainting, Rejection
from spigolo.settings.parameters import Parameters
from spigolo.settings.presets import OBJECTS_2
from spigolo.stages.depth import inpaint_small_gaps
from spigolo.stages.regions import Regions

_ADDED = OBJECTS_2.additions or Additions()
RULES = Additions(support=_ADDED.support, rules=_ADDED.rules.replace(min_contour=None, min_contour_holes=None))
"""Rules of OBJECTS_2 without the minimum contour, as the other methods have no boundary map."""

C = TypeVar("C", bound="MethodConfig")


class MethodConfig(Parameters):
    """Base of the parameters of a method.

    Lengths and areas in pixels refer to a 640x480 image. Areas (`_px2`) scale with the number of pixels.
    """

    rejection: Rejection = OBJECTS_2.rejection
    """Rules of the paper that reject regions. All methods use the same rules, so that only the regions differ."""
    additions: Additions = RULES
    """Support plane and our rules that reject regions. All methods use the same rules."""


class Division(NamedTuple):
    """Regions of a frame, and the strength of their borders, (H, W) float32 in [0, 1]."""

    regions: Regions
    contour: npt.NDArray[np.float32]


@dataclass(frozen=True)
class Baseline(Configured[C], ABC):
    """Method that divides a frame into regions. Common rules then decide which regions are objects."""

    name: ClassVar[str]
    preset: ClassVar[str] = ""

    @abstractmethod
    def divide(self, frame: Frame) -> Division:
        """Return the regions of the whole frame, both background and objects."""

    def __call__(self, frame: Frame) -> Segmentation:
        """Return the objects of a frame."""
        check_frame(frame)
        regions, contour = self.divide(frame)
        additions = self.config.additions.at_size(frame.shape)
        plane = find_support(frame.depth, frame.camera, additions.support)
        scene = Scene(
            frame=frame,
            depth=inpaint_small_gaps(frame.depth, Inpainting().at_size(frame.shape)),  # as in OBJECTS
            contour=contour,
            plane=plane,
            rejection=self.config.rejection.at_size(frame.shape),
            additions=additions,
            preset=self.name,
            digest=self.digest,
            above=find_above(frame, plane, additions),
        )
        return select_objects(regions, scene)
