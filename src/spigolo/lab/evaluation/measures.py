"""The measures of one frame.

Letters used in shapes: H, W = image, N = true objects, S = predicted segments.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spigolo.lab.evaluation.checks import checked_pair, checked_radius
from spigolo.lab.evaluation.matching import (
    Floats,
    Labels,
    Mask,
    OverlapTable,
    boundary_hits,
    boundary_map,
    default_radius_px,
    overlap_table,
    pair_by_f,
)

FOUND_SHARE = 0.7
"""An object counts as found when a share is larger than this (equal is not enough)."""

GOOD_F = 0.75
"""A pair counts in F@.75 when its F is larger than this (equal is not enough)."""


@dataclass(frozen=True, slots=True, eq=False)
class Measures:
    """Main figures of a score, for a frame, a row or a data set."""

    overlap_precision: float
    """Pixels shared within the pairs, over all predicted pixels."""

    overlap_recall: float
    """Pixels shared within the pairs, over all true pixels."""

    overlap_f: float
    """Harmonic mean of `overlap_precision` and `overlap_recall`."""

    boundary_precision: float
    """Share of the predicted boundary pixels with a true boundary pixel at most `radius_px` away."""

    boundary_recall: float
    """Share of the true boundary pixels with a predicted boundary pixel at most `radius_px` away."""

    boundary_f: float
    """Harmonic mean of `boundary_precision` and `boundary_recall`."""

    f75: float
    """Share of true objects whose paired segment has F > 0.75. Without objects: 1, or 0 if segments exist."""


MEASURES = tuple(Measures.__dataclass_fields__)


@dataclass(frozen=True, slots=True, eq=False)
class FrameScore(Measures):
    """Measures of one frame.

    Precision, recall and F are 1 when nothing is true and nothing predicted, 0 when only one side is empty.
    The pairing is one to one with the largest sum of F (`spigolo.lab.evaluation.matching.pair_by_f`).
    """

    object_ids: NDArray[np.integer[Any]]
    """(N,) labels of the true objects, ascending. The order of the arrays below."""

    n_segments: int
    """S, the number of predicted segments."""

    paired_f: Floats
    """(N,) F of the object with its paired segment, 0 when it was left without one."""

    found_70_recall: Mask
    """(N,) one segment covers more than 70 % of the object. A segment over everything finds them all."""

    found_70_both: Mask
    """(N,) one segment covers more than 70 % of the object, and more than 70 % of that segment lies on it."""

    found_iou_70: Mask
    """(N,) one segment has IoU > 0.7 with the object."""

    best_iou: Floats
    """(N,) largest IoU of the object with any segment, 0 when there is none."""

    covered: Floats
    """(N,) largest share of the object that one segment covers, 0 when there is none."""

    @property
    def n_objects(self) -> int:
        """N, the number of true objects."""
        return len(self.object_ids)


def score_frame(
    truth: ArrayLike, prediction: ArrayLike, ignore: ArrayLike | None = None, radius_px: float | None = None
) -> FrameScore:
    """Compare a predicted label image with the true one.

    Parameters
    ----------
    truth, prediction
        (H, W) whole numbers, 0 = background, every other value one instance. The values need not agree.
    ignore
        (H, W) boolean. If set, both images become background before anything is counted.
    radius_px
        Reach of the boundary matching [px]. By default 0.003 of the image diagonal, rounded up.

    Raises
    ------
    ValueError
        For images that are not alike, not 2-D or not labels, an unfit `ignore`, or a negative radius.

    """
    true, pred = checked_pair(truth, prediction, ignore)
    radius_px = checked_radius(default_radius_px(true.shape) if radius_px is None else radius_px)
    table = overlap_table(true, pred)
    objects, segments = pair_by_f(table)
    paired_f = np.zeros(len(table.object_ids))
    paired_f[objects] = table.f()[objects, segments]
    overlap = _overlap_shares(table, int(table.shared_px[objects, segments].sum()))
    boundary = _boundary_shares(true, pred, radius_px)
    recall, precision, iou = table.recall(), table.precision(), table.iou()
    return FrameScore(
        *overlap,
        *boundary,
        f75=float(np.mean(paired_f > GOOD_F)) if len(paired_f) else float(not len(table.segment_ids)),
        object_ids=table.object_ids,
        n_segments=len(table.segment_ids),
        paired_f=paired_f,
        found_70_recall=_by_any_segment(recall > FOUND_SHARE),
        found_70_both=_by_any_segment((recall > FOUND_SHARE) & (precision > FOUND_SHARE)),
        found_iou_70=_by_any_segment(iou > FOUND_SHARE),
        best_iou=iou.max(axis=1, initial=0.0),
        covered=recall.max(axis=1, initial=0.0),
    )


def _by_any_segment(holds: Mask) -> Mask:
    """(N,) from (N, S): True if it holds for any segment. Never without segments."""
    return np.asarray(holds.any(axis=1), np.bool_)


def _shares(hits_pred: int, all_pred: int, hits_true: int, all_true: int) -> tuple[float, float, float]:
    """Precision, recall and F of counts. 1 when both sides are empty, 0 when one is."""
    if all_pred == 0 and all_true == 0:
        return 1.0, 1.0, 1.0
    precision = hits_pred / all_pred if all_pred else 0.0
    recall = hits_true / all_true if all_true else 0.0
    both = precision + recall
    return precision, recall, 2 * precision * recall / both if both else 0.0


def _overlap_shares(table: OverlapTable, paired_px: int) -> tuple[float, float, float]:
    return _shares(paired_px, int(table.segment_px.sum()), paired_px, int(table.object_px.sum()))


def _boundary_shares(truth: Labels, prediction: Labels, radius_px: float) -> tuple[float, float, float]:
    true, pred = boundary_map(truth), boundary_map(prediction)
    hits_pred, hits_true = boundary_hits(pred, true, radius_px), boundary_hits(true, pred, radius_px)
    return _shares(hits_pred, int(np.count_nonzero(pred)), hits_true, int(np.count_nonzero(true)))
