"""Accuracy measures of one frame.

Letters in array shapes: H, W = image height and width, N = number of true objects (objects of the ground truth),
S = number of predicted segments.
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
"""An object counts as found if its IoU, or its share of covered pixels, is above `FOUND_SHARE`. An object with a value
of exactly `FOUND_SHARE` does not count as found.
"""

GOOD_F = 0.75
"""The measure F@.75 counts pairs of an object and a segment whose F measure is above `GOOD_F`."""


@dataclass(frozen=True, slots=True, eq=False)
class Measures:
    """Main accuracy measures of a frame or a data set."""

    overlap_precision: float
    """Number of pixels that paired objects and segments share, divided by the number of pixels in all predicted
    segments.
    """

    overlap_recall: float
    """Number of pixels that paired objects and segments share, divided by the number of pixels in all true objects."""

    overlap_f: float
    """Harmonic mean of `overlap_precision` and `overlap_recall`."""

    boundary_precision: float
    """Share of the predicted boundary pixels that are at most `radius_px` from a boundary pixel of the ground truth."""

    boundary_recall: float
    """Share of the boundary pixels of the ground truth that are at most `radius_px` from a predicted boundary pixel."""

    boundary_f: float
    """Harmonic mean of `boundary_precision` and `boundary_recall`."""

    f75: float
    """Share of true objects whose F measure with the paired segment is above 0.75."""


MEASURES = tuple(Measures.__dataclass_fields__)


@dataclass(frozen=True, slots=True, eq=False)
class FrameScore(Measures):
    """Accuracy measures of one frame.

    Precision, recall and F are 1 if neither ground truth nor prediction has objects, and 0 if only one of them has
    objects. True objects and predicted segments are paired by `spigolo.lab.evaluation.matching.pair_by_f`.
    """

    object_ids: NDArray[np.integer[Any]]
    """Labels (N,) of the true objects, ascending. The elements of all other arrays (N,) have the same order as
    `object_ids`.
    """

    n_segments: int
    """Number S of predicted segments."""

    paired_f: Floats
    """F measure (N,) of each object with its paired segment, 0 for an object without a segment."""

    found_70_recall: Mask
    """True (N,) for each object if one segment covers more than 70 % of the object.

    The segment may also cover pixels outside the object.
    """

    found_70_both: Mask
    """True (N,) for each object if one segment has a precision above 0.7 and a recall above 0.7 on the object."""

    found_iou_70: Mask
    """True (N,) for objects that have an IoU above 0.7 with a segment."""

    best_iou: Floats
    """Maximum IoU (N,) of each object over all segments, 0 if there are no segments."""

    covered: Floats
    """Share (N,) of each object's pixels that one segment covers, maximum over the segments. The share is 0 if there
    are no segments.
    """

    @property
    def n_objects(self) -> int:
        """Return the number N of true objects."""
        return len(self.object_ids)


def score_frame(
    truth: ArrayLike, prediction: ArrayLike, ignore: ArrayLike | None = None, radius_px: float | None = None
) -> FrameScore:
    """Compute accuracy measures of a predicted label image.

    Parameters
    ----------
    truth, prediction
        Label images (H, W) of integers: 0 = background, every other value = one object. An object may have different
        labels in the two images.
    ignore
        Mask (H, W) of pixels that are set to background in both images.
    radius_px
        Maximum distance between matching boundary pixels, in pixels. The default is 0.3 % of the image diagonal,
        rounded up to pixels.

    Raises
    ------
    ValueError
        If an image is not a 2-D label image, if the shapes differ, or if the radius is negative.

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
    """Reduce a boolean array (N, S) to (N,): an element is True if at least one of its S values is True."""
    return np.asarray(holds.any(axis=1), np.bool_)


def _shares(hits_pred: int, all_pred: int, hits_true: int, all_true: int) -> tuple[float, float, float]:
    """Return precision, recall and F from the numbers of matched pixels (`hits_*`) and of all pixels (`all_*`).

    Precision, recall and F are 1 if `all_pred` and `all_true` are 0, and 0 if only one of them is 0.
    """
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
