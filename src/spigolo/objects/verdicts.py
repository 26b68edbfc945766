"""Rules that decide whether a region is an object, and reasons for rejecting a region (paper, section III-F)."""

from __future__ import annotations

from enum import Enum

from spigolo.additions.rims import surrounded_support
from spigolo.frames.roi import LEAST_INSIDE
from spigolo.objects.facts import RegionFacts
from spigolo.settings.paper import Rejection
from spigolo.settings.rules import Ledge, Rim, Rules, Wall
from spigolo.settings.support import Support


class Reason(str, Enum):
    """Reasons for rejecting a region. A region has the reason of the first rule that it violates. The rule for rims is
    checked last.
    """

    NO_DEPTH = "no depth"
    """The frame has no depth at all."""
    OUTSIDE = "outside the region of interest"
    """Less than half of the region lies in the region of interest."""
    SUPPORT = "support"
    """The region lies on the support plane (`Support.min_above`)."""
    WALL = "wall"
    """The region is part of a wall or a rim. A region counts as a wall if too little of its outline is a depth step, or
    if the image border cuts off the long region (`Wall`). A region counts as a rim if it surrounds the support plane
    (`Rim`).
    """
    WEAK_CONTOUR = "weak contour"
    """The mean boundary value along the region's border is too small (`Rules.min_contour`)."""
    OUT_OF_REACH = "out of reach"
    """The centroid of the region is too far from the camera (`Rejection.max_distance_m`)."""
    TOO_SMALL = "too small"
    """The region is too short (`Rules.min_length_m`)."""
    TOO_LONG = "too long"
    """The region is too long (`Rules.max_length_m`, `Rejection.max_lambda1_px2`)."""
    TOO_WIDE = "too wide"
    """The region is too wide (`Rules.max_width_m`, `Rejection.max_lambda2_px2`)."""
    TOO_THIN = "too thin"
    """The region is too elongated (`Rejection.max_eccentricity`)."""
    MISSING_DEPTH = "missing depth"
    """Depth is missing in too large a share of the region (`Rejection.max_missing`)."""
    DARK = "dark"
    """Too large a share of the region is very dark (`Rejection.max_dark`)."""
    BY_HAND = "dropped by hand"
    """The user dropped the object (`Segmentation.drop`)."""


REACH = "the region's centroid is at {:.2f} m (maximum {:.2f} m)"
MISSING = "{:.0%} of the region has no depth (maximum {:.0%})"
THIN = "the region's eccentricity is {:.3f} (maximum {:.3f})"

Verdict = tuple[Reason, str]


def judge(facts: RegionFacts, paper: Rejection, ours: Rules, support: Support | None) -> Verdict | None:
    """Return the reason for rejecting a region, with an explanation, or None if the region violates no rule. The
    returned reason is the first rule that the region violates.

    All limits in pixels must be scaled to the image size.

    - facts: measurements of the region.
    - paper: limits of the paper's rules (section III-F).
    - ours: limits of our additional rules.
    - support: parameters of the support plane. The field `min_above` is the minimum share of a region above the plane.
    """
    return (
        _judge_support(facts, support)
        or _judge_stance(facts, ours)
        or _above(Reason.OUT_OF_REACH, facts.distance_m, paper.max_distance_m, REACH)
        or _judge_shape(facts, paper, ours)
        or _judge_pixels(facts, paper)
        or _judge_rim(facts, ours.rim, support)
    )


def judge_flat(facts: RegionFacts, paper: Rejection, ours: Rules, support: Support | None) -> Verdict | None:
    """Return the reason for rejecting a flat object (`settings.Flats`), or None. The rules for heights, walls and
    contours do not apply to flat objects. The functions `judge_flat` and `judge` have the same arguments.
    """
    return (
        _above(Reason.OUT_OF_REACH, facts.distance_m, paper.max_distance_m, REACH)
        or _judge_shape(facts, paper, ours)
        or _judge_pixels(facts, paper)
        or _judge_rim(facts, ours.rim, support)
    )


def judge_place(facts: RegionFacts) -> Verdict | None:
    """Return the reason for rejecting a region outside the region of interest, or None."""
    if facts.inside is None or facts.inside >= LEAST_INSIDE:
        return None
    why = f"only {facts.inside:.0%} of the region lies in the region of interest (minimum {LEAST_INSIDE:.0%})"
    return Reason.OUTSIDE, f"outside: {why}"


def _judge_support(facts: RegionFacts, support: Support | None) -> Verdict | None:
    """Check that a region lies above the support plane."""
    if support is not None and facts.above is not None and facts.above < support.min_above:
        why = f"only {facts.above:.0%} of the region is above the support plane (minimum {support.min_above:.0%})"
        return Reason.SUPPORT, f"support: {why}"
    return None


def _judge_stance(facts: RegionFacts, rules: Rules) -> Verdict | None:
    """Check that a region is not a wall and that its mean boundary value is large enough (our rules)."""
    if rules.wall is not None and (why := _lacks_stance(facts, rules.wall)):
        return Reason.WALL, f"wall: {why}"
    if rules.min_contour is not None and facts.contour < rules.min_contour and not _is_ledge(facts, rules.ledge):
        limit = f"(minimum {rules.min_contour:.2f})"
        why = f"the mean boundary value along the region's border is {facts.contour:.2f} {limit}"
        return Reason.WEAK_CONTOUR, f"weak contour: {why}"
    return None


def _lacks_stance(facts: RegionFacts, rule: Wall) -> str | None:
    """Return the reason why a region is a wall, or None if the region is not a wall.

    A region counts as a wall if depth increases by a step along too little of its outline. A long region that the image
    border cuts off also counts as a wall.
    """
    lean_deg, cut = facts.lean_deg or 0.0, facts.cut or 0.0
    slant = rule.hides_per_deg * max(lean_deg - rule.slant_deg, 0)
    least = rule.min_hides + rule.min_hides_cut * cut + slant
    if facts.hides is not None and facts.hides < least:
        leans = f" for a surface tilted by {lean_deg:.0f} deg" if slant > 0 else ""
        share, limit = _percent(facts.hides, least)
        enough = f"minimum {limit}" if least <= 1 else "no share is enough"
        return f"depth increases by a step along {share} of the region's outline ({enough}{leans})"
    length, width = facts.size_m or (0.0, 0.0)
    if cut > 0 and rule.max_cut_ratio is not None and length > rule.max_cut_ratio * width:
        ratio = length / max(width, 1e-9)
        limit = f"(maximum {rule.max_cut_ratio:.1f})"
        return f"the image border cuts off the region, and the region is {ratio:.1f} times as long as wide {limit}"
    return None


def _percent(value: float, limit: float) -> tuple[str, str]:
    """Return a share and its limit as text in per cent. Both texts have one decimal place if they would be equal
    without decimal places.
    """
    form = "{:.1%}" if f"{value:.0%}" == f"{limit:.0%}" else "{:.0%}"
    return form.format(value), form.format(limit)


def _is_ledge(facts: RegionFacts, rule: Ledge | None) -> bool:
    return rule is not None and facts.ledge is not None and facts.ledge >= rule.min_share


def _judge_shape(facts: RegionFacts, paper: Rejection, ours: Rules) -> Verdict | None:
    """Check the size and the eccentricity of a region.

    If intrinsics are known, the limits in metres apply. The limits in pixels apply too, unless `ours.metric` is set.
    Without intrinsics, only the limits in pixels apply.
    """
    large, small = facts.spread_px2
    length, width = facts.size_m or (None, None)
    in_metres = ours.metric and length is not None
    max_large, max_small = (None, None) if in_metres else (paper.max_lambda1_px2, paper.max_lambda2_px2)
    return (
        _below(Reason.TOO_SMALL, length, ours.min_length_m, "the region's length is {:.3f} m (minimum {:.3f} m)")
        or _above(Reason.TOO_LONG, large, max_large, "the region's lambda1 is {:.0f} px2 (maximum {:.0f} px2)")
        or _above(Reason.TOO_LONG, length, ours.max_length_m, "the region's length is {:.2f} m (maximum {:.2f} m)")
        or _above(Reason.TOO_WIDE, small, max_small, "the region's lambda2 is {:.0f} px2 (maximum {:.0f} px2)")
        or _above(Reason.TOO_WIDE, width, ours.max_width_m, "the region's width is {:.2f} m (maximum {:.2f} m)")
        or _above(Reason.TOO_THIN, facts.eccentricity, paper.max_eccentricity, THIN)
    )


def _judge_pixels(facts: RegionFacts, rules: Rejection) -> Verdict | None:
    """Check that the shares of missing depth and of dark pixels in a region are not too large."""
    missing = _above(Reason.MISSING_DEPTH, facts.unfilled, rules.max_missing, MISSING)
    if missing is None and rules.max_dark is not None and facts.dark >= rules.max_dark:
        share = f"{facts.dark:.0%} of the region is in the three darkest of 32 brightness bins"
        return Reason.DARK, f"dark: {share} (maximum {rules.max_dark:.0%})"
    return missing


def _judge_rim(facts: RegionFacts, rule: Rim | None, support: Support | None) -> Verdict | None:
    """Check that a long region does not surround the support plane (our rule). The check for rims is done last, because
    it reads pixels and is slow.
    """
    plane, camera, size_m = facts.plane, facts.frame.camera, facts.size_m
    if rule is None or support is None or plane is None or camera is None or size_m is None:
        return None
    if size_m[0] < rule.min_length_m:
        return None
    share = surrounded_support(facts.mask, plane, facts.frame.depth, camera, support)
    if share <= rule.max_support:
        return None
    limit = f"(maximum {rule.max_support:.0%})"
    why = f"the support plane inside the region's convex hull has {share:.0%} of the region's area {limit}"
    return Reason.WALL, f"wall: {why}"


def _below(reason: Reason, value: float | None, limit: float | None, form: str) -> Verdict | None:
    if value is None or limit is None or value >= limit:
        return None
    return reason, f"{reason.value}: {form.format(value, limit)}"


def _above(reason: Reason, value: float | None, limit: float | None, form: str) -> Verdict | None:
    if value is None or limit is None or value <= limit:
        return None
    return reason, f"{reason.value}: {form.format(value, limit)}"
