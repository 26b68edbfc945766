"""Which regions are no objects, each with its reason (section III-F)."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

import numpy as np

from spigolo.frames.frame import DepthMap
from spigolo.frames.roi import LEAST_INSIDE
from spigolo.objects.facts import Heights, RegionFacts, find_level, measure_rim
from spigolo.settings.additions import Rules, Support, Wall
from spigolo.settings.paper import Rejection
from spigolo.stages.regions import Regions


class Reason(str, Enum):
    """Why a region is no object, in the order in which the rules are asked."""

    NO_DEPTH = "no depth"
    OUTSIDE = "outside the region of interest"
    SUPPORT = "support"
    WALL = "wall"
    WEAK_CONTOUR = "weak contour"
    OUT_OF_REACH = "out of reach"
    TOO_LONG = "too long"
    TOO_WIDE = "too wide"
    TOO_THIN = "too thin"
    MISSING_DEPTH = "missing depth"
    DARK = "dark"
    BY_HAND = "dropped by hand"


Verdict = tuple[Reason, str]


def judge(facts: RegionFacts, paper: Rejection, ours: Rules, support: Support | None) -> Verdict | None:
    """Return the first rule that a region breaks, and a sentence with its numbers. None: it breaks none.

    paper: the rules of section III-F. ours: our own. Both are sized for the image.
    """
    return (
        _judge_place(facts, support)
        or _judge_stance(facts, ours)
        or _above(Reason.OUT_OF_REACH, facts.distance_m, paper.max_distance_m, "centroid at {:.2f} m, limit {:.2f} m")
        or _judge_shape(facts, paper, ours)
        or _judge_pixels(facts, paper)
    )


def reject_rims(
    facts: Sequence[RegionFacts],
    verdicts: Sequence[Verdict | None],
    regions: Regions,
    depth: DepthMap,
    height: Heights,
    rule: Wall,
) -> list[Verdict | None]:
    """The verdicts, those of level regions that go on in what is no object changed. height (H, W) above the support."""
    changed = list(verdicts)
    no_object = (regions.spread(np.array([v is not None for v in verdicts], np.int32)) > 0) & (depth > 0)
    for f in (f for f, v in zip(facts, verdicts, strict=True) if v is None and f.lean_deg is not None):
        level = find_level(f, height, depth, rule.rim_m)
        if level is None:
            continue
        rim = measure_rim(f, np.asarray((np.abs(height - level) <= rule.rim_m) & no_object))
        if rim > rule.max_rim:
            changed[f.region] = Reason.WALL, f"wall: in a rim {rim:.1f} times as large, limit {rule.max_rim}"
    return changed


def _judge_place(facts: RegionFacts, support: Support | None) -> Verdict | None:
    """Judge the place: in the region of interest, and above the support."""
    if facts.inside is not None and facts.inside < LEAST_INSIDE:
        return Reason.OUTSIDE, f"outside the region of interest: {facts.inside:.0%} of it inside"
    if support is not None and facts.above is not None and facts.above < support.min_above:
        return Reason.SUPPORT, f"support: {facts.above:.0%} stands above the plane, least {support.min_above:.0%}"
    return None


def _judge_stance(facts: RegionFacts, rules: Rules) -> Verdict | None:
    """Judge the stance: not a wall, and within a contour (ours)."""
    if rules.wall is not None and (why := _lacks_stance(facts, rules.wall)):
        return Reason.WALL, why
    if rules.min_contour is not None and facts.contour < rules.min_contour:
        return Reason.WEAK_CONTOUR, f"weak contour: mean boundary {facts.contour:.2f}, least {rules.min_contour:.2f}"
    return None


def _lacks_stance(facts: RegionFacts, rule: Wall) -> str | None:
    """What makes a tall region a wall: it hides little, turns away, or is a rail of which the image shows a part."""
    lean_deg, cut = facts.lean_deg or 0.0, facts.cut or 0.0
    least = (rule.min_hides_leaning if lean_deg > rule.leaning_deg else rule.min_hides) + rule.min_hides_cut * cut
    if facts.hides is not None and facts.hides < least:
        return f"wall: hides what is behind along {facts.hides:.0%}, least {least:.0%}"
    if lean_deg > rule.max_lean_deg:
        return f"wall: leans away by {lean_deg:.0f} deg, limit {rule.max_lean_deg:.0f} deg"
    length, width = facts.size_m or (0.0, 0.0)
    if cut > 0 and length > rule.max_cut_ratio * width:
        return f"wall: the image cuts it off, and {length:.2f} m are more than {rule.max_cut_ratio:.1f} x {width:.2f} m"
    return None


def _judge_shape(facts: RegionFacts, paper: Rejection, ours: Rules) -> Verdict | None:
    """Judge the extent, in metres where there is such a limit and intrinsics, else in pixels, and the eccentricity."""
    large, small = facts.spread_px2
    length, width = facts.size_m or (None, None)
    max_large = None if length is not None and ours.max_length_m is not None else paper.max_lambda1_px2
    max_small = None if width is not None and ours.max_width_m is not None else paper.max_lambda2_px2
    return (
        _above(Reason.TOO_LONG, large, max_large, "lambda1 {:.0f} px2, limit {:.0f} px2")
        or _above(Reason.TOO_LONG, length, ours.max_length_m, "{:.2f} m, limit {:.2f} m")
        or _above(Reason.TOO_WIDE, small, max_small, "lambda2 {:.0f} px2, limit {:.0f} px2")
        or _above(Reason.TOO_WIDE, width, ours.max_width_m, "{:.2f} m, limit {:.2f} m")
        or _above(Reason.TOO_THIN, facts.eccentricity, paper.max_eccentricity, "eccentricity {:.3f}, limit {:.3f}")
    )


def _judge_pixels(facts: RegionFacts, rules: Rejection) -> Verdict | None:
    """What its pixels hold: depth, light."""
    missing = _above(Reason.MISSING_DEPTH, facts.unfilled, rules.max_missing, "{:.0%} without depth, limit {:.0%}")
    if missing is None and rules.max_dark is not None and facts.dark >= rules.max_dark:
        return Reason.DARK, f"dark: {facts.dark:.0%} in the first three brightness bins, limit {rules.max_dark:.0%}"
    return missing


def _above(reason: Reason, value: float | None, limit: float | None, form: str) -> Verdict | None:
    if value is None or limit is None or value <= limit:
        return None
    return reason, f"{reason.value}: {form.format(value, limit)}"
