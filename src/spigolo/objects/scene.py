"""Scene of a frame: its depth, support plane and rules, by which regions are judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane, above_mask, support_mask
from spigolo.additions.stance import Stance, measure_stance
from spigolo.frames.frame import DepthMap, Frame, Mask
from spigolo.frames.roi import Roi, roi_mask
from spigolo.objects.facts import Labels, RegionFacts, measure_regions
from spigolo.settings.additions import Additions, Support
from spigolo.settings.paper import Rejection
from spigolo.settings.rules import Rules
from spigolo.stages.regions import Regions


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Scene:
    """Maps and rules by which regions of any method are judged. Corrections by hand use them again."""

    frame: Frame
    """Frame whose regions are judged."""
    depth: DepthMap
    """Depth (H, W) in metres, in-painted if in-painting is on. 0 counts as missing."""
    contour: npt.NDArray[np.float32]
    """Boundary value (H, W) in [0, 1] of each pixel."""
    plane: Plane | None
    """Support plane, or None."""
    rejection: Rejection
    """Rules of the paper, sized for the image."""
    additions: Additions | None
    """Our rules, sized for the image. None without additions."""
    preset: str
    """Name of the preset that the regions were made with."""
    digest: str
    """Digest of the preset's values."""
    left_out: tuple[str, ...] = ()
    """Cues that need intrinsics and were left out."""
    above: Mask | None = None
    """Measured pixels (H, W) above the support plane. None without a plane."""
    inside: tuple[Mask, Mask] | None = None
    """Pixels (H, W) in the region of interest, and the pixels that count. None without a region of interest."""

    @property
    def support(self) -> Support | None:
        """Parameters of the support plane. None if no plane was searched."""
        return None if self.additions is None else self.additions.support

    @property
    def rules(self) -> Rules:
        """Our rules, all off without additions."""
        return Rules() if self.additions is None else self.additions.rules

    def measure(self, regions: Regions) -> list[RegionFacts]:
        """Return the measurements of each region."""
        stance = self._stance(regions)
        return measure_regions(
            regions, self.depth, self.frame, self.contour, self.above, self.inside, stance, self.plane
        )

    def on_support(self, labels: Labels) -> Mask | None:
        """Return the background pixels (H, W) on the support plane. None without a plane."""
        camera = self.frame.camera
        if self.plane is None or self.support is None or camera is None:
            return None
        return np.asarray(support_mask(self.plane, self.frame.depth, camera, self.support) & (labels == 0))

    def all_left_out(self) -> tuple[str, ...]:
        """Return the names of all features that were left out because intrinsics are missing."""
        if self.frame.camera is not None:
            return ()
        support = ("support plane",) if self.support is not None else ()
        return (*self.left_out, *support, "reach", "points, centroids and boxes in metres")

    def _stance(self, regions: Regions) -> Stance | None:
        plane, camera, wall = self.plane, self.frame.camera, self.rules.wall
        if wall is None or self.support is None or camera is None:
            return None
        if plane is None:  # without a plane every region is tested
            tall = np.asarray(self.depth > 0)
        else:
            high = self.support.model_copy(update={"min_height_m": wall.min_height_m})
            tall = above_mask(plane, self.depth, camera, high)
        return measure_stance(regions, self.depth, camera, plane, tall, wall, self.rules.ledge)


def find_above(frame: Frame, plane: Plane | None, additions: Additions | None) -> Mask | None:
    """Return the measured pixels (H, W) above the support plane. None without a plane."""
    if plane is None or additions is None or additions.support is None or frame.camera is None:
        return None
    return above_mask(plane, frame.depth, frame.camera, additions.support)


def find_inside(frame: Frame, roi: Roi | None) -> tuple[Mask, Mask] | None:
    """Return the pixels (H, W) in the region of interest, and the pixels that count. None without a region of
    interest.
    """
    return None if roi is None else roi_mask(roi, frame)
