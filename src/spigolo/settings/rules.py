"""Parameters of the rules that reject or keep regions, in addition to those of the paper (`Additions.rules`)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Angle_deg, Grows, NotNegative, Positive, Settings, Share


class Wall(Settings):
    """Rules that reject walls and rims of bins and shelves, which are as tall as objects.

    An object stands free: the depth beyond its own outline is larger by a step. Where the other side is nearer by a
    step, the outline belongs to the object in front and does not count.
    """

    min_hides: Share = 0.15
    """Minimum share of a region's own outline beyond which the depth is larger by a step. The image border does not
    count as such a step.
    """
    min_hides_cut: NotNegative = 0.7
    """Increase of the minimum `min_hides`, per share of the outline that lies on the image border."""
    slant_deg: Angle_deg = 36.0
    """Angle between a region's mean normal and the line of sight above which `min_hides` increases, degrees. The faces
    of a whole object look towards the camera on average, in contrast to the side of a compartment.
    """
    hides_per_deg: NotNegative = 0.025
    """Increase of the minimum `min_hides` for each degree above `slant_deg`."""
    min_height_m: Positive = 0.06
    """Minimum height above the support that 5 % of a region must reach for the test, m. Lower objects hide too little.
    Without a support, every region is tested.
    """
    min_measured: Share = 0.4
    """Minimum share of a region's outline with depth on both sides. Regions with a smaller share are not tested."""
    reach_px: Annotated[int, Field(ge=1, le=100), Grows(always=True)] = 4
    """Distance from the outline to the depth samples on both sides, px. This length always grows with the image."""
    shadow_px: Annotated[int, Field(ge=0, le=1000), Grows(always=True)] = 60
    """Maximum width of missing depth beyond an outline across which depths are compared, px. This length always grows
    with the image.
    """
    step_m: NotNegative = 0.012
    """Minimum depth step beyond a region's outline, m, in addition to the slope of the region there. The limit is the
    sum of `step_m` and of `step_share` times the distance.
    """
    step_share: Share = 0.006
    """Minimum depth step beyond a region's outline, as a share of the distance. The limit is the sum of `step_m` and of
    this share times the distance.
    """
    max_cut_ratio: Annotated[float, Field(ge=1)] | None = 3.5
    """Maximum ratio of length to width of a region that the image border cuts off. Longer regions are rails, rims or
    legs. None: no limit.
    """


class Ledge(Settings):
    """Rule that keeps flat objects, which are too low for a strong boundary."""

    min_share: Share = 0.5
    """Minimum share of a region's outline along which its height above the support changes by a step. Such a region is
    kept even if its mean boundary value is below `min_contour`.
    """
    step_m: Positive = 0.006
    """Minimum step in height at the outline, m."""
    step_per_m: NotNegative = 0.0056
    """Minimum step in height per squared distance, 1/m: twice the depth error. The larger of this limit and `step_m`
    applies.
    """


class Rules(Settings):
    """Rules that reject regions, in addition to those of the paper. None switches a rule off."""

    wall: Wall | None = None
    """Reject tall regions that hide nothing behind them. Requires a support."""
    ledge: Ledge | None = None
    """Keep flat regions with a weak boundary if the height changes by a step along their outline. Requires a support
    and `wall`.
    """
    min_contour: Share | None = None
    """Minimum mean boundary value along a region's border. If the cost function reads no boundary map, the edge weights
    are used.
    """
    min_contour_holes: Share | None = None
    """Minimum mean boundary value in frames whose hole outlines are contours (`DepthContours.holes_from`). In these
    frames almost every region has contours. None: `min_contour` applies there too.
    """
    metric: bool = False
    """Limit sizes in metres if intrinsics are known. The limits in pixels then apply only without intrinsics."""
    max_length_m: Positive | None = None
    """Maximum length of a region, m, estimated by a rectangle with the region's spread at its distance. It differs from
    the length of the oriented box, which is measured in space between the outermost points. None: no limit.
    """
    max_width_m: Positive | None = None
    """Maximum width of a region, m, estimated by the same rectangle as its length. None: no limit."""
