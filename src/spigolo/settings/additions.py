"""Parameters of our additions to the paper. `Config.additions` is None in the paper's presets.

`settings.joining` contains the parameters of the rules that join regions. `settings.rules` contains the parameters of
the rules that reject or keep regions.

Lengths in pixels are given for a 640x480 image. They are scaled with the image size if `Additions.lengths_grow` is set.
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
    """Upward direction in the camera's frame (X right, Y down, Z forward), of any length. None assumes that the camera
    looks horizontally or downwards and is mounted upright.
    """
    max_tilt_deg: Annotated[float, Field(ge=0, le=90)] = 30.0
    """Maximum angle between the plane's normal and `up`, in degrees. Larger values accept steeper planes."""
    max_roll_deg: Annotated[float, Field(ge=0, le=90)] = 40.0
    """Maximum angle between the plane's normal and the Y-Z plane of the camera's frame, in degrees. Planes with a
    larger angle face sideways and must reach `min_share_sideways`. Used only if `up` is None.
    """
    max_down_deg: Annotated[float, Field(ge=0, le=90)] = 20.0
    """Maximum angle of the plane's normal below the X-Z plane of the camera's frame, in degrees. Planes with a larger
    angle face down, such as ceilings, and are skipped. Used only if `up` is None.
    """
    min_share_sideways: Share = 0.5
    """Minimum share of the frame's measured pixels that lie on a plane that faces sideways. With at least this share,
    the plane is accepted, because the camera is probably mounted on its side. Used only if `up` is None.
    """

    @model_validator(mode="after")
    def _up_points_somewhere(self) -> Facing:
        if self.up is not None and not any(self.up):
            raise ValueError("expected a direction as additions.support.facing.up, such as [0, -1, 0], got [0, 0, 0]")
        return self


class Support(Settings):
    """Detection of the support plane of a frame, and of the pixels above this plane. By default, the support plane is
    the largest plane.
    """

    min_height_m: Positive = 0.008
    """Minimum height of an object pixel above the support plane, in metres. Lower pixels belong to the plane."""
    noise_factor: NotNegative | None = None
    """Minimum height of an object pixel above the support plane, as a multiple of the noise of the plane. The noise is
    the standard deviation of the plane's pixels. If this height is lower than `min_height_m`, it replaces
    `min_height_m`, and `Ledge.step_m` is lowered by the same ratio. If None, the height is always `min_height_m`.
    """
    lowest_m: Positive = 0.004
    """Minimum of the height that is computed from `noise_factor`, in metres."""
    noise_per_m: NotNegative = 0.0056
    """Minimum height of an object pixel above the support plane per squared distance, 1/m. The limit is
    max(`min_height_m`, `noise_per_m` * distance^2). The default is twice `Smoothing.error_per_m`.
    """
    min_above: Share = 0.6
    """Minimum share of a region's measured pixels that lie above the support plane. Regions with a smaller share are
    rejected.
    """
    min_share: Share = 0.15
    """Minimum share of the frame's measured pixels that lie on the support plane. Planes with a smaller share are
    ignored.
    """
    contour: bool = True
    """Add the outlines of the pixels above the support plane to the boundary map."""
    stacked_share: Positive | None = None
    """Minimum number of pixels on a parallel plane above the largest plane, as a share of the pixels on the largest
    plane. With at least this share, the upper plane becomes the support plane, such as a table above the floor. If
    None, the largest plane is used.
    """
    facing: Facing | None = None
    """Skip planes on which nothing can stand, such as ceilings and side walls. None accepts every direction."""
    min_things: Share | None = None
    """Minimum share of the frame's measured pixels that stand on the support plane. Such a pixel lies above the plane
    by less than 0.3 m, and the plane surrounds it on at least three sides. If the largest plane has a smaller share,
    such as the wall of a bin, the next plane with this share is used. If None, the largest plane is used.
    """
    max_below: Share | None = None
    """Maximum share of points below the support plane, among the points on or below it that the plane surrounds. If the
    share is larger, as for the upper side of a heap of objects, a parallel plane below is used. If None, the plane is
    never lowered.
    """
    near_roi: NotNegative | None = None
    """Margin around the region of interest, as a share of its height and width. The support plane is searched only in
    the region of interest and this margin. If None, the whole frame is searched.
    """
    within_reach: bool = False
    """Search the support plane only at distances up to `Rejection.max_distance_m`."""
    opaque: bool = False
    """Skip planes through which points are visible, such as the front of a shelf, and use the next largest plane. If
    more than 40 % of the depth is missing, also skip planes with more points below the plane than on it.
    """


class Packing(Settings):
    """Conditions for the warning that a layer of packed objects may have been mistaken for the support plane."""

    min_share: Share = 0.6
    """Minimum share of the frame's measured pixels on the support plane. With a smaller share, no warning is given."""
    min_edges: Share = 0.9
    """Minimum share of the support plane's pixels that lie close to an image edge. With a smaller share, no warning is
    given.
    """
    max_things: Share = 0.02
    """Maximum share of the frame's measured pixels that stand on the support plane, as defined in `Support.min_things`.
    With a larger share, no warning is given.
    """


class DepthContours(Settings):
    """Contours that are added to the boundary map: depth steps and concave creases, found in the depth map only.

    Shadows are first filled with the depth of their farther side. The contour of an object then lies where the shadow
    of the object begins.
    """

    max_shadow_px: Length_px = 60
    """Maximum width of a shadow that is filled with the depth of its farther side, in pixels. Wider shadows stay
    missing.
    """
    step_offset_px: Offset_px = 2
    """Distance between a pixel and two depth samples on opposite sides of the pixel, in pixels. A depth step is
    measured from the pixel and the samples. Larger values bridge wider depth ramps.
    """
    step_m: NotNegative = 0.015
    """Minimum second difference of depth at a depth step, in metres. Larger values give fewer contours."""
    step_per_m: NotNegative = 0.012
    """Minimum second difference of depth at a depth step per squared distance, 1/m. The limit is max(`step_m`,
    `step_per_m` * distance^2). Larger values find fewer false steps in noise at long range.
    """
    crease_offset_px: Offset_px = 5
    """Distance between the three depth samples that measure a concave crease, in pixels."""
    crease_low_deg: Angle_deg = 30.0
    """Minimum angle between the two sides of a concave crease, in degrees. Larger values give fewer contours."""
    crease_high_deg: Angle_deg = 140.0
    """Maximum angle between the two sides of a concave crease, in degrees. Larger values give more contours. 0 finds no
    creases.
    """
    crease_noise: NotNegative | None = None
    """Minimum depth of a crease behind the straight line between the depth samples on its two sides, as a multiple of
    the frame's depth noise. Larger values find fewer creases in noise. If None, there is no minimum.
    """
    holes_from: Share | None = None
    """Minimum share of missing depth in a frame at which hole outlines and the image edges inside holes become
    contours. These contours keep holes from connecting regions. If None, the rule is off.
    """


class Merging(Settings):
    """Merging of neighbouring regions by the mean boundary value along their common border."""

    max_mean: Share = 0.4
    """Maximum mean boundary value along the common border of two regions that are merged. Larger values merge more."""
    line: Share = 0.35
    """Minimum boundary value of a pixel that counts as part of a boundary line. Larger values give fewer lines."""
    min_open_px2: Area_px2 = 200.0
    """Minimum area of a region outside boundary lines, px^2. A region with a smaller area is merged with the neighbour
    across the weakest border.
    """


class Refinement(Settings):
    """Refinement of object outlines by colour where depth is missing or smeared.

    The pixels in a band along object borders lose their labels. A spanning forest over colour differences grows from
    the pixels outside the band. The forest assigns each pixel of the band to an object or to the background.
    """

    ramp_factor: NotNegative = 5.0
    """Width of the band of refined pixels on each side of a border, as a multiple of the ramp width. A ramp is a depth
    step that is spread over several pixels, as in stereo depth. Larger values refine more pixels.
    """
    min_width_px: Length_px = 2
    """Minimum width of the band of refined pixels on each side of a border, in pixels. Larger values refine more
    pixels.
    """
    max_width_px: Length_px = 10
    """Maximum width of the band of refined pixels on each side of a border, in pixels. Larger values refine more
    pixels.
    """
    hole_width_px: Annotated[int, Field(ge=0, le=250), Grows()] = 20
    """Width of the band of refined pixels on missing depth, such as shadows, px, if larger than the width elsewhere.
    Larger values refine more pixels.
    """
    near_hole_px: Length_px = 1
    """Maximum distance to missing depth of the pixels to which `hole_width_px` applies, in pixels. Larger values refine
    more pixels.
    """
    reach_px: Offset_px = 8
    """Distance from a border up to which ramp widths are measured, in pixels."""
    min_profiles: Annotated[int, Field(ge=1)] = 40
    """Minimum number of depth steps from which the ramp width is measured. With fewer steps, the band of refined pixels
    has the width `min_width_px`.
    """
    max_opened: Share = 0.6
    """Maximum share of an object's thickness that the band of refined pixels may cover. The innermost pixels keep their
    label, so that small objects do not vanish. Larger values refine more pixels.
    """
    min_solidity: Share | None = 0.5
    """Minimum share of the convex hull that an object fills (solidity). If an object has at least this solidity,
    background pixels inside its hull are refined too. If None, the rule is off.
    """
    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Sigma of the Gaussian smoothing of the colour image before colour differences are computed, in pixels. 0 does not
    smooth. Larger values suppress more noise.
    """
    step_m: Positive = 0.018
    """Depth difference between neighbouring pixels that counts as a full depth step, in metres. Larger values give
    depth less influence.
    """
    step_per_m: NotNegative = 0.0083
    """Depth difference per squared distance that counts as a full depth step, 1/m. The limit is max(`step_m`,
    `step_per_m` * distance^2). Larger values give depth less influence at long range.
    """
    step_weight: NotNegative = 40.0
    """Weight of a full depth step between measured pixels, in grey levels of colour difference. Larger values keep
    outlines on sharp depth steps.
    """


class Additions(Settings):
    """Our additions to the paper. All additions are off by default."""

    support: Support | None = None
    """Find the support plane, and reject regions that are not above the plane."""
    packing: Packing | None = None
    """Warn if a layer of packed objects may have been mistaken for the support plane. No region is rejected."""
    contours: DepthContours | None = None
    """Add depth steps and creases to the boundary map. Effective only if the cost function reads the boundary map."""
    merging: Merging | None = None
    """Merge neighbouring regions if the mean boundary value along their common border is small. Effective only if the
    cost function reads the boundary map.
    """
    joining: Joining | None = None
    """Join the parts of an object that the partition separated. Requires `support`."""
    rules: Rules = Rules()
    """Reject regions by our rules, in addition to the rules of the paper."""
    refinement: Refinement | None = None
    """Refine the outlines of objects by colour where depth is missing or smeared."""
    noise_per_m: NotNegative = 0.0
    """Depth difference per squared distance that eq. 9 treats as zero, 1/m. Larger values remove more of the borders
    that the steps of quantised depth leave inside large regions.
    """
    line_px: Offset_px = 1
    """Width of the boundary lines E_F before blurring, in pixels. 1: as in eq. 20. Larger values close gaps in the
    lines.
    """
    lengths_grow: bool = False
    """Scale lengths in pixels with the image. All lengths are stated for a 640x480 image."""
    resolution: Literal["full", "half"] = "full"
    """Image size at which the frame is partitioned. `half` halves width and height, and then refines the outlines of
    objects at full size. At 1280x720, `half` takes less than half of the time, but loses objects of a few pixels.
    """

    @model_validator(mode="after")
    def _has_support(self) -> Additions:
        if self.joining is not None and self.support is None:
            raise ValueError(
                "joining requires additions.support, because joining tests which parts stand on the support plane:"
                " switch off joining too (--additions.joining none)"
            )
        return self
