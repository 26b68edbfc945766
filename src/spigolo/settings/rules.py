"""Parameters of our rules that reject or keep regions (`Additions.rules`). `settings.paper` contains the parameters of
the paper's rules.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Angle_deg, Grows, NotNegative, Positive, Settings, Share


class Wall(Settings):
    """Rules that reject the walls and rims of bins and shelves. Walls and rims can have the same height above the
    support plane as objects.

    At the outline of a free-standing object, the depth outside is larger than the depth inside by a step. If the depth
    outside is smaller by a step, an object in front hides the region. Parts of the outline next to an object in front
    are not counted.
    """

    min_hides: Share = 0.15
    """Minimum share of a region's outline along which the depth outside is larger than the depth inside by a step.
    Regions with a smaller share are rejected. Parts of the outline on the image border count as parts without a step.
    """
    min_hides_cut: NotNegative = 0.7
    """Increase of `min_hides` for regions that touch the image border. The increase is this value multiplied by the
    share of the region's outline that lies on the image border. Larger values reject more regions.
    """
    slant_deg: Angle_deg = 36.0
    """Maximum angle between a region's mean surface normal and the line of sight without an effect on `min_hides`, in
    degrees. For each degree above this angle, `min_hides` increases by `hides_per_deg`. The reason is that the side
    wall of a bin faces sideways, while the visible faces of an object face the camera on average. Larger values reject
    fewer regions.
    """
    hides_per_deg: NotNegative = 0.025
    """Increase of `min_hides` for each degree by which a region's slant is above `slant_deg`, 1/degree. Larger values
    reject more slanted regions.
    """
    min_height_m: Positive = 0.06
    """Minimum height of a region that is tested for being a wall, in metres. At least 5 % of the region's measured
    pixels must be this high above the support plane. Without a support plane, every region is tested.
    """
    min_measured: Share = 0.4
    """Minimum share of a region's outline that has depth on both sides. For regions with a smaller share, `min_hides`
    is not tested.
    """
    reach_px: Annotated[int, Field(ge=1, le=100), Grows(always=True)] = 4
    """Distance from a region's outline to the depth samples on both sides, in pixels. This length is always scaled with
    the image size.
    """
    shadow_px: Annotated[int, Field(ge=0, le=1000), Grows(always=True)] = 60
    """Maximum width of missing depth next to a region's outline, in pixels. If the missing depth is wider, depths on
    both sides of the outline are not compared. This length is always scaled with the image size.
    """
    step_m: NotNegative = 0.012
    """Minimum depth difference across a region's outline that counts as a step, in metres. The minimum depth difference
    is `step_m` + `step_share` * distance + the depth change due to the region's slope. With larger values, fewer steps
    are found and more regions are rejected.
    """
    step_share: Share = 0.006
    """Minimum depth difference across a region's outline that counts as a step, as a share of the distance. The minimum
    depth difference is `step_m` + `step_share` * distance + the depth change due to the region's slope. With larger
    values, fewer steps are found and more regions are rejected.
    """
    max_cut_ratio: Annotated[float, Field(ge=1)] | None = 3.5
    """Maximum length divided by width of a high region that touches the image border. Regions with a larger ratio are
    rejected, because they are probably rails, rims or legs. If None, there is no limit.
    """


class Ledge(Settings):
    """Rule that accepts low objects although the boundary along their border is weak."""

    min_share: Share = 0.5
    """Minimum share of a region's outline along which the height above the support plane changes by a step. A region
    with at least this share is not rejected by `min_contour`.
    """
    step_m: Positive = 0.006
    """Minimum difference in height above the support plane across a region's outline that counts as a step, in metres.
    With larger values, fewer regions are accepted.
    """
    step_per_m: NotNegative = 0.0056
    """Minimum difference in height across a region's outline that counts as a step, divided by the squared distance,
    1/m. The minimum height difference is max(`step_m`, `step_per_m` * distance^2). With larger values, fewer regions
    are accepted.
    """


class Rim(Settings):
    """Rule that rejects the rims of bins and trays, which surround the support plane. A rim is long and fills only a
    small part of its convex hull. Objects are shorter, or fill most of their convex hull.
    """

    max_support: NotNegative = 0.3
    """Maximum area of the support plane inside the convex hull of a long region, divided by the area of the region.
    Regions with a larger ratio are rejected. Larger values reject fewer regions.
    """
    min_length_m: Positive = 0.35
    """Minimum length of a region that is tested for being a rim, in metres. The length is estimated as described for
    `Rules.max_length_m`. Shorter regions, such as tools and cables, are not tested.
    """


class Rules(Settings):
    """Rules that reject regions, in addition to the rules of the paper. A rule with the value None is switched off."""

    wall: Wall | None = None
    """Reject high regions that have few depth steps along their outline, such as the walls of a bin. This rule requires
    `additions.support`.
    """
    ledge: Ledge | None = None
    """Accept flat regions with a weak boundary if their height differs from that of the surroundings by a step. This
    rule requires `additions.support` and `wall`.
    """
    rim: Rim | None = None
    """Reject long regions that surround the support plane, such as the rim of a tray. This rule requires
    `additions.support`.
    """
    min_contour: Share | None = None
    """Minimum mean boundary value along a region's border. Regions with a smaller value are rejected. If the cost
    function does not use the boundary map, boundary values are computed from the edge weights.
    """
    min_contour_holes: Share | None = None
    """Minimum mean boundary value along a region's border in frames with much missing depth. This limit replaces
    `min_contour` if hole outlines count as contours (`DepthContours.holes_from`). If None, `min_contour` is used in all
    frames.
    """
    metric: bool = False
    """Ignore the size limits in pixels (`max_lambda1_px2`, `max_lambda2_px2`) if intrinsics are known. Only the limits
    in metres then apply.
    """
    min_length_m: Positive | None = None
    """Minimum length of a region, in metres. The length is estimated as described for `max_length_m`. Larger values
    reject more small regions. If None, there is no limit.
    """
    max_length_m: Positive | None = None
    """Maximum length of a region, in metres. The length is the longer side of a rectangle that faces the camera at the
    distance of the region. The pixel coordinates of the rectangle have the same variances as those of the region. The
    length can differ from that of the oriented box. Larger values keep longer regions. If None, there is no limit.
    """
    max_width_m: Positive | None = None
    """Maximum width of a region, in metres. The width is the shorter side of the rectangle that is described for
    `max_length_m`. Larger values keep wider regions. If None, there is no limit.
    """
