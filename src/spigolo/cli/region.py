"""Flags for a region of interest, which several commands share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from spigolo.errors import FileError

if TYPE_CHECKING:
    from spigolo.frames.roi import Roi

PixelBox = Annotated[tuple[int, int, int, int], Parameter(negative=())]
SpaceBox = Annotated[tuple[float, float, float, float, float, float], Parameter(negative=())]


@dataclass(frozen=True, slots=True)
class Region:
    """Region of interest. Regions with less than half of their pixels inside it are rejected.

    Parameters
    ----------
    roi
        Region of interest in pixels: first row, first column, last row + 1, last column + 1.
    roi_mask
        Image file that marks the region of interest. All pixels that are not black belong to the region.
    roi_box
        Region of interest in metres in the camera's frame (X right, Y down, Z forward): minimum X Y Z, maximum X Y Z.

    """

    roi: PixelBox | None = None
    roi_mask: Path | None = None
    roi_box: SpaceBox | None = None

    def read(self, max_pixels: int) -> Roi | None:
        """Return the region of interest, or None if no flag is given. Raises FileError for several flags."""
        if sum(given is not None for given in (self.roi, self.roi_mask, self.roi_box)) > 1:
            raise FileError(
                "expected one region of interest, got several: --roi, --roi-mask and --roi-box exclude each other"
            )
        if self.roi_mask is not None:
            from spigolo.frames.files import read_mask

            return read_mask(self.roi_mask, max_pixels)
        if self.roi_box is not None:
            from spigolo.frames.roi import MetricBox

            return MetricBox(self.roi_box[:3], self.roi_box[3:])
        return self.roi


RegionFlags = Annotated[Region, Parameter(name="*")]
NO_REGION = Region()
