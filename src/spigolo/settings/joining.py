"""Parameters of the rules that join the parts of an object (`Additions.joining`)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Grows, NotNegative, Offset_px, Positive, Settings, Share


class Vessel(Settings):
    """Conditions to join the wall and the inside of a cup, bowl or pot.

    Hollowness describes how concave a region is. A chord is a straight line between the left and the right end of the
    region in one image row. Hollowness is the mean distance of the surface behind the middle of its chords, divided by
    their mean length. Hollowness is positive for a concave region and negative for a convex region.
    """

    min_behind_m: Positive = 0.02
    """Minimum mean depth difference between the wall of a vessel and its inside, which lies behind the wall, in metres.
    A larger minimum depth difference joins fewer regions.
    """
    max_hollow_front: float = -0.1
    """Maximum hollowness of the wall of a vessel. Hollowness is negative for convex surfaces. A larger maximum
    hollowness joins more regions, because flatter walls are also accepted.
    """
    min_hollow_back: float = -0.11
    """Minimum hollowness of the inside of a vessel. If this minimum is negative, the inside of a vessel may also be
    nearly flat, for example because depth is missing. A larger minimum hollowness joins fewer regions.
    """
    min_contrast: float = 0.15
    """Minimum difference in hollowness: the hollowness of the inside of a vessel minus the hollowness of its wall. A
    larger minimum difference joins fewer regions.
    """
    top_m: NotNegative = 0.008
    """Maximum difference between the top heights of the wall and of the inside of a vessel, in metres. A larger maximum
    height difference joins more regions.
    """
    top_share: Share = 0.1
    """Maximum difference between the top heights of the wall and of the inside of a vessel, divided by the larger of
    both heights. Heights are measured from the support plane. The maximum difference of the top heights is max(`top_m`,
    `top_share` * height). A larger maximum height difference joins more regions.
    """
    min_solidity: Share = 0.87
    """Minimum solidity of the wall and the inside of a vessel together. Solidity is the area of both regions divided by
    the area of their common convex hull. A larger minimum solidity joins fewer regions.
    """
    sure_hollow_back: float = -0.01
    """Minimum hollowness of a region that is certainly the inside of a vessel. For a region that is certainly the
    inside of a vessel, `sure_solidity` replaces `min_solidity`. A larger minimum hollowness joins fewer regions.
    """
    sure_contrast: float = 0.25
    """Minimum difference in hollowness between the inside and the wall, for a region that is certainly the inside of a
    vessel. For a region that is certainly the inside of a vessel, `sure_solidity` replaces `min_solidity`. A larger
    minimum difference joins fewer regions.
    """
    sure_solidity: Share = 0.75
    """Minimum solidity of the wall and the inside of a vessel together. The limit `sure_solidity` replaces
    `min_solidity` if the hollowness reaches both `sure_hollow_back` and `sure_contrast`. A larger minimum solidity
    joins fewer regions.
    """


class Cap(Settings):
    """Conditions to join the upper face of an object with its side. The inside of a filled cup is joined with the wall
    of the cup under the same conditions.
    """

    max_gap_m: Positive = 0.025
    """Maximum mean depth difference across the common border of two regions that are joined, in metres. A larger
    maximum depth difference joins more regions.
    """
    max_bend_m: float = 0.006
    """Maximum mean distance of the common border behind the straight line between the depth samples on both sides, in
    metres. At a larger distance, the border counts as a valley between two objects, and the regions are not joined. A
    larger maximum distance joins more regions.
    """
    top_share: Share = 0.2
    """Maximum difference between the top heights of two regions, divided by the larger of both heights. Heights are
    measured from the support plane. A larger maximum height difference joins more regions.
    """
    min_solidity: Share = 0.9
    """Minimum solidity of two regions together. Solidity is the area of both regions divided by the area of their
    common convex hull. A larger minimum solidity joins fewer regions.
    """


class Smooth(Settings):
    """Conditions to join two parts of one flat or convex surface, which noise often divides into several regions."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth difference across the common border of two regions that are joined, in metres. A larger
    maximum depth difference joins more regions.
    """
    max_bend_m: float = 0.0015
    """Maximum mean distance of the common border behind the straight line between the depth samples on both sides, in
    metres. At a larger distance, the border counts as a valley between two objects, and the regions are not joined. A
    larger maximum distance joins more regions.
    """
    max_boundary: Share = 0.75
    """Maximum mean boundary value (0 to 1) along the common border of two regions that are joined. A larger maximum
    boundary value joins more regions.
    """


class Joining(Settings):
    """Rules that join the parts of one object. A joining rule with the value None is switched off."""

    vessel: Vessel | None = None
    """Join the wall of a cup, bowl or pot with its inside."""
    cap: Cap | None = None
    """Join the upper face of an object with its side."""
    smooth: Smooth | None = None
    """Join two parts of one flat or convex surface."""
    enclosed: Share | None = None
    """Minimum share of the pixels around a region that belong to one object. A region with at least this share is
    joined with the object around it. Only regions on the support plane or without depth, such as the bottom of a bowl,
    are joined with the object around them. With a larger minimum share, fewer regions are joined with the object around
    them. If None, regions inside objects are not joined.
    """
    reach_px: Offset_px = 4
    """Distance from the border of two regions to the depth samples on both sides, in pixels. The depth difference
    across the border is computed from the two samples.
    """
    margin_px: Annotated[int, Field(ge=0, le=100), Grows()] = 3
    """Distance from a region's outline to the ends of its chords, in pixels. Chords are straight lines in image rows,
    from which the hollowness of a region is computed (see `Vessel`). Depth near the outline is not used, because it can
    lie between object and background.
    """
    min_border_px: Annotated[int, Field(ge=1), Grows()] = 12
    """Minimum length of the common border of two regions that are joined, in pixels. Regions with a shorter common
    border are not joined.
    """
    min_measured: Share = 0.5
    """Minimum share of pixels with measured depth, in each of two regions that are joined and along their common
    border.
    """
    min_above: Share = 0.5
    """Minimum share of a region's measured pixels that lie above the support plane. Regions with fewer pixels above the
    plane are not joined.
    """
    max_share: Share = 0.25
    """Maximum share of the image that a region covers. Regions that cover more of the image are not joined."""
