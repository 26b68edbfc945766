"""Parameters of the rules that join the parts of an object (`Additions.joining`)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Grows, NotNegative, Offset_px, Positive, Settings, Share


class Vessel(Settings):
    """Conditions to join the wall and the inside of a cup, bowl or pot.

    Hollowness is the depth of a region's middle behind its chords along image rows, as a share of their length.
    Hollowness is positive for a concave region and negative for a convex one.
    """

    min_behind_m: Positive = 0.02
    """Minimum mean depth step from the wall back to the inside, m."""
    max_hollow_front: float = -0.1
    """Maximum hollowness of the wall. The wall is convex, so the value is negative."""
    min_hollow_back: float = -0.11
    """Minimum hollowness of the inside. The inside looks flat if only its back is seen or depth is missing."""
    min_contrast: float = 0.15
    """Minimum difference between the hollowness of the inside and that of the wall."""
    top_m: NotNegative = 0.008
    """Maximum height difference between the top of the wall and the top of the inside, m."""
    top_share: Share = 0.1
    """Maximum height difference between both tops, as a share of their height above the support. The larger of this
    limit and `top_m` applies.
    """
    min_solidity: Share = 0.87
    """Minimum solidity of both regions together, which is the share of their convex hull that they fill."""
    sure_hollow_back: float = -0.01
    """Hollowness above which a region is certainly the inside of a vessel."""
    sure_contrast: float = 0.25
    """Minimum difference in hollowness to the wall for a region that is certainly an inside."""
    sure_solidity: Share = 0.75
    """Minimum solidity of wall and inside together if the region is certainly an inside."""


class Cap(Settings):
    """Conditions to join the upper face of an object with its side, or the inside of a filled cup with its wall."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth step between both regions, m."""
    max_bend_m: float = 0.006
    """Maximum mean depth of the border behind the line between its two sides, m. A deeper border is a valley between
    two objects.
    """
    top_share: Share = 0.2
    """Maximum height difference between both tops, as a share of their height above the support."""
    min_solidity: Share = 0.9
    """Minimum solidity of both regions together, which is the share of their convex hull that they fill."""


class Smooth(Settings):
    """Conditions to join two parts of one flat or convex surface that noise separated."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth step across the border, m."""
    max_bend_m: float = 0.0015
    """Maximum mean depth of the border behind the line between its two sides, m. A deeper border is a valley between
    two objects.
    """
    max_boundary: Share = 0.75
    """Maximum mean boundary value along the border."""


class Joining(Settings):
    """Rules that join the parts of one object. None switches a rule off."""

    vessel: Vessel | None = None
    """Join the wall of a cup, bowl or pot with its inside."""
    cap: Cap | None = None
    """Join an upper face with the region below it."""
    smooth: Smooth | None = None
    """Join regions whose surface continues across their border."""
    enclosed: Share | None = None
    """Minimum share of a region's surroundings that one object must fill. The region then joins that object although it
    lies on the support plane. None: off.
    """
    reach_px: Offset_px = 4
    """Distance from a border to the depth samples on both sides, px."""
    margin_px: Annotated[int, Field(ge=0, le=100), Grows()] = 3
    """Distance between the ends of a chord and the region's outline, px. Depth near the outline mixes object and
    background.
    """
    min_border_px: Annotated[int, Field(ge=1), Grows()] = 12
    """Minimum length of a border, px. Shorter borders are not tested."""
    min_measured: Share = 0.5
    """Minimum share of a border's pixels, and of a region's pixels, with measured depth."""
    min_above: Share = 0.5
    """Minimum share of a part's measured pixels above the support. Regions with a smaller share are not joined."""
    max_share: Share = 0.25
    """Maximum share of the image that a part may cover. Larger regions are not joined."""
