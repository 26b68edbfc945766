"""Parameters of our additions to the paper's method. In the paper's presets (SHELF, TABLE, CLUTTER), `Config.additions`
is None.

Three other modules contain further parameters of our additions. The module `settings.support` contains the parameters
of the support plane. The module `settings.joining` contains the parameters of the rules that join regions. The module
`settings.rules` contains the parameters of the rules that reject or keep regions.

Lengths in pixels are given for a 640x480 image. If `Additions.lengths_grow` is set, lengths in pixels are scaled with
the image size.
"""

from __future__ import annotations

from operator import attrgetter
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

NEED_SUPPORT = ("joining", "flats", "rules.wall", "rules.rim", "rules.ledge")
"""Names of the parts of `Additions` that have no effect without a support plane."""


class DepthContours(Settings):
    """Contours of objects that are added to the map of object boundaries. The contours are depth steps and concave
    creases, which are found in the depth map without the colour image.

    Before contours are searched, shadows (missing depth next to objects) are filled with the larger of the depths on
    both sides. The contour of an object then lies between the object and its shadow.
    """

    max_shadow_px: Length_px = 60
    """Maximum width of a shadow that is filled before contours are searched, in pixels. A shadow (missing depth next to
    an object) is filled with the larger one of the depths on its two sides. Shadows wider than this maximum width are
    not filled.
    """
    step_offset_px: Offset_px = 2
    """Distance from a pixel to each of two depth samples on opposite sides of the pixel, in pixels. The depths of the
    pixel and of both samples determine whether the pixel lies on a depth step. With a larger distance, depth steps that
    are smeared over more pixels are also detected.
    """
    step_m: NotNegative = 0.015
    """Minimum second difference of depth at a pixel that counts as a depth step, in metres. With a larger minimum,
    fewer depth steps are found.
    """
    step_per_m: NotNegative = 0.012
    """Minimum second difference of depth at a pixel that counts as a depth step, divided by the squared distance, 1/m.
    The minimum second difference is max(`step_m`, `step_per_m` * distance^2). Larger values give fewer false depth
    steps at large distances, where the depth noise is larger.
    """
    crease_offset_px: Offset_px = 5
    """Distance from a pixel to each of two depth samples on opposite sides of the pixel, in pixels. At a concave
    crease, the surfaces from the pixel to both samples meet at a certain angle.
    """
    crease_low_deg: Angle_deg = 30.0
    """Minimum angle between the two sides of a concave crease, in degrees. With a larger minimum angle, fewer creases
    are found.
    """
    crease_high_deg: Angle_deg = 140.0
    """Maximum angle between the two sides of a concave crease, in degrees. With a larger maximum angle, more creases
    are found. With a maximum angle of 0, no creases are found.
    """
    crease_noise: NotNegative | None = None
    """Minimum distance by which a crease pixel lies behind the straight line between its two depth samples, as a
    multiple of the frame's depth noise. With a larger minimum distance, fewer false creases are found in noise. If
    None, the distance behind the straight line is not tested.
    """
    holes_from: Share | None = None
    """Minimum share of missing depth in a frame in which holes (areas without depth) give contours. In frames with at
    least this share, hole outlines and the image edges inside holes become contours. Without contours at holes, regions
    on opposite sides of a hole could merge. If None, holes in the depth map give no contours.
    """


class Merging(Settings):
    """Merging of neighbouring regions whose common border has a small mean value in the boundary map."""

    max_mean: Share = 0.4
    """Maximum mean boundary value (0 to 1) along the common border of two regions that are merged. With a larger
    maximum mean value, more regions are merged.
    """
    line: Share = 0.35
    """Minimum boundary value (0 to 1) of a pixel that counts as part of a boundary line. A larger minimum gives thinner
    and fewer boundary lines.
    """
    min_open_px2: Area_px2 = 200.0
    """Minimum number of pixels of a region that are not part of a boundary line, px^2. A region with fewer pixels
    outside of boundary lines is merged with a neighbouring region. The neighbour with the smallest mean boundary value
    along the common border is chosen. With a larger minimum number of pixels, more regions are merged.
    """


class Refinement(Settings):
    """Refinement of object outlines by colour where depth is missing or smeared.

    The pixels in a band along object borders get new labels. A minimum spanning forest, with colour differences as edge
    weights, grows from the labelled pixels outside the band. Each tree of the forest passes the label of its first
    pixel to the band pixels that it reaches.
    """

    ramp_factor: NotNegative = 5.0
    """Width of the band in which pixels get new labels, on each side of an object border, as a multiple of the ramp
    width. A ramp is a depth step that is smeared over several pixels, as in stereo depth. A larger factor gives a wider
    band along object borders.
    """
    min_width_px: Length_px = 2
    """Minimum width of the band in which pixels get new labels, on each side of an object border, in pixels."""
    max_width_px: Length_px = 10
    """Maximum width of the band in which pixels get new labels, on each side of an object border, in pixels."""
    hole_width_px: Annotated[int, Field(ge=0, le=250), Grows()] = 20
    """Width of the band in which pixels get new labels where depth is missing, such as in shadows, in pixels. If the
    band is wider than `hole_width_px` elsewhere, it has that larger width also where depth is missing.
    """
    near_hole_px: Length_px = 1
    """Maximum distance of a pixel from missing depth, in pixels, at which `hole_width_px` is the width of the band
    along object borders.
    """
    reach_px: Offset_px = 8
    """Distance on each side of an object border within which the width of a ramp (smeared depth step) is measured, in
    pixels.
    """
    min_profiles: Annotated[int, Field(ge=1)] = 40
    """Minimum number of depth profiles across object borders from which the mean width of smeared depth steps is
    computed. With fewer profiles, the band in which pixels get new labels has the width `min_width_px`.
    """
    max_opened: Share = 0.6
    """Maximum share of an object's thickness in which pixels get new labels, if the object lies entirely inside the
    band along its border. The innermost pixels of a small object keep their labels, so that the object does not vanish.
    With a larger share, fewer pixels of small objects keep their labels.
    """
    min_solidity: Share | None = 0.5
    """Minimum solidity of an object: its area divided by the area of its convex hull. If an object has at least this
    solidity, background pixels inside its convex hull get new labels too. If None, background pixels inside convex
    hulls keep their labels.
    """
    sigma_px: Annotated[NotNegative, Field(le=100), Grows()] = 0.8
    """Sigma of the Gaussian smoothing of the colour image before colour differences are computed, in pixels. With 0,
    the image is not smoothed. With a larger sigma, more noise is suppressed.
    """
    step_m: Positive = 0.018
    """Minimum depth difference between neighbouring pixels that counts as a full depth step, in metres. With a larger
    minimum, depth has less influence on the outlines of objects.
    """
    step_per_m: NotNegative = 0.0083
    """Minimum depth difference that counts as a full depth step, divided by the squared distance, 1/m. The minimum
    depth difference is max(`step_m`, `step_per_m` * distance^2). With larger values, depth has less influence on the
    outlines of distant objects.
    """
    step_weight: NotNegative = 40.0
    """Weight of a full depth step between two neighbouring pixels, in the unit of colour differences (grey levels).
    With larger values, outlines follow sharp depth steps more closely.
    """


class Additions(Settings):
    """Our additions to the method of the paper. All additions are off by default."""

    support: Support | None = None
    """Find the support plane, and reject regions that are not above the plane."""
    packing: Packing | None = None
    """Warn if a layer of packed objects may have been mistaken for the support plane. The warning does not change the
    result.
    """
    contours: DepthContours | None = None
    """Add depth steps and concave creases to the boundary map. The added contours have an effect only if the cost
    function uses the boundary map.
    """
    merging: Merging | None = None
    """Merge neighbouring regions if the mean boundary value along their common border is small. Regions are merged by
    boundary values only if the cost function uses the boundary map.
    """
    joining: Joining | None = None
    """Join regions that are parts of one object. Joining requires the search for the support plane
    (`Additions.support`).
    """
    rules: Rules = Rules()
    """Rules that reject regions, in addition to the rules of the paper."""
    flats: Flats | None = None
    """Find flat objects on the support plane. Flat objects are found only if `Additions.support` is set."""
    refinement: Refinement | None = None
    """Refine the outlines of objects by colour where depth is missing or smeared."""
    noise_per_m: NotNegative = 0.0
    """Depth noise that is subtracted from the depth difference between neighbouring pixels (equation 9), divided by the
    squared distance, 1/m. The depth of some cameras is quantised, so that small depth steps divide large surfaces. With
    larger values, more of the small depth steps are ignored.
    """
    line_px: Offset_px = 1
    """Width of the boundary lines E_F before they are blurred, in pixels. The value 1 gives the lines of equation 20.
    Wider boundary lines close wider gaps between boundary pixels.
    """
    lengths_grow: bool = False
    """Scale all lengths in pixels with the image size. The lengths in a preset are given for a 640x480 image."""
    resolution: Literal["full", "half"] = "full"
    """Image size at which the frame is segmented. With `half`, the frame is segmented at half the width and height, and
    the outlines of objects are then refined at full size. For frames of 1280x720, `half` needs less than half of the
    time of `full`. At half resolution, small and flat objects may be missed.
    """

    @model_validator(mode="after")
    def _has_support(self) -> Additions:
        needy = [name for name in NEED_SUPPORT if attrgetter(name)(self) is not None]
        if self.support is None and needy:
            others = f"{', '.join(needy[:-1])} and {needy[-1]} require" if len(needy) > 1 else f"{needy[0]} requires"
            flags = " ".join(f"--additions.{name} none" for name in needy)
            raise ValueError(f"{others} additions.support: switch off the support plane only together with {flags}")
        return self
