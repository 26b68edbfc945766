"""Parameters of the rules that join the parts of an object (`Additions.joining`)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from spigolo.settings.parameters import Grows, NotNegative, Offset_px, Positive, Settings, Share


class Vessel(Settings):
    """Conditions to join the wall and the inside of a cup, bowl or pot.

    Hollowness is the depth of a region's middle behind its chords along image rows, as a share of the chord length.
    Hollowness is positive for a concave region and negative for a convex one.
    """

    min_behind_m: Positive = 0.02
    """Minimum mean depth step from the wall of a vessel back to its inside, in metres. Larger values join fewer
    regions.
    """
    max_hollow_front: float = -0.1
    """Maximum hollowness of the wall of a vessel. Convex surfaces have a negative hollowness. Larger values also accept
    flatter walls.
    """
    min_hollow_back: float = -0.11
    """Minimum hollowness of the inside of a vessel. With a negative value, an inside that looks flat because of missing
    depth is accepted too. Larger values join fewer regions.
    """
    min_contrast: float = 0.15
    """Minimum difference in hollowness, inside minus wall. Larger values join fewer regions."""
    top_m: NotNegative = 0.008
    """Maximum height difference between the highest point of the wall and the highest point of the inside, in metres.
    Larger values join more regions.
    """
    top_share: Share = 0.1
    """Maximum height difference between the highest point of the wall and the highest point of the inside, as a share
    of their height above the support plane. The limit is max(`top_m`, `top_share` * height). Larger values join more
    regions.
    """
    min_solidity: Share = 0.87
    """Minimum share of their common convex hull that the wall and the inside must fill (solidity). Larger values join
    fewer regions.
    """
    sure_hollow_back: float = -0.01
    """Minimum hollowness of a region that is certainly the inside of a vessel, so that `sure_solidity` applies. Larger
    values apply `sure_solidity` to fewer regions.
    """
    sure_contrast: float = 0.25
    """Minimum difference in hollowness, inside minus wall, for a region that is certainly the inside of a vessel, so
    that `sure_solidity` applies. Larger values apply `sure_solidity` to fewer regions.
    """
    sure_solidity: Share = 0.75
    """Minimum solidity of the wall and the inside together if the inside is certain (`sure_hollow_back`,
    `sure_contrast`). Replaces `min_solidity`. Larger values join fewer regions.
    """


class Cap(Settings):
    """Conditions to join the upper face of an object with its side, or the inside of a filled cup with its wall."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth step between the two regions across their border, in metres. Larger values join more
    regions.
    """
    max_bend_m: float = 0.006
    """Maximum mean depth of the border behind the straight line between the depth samples on both sides, in metres. A
    deeper border is a valley between two objects. Larger values join more regions.
    """
    top_share: Share = 0.2
    """Maximum height difference between the tops of the two regions, as a share of their height above the support
    plane. Larger values join more regions.
    """
    min_solidity: Share = 0.9
    """Minimum share of their common convex hull that the two regions must fill (solidity). Larger values join fewer
    regions.
    """


class Smooth(Settings):
    """Conditions to join two parts of one flat or convex surface that noise separated."""

    max_gap_m: Positive = 0.025
    """Maximum mean depth step between the two regions across their border, in metres. Larger values join more
    regions.
    """
    max_bend_m: float = 0.0015
    """Maximum mean depth of the border behind the straight line between the depth samples on both sides, in metres. A
    deeper border is a valley between two objects. Larger values join more regions.
    """
    max_boundary: Share = 0.75
    """Maximum mean boundary value along the border of the two regions. Larger values join more regions."""


class Joining(Settings):
    """Rules that join the parts of one object. None switches a rule off."""

    vessel: Vessel | None = None
    """Join the wall of a cup, bowl or pot with its inside."""
    cap: Cap | None = None
    """Join the upper face of an object with the side of the object below."""
    smooth: Smooth | None = None
    """Join two parts of one flat or convex surface."""
    enclosed: Share | None = None
    """Minimum share of the pixels around a region that must belong to one object, so that the region is joined with the
    object. The rule joins regions on the support plane or without depth, such as the bottom of a bowl. Larger values
    join fewer regions. If None, the rule is off.
    """
    reach_px: Offset_px = 4
    """Distance from a border to the depth samples on both sides that measure the depth step, in pixels."""
    margin_px: Annotated[int, Field(ge=0, le=100), Grows()] = 3
    """Distance from a region's outline to the ends of the chords that measure hollowness, in pixels. Depth near the
    outline mixes object and background.
    """
    min_border_px: Annotated[int, Field(ge=1), Grows()] = 12
    """Minimum length of a border between two regions, in pixels. Regions with a shorter border are not joined."""
    min_measured: Share = 0.5
    """Minimum share of pixels with measured depth, both on a border and in a region. Regions or borders with a smaller
    share are not joined.
    """
    min_above: Share = 0.5
    """Minimum share of a region's measured pixels above the support plane. Regions with a smaller share are not
    joined.
    """
    max_share: Share = 0.25
    """Maximum share of the image that a region may cover. Larger regions are not joined."""
