"""Common base of the segmentation methods for comparison: parameters, and the rules that reject regions."""

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
"""Parameters of the support plane and of the rejection rules in the preset OBJECTS_2, without the rule that requires a
boundary map.
"""

C = TypeVar("C", bound="MethodConfig")


class MethodConfig(Parameters):
    """Base class of the parameters of a segmentation method.

    Lengths and areas in pixels refer to a 640x480 image. Areas (`_px2`) are scaled to the number of pixels of the
    image.
    """

    rejection: Rejection = OBJECTS_2.rejection
    """Rejection rules of Toscana & Rosa 2016, by default the same for all methods."""
    additions: Additions = RULES
    """Parameters of the support plane and of our rejection rules, by default the same for all methods."""


class Division(NamedTuple):
    """Regions of a frame, and a map of border strength.

    contour: (H, W) float32, strength of the border between regions at each pixel, from 0 to 1.
    """

    regions: Regions
    contour: npt.NDArray[np.float32]


@dataclass(frozen=True)
class Baseline(Configured[C], ABC):
    """Base class of methods that divide a frame into regions. The rules that select objects among the regions are the
    same for all these methods.
    """

    name: ClassVar[str]
    preset: ClassVar[str] = ""

    @abstractmethod
    def divide(self, frame: Frame) -> Division:
        """Return all regions of a frame, including the regions of the background."""

    def __call__(self, frame: Frame) -> Segmentation:
        """Segment a frame into objects."""
        check_frame(frame)
        regions, contour = self.divide(frame)
        additions = self.config.additions.at_size(frame.shape)
        plane = find_support(frame.depth, frame.camera, additions.support)
        scene = Scene(
            frame=frame,
            depth=inpaint_small_gaps(frame.depth, Inpainting().at_size(frame.shape)),  # in-painted as in OBJECTS
            contour=contour,
            plane=plane,
            rejection=self.config.rejection.at_size(frame.shape),
            additions=additions,
            preset=self.name,
            digest=self.digest,
            above=find_above(frame, plane, additions),
        )
        return select_objects(regions, scene)
