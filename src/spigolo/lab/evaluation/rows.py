"""Rows: the scores of one method on one frame as a line of JSON, in a file to which an evaluation can append.

Letters used in shapes: H, W = image, N = true objects.
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
"""Minimum share of an object in a region for the region to count as a piece of it."""

Labelling = Literal["full", "part", "none"]
"""Extent of the labels in a frame: every object, some objects, or none. Precision is meaningful only with `full`."""


class Key(NamedTuple):
    """Key of a row. Two rows with one key are the same evaluation, so nothing is evaluated twice."""

    data_set: str
    frame: str
    method: str
    digest: str


@dataclass(frozen=True, slots=True)
class RowScore(Measures):
    """Measures of one frame as in `FrameScore`, and counts that can be summed."""

    n_objects: int
    """Number N of labelled objects."""

    n_segments: int
    """Number of predicted objects outside the ignored pixels."""

    best_iou: tuple[float, ...]
    """Largest IoU (N,) of each labelled object with a predicted one."""

    best_iou_of_regions: tuple[float, ...]
    """Largest IoU (N,) of each labelled object with any region, including rejected ones."""

    true_positives: int
    """Number of labelled objects with IoU > 0.7. Each is matched by exactly one predicted object."""

    false_positives: int
    """Number of predicted objects without a match at IoU > 0.7. Such objects are errors only if every object is
    labelled.
    """

    false_negatives: int
    """Number of labelled objects without a match."""

    found_70_recall: int
    """Number of labelled objects that one predicted object covers by more than 70 %, even if it covers other pixels
    too.
    """

    found_70_both: int
    """Number of labelled objects in `found_70_recall` whose predicted object lies on them with more than 70 % of its
    area.
    """

    pieces: int
    """Number of regions with at least 5 % of a labelled object, summed over the objects."""

    leaks: float
    """Under-segmentation error (Neubert & Protzel 2012), summed over the objects.

    For each region that meets an object, it is the smaller of the region's area outside and inside the object, as a
    share of the object.
    """

    covered: tuple[float, ...] = ()
    """Largest share (N,) of each labelled object that one predicted object covers. () in older rows."""

    covered_by_regions: tuple[float, ...] = ()
    """Largest share (N,) of each labelled object that any region covers, including rejected ones."""

    names: tuple[str, ...] = ()
    """Names (N,) of the labelled objects. () if the data set has no names."""


@dataclass(frozen=True, slots=True)
class Row:
    """Result of one method on one frame."""

    data_set: str
    frame: str

    group: str
    """Name shared by near-identical frames."""

    labelling: Labelling
    method: str

    preset: str
    """Name of the preset. Presets of one name are distinguished by `digest`."""

    digest: str
    parameters: dict[str, Any]

    version: str
    """Version of spigolo."""

    machine: str

    cpu_s: float | None
    """CPU time of the run. None after an error."""

    wall_s: float | None

    n_predicted: int
    """Number of predicted objects, including those on ignored pixels."""

    rejected: dict[str, int]
    """Number of rejected regions, indexed by reason."""

    score: RowScore | None
    """Score of the frame. None without labels. A method that failed is scored as if it found nothing."""

    error: str | None = None
    """One-line error message. None after success."""

    content: str = ""
    """Checksum of the frame's files, which distinguishes frames with the same name. "" if unknown."""

    @property
    def key(self) -> Key:
        """Return data set, frame, method and digest."""
        return Key(self.data_set, self.frame, self.method, self.digest)


def score_row(
    truth: ArrayLike,
    prediction: ArrayLike,
    regions: ArrayLike | None = None,
    ignore: ArrayLike | None = None,
    names: Mapping[int, str] | None = None,
) -> RowScore:
    """Return the score of a row from label images (H, W), 0 = background. See `score_frame`.

    regions: partition from which the objects were chosen, as a label image without background. By default the
    prediction itself. names: names of the true objects, indexed by label.
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
    """Return a row as one line of JSON, without line end."""
    return _adapter().dump_json(row).decode()


def read_rows(path: Path | str) -> list[Row]:
    """Return the rows of a file. An incomplete last line, left by a crash, is dropped.

    Raises FileError if the file cannot be read or a line is not a row.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise FileError(f"expected rows in {path}, but it cannot be read: {error.strerror or error}") from None
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
                f"expected a row as `spigolo evaluate` writes it in line {number} of {path}, got {what}:"
                " remove the line, or give a file of rows"
            ) from None
    return rows


class RowFile:
    """File of rows, open for appending. `rows` holds its rows. Each new row is written to disk at once.

    An incomplete last line is removed when the file is opened. Raises FileError if it cannot be opened or is not a file
    of rows.
    """

    rows: list[Row]

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self.rows = read_rows(self.path) if self.path.exists() else []  # before the file is changed
        self._file = append_lines(self.path)

    def append(self, row: Row) -> None:
        """Write a row and keep it in `rows`."""
        self._file.write(row_to_json(row).encode() + b"\n")
        self._file.flush()
        self.rows.append(row)

    def rewrite(self, rows: Sequence[Row]) -> None:
        """Replace all rows of the file in one step."""
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
