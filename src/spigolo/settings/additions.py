"""The numbers of our additions to the paper. `Config.additions` is None in the paper's presets.

Lengths in pixels are those of a 640x480 image. They grow with the image where `Additions.lengths_grow` is set.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

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


class Facing(Settings):
    """Direction that a plane must face to be a support: things stand on it."""

    up: tuple[float, float, float] | None = None
    """Upward direction in the camera's frame (X right, Y down, Z forward), of any length. None assumes a camera that
    looks level or down and is not turned on its side."""
    max_tilt_deg: Annotated[float, Field(ge=0, le=90)] = 30.0
    """Maximum angle between the plane's normal and `up`, degrees."""
    max_roll_deg: Annotated[float, Field(ge=0, le=90)] = 40.0
    """Angle of the normal to the image's vertical plane, degrees, beyond which a plane faces sideways. Without `up`
    only."""
    max_down_deg: Annotated[float, Field(ge=0, le=90)] = 20.0
    """Maximum angle, degrees, by which the normal may point down in the image. A larger one is a ceiling. Without `up`
    only."""
    min_share_sideways: Share = 0.5
    """Minimum share of the measured pixels on a plane that faces sideways. The camera may be mounted on its side."""

    @model_validator(mode="after")
    def _up_points_somewhere(self) -> Facing:
        if self.up is not None and not any(self.up):
            raise ValueError("expected a direction as additions.support.facing.up, such as [0, -1, 0], got [0, 0, 0]")
        return self


class Support(Settings):
    """The support plane: the largest plane of the frame, and the test which pixels stand above it."""

    min_height_m: Positive = 0.008
    """Minimum height above the plane, m. Lower pixels belong to the plane."""
    noise_per_m: NotNegative = 0.0056
    """The same per squared distance, 1/m: twice the depth error. The larger of both limits holds."""
    min_above: Share = 0.6
    """Minimum share of a region's measured pixels that stand above the plane."""
    min_share: Share = 0.15
    """Minimum share of the measured pixels that lie on a support plane."""
    contour: bool = True
    """Add the outline of all that stands above the plane to the boundary map."""
    stacked_share: Positive | None = None
    """Minimum size of a plane above the largest one and parallel to it, as a share of the largest one's pixels. A plane
    of that size is taken instead: the table rather than the floor. None takes the largest plane.
    """
    facing: Facing | None = None
    """Skip planes on which nothing can stand: ceilings and side walls. None skips none."""
    min_things: Share | None = None
    """Minimum share of the measured pixels that stand on the largest plane. With fewer, the next plane with so many
    things is taken: the floor of a bin rather than its wall. None takes the largest plane."""
    near_roi: NotNegative | None = None
    """Margin around the region of interest, as a share of its size, in which the plane is looked for. None looks in the
    whole frame."""
    within_reach: bool = False
    """Look for the plane only within `Rejection.max_distance_m`."""
    opaque: bool = False
    """Skip planes that surround points below them, such as the front of a shelf, for the next largest plane. In frames
    without much of their depth, also skip planes with more points below than on them."""


class Packing(Settings):
    """Warning that a layer of packed objects was taken for the support."""

    min_share: Share = 0.6
    """Minimum share of the measured pixels on the support."""
    min_edges: Share = 0.9
    """Minimum share of the support close to a colour edge in it."""
    max_things: Share = 0.02
    """Maximum share of the measured pixels that stand on the support."""


class DepthContours(Settings):
    """Contours: depth steps and concave creases of the depth map alone, added to the boundary map.

    For this purpose a shadow gets the depth of its farther side, so that the contour of an object lies where its
    shadow begins.
    """

    max_shadow_px: Length_px = 60
    """Widest shadow that gets the depth of its farther side, px."""
    step_offset_px: Offset_px = 2
    """Offset of the depth samples on both sides of a pixel, px."""
    step_m: NotNegative = 0.015
    """Minimum bend of the depth that makes a step, m. Larger values give fewer contours."""
    step_per_m: NotNegative = 0.012
    """The same per squared distance, 1/m, so that noise far away makes no step. The larger of both limits holds."""
    crease_offset_px: Offset_px = 5
    """Offset of the three points of a concave crease, px."""
    crease_low_deg: Angle_deg = 30.0
    """Smallest angle of a crease, degrees."""
    crease_high_deg: Angle_deg = 140.0
    """Largest angle of a crease, degrees. Larger values give more contours. 0 finds no creases."""
    crease_noise: NotNegative | None = None
    """Minimum depth of a crease behind the chord of its sides, as a multiple of the frame's own depth noise. None:
    every crease counts, however short its sides are in metres."""
    holes_from: Share | None = None
    """Minimum share of missing depth from which hole outlines are contours too. The image edges inside holes then
    become contours as well, so that regions do not leak through. None: off.
    """


class Merging(Settings):
    """Merging of regions over their whole common border."""

    max_mean: Share = 0.4
    """Maximum mean boundary along the whole common border of two regions that merge. Larger values merge more."""
    line: Share = 0.35
    """Minimum boundary of a pixel on a line."""
    min_open_px2: Area_px2 = 200.0
    """Minimum number of pixels off the lines in a region. A smaller one joins the neighbour with the weakest border."""


class Vessel(Settings):
    """The wall and the inside of a cup, bowl or pot.

    Hollowness is the depth of a region's middle behind its chords along image rows, as a share of their length. It is
    positive where the region curves away from the camera.
    """

    min_behind_m: Positive = 0.02
    """Minimum mean depth step from the wall to the inside, m."""
    max_hollow_front: float = -0.1
    """Maximum hollowness of the wall, which bulges."""
    min_hollow_back: float = -0.11
    """Minimum hollowness of the inside, which looks flat if only its back is seen or depth is missing."""
    min_contrast: float = 0.15
    """Minimum difference of both hollownesses."""
    top_m: NotNegative = 0.008
    """Maximum height difference of both tops above the support, m."""
    top_share: Share = 0.1
    """The same as a share of the height. The larger of both limits holds."""
    min_solidity: Share = 0.87
    """Minimum solidity: the share of their convex hull that both regions fill together."""
    sure_hollow_back: float = -0.01
    """Hollowness above which a region is certainly an inside."""
    sure_contrast: float = 0.25
    """Minimum difference in hollowness to the wall for the same."""
    sure_solidity: Share = 0.75
    """Minimum solidity once both hold."""


class Cap(Settings):
    """The upper face of an object, or the inside of a cup that the camera saw filled."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth step between both regions, m."""
    max_bend_m: float = 0.006
    """Maximum mean depth of the border behind the chord of its sides, m. A larger one is a valley between two
    objects."""
    top_share: Share = 0.2
    """Maximum difference of both tops as a share of their height above the support."""
    min_solidity: Share = 0.9
    """Minimum solidity: the share of their convex hull that both regions fill together."""


class Smooth(Settings):
    """A flat or convex surface that noise cut in two."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth step across the border, m."""
    max_bend_m: float = 0.0015
    """Maximum mean depth of the border behind the chord of its sides, m. A larger one is a valley between two
    objects."""
    max_boundary: Share = 0.75
    """Maximum mean boundary along the border."""


class Joining(Settings):
    """Rules that join the parts of one object. None switches a rule off."""

    vessel: Vessel | None = None
    """Join the wall of a cup, bowl or pot with its inside."""
    cap: Cap | None = None
    """Join an upper face with the region below it."""
    smooth: Smooth | None = None
    """Join regions whose surface continues across their border."""
    enclosed: Share | None = None
    """Minimum share of a region's surroundings that belongs to one object for a region on the plane to join it."""
    reach_px: Offset_px = 4
    """Offset of the samples on both sides of a border, px."""
    margin_px: Annotated[int, Field(ge=0, le=100), Grows()] = 3
    """Distance of a chord's ends from the region's outline, px, where depth mixes object and background."""
    min_border_px: Annotated[int, Field(ge=1), Grows()] = 12
    """Minimum length of a border, px. Shorter borders are not tested."""
    min_measured: Share = 0.5
    """Minimum share of a border, and of a region, with depth."""
    min_above: Share = 0.5
    """Minimum share of a region's measured pixels above the support for it to be a part."""
    max_share: Share = 0.25
    """Maximum share of the image that a part may have."""


class Wall(Settings):
    """Rules against walls and rims of bins and shelves, which stand as tall as objects do.

    An object stands free: along its own outline, depth steps back to what is behind. If the other side is nearer by a
    step, the outline belongs to the object in front and does not count.
    """

    min_hides: Share = 0.15
    """Minimum share of a region's own outline beyond which depth steps back. The image border hides nothing."""
    min_hides_cut: NotNegative = 0.7
    """Increase of that minimum, times the share of the outline on the image border."""
    slant_deg: Angle_deg = 36.0
    """Angle between a region's mean normal and the line of sight, degrees, above which the minimum increases. The faces
    of a whole object look towards the camera on average. The side of a compartment is seen at a slant."""
    hides_per_deg: NotNegative = 0.025
    """Increase of the minimum for each degree above `slant_deg`."""
    min_height_m: Positive = 0.06
    """Height above the support, m, that 5 % of a region must reach to be tested. Low objects hide little. Without a
    support every region is tested."""
    min_measured: Share = 0.4
    """Minimum share of a region's outline with depth on both sides for it to be tested."""
    reach_px: Annotated[int, Field(ge=1, le=100), Grows(always=True)] = 4
    """Offset of the depth samples on both sides of the outline, px. It always grows with the image."""
    shadow_px: Annotated[int, Field(ge=0, le=1000), Grows(always=True)] = 60
    """Widest gap without depth beyond an outline across which depth is compared, px. It always grows with the image."""
    step_m: NotNegative = 0.012
    """Minimum step of depth, m, beyond the region's own slope there. It adds to `step_share`."""
    step_share: Share = 0.006
    """The same as a share of the distance."""
    max_cut_ratio: Annotated[float, Field(ge=1)] | None = 3.5
    """Maximum length over width of a region that the image cuts off. Longer ones are rails, rims or legs."""


class Ledge(Settings):
    """Flat objects, whose outline is too low for the boundary map."""

    min_share: Share = 0.5
    """Minimum share of a region's outline along which its height above the support steps. Such a region is kept even if
    its mean boundary is below `min_contour`."""
    step_m: Positive = 0.006
    """Minimum step of height, m."""
    step_per_m: NotNegative = 0.0056
    """The same per squared distance, 1/m: twice the depth error. The larger of both limits holds."""


class Rules(Settings):
    """Our rules that reject regions, next to those of the paper. None switches a rule off."""

    wall: Wall | None = None
    """Reject tall regions that hide nothing. Needs a support."""
    ledge: Ledge | None = None
    """Keep flat regions with a weak contour if height steps along their outline. Needs a support and `wall`."""
    min_contour: Share | None = None
    """Minimum mean boundary along a region's border. A cost without boundary map uses the weights."""
    min_contour_holes: Share | None = None
    """The same in frames whose holes have contours (`DepthContours.holes_from`), where hardly a region lacks them.
    None: `min_contour` holds there too."""
    metric: bool = False
    """Judge sizes in metres wherever intrinsics are known. The limits in pixels then hold only without intrinsics."""
    max_length_m: Positive | None = None
    """Maximum length, m, of a rectangle with the region's spread at its distance. It differs from the length of the
    oriented box, which is measured in space between the outermost points."""
    max_width_m: Positive | None = None
    """Maximum width of that rectangle, m."""


class Refinement(Settings):
    """Outlines of objects, drawn again by colour if depth is missing or smeared.

    A band along the borders of objects is opened. A spanning forest over colour differences gives each open pixel to an
    object or to the background. It grows from the pixels outside the band.
    """

    ramp_factor: NotNegative = 5.0
    """Width of the band for each pixel of ramp. The ramp is the mean number of pixels between the near and the far
    depth of the frame's depth steps. Wider ramps mean a coarser sensor: stereo smears steps, structured light hardly
    does.
    """
    min_width_px: Length_px = 2
    """Minimum width of the band on each side of a border, also without ramps."""
    max_width_px: Length_px = 10
    """Maximum width of the band on each side of a border."""
    hole_width_px: Annotated[int, Field(ge=0, le=250), Grows()] = 20
    """Maximum width of the band at missing depth: shadows and rims of objects."""
    near_hole_px: Length_px = 1
    """Distance to missing depth up to which measured depth is not trusted either."""
    reach_px: Offset_px = 8
    """Length on each side of a border along which ramps are counted."""
    min_profiles: Annotated[int, Field(ge=1)] = 40
    """Minimum number of depth steps to measure ramps from. With fewer, the band has its minimum width."""
    max_opened: Share = 0.6
    """Maximum share of the layers of a small object that is opened: its innermost pixels stay."""
    min_solidity: Share | None = 0.5
    """Minimum share of an object's convex hull that it fills for the background inside the hull to be opened."""
    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Gaussian smoothing of the colour image before differences are taken. 0 smooths nothing."""
    step_m: Positive = 0.018
    """Depth difference between neighbours that counts as a full step."""
    step_per_m: NotNegative = 0.0083
    """The same per squared distance, 1/m. The larger of both applies."""
    step_weight: NotNegative = 40.0
    """Weight of a full depth step between measured pixels, in grey levels of colour difference. A larger weight keeps
    outlines on sharp steps.
    """


class Additions(Settings):
    """Our additions to the paper. Each is off by default."""

    support: Support | None = None
    """Find the support plane. Regions that do not stand above it are no objects."""
    packing: Packing | None = None
    """Warn if a layer of packed objects was taken for the support. Nothing is rejected."""
    contours: DepthContours | None = None
    """Add depth steps and creases to the boundary map, if the cost function reads it."""
    merging: Merging | None = None
    """Merge regions over their whole common border, if the cost function reads the boundary map."""
    joining: Joining | None = None
    """Join the parts of an object that the partition cut. Needs a support."""
    rules: Rules = Rules()
    """Reject more regions than the paper does."""
    refinement: Refinement | None = None
    """Draw the outlines of objects again by colour if depth is missing or smeared."""
    noise_per_m: NotNegative = 0.0
    """Depth difference per squared distance, 1/m, up to which eq. 9 counts none. Depth comes in steps, whose borders
    would otherwise stay in a large region of equal depths."""
    line_px: Offset_px = 1
    """Width of the lines of E_F before they are blurred, px. 1 is eq. 20."""
    lengths_grow: bool = False
    """Let lengths in pixels grow with the image, so that twice the resolution shows the same edges, twice as wide."""
    resolution: Literal["full", "half"] = "full"
    """Size at which the frame is partitioned. `half` takes half the width and height, and draws the outlines of objects
    again at full size. A frame of 1280x720 then takes less than half of the time. Things of a few pixels are lost."""

    @model_validator(mode="after")
    def _has_support(self) -> Additions:
        if self.joining is not None and self.support is None:
            raise ValueError(
                "joining needs additions.support, as its rules test what stands on the plane: switch it off too"
                " (--additions.joining none)"
            )
        return self
