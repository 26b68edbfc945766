"""Evaluation of segmentation methods on labelled frames, in one or several processes."""

from __future__ import annotations

import importlib.util
import time
import warnings
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from spigolo import __version__
from spigolo.batch import Engine, Lost, here, in_order, local
from spigolo.errors import FileError, SpigoloError, UnitWarning
from spigolo.frames.frame import Frame
from spigolo.lab.datasets import Entry, Truth
from spigolo.lab.evaluation.matching import NEEDS_SCIPY
from spigolo.lab.evaluation.rows import Key, Row, RowFile, RowScore, score_row
from spigolo.lab.machine import this_machine
from spigolo.methods import Method
from spigolo.objects.segmentation import Segmentation

Tell = Callable[[int, int, Row | None], None]
"""Progress callback.

The arguments of the callback are the number of finished evaluations, the number of evaluations to run, and the latest
result (None at the start). Evaluations that already have a result in the output file are not counted.
"""


@dataclass(frozen=True, slots=True)
class Task:
    """Evaluation task: one method on one frame. digest: digest of the method's parameters."""

    frame: Entry
    method: str
    digest: str

    @property
    def key(self) -> Key:
        """Return the identification of the task's result: data set, frame, method and digest of the parameters."""
        return Key(self.frame.data_set, self.frame.name, self.method, self.digest)


@dataclass(frozen=True, slots=True)
class Run:
    """Segmentation of one frame, with CPU time and wall time in seconds."""

    result: Segmentation
    cpu_s: float
    wall_s: float


class Worker:
    """Callable that executes evaluation tasks.

    A method segments its first frame once before time is measured, so that compilation is not included in the CPU time.
    """

    def __init__(self, methods: Sequence[Method]) -> None:
        self._methods = {(method.name, method.digest): method for method in methods}
        self._warm: set[tuple[str, str]] = set()

    def __call__(self, task: Task) -> Row:
        """Segment the frame of a task, and return the scores.

        If a `SpigoloError` is raised, the result contains the error message and no exception leaves this function.
        """
        method = self._methods[task.method, task.digest]
        content, truth = "", None
        try:
            content = task.frame.content
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UnitWarning)
                frame, truth = task.frame.read_both()
                warnings.simplefilter("ignore", UserWarning)  # the scores tell more than the warnings of a frame
                run = self._time(method, frame)
        except SpigoloError as error:
            truth = _readable_truth(task.frame) if truth is None else truth
            return _row(task.frame, content, method, None, _score_of_nothing(truth), str(error))
        return _row(task.frame, content, method, run, None if truth is None else _score(truth, run.result))

    def lost(self, task: Task, reason: str) -> Row:
        """Return the result for a task whose worker process died.

        The returned result has no checksum of the frame's files, so that the next evaluation repeats the task.
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
    """Evaluate every method on every frame, and append the results to the file `out`.

    Return the results of all methods on all frames.

    Evaluations with a result in the file `out` are not repeated, unless another version of spigolo wrote the result. An
    evaluation is repeated if its worker process died,
    or if it raised an error and the files of the frame have changed since then. Only one process may use the file `out`
    at a time.

    Raises SpigoloError if scipy is not installed. Raises FileError if the file `out` is invalid, or if it has results
    of other frames with the same names.

    Parameters
    ----------
    frames
        Labelled frames to segment.
    methods
        Segmentation methods to evaluate.
    out
        File of evaluation results, to which new results are appended.
    jobs
        Number of worker processes.
    tell
        Progress callback.
    engine
        Executor that runs the evaluation tasks. If an executor is given, `jobs` is ignored.

    """
    if importlib.util.find_spec("scipy") is None:
        raise SpigoloError(NEEDS_SCIPY)
    engine = engine_of(jobs) if engine is None else engine
    wanted = [Task(frame, method.name, method.digest) for frame in frames for method in methods]
    with RowFile(out) as file:
        asked = {task.key for task in wanted}
        rows = [r for r in _brought_up(frames, file) if r.version == __version__ or r.key not in asked]
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
    """Return the existing results that are still valid, with the fields `group` and `labelling` of the current frames.

    A result with an error is left out if the files of its frame have changed. Raises FileError if a frame was evaluated
    without an error, and its files have changed since then.
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
                f"expected the same frame {row.data_set}/{row.frame} as in {file.path}, got another frame of that name,"
                " or another ignored label: give another --out"
            )
        if not (changed and row.error is not None):
            rows.append(_as_described(row, entries.get(place)))
    return rows


def _places(rows: Iterable[Row]) -> set[tuple[str, str]]:
    return {(row.data_set, row.frame) for row in rows}


def _readable_content(frame: Entry) -> str:
    """Return the checksum of a frame's files, or an empty string if a file cannot be read."""
    try:
        return frame.content
    except FileError:
        return ""


def _as_described(row: Row, frame: Entry | None) -> Row:
    """Update the fields `group` and `labelling` of an evaluation result from its frame.

    The field `labelling` is not changed if the result or the frame has no labels.
    """
    if frame is None:
        return row
    unscored = "none" in (row.labelling, frame.labelling)
    return replace(row, group=frame.group, labelling=row.labelling if unscored else frame.labelling)


def _rows_of(tasks: Sequence[Task], methods: Sequence[Method], engine: Engine) -> Generator[Row]:
    """Execute evaluation tasks, and yield the results in the order of the tasks."""
    work = Worker(methods)
    with closing(in_order(engine, work, tasks)) as outcomes:
        for task, outcome in zip(tasks, outcomes, strict=True):
            yield work.lost(task, outcome.reason) if isinstance(outcome, Lost) else outcome


def engine_of(jobs: int) -> Engine:
    """Return an executor with `jobs` worker processes.

    If `jobs` is 1, all evaluation tasks run in the current process. Raises SpigoloError if `jobs` is less than 1.
    """
    if jobs < 1:
        raise SpigoloError(f"expected at least one job, got {jobs}: leave out the number for one job")
    return here if jobs == 1 else local(jobs)


def _score(truth: Truth, result: Segmentation) -> RowScore:
    return score_row(truth.labels, result.labels, result.regions.labels + 1, truth.ignore, truth.names)


def _readable_truth(frame: Entry) -> Truth | None:
    """Read the ground truth of a frame. Return None if the files cannot be read."""
    try:
        return frame.read_truth()
    except SpigoloError:
        return None


def _score_of_nothing(truth: Truth | None) -> RowScore | None:
    """Return the score of a prediction without objects.

    Return None if the frame has no labelled objects, because a failed method must not get a perfect score.
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
