"""Mean accuracy measures over the frames of a data set."""

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
    """Mean accuracy measures over many frames.

    Each F is averaged over the frames, so it differs from the harmonic mean of the averaged precision and recall.
    """

    found_70_recall: float
    """Share of true objects of which one segment covers more than 70 %, NaN without objects.

    Large segments that cover several objects raise this value, so compare `overlap_precision` too.
    """

    found_70_both: float
    """Share of true objects that have a segment with precision and recall both above 0.7, NaN without objects."""

    found_iou_70: float
    """Share of true objects that have an IoU above 0.7 with a segment, NaN without objects."""

    best_iou: float
    """Maximum IoU of a true object over all segments, averaged over all true objects, NaN without objects."""

    segments_per_object: float
    """Number of predicted segments in all frames, divided by the number of true objects."""

    n_frames: int
    """Number of scored frames."""

    n_objects: int
    """Number of true objects in all frames."""


def summarise(scores: Iterable[FrameScore]) -> DatasetScore:
    """Average the scores of many frames.

    In `MEASURES`, all frames have the same weight. In the other scores, all objects have the same weight.

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
