"""Parameters of our rules that reject or keep regions (`Additions.rules`). The module `settings.paper` contains the
parameters of the paper's rules.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Angle_deg, Grows, NotNegative, Positive, Settings, Share


class Wall(Settings):
    """Rules that reject the walls and rims of bins and shelves. Walls and rims can have the same height above the
    support plane as objects.

    At the outline of a free-standing object, the depth outside is larger than the depth inside by a step. If the depth
    outside is smaller by a step, a nearer object hides part of the region. Parts of the outline next to a nearer object
    are not counted.
    """

    min_hides: Share = 0.15
    """Minimum share of a region's outline along which the depth outside is larger than the depth inside by a step.
    Regions with steps along a smaller share of their outline are rejected. Parts of the outline on the image border
    count as parts without a step.
    """
    min_hides_cut: NotNegative = 0.7
    """Increase of `min_hides` for regions that touch the image border. The increase is `min_hides_cut` multiplied by
    the share of the region's outline that lies on the image border. Larger values of `min_hides_cut` reject more
    regions at the image border.
    """
    slant_deg: Angle_deg = 36.0
    """Maximum angle between a region's mean surface normal and the line of sight at which `min_hides` is not increased,
    in degrees. For each degree above this angle, `min_hides` increases by `hides_per_deg`. The side wall of a bin faces
    sideways, while the visible faces of an object face the camera on average. A larger maximum angle rejects fewer
    regions.
    """
    hides_per_deg: NotNegative = 0.025
    """Increase of `min_hides` for each degree by which a region's slant is above `slant_deg`, 1/degree. The slant is
    the angle between the region's mean surface normal and the line of sight. Larger values of `hides_per_deg` reject
    more slanted regions.
    """
    min_height_m: Positive = 0.06
    """Minimum height of a region that is tested for being a wall, in metres. At least 5 % of the region's measured
    pixels must reach this height above the support plane. Lower regions are not tested for being a wall. If no support
    plane was found, every region is tested.
    """
    min_measured: Share = 0.4
    """Minimum share of a region's outline that has depth on both sides. If less of the outline has depth on both sides,
    `min_hides` is not tested.
    """
    reach_px: Annotated[int, Field(ge=1, le=100), Grows(always=True)] = 4
    """Distance from a region's outline to the depth samples on both sides, in pixels. The distance to the samples is
    always scaled with the image size.
    """
    shadow_px: Annotated[int, Field(ge=0, le=1000), Grows(always=True)] = 60
    """Maximum width of missing depth next to a region's outline, in pixels. Next to wider missing depth, the depths on
    both sides of the outline are not compared. The maximum width is always scaled with the image size.
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
    """Maximum length of a high region that touches the image border, divided by its width. High regions at the image
    border with a larger ratio of length to width are probably rails, rims or legs, and are rejected. If None, there is
    no maximum ratio.
    """


class Ledge(Settings):
    """Rule that keeps low objects although the boundary map is weak along their border."""

    min_share: Share = 0.5
    """Minimum share of a region's outline along which the height above the support plane changes by a step. A region
    with height steps along at least this share of its outline is not rejected by `min_contour`.
    """
    step_m: Positive = 0.006
    """Minimum difference in height above the support plane across a region's outline that counts as a step, in metres.
    With a larger minimum difference, fewer low regions are kept.
    """
    step_per_m: NotNegative = 0.0056
    """Minimum difference in height across a region's outline that counts as a step, divided by the squared distance,
    1/m. The minimum height difference is max(`step_m`, `step_per_m` * distance^2). With a larger minimum difference,
    fewer distant low regions are kept.
    """


class Rim(Settings):
    """Rule that rejects the rims of bins and trays, which surround the support plane. A rim is long and fills only a
    small part of its convex hull. Objects are shorter than rims, or fill most of their convex hull.
    """

    max_support: NotNegative = 0.3
    """Maximum area of the support plane inside the convex hull of a long region, divided by the area of the region.
    Regions with a larger ratio are rejected. A larger maximum ratio rejects fewer regions.
    """
    min_length_m: Positive = 0.35
    """Minimum length of a region that is tested for being a rim, in metres. The length of a region is estimated from
    the variances of its pixel coordinates (see `Rules.max_length_m`). Shorter regions, such as tools and cables, are
    not tested.
    """


class Rules(Settings):
    """Rules that reject regions, in addition to the rules of the paper. A rule of this class with the value None is
    switched off.
    """

    wall: Wall | None = None
    """Reject high regions that have few depth steps along their outline, such as the walls of a bin. The rule `wall`
    requires `additions.support`.
    """
    ledge: Ledge | None = None
    """Keep regions with a weak boundary, such as low objects, if their height differs from that of the surroundings by
    a step. The rule `ledge` requires `additions.support` and the rule `wall`.
    """
    rim: Rim | None = None
    """Reject long regions that surround the support plane, such as the rim of a tray. The rule `rim` requires
    `additions.support`.
    """
    min_contour: Share | None = None
    """Minimum mean boundary value (0 to 1) along a region's border. Regions with a smaller mean value are rejected. If
    the cost function does not use the boundary map, boundary values are computed from the edge weights.
    """
    min_contour_holes: Share | None = None
    """Minimum mean boundary value along a region's border in frames with much missing depth. In frames in which hole
    outlines count as contours (`DepthContours.holes_from`), the limit `min_contour_holes` replaces `min_contour`. If
    None, `min_contour` is used in all frames.
    """
    metric: bool = False
    """Ignore the size limits in pixels (`max_lambda1_px2`, `max_lambda2_px2`) if intrinsics are known. If intrinsics
    are known, only the size limits in metres apply.
    """
    min_length_m: Positive | None = None
    """Minimum length of a region, in metres. The length of a region is estimated from the variances of its pixel
    coordinates (see `max_length_m`). Regions below this length are rejected. If None, there is no minimum length.
    """
    max_length_m: Positive | None = None
    """Maximum length of a region, in metres. The length of a region is the longer side of a rectangle that faces the
    camera at the distance of the region. The pixel coordinates of the rectangle have the same variances as those of the
    region. The length of the rectangle can differ from the length of the region's oriented box. Regions above this
    length are rejected. If None, there is no maximum length.
    """
    max_width_m: Positive | None = None
    """Maximum width of a region, in metres. The width of a region is estimated from the variances of its pixel
    coordinates, as the shorter side of a rectangle (see `max_length_m`). Regions above this width are rejected. If
    None, there is no maximum width.
    """
