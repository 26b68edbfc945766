"""Files of evaluation results. Each line of a file is a JSON object (row): the scores of one method on one frame.

Letters in array shapes: H, W = image height and width, N = number of true objects.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic import TypeAdapter, ValidationError

from spigolo.errors import FileError
from spigolo.frames.files import append_lines, write_bytes
from spigolo.lab.evaluation.checks import checked_pair
from spigolo.lab.evaluation.matching import OverlapTable, overlap_table
from spigolo.lab.evaluation.measures import MEASURES, Measures, score_frame

PIECE = 0.05
"""Minimum share of an object's pixels that a region must cover to count as a piece of the object."""

Labelling = Literal["full", "part", "none"]
"""Completeness of the labels of a frame: all (`full`), some (`part`) or none (`none`) of the objects have a label.

Precision is meaningful only if all objects in the frame are labelled.
"""


class Key(NamedTuple):
    """Identification of an evaluation result: data set, frame, method and digest (hash) of its parameters.

    If two results have equal keys, they are results of the same evaluation.
    """

    data_set: str
    frame: str
    method: str
    digest: str


@dataclass(frozen=True, slots=True)
class RowScore(Measures):
    """Accuracy measures of one method on one frame. The class `FrameScore` describes most of the measures."""

    n_objects: int
    """Number N of labelled objects."""

    n_segments: int
    """Number of predicted objects. Predicted objects that contain only ignored pixels are not counted."""

    best_iou: tuple[float, ...]
    """Maximum IoU (N,) of each labelled object over all predicted objects."""

    best_iou_of_regions: tuple[float, ...]
    """Maximum IoU (N,) of each labelled object over all regions, including rejected regions."""

    true_positives: int
    """Number of labelled objects that have an IoU above 0.7 with a predicted object."""

    false_positives: int
    """Number of predicted objects that have no IoU above 0.7 with any labelled object.

    The number of false positives is meaningful only if all objects are labelled.
    """

    false_negatives: int
    """Number of labelled objects that have no IoU above 0.7 with any predicted object."""

    found_70_recall: int
    """Number of labelled objects with more than 70 % of their pixels in one predicted object.

    The predicted object may also cover pixels outside the labelled object.
    """

    found_70_both: int
    """Number of labelled objects for which one predicted object has a precision above 0.7 and a recall above 0.7."""

    pieces: int
    """Number of regions that each cover at least 5 % of a labelled object, summed over the objects."""

    leaks: float
    """Under-segmentation error (Neubert & Protzel 2012), summed over the labelled objects.

    For each region that overlaps an object, the smaller of two areas is added: the region's area inside the object, or
    its area outside. The sum of these areas is divided by the area of the object.
    """

    covered: tuple[float, ...] = ()
    """Share (N,) of each labelled object that one predicted object covers, maximum over the predicted objects. The
    tuple is empty in files written by earlier versions.
    """

    covered_by_regions: tuple[float, ...] = ()
    """Share (N,) of each labelled object that one region covers, maximum over all regions.

    The maximum is taken over accepted and rejected regions.
    """

    names: tuple[str, ...] = ()
    """Names (N,) of the labelled objects, empty if the data set has no names."""


@dataclass(frozen=True, slots=True)
class Row:
    """Evaluation result of one method on one frame."""

    data_set: str
    frame: str

    group: str
    """Name of the group of near-identical frames to which the frame belongs."""

    labelling: Labelling
    method: str

    preset: str
    """Name of the preset. Presets with the same name but different parameter values have different digests."""

    digest: str
    parameters: dict[str, Any]

    version: str
    """Version of spigolo that segmented the frame."""

    machine: str

    cpu_s: float | None
    """CPU time of the segmentation in seconds, or None after an error."""

    wall_s: float | None

    n_predicted: int
    """Number of predicted objects. Predicted objects that contain only ignored pixels are also counted."""

    rejected: dict[str, int]
    """Number of rejected regions, indexed by the reason for rejection."""

    score: RowScore | None
    """Accuracy measures, or None if the frame has no labels.

    If the method raised an error, a prediction without objects is scored. If a method raises an error on a frame
    without labelled objects, the score is None.
    """

    error: str | None = None
    """One-line message of the error that the method raised, or None if the method succeeded."""

    content: str = ""
    """Checksum of the frame's files, to distinguish frames with the same name, empty if unknown."""

    @property
    def key(self) -> Key:
        """Return the identification of this evaluation: data set, frame, method and digest of the parameters."""
        return Key(self.data_set, self.frame, self.method, self.digest)


def score_row(
    truth: ArrayLike,
    prediction: ArrayLike,
    regions: ArrayLike | None = None,
    ignore: ArrayLike | None = None,
    names: Mapping[int, str] | None = None,
) -> RowScore:
    """Compute the scores of a predicted label image by comparison with the ground truth.

    The function `score_frame` defines the accuracy measures.

    Parameters
    ----------
    truth
        Ground truth labels (H, W), 0 = background.
    prediction
        Predicted label image (H, W), 0 = background.
    regions
        All regions of the segmentation, including rejected regions, as a label image (H, W) without 0. By default
        `prediction`.
    ignore
        Mask (H, W) of pixels to leave out of the scores.
    names
        Names of the true objects, indexed by label.

    """
    score = score_frame(truth, prediction, ignore)
    table = overlap_table(*checked_pair(truth, prediction if regions is None else regions, ignore))
    hits = int(np.count_nonzero(score.found_iou_70))
    return RowScore(
        **{name: getattr(score, name) for name in MEASURES},
        n_objects=score.n_objects,
        n_segments=score.n_segments,
        best_iou=tuple(score.best_iou.tolist()),
        best_iou_of_regions=tuple(table.iou().max(axis=1, initial=0.0).tolist()),
        true_positives=hits,
        false_positives=score.n_segments - hits,
        false_negatives=score.n_objects - hits,
        found_70_recall=int(np.count_nonzero(score.found_70_recall)),
        found_70_both=int(np.count_nonzero(score.found_70_both)),
        pieces=int(np.count_nonzero(table.recall() >= PIECE)),
        leaks=_leaks(table),
        covered=tuple(score.covered.tolist()),
        covered_by_regions=tuple(table.recall().max(axis=1, initial=0.0).tolist()),
        names=tuple(names.get(label, "") for label in score.object_ids.tolist()) if names else (),
    )


def _leaks(table: OverlapTable) -> float:
    beside = table.segment_px[None, :] - table.shared_px
    return float((np.minimum(table.shared_px, beside) / table.object_px[:, None]).sum())


@cache
def _adapter() -> TypeAdapter[Row]:
    return TypeAdapter(Row)


def row_to_json(row: Row) -> str:
    """Convert an evaluation result to one line of JSON, without a newline."""
    return _adapter().dump_json(row).decode()


def read_rows(path: Path | str) -> list[Row]:
    """Read a file of evaluation results. An incomplete last line, for example after a crash, is ignored.

    Raises FileError if the file cannot be read, or if a line is not a valid result.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise FileError(f"expected rows in {path}, but the file cannot be read: {error.strerror or error}") from None
    return _parse(data[: data.rfind(b"\n") + 1], path)


def _parse(data: bytes, path: Path | str) -> list[Row]:
    rows = []
    for number, line in enumerate(data.splitlines(), start=1):
        try:
            rows.append(_adapter().validate_json(line))
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"]))
            what = f"{where}: {first['msg']}" if where else first["msg"]
            raise FileError(
                f"expected a row of `spigolo evaluate` in line {number} of {path}, got {what}:"
                " remove the line, or give another file"
            ) from None
    return rows


class RowFile:
    """File of evaluation results, open for appending. Each new result is written to disk immediately.

    The attribute `rows` holds all results in the file. If the last line is incomplete, it is removed when the file is
    opened. Raises FileError if the file cannot be opened, or if a line is not a valid result.
    """

    rows: list[Row]

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self.rows = read_rows(self.path) if self.path.exists() else []  # read before the file is changed
        self._file = append_lines(self.path)

    def append(self, row: Row) -> None:
        """Append an evaluation result to the file and to `rows`."""
        self._file.write(row_to_json(row).encode() + b"\n")
        self._file.flush()
        self.rows.append(row)

    def rewrite(self, rows: Sequence[Row]) -> None:
        """Replace all evaluation results in the file in one step. If writing fails, the old file stays unchanged."""
        self._file.close()
        write_bytes(self.path.resolve(), b"".join(row_to_json(row).encode() + b"\n" for row in rows))
        self.rows, self._file = list(rows), append_lines(self.path)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> RowFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
