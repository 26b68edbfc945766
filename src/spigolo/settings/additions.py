"""Parameters of our additions to the paper. `Config.additions` is None in the paper's presets.

The rules of joining are in `settings.joining`, those that reject or keep regions in `settings.rules`.

Lengths in pixels refer to a 640x480 image, and grow with the image if `Additions.lengths_grow` is set.
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


class Facing(Settings):
    """Required direction of a support plane. Objects can stand only on a plane that faces up."""

    up: tuple[float, float, float] | None = None
    """Upward direction in the camera's frame (X right, Y down, Z forward), of any length. With None, the camera is
    assumed to look level or down, and not to be turned on its side.
    """
    max_tilt_deg: Annotated[float, Field(ge=0, le=90)] = 30.0
    """Maximum angle between the plane's normal and `up`, degrees."""
    max_roll_deg: Annotated[float, Field(ge=0, le=90)] = 40.0
    """Maximum angle between the plane's normal and the image's vertical plane, degrees. A plane beyond it faces
    sideways. Used only without `up`.
    """
    max_down_deg: Annotated[float, Field(ge=0, le=90)] = 20.0
    """Maximum angle by which the plane's normal may point down in the image, degrees. A plane beyond it is a ceiling.
    Used only without `up`.
    """
    min_share_sideways: Share = 0.5
    """Minimum share of the measured pixels that a sideways plane must cover to be accepted. Such a large plane means
    that the camera is mounted on its side.
    """

    @model_validator(mode="after")
    def _up_points_somewhere(self) -> Facing:
        if self.up is not None and not any(self.up):
            raise ValueError("expected a direction as additions.support.facing.up, such as [0, -1, 0], got [0, 0, 0]")
        return self


class Support(Settings):
    """Detection of the support plane, which is the largest plane of the frame, and of the pixels above it."""

    min_height_m: Positive = 0.008
    """Minimum height of an object pixel above the plane, m. Lower pixels belong to the plane."""
    noise_factor: NotNegative | None = None
    """Minimum height of an object pixel above the plane, as a multiple of the plane's noise. The noise is the standard
    deviation of the plane's own pixels. This height replaces `min_height_m` if it is lower, and the step in height of
    `Ledge` is lowered by the same ratio. None: always `min_height_m`.
    """
    lowest_m: Positive = 0.004
    """Lowest value of the minimum height that `noise_factor` gives, m."""
    noise_per_m: NotNegative = 0.0056
    """Minimum height above the plane per squared distance, 1/m: twice the depth error. The larger of this limit and
    `min_height_m` applies.
    """
    min_above: Share = 0.6
    """Minimum share of a region's measured pixels that lie above the plane. Regions with a smaller share are
    rejected.
    """
    min_share: Share = 0.15
    """Minimum share of the frame's measured pixels that lie on the support plane. Smaller planes are ignored."""
    contour: bool = True
    """Add the outline of everything above the plane to the boundary map."""
    stacked_share: Positive | None = None
    """Minimum size of a second plane that is parallel to the largest one and above it, as a share of the pixels of the
    largest one. The second plane is then the support: the table instead of the floor. None: always the largest plane.
    """
    facing: Facing | None = None
    """Skip planes on which nothing can stand, such as ceilings and side walls. None: skip no plane."""
    min_things: Share | None = None
    """Minimum share of the measured pixels that stand on the largest plane. If fewer do, the next plane that reaches
    this share is the support: the floor of a bin instead of its wall. None: always the largest plane.
    """
    near_roi: NotNegative | None = None
    """Margin around the region of interest in which the plane is searched, as a share of the size of the region of
    interest. None: search the whole frame.
    """
    within_reach: bool = False
    """Search the plane only within `Rejection.max_distance_m`."""
    opaque: bool = False
    """Skip planes that surround points below them, such as the front of a shelf, and use the next largest plane. If
    much of the depth is missing, also skip planes with more points below than on them.
    """


class Packing(Settings):
    """Warning that a layer of packed objects may have been mistaken for the support."""

    min_share: Share = 0.6
    """Minimum share of the frame's measured pixels on the support for the warning."""
    min_edges: Share = 0.9
    """Minimum share of the support's pixels that lie close to a colour edge for the warning."""
    max_things: Share = 0.02
    """Maximum share of the frame's measured pixels that stand on the support for the warning."""


class DepthContours(Settings):
    """Contours that are added to the boundary map: depth steps and concave creases, found in the depth map only.

    A shadow first gets the depth of its farther side, so that the contour of an object lies where its shadow begins.
    """

    max_shadow_px: Length_px = 60
    """Maximum width of a shadow that gets the depth of its farther side, px."""
    step_offset_px: Offset_px = 2
    """Distance from a pixel to the depth samples on both sides of it, px."""
    step_m: NotNegative = 0.015
    """Minimum bend of the depth at a step, m. Larger values give fewer contours."""
    step_per_m: NotNegative = 0.012
    """Minimum bend of the depth at a step per squared distance, 1/m, so that noise at long range makes no step. The
    larger of this limit and `step_m` applies.
    """
    crease_offset_px: Offset_px = 5
    """Distance between the three depth samples that measure a concave crease, px."""
    crease_low_deg: Angle_deg = 30.0
    """Minimum angle of a concave crease, degrees."""
    crease_high_deg: Angle_deg = 140.0
    """Maximum angle of a concave crease, degrees. Larger values give more contours. 0 finds no creases."""
    crease_noise: NotNegative | None = None
    """Minimum depth of a crease behind the line between its two sides, as a multiple of the frame's depth noise. None:
    every crease counts, even if its sides are short.
    """
    holes_from: Share | None = None
    """Minimum share of missing depth in the frame at which hole outlines become contours. The image edges inside holes
    then become contours too, so that regions do not leak through. None: off.
    """


class Merging(Settings):
    """Merging of regions over their whole common border."""

    max_mean: Share = 0.4
    """Maximum mean boundary value along the common border of two regions that are merged. Larger values merge more."""
    line: Share = 0.35
    """Minimum boundary value of a pixel that counts as part of a line."""
    min_open_px2: Area_px2 = 200.0
    """Minimum number of a region's pixels that are not on lines. A region with fewer joins the neighbour with the
    weakest border.
    """


class Refinement(Settings):
    """Refinement of object outlines by colour where depth is missing or smeared.

    All pixels in a band along the borders of objects are assigned anew. A spanning forest over colour differences grows
    from the pixels outside the band. The forest gives each pixel of the band to an object or to the background.
    """

    ramp_factor: NotNegative = 5.0
    """Width of the band per pixel of ramp width. A ramp is a depth step that is spread over several pixels. Ramps are
    wide in stereo depth and narrow in structured-light depth.
    """
    min_width_px: Length_px = 2
    """Minimum width of the band on each side of a border, px, even if the frame has no ramps."""
    max_width_px: Length_px = 10
    """Maximum width of the band on each side of a border, px."""
    hole_width_px: Annotated[int, Field(ge=0, le=250), Grows()] = 20
    """Maximum width of the band at missing depth, such as shadows and rims of objects, px."""
    near_hole_px: Length_px = 1
    """Distance to missing depth up to which measured depth is treated as unreliable, px."""
    reach_px: Offset_px = 8
    """Length on each side of a border along which ramp widths are measured, px."""
    min_profiles: Annotated[int, Field(ge=1)] = 40
    """Minimum number of depth steps to measure ramp widths from. With fewer, the band has its minimum width."""
    max_opened: Share = 0.6
    """Maximum share of a small object's layers of pixels that belong to the band. The innermost layers stay."""
    min_solidity: Share | None = 0.5
    """Minimum solidity of an object, which is the share of its convex hull that it fills. Background inside the hull is
    then assigned anew too. None: off.
    """
    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Sigma of the Gaussian smoothing of the colour image before differences are taken, px. 0 does not smooth."""
    step_m: Positive = 0.018
    """Depth difference between neighbours that counts as a full step, m."""
    step_per_m: NotNegative = 0.0083
    """Depth difference per squared distance that counts as a full step, 1/m. The larger of this limit and `step_m`
    applies.
    """
    step_weight: NotNegative = 40.0
    """Weight of a full depth step between measured pixels, in grey levels of colour difference. Larger values keep
    outlines on sharp depth steps.
    """


class Additions(Settings):
    """Our additions to the paper. Each is off by default."""

    support: Support | None = None
    """Find the support plane, and reject regions that do not stand above it."""
    packing: Packing | None = None
    """Warn if a layer of packed objects may have been mistaken for the support. No region is rejected."""
    contours: DepthContours | None = None
    """Add depth steps and creases to the boundary map. Effective only if the cost function reads the map."""
    merging: Merging | None = None
    """Merge regions over their whole common border. Effective only if the cost function reads the boundary map."""
    joining: Joining | None = None
    """Join the parts of an object that the partition separated. Requires a support."""
    rules: Rules = Rules()
    """Reject more regions than the rules of the paper do."""
    refinement: Refinement | None = None
    """Refine the outlines of objects by colour where depth is missing or smeared."""
    noise_per_m: NotNegative = 0.0
    """Depth difference per squared distance that eq. 9 treats as zero, 1/m. Steps of quantised depth would otherwise
    remain as borders inside large regions.
    """
    line_px: Offset_px = 1
    """Width of the lines of E_F before they are blurred, px. 1 is eq. 20."""
    lengths_grow: bool = False
    """Let lengths in pixels grow with the image. An image of twice the resolution then shows the same edges, twice as
    wide.
    """
    resolution: Literal["full", "half"] = "full"
    """Image size at which the frame is partitioned. `half` halves width and height, and then refines the outlines of
    objects at full size. At 1280x720, `half` takes less than half of the time, but loses objects of a few pixels.
    """

    @model_validator(mode="after")
    def _has_support(self) -> Additions:
        if self.joining is not None and self.support is None:
            raise ValueError(
                "joining needs additions.support, as its rules test what stands on the plane: switch it off too"
                " (--additions.joining none)"
            )
        return self
