"""Mean measures of a method over many frames, and differences between two methods.

Near-identical frames, such as the frames of one video, form a group. Every group of near-identical frames has the same
weight in a mean. In a group of n near-identical frames, each frame and each object has the weight 1 / n.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spigolo.lab.evaluation.measures import FOUND_SHARE
from spigolo.lab.evaluation.resampling import UNKNOWN, Estimate, bootstrap, wilson_interval
from spigolo.lab.evaluation.rows import Row, RowScore

Floats = NDArray[np.float64]
Figure = Callable[[RowScore], float]


@dataclass(frozen=True, slots=True)
class Pooled:
    """Mean accuracy measures of one method on many frames. Undefined measures are NaN.

    Precision, overlap F, boundary F and number of false positives are NaN if any frame has unlabelled objects.
    """

    n_frames: int
    n_groups: int
    """Number of groups of near-identical frames. A frame without near-identical frames counts as one group."""

    n_failed: int
    """Number of frames for which the method raised an error.

    A frame with an error is scored like a prediction without objects.
    """

    n_predicted: float
    """Mean number of predicted objects per frame."""

    n_objects: float
    """Mean number of labelled objects per frame in each group of near-identical frames, summed over the groups.

    The number of objects can be a fraction, because it is a sum of means.
    """

    overlap_precision: float
    overlap_recall: float
    overlap_f: Estimate
    """Mean overlap F over the groups of near-identical frames, with a bootstrap confidence interval."""

    boundary_precision: float
    boundary_recall: float
    boundary_f: float
    f75: float
    true_positives: float
    """Number of labelled objects that have an IoU above 0.7 with a predicted object."""

    false_positives: float
    found: Estimate
    """Share of labelled objects that have an IoU above 0.7 with a predicted object, with a Wilson interval."""

    found_in_regions: float
    """Share of labelled objects that have an IoU above 0.7 with any region, including rejected regions."""

    best_iou: float
    """Maximum IoU of a labelled object over all predicted objects, averaged over the labelled objects."""

    best_iou_of_regions: float
    """Maximum IoU of a labelled object over all regions, including rejected regions, averaged over the labelled
    objects.
    """

    found_70_recall: float
    """Share of labelled objects with more than 70 % of their pixels in one predicted object.

    The predicted object may also cover pixels outside the labelled object.
    """

    found_70_both: float
    """Share of labelled objects for which one predicted object has a precision above 0.7 and a recall above 0.7."""

    pieces: float
    """Number of regions that each cover at least 5 % of an object, averaged over the labelled objects."""

    leaks: float
    """Under-segmentation error of the regions (`RowScore.leaks`), averaged over the labelled objects."""

    cpu_median_s: float
    cpu_mean_s: float


@dataclass(frozen=True, slots=True)
class Difference:
    """Measures of the second method minus measures of the first method, on the frames that both methods segmented.

    The confidence intervals are from a paired bootstrap over groups of near-identical frames.
    """

    n_frames: int
    n_groups: int
    overlap_f: Estimate
    boundary_f: Estimate
    f75: Estimate
    found: Estimate
    cpu_ratio: float
    """CPU time of the second method divided by the CPU time of the first method, median over the frames."""


def pool(rows: Sequence[Row]) -> Pooled:
    """Return the mean measures of one method over all frames. rows: evaluation results, one per frame.

    Raises ValueError if `rows` is empty, or if two evaluation results belong to the same frame.
    """
    _check(rows)
    scored = [row for row in rows if row.score is not None]
    complete = bool(scored) and all(row.labelling == "full" for row in scored)
    hits, objects = _total(scored, lambda s: s.true_positives), _total(scored, lambda s: s.n_objects)
    cpu = [row.cpu_s for row in rows if row.cpu_s is not None]

    def where_complete(figure: Figure) -> float:
        return _mean(scored, figure).value if complete else math.nan

    return Pooled(
        n_frames=len(rows),
        n_groups=len({row.group for row in rows}),
        n_failed=sum(row.error is not None for row in rows),
        n_predicted=float(np.average([row.n_predicted for row in rows], weights=_weights(rows))),
        n_objects=objects,
        overlap_precision=where_complete(lambda s: s.overlap_precision),
        overlap_recall=_mean(scored, lambda s: s.overlap_recall).value,
        overlap_f=_mean(scored, lambda s: s.overlap_f) if complete else UNKNOWN,
        boundary_precision=where_complete(lambda s: s.boundary_precision),
        boundary_recall=_mean(scored, lambda s: s.boundary_recall).value,
        boundary_f=where_complete(lambda s: s.boundary_f),
        f75=_mean(scored, lambda s: s.f75).value,
        true_positives=hits,
        false_positives=_total(scored, lambda s: s.false_positives) if complete else math.nan,
        found=Estimate(hits / objects, *wilson_interval(hits, objects)) if objects else UNKNOWN,
        found_in_regions=_share(scored, lambda s: sum(iou > FOUND_SHARE for iou in s.best_iou_of_regions)),
        best_iou=_share(scored, lambda s: sum(s.best_iou)),
        best_iou_of_regions=_share(scored, lambda s: sum(s.best_iou_of_regions)),
        found_70_recall=_share(scored, lambda s: s.found_70_recall),
        found_70_both=_share(scored, lambda s: s.found_70_both),
        pieces=_share(scored, lambda s: s.pieces),
        leaks=_share(scored, lambda s: s.leaks),
        cpu_median_s=float(np.median(cpu)) if cpu else math.nan,
        cpu_mean_s=float(np.mean(cpu)) if cpu else math.nan,
    )


def compare(before: Sequence[Row], after: Sequence[Row]) -> Difference:
    """Return the accuracy measures of `after` minus those of `before`, on the frames that both lists contain.

    Raises ValueError if a list is empty, or if two evaluation results in a list belong to the same frame.
    """
    _check(before)
    _check(after)
    old = {(row.data_set, row.frame): row for row in before}
    pairs = [(old[row.data_set, row.frame], row) for row in after if (row.data_set, row.frame) in old]
    scored = [(a, b) for a, b in pairs if a.score is not None and b.score is not None]
    complete = bool(scored) and all(a.labelling == b.labelling == "full" for a, b in scored)

    def paired(figure: Figure, weigh: Figure = lambda _: 1.0) -> Estimate:
        a, b = ([pair[k] for pair in scored] for k in (0, 1))
        objects = _group_means(b, weigh)
        change = _group_means(b, figure) - _group_means(a, figure, of=b)
        return bootstrap(np.divide(change, objects, out=np.zeros_like(change), where=objects > 0), objects)

    ratios = [b.cpu_s / a.cpu_s for a, b in pairs if a.cpu_s and b.cpu_s is not None]
    return Difference(
        n_frames=len(pairs),
        n_groups=len({b.group for _, b in pairs}),
        overlap_f=paired(lambda s: s.overlap_f) if complete else UNKNOWN,
        boundary_f=paired(lambda s: s.boundary_f) if complete else UNKNOWN,
        f75=paired(lambda s: s.f75),
        found=paired(lambda s: s.true_positives, lambda s: s.n_objects),
        cpu_ratio=float(np.median(ratios)) if ratios else math.nan,
    )


def _check(rows: Sequence[Row]) -> None:
    if not rows:
        raise ValueError("expected at least one row, got none: evaluate some frames")
    counts = Counter((row.data_set, row.frame) for row in rows)
    (data_set, frame), most = counts.most_common(1)[0]
    if most > 1:
        raise ValueError(
            f"expected one row per frame, got {most} of {data_set}/{frame}:"
            " give the rows of one method with one set of parameters"
        )


def _weights(rows: Sequence[Row]) -> Floats:
    size = Counter(row.group for row in rows)
    return np.array([1 / size[row.group] for row in rows])


def _group_means(rows: Sequence[Row], figure: Figure, of: Sequence[Row] | None = None) -> Floats:
    """Return the mean (G,) of a measure in each group of near-identical frames.

    The groups are read from the evaluation results `of`, or from `rows` if `of` is None.
    """
    members: dict[str, list[float]] = {}
    for row, like in zip(rows, rows if of is None else of, strict=True):
        assert row.score is not None
        members.setdefault(like.group, []).append(figure(row.score))
    return np.array([np.mean(values) for values in members.values()], np.float64)


def _mean(rows: Sequence[Row], figure: Figure) -> Estimate:
    return bootstrap(_group_means(rows, figure))


def _total(rows: Sequence[Row], count: Figure) -> float:
    return float(_group_means(rows, count).sum())


def _share(rows: Sequence[Row], count: Figure) -> float:
    """Return a count divided by the number of labelled objects.

    The count and the number of objects are averaged over the frames of each group of near-identical frames, then summed
    over the groups.
    """
    objects = _total(rows, lambda s: s.n_objects)
    return _total(rows, count) / objects if objects else math.nan
