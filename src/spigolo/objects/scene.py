"""Input of the rejection rules for a frame: depth map, support plane, boundary map and parameters of the rules."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane, above_mask, support_mask
from spigolo.additions.stance import Stance, measure_stance
from spigolo.frames.frame import DepthMap, Frame, Mask
from spigolo.frames.roi import Roi, roi_mask
from spigolo.objects.facts import Labels, RegionFacts, measure_regions
from spigolo.settings.additions import Additions
from spigolo.settings.paper import Rejection
from spigolo.settings.rules import Rules
from spigolo.settings.support import Support
from spigolo.stages.regions import Regions


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Scene:
    """Maps of a frame and parameters of the rules, which together decide which regions are objects."""

    frame: Frame
    """Frame to which the regions belong."""
    depth: DepthMap
    """Depth map (H, W) in metres, 0 where missing. Small gaps are filled if in-painting is on."""
    contour: npt.NDArray[np.float32]
    """Boundary map (H, W) with values from 0 to 1."""
    plane: Plane | None
    """Support plane of the frame. The value is None if no plane was found."""
    rejection: Rejection
    """Rejection rules of the paper, with lengths and areas scaled to the image size."""
    additions: Additions | None
    """Our additions, with lengths and areas scaled to the image size. The value is None if the preset has no
    additions.
    """
    preset: str
    """Name of the preset that produced the regions."""
    digest: str
    """Hash of the parameter values of the preset."""
    left_out: tuple[str, ...] = ()
    """Names of cues that were not computed because intrinsics are missing."""
    above: Mask | None = None
    """Mask (H, W) of the measured pixels above the support plane. The value is None if the frame has no support
    plane.
    """
    inside: tuple[Mask, Mask] | None = None
    """Two masks (H, W): the pixels inside the region of interest, and the pixels whose position is known. If the region
    of interest is a box in metres, only the positions of pixels with depth are known. The value is None if no region of
    interest is given.
    """

    @property
    def support(self) -> Support | None:
        """Parameters of the support plane. The value is None if the support plane is switched off."""
        return None if self.additions is None else self.additions.support

    @property
    def rules(self) -> Rules:
        """Our rejection rules. If the preset has no additions, all of our rules are switched off."""
        return Rules() if self.additions is None else self.additions.rules

    def measure(self, regions: Regions) -> list[RegionFacts]:
        """Compute the measurements of every region, in pixels and in metres."""
        stance = self._stance(regions)
        return measure_regions(
            regions, self.depth, self.frame, self.contour, self.above, self.inside, stance, self.plane
        )

    def on_support(self, labels: Labels) -> Mask | None:
        """Return the mask (H, W) of background pixels on the support plane, or None if the frame has no support
        plane.
        """
        camera = self.frame.camera
        if self.plane is None or self.support is None or camera is None:
            return None
        return np.asarray(support_mask(self.plane, self.frame.depth, camera, self.support) & (labels == 0))

    def all_left_out(self) -> tuple[str, ...]:
        """Return the names of all results that are missing because the frame has no intrinsics."""
        if self.frame.camera is not None:
            return ()
        support = ("support plane",) if self.support is not None else ()
        return (*self.left_out, *support, "reach", "points, centroids and boxes in metres")

    def _stance(self, regions: Regions) -> Stance | None:
        plane, camera, wall = self.plane, self.frame.camera, self.rules.wall
        if wall is None or self.support is None or camera is None:
            return None
        if plane is None:  # without a support plane, every region is tested for a wall
            tall = np.asarray(self.depth > 0)
        else:
            high = self.support.model_copy(update={"min_height_m": wall.min_height_m})
            tall = above_mask(plane, self.depth, camera, high)
        return measure_stance(regions, self.depth, camera, plane, tall, wall, self.rules.ledge)


def find_above(frame: Frame, plane: Plane | None, additions: Additions | None) -> Mask | None:
    """Return the mask (H, W) of measured pixels above the support plane, or None if the frame has no support plane."""
    if plane is None or additions is None or additions.support is None or frame.camera is None:
        return None
    return above_mask(plane, frame.depth, frame.camera, additions.support)


def find_inside(frame: Frame, roi: Roi | None) -> tuple[Mask, Mask] | None:
    """Return the value of the field `Scene.inside`: two masks (H, W), or None if no region of interest is given."""
    return None if roi is None else roi_mask(roi, frame)
