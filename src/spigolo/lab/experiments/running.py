"""Evaluation of methods on frames, one row each, in this process or in several."""

from __future__ import annotations

import importlib.util
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from spigolo import __version__
from spigolo.batch import Engine, Lost, here, in_order, local
from spigolo.errors import FileError, SpigoloError
from spigolo.frames.frame import Frame
from spigolo.lab.datasets import Entry, Truth
from spigolo.lab.evaluation.matching import NEEDS_SCIPY
from spigolo.lab.evaluation.rows import Key, Row, RowFile, RowScore, score_row
from spigolo.lab.machine import this_machine
from spigolo.methods import Method
from spigolo.objects.segmentation import Segmentation

Tell = Callable[[int, int, Row | None], None]
"""Function that is called with the number of rows done, the total, and the latest row."""


@dataclass(frozen=True, slots=True)
class Task:
    """One method on one frame."""

    frame: Entry
    method: str
    digest: str

    @property
    def key(self) -> Key:
        """Return the key of the row that the task will give."""
        return Key(self.frame.data_set, self.frame.name, self.method, self.digest)


@dataclass(frozen=True, slots=True)
class Run:
    """Result and times of a method."""

    result: Segmentation
    cpu_s: float
    wall_s: float


class Worker:
    """Function that runs tasks. The first frame of a method is run once before it is timed."""

    def __init__(self, methods: Sequence[Method]) -> None:
        self._methods = {(method.name, method.digest): method for method in methods}
        self._warm: set[tuple[str, str]] = set()

    def __call__(self, task: Task) -> Row:
        """Return the row of a task. An error that spigolo raises on purpose gives a row too."""
        method = self._methods[task.method, task.digest]
        content, truth = "", None
        try:
            content = task.frame.content
            frame, truth = task.frame.read_both()
            run = self._time(method, frame)
        except SpigoloError as error:
            truth = _readable_truth(task.frame) if truth is None else truth
            return _row(task.frame, content, method, None, _score_of_nothing(truth), str(error))
        return _row(task.frame, content, method, run, None if truth is None else _score(truth, run.result))

    def lost(self, task: Task, reason: str) -> Row:
        """Return the row of a task whose workers died. The row has no content checksum, so that a later run repeats the
        task.
        """
        method = self._methods[task.method, task.digest]
        return _row(task.frame, "", method, None, _score_of_nothing(_readable_truth(task.frame)), reason)

    def _time(self, method: Method, frame: Frame) -> Run:
        key = method.name, method.digest
        if key not in self._warm:
            method(frame)
            self._warm.add(key)
        wall, cpu = time.perf_counter(), time.process_time()
        result = method(frame)
        if not isinstance(result, Segmentation):
            raise SpigoloError(f"expected a Segmentation from {method.name}, got {type(result).__name__}: build one")
        return Run(result, time.process_time() - cpu, time.perf_counter() - wall)


def evaluate(
    frames: Sequence[Entry],
    methods: Sequence[Method],
    out: Path,
    jobs: int = 1,
    tell: Tell | None = None,
    engine: Engine | None = None,
) -> list[Row]:
    """Run every method on every frame and append one row each to the file `out`. Existing rows are kept.

    Groups and labelling of existing rows are updated from the frames. Frames that were repaired after an error are run
    again, and so are tasks whose worker died. One run at a time owns the file.

    jobs: worker processes. engine: used instead of worker processes. Returns the rows of these methods on these frames,
    old and new. Raises SpigoloError if the measures cannot run, FileError for a file with another content.
    """
    if importlib.util.find_spec("scipy") is None:
        raise SpigoloError(NEEDS_SCIPY)
    engine = engine_of(jobs) if engine is None else engine
    wanted = [Task(frame, method.name, method.digest) for frame in frames for method in methods]
    with RowFile(out) as file:
        rows = _brought_up(frames, file)
        if rows != file.rows:
            file.rewrite(rows)
        there = {row.key for row in file.rows}
        tasks = [task for task in wanted if task.key not in there]
        if tell is not None:
            tell(0, len(tasks), None)
        with closing(_rows_of(tasks, methods, engine)) as made:
            for done, row in enumerate(made, start=1):
                file.append(row)
                if tell is not None:
                    tell(done, len(tasks), row)
        by_key = {row.key: row for row in file.rows}
    return [by_key[task.key] for task in wanted]


def _brought_up(frames: Sequence[Entry], file: RowFile) -> list[Row]:
    """Return the rows of a file with the current groups and labelling of the frames, which require no new run.

    Errors of repaired frames are dropped. Raises FileError if rows belong to other frames with the same names.
    """
    entries = {(frame.data_set, frame.name): frame for frame in frames}
    failed = _places(row for row in file.rows if row.error is not None)
    contents = {
        place: _readable_content(entries[place]) if place in failed else entries[place].content
        for place in _places(row for row in file.rows if row.content or row.error is not None) & entries.keys()
    }
    rows = []
    for row in file.rows:
        place = row.data_set, row.frame
        changed = place in contents and row.content != contents[place]
        if changed and row.error is None and row.content:
            raise FileError(
                f"expected {row.data_set}/{row.frame} as it was when {file.path} was written, got another frame of that"
                " name, or another ignored label: give another --out"
            )
        if not (changed and row.error is not None):
            rows.append(_as_described(row, entries.get(place)))
    return rows


def _places(rows: Iterable[Row]) -> set[tuple[str, str]]:
    return {(row.data_set, row.frame) for row in rows}


def _readable_content(frame: Entry) -> str:
    """Return the content checksum of a frame as in its row. Empty if a file is unreadable."""
    try:
        return frame.content
    except FileError:
        return ""


def _as_described(row: Row, frame: Entry | None) -> Row:
    """Return a row with the group and labelling of its frame. A row that was scored without labels stays unlabelled."""
    if frame is None:
        return row
    unscored = "none" in (row.labelling, frame.labelling)
    return replace(row, group=frame.group, labelling=row.labelling if unscored else frame.labelling)


def _rows_of(tasks: Sequence[Task], methods: Sequence[Method], engine: Engine) -> Generator[Row]:
    """Yield the rows in the order of the tasks."""
    work = Worker(methods)
    with closing(in_order(engine, work, tasks)) as outcomes:
        for task, outcome in zip(tasks, outcomes, strict=True):
            yield work.lost(task, outcome.reason) if isinstance(outcome, Lost) else outcome


def engine_of(jobs: int) -> Engine:
    """Return the engine for a number of jobs: this process for one, else worker processes. Raises SpigoloError."""
    if jobs < 1:
        raise SpigoloError(f"expected at least one job, got {jobs}: leave it out for one")
    return here if jobs == 1 else local(jobs)


def _score(truth: Truth, result: Segmentation) -> RowScore:
    return score_row(truth.labels, result.labels, result.regions.labels + 1, truth.ignore, truth.names)


def _readable_truth(frame: Entry) -> Truth | None:
    """Return the labels of a frame with an unreadable file. None if the labels are unreadable."""
    try:
        return frame.read_truth()
    except SpigoloError:
        return None


def _score_of_nothing(truth: Truth | None) -> RowScore | None:
    """Return the score of an empty prediction. None for an empty scene, as a failed method did not detect that it is
    empty.
    """
    if truth is None or not truth.labels.any():
        return None
    return score_row(truth.labels, np.zeros_like(truth.labels), None, truth.ignore, truth.names)


def _row(
    frame: Entry, content: str, method: Method, run: Run | None, score: RowScore | None, error: str | None = None
) -> Row:
    rejected = Counter(region.reason.value for region in run.result.rejected) if run is not None else {}
    return Row(
        data_set=frame.data_set,
        frame=frame.name,
        group=frame.group,
        labelling=frame.labelling,
        method=method.name,
        preset=method.preset,
        digest=method.digest,
        parameters=dict(method.parameters),
        version=__version__,
        machine=str(this_machine()),
        cpu_s=None if run is None else run.cpu_s,
        wall_s=None if run is None else run.wall_s,
        n_predicted=0 if run is None else len(run.result),
        rejected=dict(sorted(rejected.items())),
        score=score,
        error=error,
        content=content,
    )
