"""Parameters of our rules that reject or keep regions (`Additions.rules`). `settings.paper` contains the parameters of
the paper's rules.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Angle_deg, Grows, NotNegative, Positive, Settings, Share


class Wall(Settings):
    """Rules that reject walls and rims of bins and shelves, which are as tall as objects.

    At the outline of a free-standing object, the depth outside is larger than the depth inside by a step. Where the
    depth outside is smaller, the outline belongs to an object in front and is not counted.
    """

    min_hides: Share = 0.15
    """Minimum share of a region's outline at which the depth outside is larger than the depth inside by a step. Regions
    with a smaller share are rejected. The image border does not count as a step.
    """
    min_hides_cut: NotNegative = 0.7
    """Increase of `min_hides` for a region whose whole outline lies on the image border. For other regions, the
    increase is multiplied by the share of the outline on the image border. Larger values reject more regions.
    """
    slant_deg: Angle_deg = 36.0
    """Angle between a region's mean normal and the line of sight above which `min_hides` increases, in degrees. The
    visible faces of a whole object point towards the camera on average, but the side wall of a compartment points
    sideways. Larger values reject fewer regions.
    """
    hides_per_deg: NotNegative = 0.025
    """Increase of `min_hides` for each degree above `slant_deg`, 1/degree. Larger values reject more slanted
    regions.
    """
    min_height_m: Positive = 0.06
    """Minimum height above the support plane that 5 % of a region's measured pixels must reach, so that the region is
    tested as a wall, in metres. Lower regions are not tested. Without a support plane, every region is tested.
    """
    min_measured: Share = 0.4
    """Minimum share of a region's outline with depth on both sides. For regions with a smaller share, `min_hides` is
    not tested.
    """
    reach_px: Annotated[int, Field(ge=1, le=100), Grows(always=True)] = 4
    """Distance from a region's outline to the depth samples on both sides, in pixels. This length always grows with the
    image.
    """
    shadow_px: Annotated[int, Field(ge=0, le=1000), Grows(always=True)] = 60
    """Maximum width of missing depth beyond an outline across which depths are compared, in pixels. This length always
    grows with the image.
    """
    step_m: NotNegative = 0.012
    """Minimum depth step across a region's outline, in metres. The limit is `step_m` + `step_share` * distance + the
    depth change due to the region's slope. Larger values find fewer steps and reject more regions.
    """
    step_share: Share = 0.006
    """Minimum depth step across a region's outline, as a share of the distance. The limit is `step_m` + `step_share` *
    distance + the depth change due to the region's slope. Larger values find fewer steps and reject more regions.
    """
    max_cut_ratio: Annotated[float, Field(ge=1)] | None = 3.5
    """Maximum ratio of length to width of a region that the image border cuts off. Regions with a larger ratio are
    rejected as rails, rims or legs. If None, there is no limit.
    """


class Ledge(Settings):
    """Rule that keeps flat objects, which are too low for a strong boundary."""

    min_share: Share = 0.5
    """Minimum share of a region's outline along which the height above the support plane changes by a step. A region
    with at least this share is kept even if its mean boundary value is below `min_contour`.
    """
    step_m: Positive = 0.006
    """Minimum step in height above the support plane along a region's outline, in metres. Larger values keep fewer
    regions.
    """
    step_per_m: NotNegative = 0.0056
    """Minimum step in height along a region's outline per squared distance, 1/m. The limit is max(`step_m`,
    `step_per_m` * distance^2). Larger values keep fewer regions.
    """


class Rim(Settings):
    """Rule that rejects rims of bins and trays, which surround the support plane. An object fills most of its convex
    hull, or is small.
    """

    max_support: NotNegative = 0.3
    """Maximum area of the support plane inside the convex hull of a long region, divided by the area of the region.
    Larger values reject fewer regions.
    """
    min_length_m: Positive = 0.35
    """Minimum length of a region for this rule, m, estimated as for `Rules.max_length_m`. Shorter regions, such as
    tools and cables, are not tested.
    """


class Rules(Settings):
    """Rules that reject regions, in addition to the rules of the paper. None switches a rule off."""

    wall: Wall | None = None
    """Reject tall regions without depth steps along their outline, such as the walls of a bin. Requires
    `additions.support`.
    """
    ledge: Ledge | None = None
    """Keep flat regions with a weak boundary if the height changes by a step along their outline. Requires
    `additions.support` and `wall`.
    """
    rim: Rim | None = None
    """Reject long regions that surround the support plane, such as the rim of a tray. Requires `additions.support`."""
    min_contour: Share | None = None
    """Minimum mean boundary value along a region's border. Regions with a smaller value are rejected. If the cost
    function reads no boundary map, the edge weights are used.
    """
    min_contour_holes: Share | None = None
    """Minimum mean boundary value along a region's border in frames whose hole outlines are contours
    (`DepthContours.holes_from`). If None, `min_contour` applies to all frames.
    """
    metric: bool = False
    """Limit sizes in metres if intrinsics are known. The limits in pixels then apply only without intrinsics."""
    min_length_m: Positive | None = None
    """Minimum length of a region, m, estimated as for `max_length_m`. Larger values reject more small regions. If None,
    there is no limit.
    """
    max_length_m: Positive | None = None
    """Maximum length of a region, in metres. The length is estimated as the longer side of a rectangle that faces the
    camera and has the spread and the distance of the region. The oriented box of an object may have another length.
    Larger values keep longer regions. If None, there is no limit.
    """
    max_width_m: Positive | None = None
    """Maximum width of a region, in metres. The width is estimated as the shorter side of a rectangle that faces the
    camera and has the spread and the distance of the region. Larger values keep wider regions. If None, there is no
    limit.
    """
