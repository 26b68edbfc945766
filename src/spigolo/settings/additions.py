"""The numbers of what is not in the paper, one frozen model for each addition; all are off in the paper's presets.

Lengths in pixels are those of a 640x480 image; they grow with the image where `Config.lengths_grow` is set.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Grows, Length_px, NotNegative, Offset_px, Positive, Share, Stage


class DepthContours(Stage):
    """Boundaries found in the depth map alone and joined to the final map (our addition, not in the paper).

    Shadows are filled with the farther side of their row for this purpose only, so that the contour of an object
    stands where its shadow begins, and does not depend on a colour edge.
    """

    max_shadow_px: Length_px = 60
    """Widest shadow that is filled so."""
    step_offset_px: Offset_px = 2
    """Where depth is compared on both sides of a pixel."""
    step_m: NotNegative = 0.015
    """Least bend of the depth that makes a step."""
    step_per_m: NotNegative = 0.012
    """The same per squared distance, 1/m, so that noise far away makes no step; the larger of both holds."""
    crease_offset_px: Offset_px = 5
    """Where the three points of a concave crease are sampled."""
    crease_low_deg: Annotated[float, Field(ge=0, le=180)] = 30.0
    """Smallest angle of a crease."""
    crease_high_deg: Annotated[float, Field(ge=0, le=180)] = 140.0
    """Largest angle of a crease; 0 looks for no creases."""
    holes_from: Share | None = None
    """Share of the frame without depth from which on the borders of what is missing are boundaries too, and all
    colour edges in it, as wide as those, so that regions do not flood through. None takes none."""
    holes_min_contour: Share | None = None
    """What takes the place of `Rejection.min_contour` in such frames, where hardly a region is without contours."""


class Support(Stage):
    """The largest plane of the frame, and what stands on it (our addition, not in the paper)."""

    min_height_m: Positive = 0.008
    """What rises less above the plane belongs to it."""
    noise_per_m: NotNegative = 0.0056
    """The same per squared distance, 1/m: twice the depth error; the larger of both holds."""
    min_above: Share = 0.6
    """Least share of a region's measured pixels that must stand above the plane."""
    min_share: Share = 0.15
    """A plane with a smaller share of the measured pixels supports nothing."""
    contour: bool = True
    """Join the border of what stands above the plane to the final map, where the cost reads that."""
    stacked_share: Positive | None = None
    """Take the largest plane that lies above the largest one and along it, if it has at least this share of that one's
    pixels: the table in place of the floor below it. None takes the largest."""
    opaque: bool = False
    """Leave out planes that surround what lies below them, as the front of a shelf or a heap of things does, for the
    next largest: a table hides the floor. In frames that lack much of their depth also those below which more lies
    than on them. Where all do so, the largest stays."""


class Wall(Stage):
    """Walls and rims of bins and shelves, which stand as tall as objects do (our addition, not in the paper)."""

    min_hides: Share = 0.15
    """Least share of a region's contour beyond which depth steps back; the image border hides nothing."""
    min_hides_cut: NotNegative = 0.7
    """More is asked of regions that the image cuts off: plus this times the share of their contour on its border.
    Where half of it lies there, none can hide enough."""
    min_height_m: Positive = 0.06
    """Regions less than 5 % of which stand so high above the support are not asked: low objects hide little. Without a
    support all are asked."""
    min_measured: Share = 0.4
    """Nor are those of whose contour a smaller share has depth on both sides."""
    reach_px: Annotated[int, Field(ge=1, le=100)] = 4
    """Where depth is compared on both sides of the contour; grows with the image."""
    step_m: NotNegative = 0.012
    """Least step back, beyond what the region's own slope there explains,"""
    step_share: Share = 0.006
    """plus this share of the distance."""
    max_lean_deg: Annotated[float, Field(ge=0, le=180)] = 48.0
    """Largest angle between a region's mean normal and the line of sight. The faces of a whole object look towards the
    camera on average, three faces of a box at a corner straight at it; the side of a compartment is seen at a slant."""
    leaning_deg: Annotated[float, Field(ge=0, le=180)] = 40.0
    """Beyond this angle already more is asked:"""
    min_hides_leaning: Share = 0.35
    """an object that leans so far stands free, the side of a compartment goes over into its back."""
    max_cut_ratio: Annotated[float, Field(ge=1)] = 3.5
    """Largest length over width of a region that the image cuts off: longer ones are rails, rims or legs."""
    rim_m: Positive = 0.01
    """A level region, 65 % of which lie within this of its median height above the support, may be part of a rim;"""
    max_rim: NotNegative = 1.5
    """it is one if at that height there lie more than so many times its pixels that belong to no object."""


class Vessel(Stage):
    """Wall and inside of a cup, bowl or pot. Hollowness: depth of a region's middle behind its chords along image rows,
    as a share of their length; positive where it curves away from the camera.
    """

    min_behind_m: Positive = 0.02
    """Least mean depth step from the wall to the inside."""
    max_hollow_front: float = -0.1
    """Largest hollowness of the wall, which bulges."""
    min_hollow_back: float = -0.11
    """Least hollowness of the inside, which looks flat where its back alone is seen or depth is missing."""
    min_contrast: float = 0.15
    """Least difference of both."""
    top_m: NotNegative = 0.008
    """Both end at one height above the support, within this,"""
    top_share: Share = 0.1
    """or within this share of it."""
    min_solidity: Share = 0.87
    """Least share of their convex hull that both fill together."""
    sure_hollow_back: float = -0.01
    """An inside at least so hollow,"""
    sure_contrast: float = 0.25
    """and by so much more than the wall, is one beyond doubt:"""
    sure_solidity: Share = 0.75
    """then this share is enough."""


class Cap(Stage):
    """The upper face of an object, or the inside of a cup that the camera saw filled."""

    max_gap_m: Positive = 0.025
    """Largest mean depth step between both."""
    max_bend_m: float = 0.006
    """Largest mean depth of the border behind the chord of its sides: more is the valley between two objects."""
    top_share: Share = 0.2
    """Both end at one height above the support, within this share of it."""
    min_solidity: Share = 0.9
    """Least share of their convex hull that both fill together."""


class Smooth(Stage):
    """A surface that goes on, flat or convex, where noise looked like a contour."""

    max_gap_m: Positive = 0.025
    """Largest mean depth step across the border."""
    max_bend_m: float = 0.0015
    """Largest mean depth of the border behind the chord of its sides: more is a valley between two objects."""
    max_boundary: Share = 0.75
    """Largest mean boundary along the border."""


class Joining(Stage):
    """Which regions are parts of one object (our addition, not in the paper). None leaves a rule out."""

    vessel: Vessel | None = None
    """The wall of a cup, bowl or pot with its inside."""
    cap: Cap | None = None
    """An upper face with what lies below it."""
    smooth: Smooth | None = None
    """A surface that goes on across the border."""
    enclosed: Share | None = None
    """Least share of its surroundings that belongs to one object for a region on the plane to be part of it."""
    reach_px: Offset_px = 4
    """Where both sides of a border are sampled."""
    margin_px: Annotated[int, Field(ge=0, le=100), Grows()] = 3
    """How far inside a region the ends of its chords are taken: depth at a contour is a mixture."""
    min_border_px: Annotated[int, Field(ge=1), Grows()] = 12
    """Shorter borders say nothing."""
    min_measured: Share = 0.5
    """Least share of a border, and of a region, with depth."""
    min_above: Share = 0.5
    """Least share of a region's measured pixels above the support for it to stand there."""
    max_share: Share = 0.25
    """Regions with a larger share of the image are no parts."""
