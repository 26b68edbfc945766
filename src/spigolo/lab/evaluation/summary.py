"""Accuracy measures, averaged over the frames of a data set."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spigolo.lab.evaluation.measures import MEASURES, FrameScore, Measures


@dataclass(frozen=True, slots=True)
class DatasetScore(Measures):
    """Accuracy measures, averaged over many frames.

    Each mean F measure is the mean of the F measures of all frames. A mean F measure is not computed from the mean
    precision and the mean recall.
    """

    found_70_recall: float
    """Share of true objects with more than 70 % of their pixels in one segment, NaN if there are no objects.

    Large segments that cover several objects increase `found_70_recall`. Therefore, compare both `found_70_recall` and
    `overlap_precision`.
    """

    found_70_both: float
    """Share of true objects for which one segment has a precision above 0.7 and a recall above 0.7.

    The share is NaN if there are no true objects.
    """

    found_iou_70: float
    """Share of true objects that have an IoU above 0.7 with a segment, NaN if there are no objects."""

    best_iou: float
    """Maximum IoU of a true object over all segments, averaged over all true objects, NaN if there are no objects."""

    segments_per_object: float
    """Number of predicted segments in all frames, divided by the number of true objects."""

    n_frames: int
    """Number of scored frames."""

    n_objects: int
    """Number of true objects in all frames."""


def summarise(scores: Iterable[FrameScore]) -> DatasetScore:
    """Average the scores of many frames.

    The measures in `MEASURES` are means over frames. The other scores, such as `found_70_recall`, are means over the
    objects of all frames.

    Raises
    ------
    ValueError
        If `scores` is empty.

    """
    scores = list(scores)
    if not scores:
        raise ValueError("expected the scores of at least one frame, got none: give a data set with frames")
    means: dict[str, Any] = {name: _mean([getattr(score, name) for score in scores]) for name in MEASURES}
    n_objects = sum(score.n_objects for score in scores)
    return DatasetScore(
        **means,
        found_70_recall=_mean(np.concatenate([score.found_70_recall for score in scores])),
        found_70_both=_mean(np.concatenate([score.found_70_both for score in scores])),
        found_iou_70=_mean(np.concatenate([score.found_iou_70 for score in scores])),
        best_iou=_mean(np.concatenate([score.best_iou for score in scores])),
        segments_per_object=sum(score.n_segments for score in scores) / max(1, n_objects),
        n_frames=len(scores),
        n_objects=n_objects,
    )


def _mean(values: ArrayLike) -> float:
    array = np.asarray(values, np.float64)
    return float(array.mean()) if array.size else math.nan
