"""Parameters of our additions to the paper. `Config.additions` is None in the paper's presets.

Three modules contain further parameters: `settings.support` those of the support plane, `settings.joining` those of the
rules that join regions, and `settings.rules` those of the rules that reject or keep regions.

Lengths in pixels are given for a 640x480 image. These lengths are scaled with the image size if
`Additions.lengths_grow` is set.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from spigolo.settings.joining import Joining
from spigolo.settings.parameters import (
    Angle_deg,
    Area_px2,
    Grows,
    Length_px,
    NotNegative,
    Offset_px,
    Positive,
    Settings,
    Share,
)
from spigolo.settings.rules import Rules
from spigolo.settings.support import Flats, Packing, Support


class DepthContours(Settings):
    """Contours that are added to the boundary map: depth steps and concave creases. Contours are found in the depth
    map, without the colour image.

    Before contours are searched, shadows are filled with the larger of the depths on both sides. The contour of an
    object then lies between the object and its shadow.
    """

    max_shadow_px: Length_px = 60
    """Maximum width of a shadow that is filled before contours are searched, in pixels. A shadow is filled with the
    larger of the depths on both sides. Wider shadows are not filled.
    """
    step_offset_px: Offset_px = 2
    """Distance of two depth samples from a pixel, on opposite sides of the pixel, in pixels. The depths of the pixel
    and of both samples determine whether the pixel lies on a depth step. Larger values also detect depth steps that are
    smeared over more pixels.
    """
    step_m: NotNegative = 0.015
    """Minimum second difference of depth at a pixel on a depth step, in metres. Larger values give fewer contours."""
    step_per_m: NotNegative = 0.012
    """Minimum second difference of depth at a pixel on a depth step, divided by the squared distance, 1/m. The minimum
    second difference is max(`step_m`, `step_per_m` * distance^2). Larger values give fewer false depth steps at large
    distances, where the noise is larger.
    """
    crease_offset_px: Offset_px = 5
    """Distance of two depth samples from a pixel, on opposite sides of the pixel, in pixels. The pixel and the samples
    determine the angle of a concave crease.
    """
    crease_low_deg: Angle_deg = 30.0
    """Minimum angle between the two sides of a concave crease, in degrees. Larger values give fewer contours."""
    crease_high_deg: Angle_deg = 140.0
    """Maximum angle between the two sides of a concave crease, in degrees. Larger values give more contours. With the
    value 0, no creases are found.
    """
    crease_noise: NotNegative | None = None
    """Minimum distance of a crease pixel behind the straight line between the depth samples on both sides, as a
    multiple of the frame's depth noise. Larger values give fewer false creases in noise. If None, there is no minimum.
    """
    holes_from: Share | None = None
    """Minimum share of missing depth in a frame. In frames with at least this share, hole outlines and the image edges
    inside holes become contours. Without these contours, regions on opposite sides of a hole could merge. If None,
    holes give no contours.
    """


class Merging(Settings):
    """Merging of neighbouring regions by the mean boundary value along their common border."""

    max_mean: Share = 0.4
    """Maximum mean boundary value along the common border of two regions that are merged. Larger values merge more
    regions.
    """
    line: Share = 0.35
    """Minimum boundary value of a pixel that counts as part of a boundary line. With larger values, fewer pixels count
    as part of a line.
    """
    min_open_px2: Area_px2 = 200.0
    """Minimum number of pixels of a region that are not part of a boundary line, px^2. A region with fewer such pixels
    is merged with the neighbour that has the weakest common border. Larger values merge more regions.
    """


class Refinement(Settings):
    """Refinement of object outlines by colour where depth is missing or smeared.

    The pixels in a band along object borders get new labels. A minimum spanning forest, with colour differences as edge
    weights, grows from the labelled pixels outside the band. Each tree of the forest gives its label to the pixels of
    the band that it reaches.
    """

    ramp_factor: NotNegative = 5.0
    """Width of the band of pixels with new labels on each side of an object border, as a multiple of the ramp width. A
    ramp is a depth step that is smeared over several pixels, as in stereo depth. Larger values give a wider band.
    """
    min_width_px: Length_px = 2
    """Minimum width of the band of pixels with new labels on each side of an object border, in pixels. Larger values
    give a wider band.
    """
    max_width_px: Length_px = 10
    """Maximum width of the band of pixels with new labels on each side of an object border, in pixels. Larger values
    give a wider band.
    """
    hole_width_px: Annotated[int, Field(ge=0, le=250), Grows()] = 20
    """Width of the band of pixels with new labels where depth is missing, such as in shadows, in pixels. This width is
    used only if it is larger than the width of the band elsewhere. Larger values give a wider band.
    """
    near_hole_px: Length_px = 1
    """Maximum distance between a pixel and missing depth, in pixels, at which the band at this pixel has the width
    `hole_width_px`. Larger values give a wider band around missing depth.
    """
    reach_px: Offset_px = 8
    """Distance on each side of an object border within which the width of a ramp (smeared depth step) is measured, in
    pixels.
    """
    min_profiles: Annotated[int, Field(ge=1)] = 40
    """Minimum number of depth profiles across object borders from which the mean ramp width is computed. With fewer
    profiles, the band of pixels with new labels has the width `min_width_px`.
    """
    max_opened: Share = 0.6
    """Maximum share of an object's thickness in which pixels get new labels, if the object lies entirely inside the
    band along its border. The innermost pixels of such a small object keep their labels, so that it does not vanish.
    Larger values leave fewer pixels unchanged.
    """
    min_solidity: Share | None = 0.5
    """Minimum solidity of an object: its area divided by the area of its convex hull. If an object has at least this
    solidity, background pixels inside its convex hull get new labels too. If None, these pixels keep their labels.
    """
    sigma_px: Annotated[NotNegative, Field(le=100), Grows()] = 0.8
    """Sigma of the Gaussian smoothing of the colour image before colour differences are computed, in pixels. With 0,
    the image is not smoothed. Larger values suppress more noise.
    """
    step_m: Positive = 0.018
    """Minimum depth difference between neighbouring pixels that counts as a full depth step, in metres. Larger values
    give depth less influence on the outlines.
    """
    step_per_m: NotNegative = 0.0083
    """Minimum depth difference that counts as a full depth step, divided by the squared distance, 1/m. The minimum
    depth difference is max(`step_m`, `step_per_m` * distance^2). Larger values give depth less influence on the
    outlines at large distances.
    """
    step_weight: NotNegative = 40.0
    """Weight of a full depth step between two neighbouring pixels, in the unit of colour differences (grey levels).
    With larger values, outlines follow sharp depth steps more closely.
    """


class Additions(Settings):
    """Our additions to the paper. All additions are off by default."""

    support: Support | None = None
    """Find the support plane, and reject regions that are not above the plane."""
    packing: Packing | None = None
    """Warn if a layer of packed objects may have been mistaken for the support plane. No region is rejected."""
    contours: DepthContours | None = None
    """Add depth steps and concave creases to the boundary map. This addition has an effect only if the cost function
    uses the boundary map.
    """
    merging: Merging | None = None
    """Merge neighbouring regions if the mean boundary value along their common border is small. This addition has an
    effect only if the cost function uses the boundary map.
    """
    joining: Joining | None = None
    """Join regions that are parts of one object. This addition requires `Additions.support`."""
    rules: Rules = Rules()
    """Rules that reject regions, in addition to the rules of the paper."""
    flats: Flats | None = None
    """Find flat objects on the support plane. This addition requires `Additions.support`."""
    refinement: Refinement | None = None
    """Refine the outlines of objects by colour where depth is missing or smeared."""
    noise_per_m: NotNegative = 0.0
    """Depth difference, divided by the squared distance, that equation 9 treats as zero, 1/m. The depth of some cameras
    is quantised, so that steps divide large surfaces. Larger values remove more of these steps.
    """
    line_px: Offset_px = 1
    """Width of the boundary lines E_F before blurring, in pixels. The value 1 gives the lines of equation 20. Larger
    values close wider gaps in the lines.
    """
    lengths_grow: bool = False
    """Scale all lengths in pixels with the image size. The values of the lengths in a preset are for a 640x480
    image.
    """
    resolution: Literal["full", "half"] = "full"
    """Image size at which the frame is segmented. With `half`, the frame is segmented at half the width and height, and
    the outlines of objects are then refined at full size. For frames of 1280x720, `half` needs less than half of the
    time of `full`. However, objects of only a few pixels are missed.
    """

    @model_validator(mode="after")
    def _has_support(self) -> Additions:
        if self.joining is not None and self.support is None:
            raise ValueError(
                "joining requires additions.support, because joining tests which parts stand on the support plane:"
                " switch off joining too (--additions.joining none)"
            )
        return self
