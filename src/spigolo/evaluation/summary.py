"""The measures of many frames together, and a table of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spigolo.evaluation.measures import FrameScore

_COLUMNS: tuple[tuple[str, str], ...] = (
    ("overlap P", "overlap_precision"),
    ("R", "overlap_recall"),
    ("F", "overlap_f"),
    ("boundary P", "boundary_precision"),
    ("R", "boundary_recall"),
    ("F", "boundary_f"),
    ("F@.75", "f75"),
    ("70 % recall", "found_70_recall"),
    ("70 % recall and precision", "found_70_both"),
    ("IoU>0.7", "found_iou_70"),
    ("mean best IoU", "best_iou"),
    ("segments per object", "segments_per_object"),
    ("frames", "n_frames"),
    ("objects", "n_objects"),
)


@dataclass(frozen=True, slots=True)
class DatasetScore:
    """Measures of many frames: means over the frames, or shares of the objects of all frames together."""

    overlap_precision: float
    """Mean over the frames."""

    overlap_recall: float
    """Mean over the frames."""

    overlap_f: float
    """Mean of the frames' F; not the harmonic mean of the two figures above."""

    boundary_precision: float
    """Mean over the frames."""

    boundary_recall: float
    """Mean over the frames."""

    boundary_f: float
    """Mean of the frames' F; not the harmonic mean of the two figures above."""

    f75: float
    """Mean over the frames."""

    found_70_recall: float
    """Share of all objects, NaN without objects. Merging raises it: read it beside `overlap_precision`."""

    found_70_both: float
    """Share of all objects, NaN without objects."""

    found_iou_70: float
    """Share of all objects, NaN without objects."""

    best_iou: float
    """Mean over all objects of their best IoU, NaN without objects."""

    segments_per_object: float
    """Predicted segments of all frames over the objects of all frames (over 1 when there are none)."""

    n_frames: int
    """How many frames were scored."""

    n_objects: int
    """How many true objects they hold together."""


def summarise(scores: Iterable[FrameScore]) -> DatasetScore:
    """Put the scores of many frames together; every frame, or every object, weighs the same.

    Raises
    ------
    ValueError
        When there is no frame.

    """
    scores = list(scores)
    if not scores:
        raise ValueError("expected the scores of at least one frame, got none; mend: give a data set with frames")
    n_objects = sum(score.n_objects for score in scores)
    return DatasetScore(
        overlap_precision=_mean([score.overlap_precision for score in scores]),
        overlap_recall=_mean([score.overlap_recall for score in scores]),
        overlap_f=_mean([score.overlap_f for score in scores]),
        boundary_precision=_mean([score.boundary_precision for score in scores]),
        boundary_recall=_mean([score.boundary_recall for score in scores]),
        boundary_f=_mean([score.boundary_f for score in scores]),
        f75=_mean([score.f75 for score in scores]),
        found_70_recall=_mean(np.concatenate([score.found_70_recall for score in scores])),
        found_70_both=_mean(np.concatenate([score.found_70_both for score in scores])),
        found_iou_70=_mean(np.concatenate([score.found_iou_70 for score in scores])),
        best_iou=_mean(np.concatenate([score.best_iou for score in scores])),
        segments_per_object=sum(score.n_segments for score in scores) / max(1, n_objects),
        n_frames=len(scores),
        n_objects=n_objects,
    )


def format_table(scores: Mapping[str, DatasetScore]) -> str:
    """Markdown table of the headline figures, a line per name, columns aligned; "-" where a figure is NaN."""
    if not scores:
        raise ValueError("expected at least one named score for the table, got none; mend: pass {name: summarise(...)}")
    rows = [["method", *(title for title, _ in _COLUMNS)]]
    for name, score in scores.items():
        rows.append([name.replace("|", r"\|"), *(_cell(getattr(score, field)) for _, field in _COLUMNS)])
    widths = [max(3, *(len(row[k]) for row in rows)) for k in range(len(rows[0]))]
    rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
    return "\n".join(_table_line(row, widths) for row in (rows[0], rule, *rows[1:]))


def _table_line(cells: Sequence[str], widths: Sequence[int]) -> str:
    """The name to the left, the figures to the right."""
    figures = (cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True))
    return "| " + " | ".join([cells[0].ljust(widths[0]), *figures]) + " |"


def _cell(value: float) -> str:
    if isinstance(value, int):
        return str(value)
    return "-" if math.isnan(value) else f"{value:.3f}"


def _mean(values: ArrayLike) -> float:
    array = np.asarray(values, np.float64)
    return float(array.mean()) if array.size else math.nan
