"""Files of tested parameter values (trials), with their scores on each frame.

The first line of a file describes the search (`Subject`) and names the frames. Each further line describes a trial (set
of parameter values), with one list of numbers per frame. Each list holds the accuracy measures in `SHARES` (multiplied
by 1000) and in `COUNTS`. For each object, the list also holds the maximum IoU over the predicted objects and the
maximum IoU over all regions, multiplied by 1000. The last number in each list is the CPU time in milliseconds, null
after an error.
"""

from __future__ import annotations

import gzip
import json
import math
import zlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any

from spigolo.errors import FileError
from spigolo.frames.files import append_lines, write_bytes
from spigolo.lab.evaluation.rows import Labelling, Row, RowScore
from spigolo.lab.fitting.spaces import Setting

SHARES = ("overlap_precision", "overlap_recall", "boundary_precision", "boundary_recall", "f75", "leaks")
COUNTS = ("n_segments", "true_positives", "found_70_recall", "found_70_both", "pieces")

GZIP = b"\x1f\x8b"
"""First bytes of a gzip file."""


@dataclass(frozen=True, slots=True)
class Place:
    """Identification of a frame."""

    data_set: str
    frame: str
    group: str
    """Name of the group of near-identical frames that contains the frame."""
    labelling: Labelling
    content: str = ""
    """Checksum of the files of the frame."""


@dataclass(frozen=True, slots=True)
class Subject:
    """Description of a search: the method, the digest of its initial parameters, the seed and the frames (`places`)."""

    method: str
    preset: str
    digest: str
    seed: int
    places: tuple[Place, ...]
    machine: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Trial:
    """Tested parameter values (`setting`), and their scores on each frame.

    Trial number 0 has the initial parameter values of the search.
    """

    number: int
    setting: Setting
    rows: tuple[Row, ...]


@dataclass(frozen=True, slots=True)
class Search:
    """Parameter search with all tested parameter values and their scores."""

    subject: Subject
    trials: tuple[Trial, ...]

    @property
    def start(self) -> Trial:
        """Return the scores of the initial parameter values."""
        return self.trials[0]


def read_search(path: Path | str) -> Search:
    """Read a file of trials, which may be compressed with gzip.

    An incomplete last line, for example after a crash, is ignored.

    Raises FileError if the file cannot be read, or if the file does not hold trials.
    """
    try:
        data = Path(path).read_bytes()
        text = (gzip.decompress(data) if data.startswith(GZIP) else data).decode()
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "the file is not text"
        raise FileError(f"expected trials in {path}, but the file cannot be read: {reason}") from None
    lines = text[: text.rfind("\n") + 1].splitlines()
    trials: list[Trial] = []
    try:
        subject = _subject(json.loads(lines[0]))
        for line in lines[1:]:
            trials.append(_unpack_trial(json.loads(line), subject, len(trials)))
    except (ValueError, KeyError, TypeError, IndexError, AttributeError):
        raise FileError(
            f"expected trials of `spigolo fit` in {path}, got other content after {len(trials)} trials:"
            " remove the file, or give another file"
        ) from None
    return Search(subject, tuple(trials))


class TrialFile:
    """File of the tested parameter values (trials) of one search, open for appending.

    Each new set of tested values is written to disk immediately.

    Raises FileError if the file holds the trials of another search.
    """

    trials: list[Trial]

    def __init__(self, path: Path, subject: Subject) -> None:
        self._subject, self.trials = subject, []
        if path.exists() and b"\n" in path.read_bytes():
            held = read_search(path)
            if not held.trials:
                write_bytes(path, b"")  # an incomplete first trial is removed
            elif held.subject != subject:
                other = _describe(held.subject)
                got = f"trials of {other}" if other != _describe(subject) else "trials of other frames or labels"
                raise FileError(
                    f"expected trials of {_describe(subject)} in {path}, got {got}: give another folder with --out"
                )
            self.trials = list(held.trials)
        self._file = append_lines(path)
        if not self._file.tell():
            self._write(asdict(subject))

    def append(self, trial: Trial) -> None:
        """Append tested parameter values and their scores to the file and to `trials`.

        The list `trials` gets the scores with the same number of digits as the file.
        """
        packed = {"setting": trial.setting, "frames": [_pack(row) for row in trial.rows]}
        self._write(packed)
        self.trials.append(_unpack_trial(packed, self._subject, trial.number))

    def _write(self, values: dict[str, Any]) -> None:
        self._file.write(json.dumps(values, separators=(",", ":")).encode() + b"\n")
        self._file.flush()

    def __enter__(self) -> TrialFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()


def _describe(subject: Subject) -> str:
    start = f"{subject.method} {subject.preset}".rstrip()
    return f"{start} ({subject.digest}, seed {subject.seed}) on {len(subject.places)} frames"


def _subject(values: dict[str, Any]) -> Subject:
    return Subject(**{**values, "places": tuple(Place(**place) for place in values["places"])})


def _pack(row: Row) -> list[Any]:
    score = row.score
    assert score is not None
    cpu_ms = None if row.cpu_s is None else round(1000 * row.cpu_s)
    shares = [_thousandths(getattr(score, name)) for name in SHARES]
    counts = [getattr(score, name) for name in COUNTS]
    best = [[_ceiled(v) for v in values] for values in (score.best_iou, score.best_iou_of_regions)]
    return [*shares, *counts, *best, cpu_ms]


def _thousandths(value: float) -> int:
    return round(1000 * value)


def _ceiled(iou: float) -> int:
    """Return an IoU in thousandths, rounded up, so that an IoU above 0.7 stays above 0.7."""
    return math.ceil(1000 * iou - 1e-9)


def _unpack_trial(values: dict[str, Any], subject: Subject, number: int) -> Trial:
    if len(values["frames"]) != len(subject.places):
        raise ValueError
    pairs = zip(subject.places, values["frames"], strict=True)
    return Trial(number, values["setting"], tuple(_unpack(place, packed, subject) for place, packed in pairs))


def _unpack(place: Place, packed: Sequence[Any], subject: Subject) -> Row:
    *numbers, best, best_of_regions, cpu_ms = packed
    shares = {name: number / 1000 for name, number in zip(SHARES, numbers, strict=False)}
    counts = dict(zip(COUNTS, numbers[len(shares) :], strict=True))
    score = RowScore(
        **shares,
        **counts,
        overlap_f=_harmonic(shares["overlap_precision"], shares["overlap_recall"]),
        boundary_f=_harmonic(shares["boundary_precision"], shares["boundary_recall"]),
        n_objects=len(best),
        best_iou=tuple(v / 1000 for v in best),
        best_iou_of_regions=tuple(v / 1000 for v in best_of_regions),
        false_positives=counts["n_segments"] - counts["true_positives"],
        false_negatives=len(best) - counts["true_positives"],
    )
    return Row(
        data_set=place.data_set,
        frame=place.frame,
        group=place.group,
        labelling=place.labelling,
        method=subject.method,
        preset=subject.preset,
        digest=subject.digest,
        parameters={},
        version="",
        machine=subject.machine,
        cpu_s=None if cpu_ms is None else cpu_ms / 1000,
        wall_s=None,
        n_predicted=score.n_segments,
        rejected={},
        score=score,
    )


def _harmonic(a: float, b: float) -> float:
    return 2 * a * b / (a + b) if a + b else 0.0
