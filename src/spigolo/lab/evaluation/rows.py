"""Rows: what one method made of one frame, a line of JSON each, in a file that an evaluation can go on with.

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
"""A region with a smaller share of an object is no piece of it."""

Labelling = Literal["full", "part", "none"]
"""Which objects of a frame are labelled: every one, some, none. Precision means something with `full` alone."""


class Key(NamedTuple):
    """Key of a row. Two rows with one key are the same evaluation, so nothing is evaluated twice."""

    data_set: str
    frame: str
    method: str
    digest: str


@dataclass(frozen=True, slots=True)
class RowScore(Measures):
    """Measures of one frame, as `FrameScore` has them, and counts that can be added up."""

    n_objects: int
    """N, labelled objects."""

    n_segments: int
    """Predicted objects outside of what is ignored."""

    best_iou: tuple[float, ...]
    """(N,) largest IoU of each labelled object with a predicted one."""

    best_iou_of_regions: tuple[float, ...]
    """(N,) the same with any region, rejected ones as well: what the rejection could have kept."""

    true_positives: int
    """Labelled objects with IoU > 0.7. Each is met by one predicted object alone."""

    false_positives: int
    """Predicted objects that meet no labelled one so. Wrong only where every object is labelled."""

    false_negatives: int
    """Labelled objects that are met by none."""

    found_70_recall: int
    """Labelled objects that one predicted one covers by more than 70 %, whatever else it covers."""

    found_70_both: int
    """Labelled objects among these that such a predicted object covers by more than 70 % of its own area."""

    pieces: int
    """Regions that hold 5 % of a labelled object or more, added up over the objects."""

    leaks: float
    """Under-segmentation (Neubert & Protzel 2012): what the regions that meet an object add to it, or lack if that is
    less, as a share of it, added up over the objects."""

    covered: tuple[float, ...] = ()
    """(N,) largest share of each labelled object that one predicted one covers. () in rows made without it."""

    covered_by_regions: tuple[float, ...] = ()
    """(N,) the same by any region, rejected ones as well."""

    names: tuple[str, ...] = ()
    """(N,) what the labelled objects are, () where the data set does not say."""


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
    """Name of the parameters. `digest` tells their values apart."""

    digest: str
    parameters: dict[str, Any]

    version: str
    """Version of spigolo."""

    machine: str

    cpu_s: float | None
    """CPU time of the run. None after an error."""

    wall_s: float | None

    n_predicted: int
    """Predicted objects, also those on ignored pixels."""

    rejected: dict[str, int]
    """Rejected regions by reason."""

    score: RowScore | None
    """None without labels. A method that failed is scored as if it had found nothing."""

    error: str | None = None
    """Error in one sentence, None after success."""

    content: str = ""
    """Checksum of the frame's files, "" where it was not kept: what tells frames of one name apart."""

    @property
    def key(self) -> Key:
        """Data set, frame, method and digest."""
        return Key(self.data_set, self.frame, self.method, self.digest)


def score_row(
    truth: ArrayLike,
    prediction: ArrayLike,
    regions: ArrayLike | None = None,
    ignore: ArrayLike | None = None,
    names: Mapping[int, str] | None = None,
) -> RowScore:
    """The score of a row from label images (H, W), 0 = background. See `score_frame`.

    regions: the partition that the objects were chosen from, as a label image without background. By default the
    prediction itself. names: what the true objects are, by label.
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
    """One line of JSON, without its end."""
    return _adapter().dump_json(row).decode()


def read_rows(path: Path | str) -> list[Row]:
    """The rows of a file. A last line without its end is what a crash left, and is dropped.

    Raises FileError if the file cannot be read or a line is no row.
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
                f"expected a row as `spigolo evaluate` writes it in line {number} of {path}, got {what};"
                " mend: remove the line, or give a file of rows"
            ) from None
    return rows


class RowFile:
    """A file of rows, open to append: `rows` are those that it holds, each new one is on the disk at once.

    A half-written last line is cut off when the file is opened. Raises FileError if it cannot be opened or holds
    something else.
    """

    rows: list[Row]

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self.rows = read_rows(self.path) if self.path.exists() else []  # before anything is changed
        self._file = append_lines(self.path)

    def append(self, row: Row) -> None:
        """Write a row and keep it."""
        self._file.write(row_to_json(row).encode() + b"\n")
        self._file.flush()
        self.rows.append(row)

    def rewrite(self, rows: Sequence[Row]) -> None:
        """Put these in place of all that it holds, at once."""
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
