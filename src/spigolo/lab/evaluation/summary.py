"""Measures of many frames together."""

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
    """Measures of many frames: means over the frames, or shares of the objects of all frames.

    The mean F over frames is not the harmonic mean of the mean precision and recall.
    """

    found_70_recall: float
    """Share of all objects, NaN without objects. Merging regions raises it, so read it together with
    `overlap_precision`.
    """

    found_70_both: float
    """Share of all objects, NaN without objects."""

    found_iou_70: float
    """Share of all objects, NaN without objects."""

    best_iou: float
    """Mean over all objects of their largest IoU, NaN without objects."""

    segments_per_object: float
    """Number of predicted segments divided by the number of objects (by 1 without objects), over all frames."""

    n_frames: int
    """Number of scored frames."""

    n_objects: int
    """Number of true objects in all frames."""


def summarise(scores: Iterable[FrameScore]) -> DatasetScore:
    """Combine the scores of many frames. Every frame, or every object, has the same weight.

    Raises
    ------
    ValueError
        If there are no frames.

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
