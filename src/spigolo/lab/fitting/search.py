"""Random search: random parameter values are scored on all labelled frames."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from spigolo.batch import Engine, Lost, in_order
from spigolo.errors import FileError, SpigoloError
from spigolo.lab.datasets import Entry
from spigolo.lab.experiments.running import Task, Worker, engine_of
from spigolo.lab.fitting.drawing import draw
from spigolo.lab.fitting.spaces import Setting, apply, space_of
from spigolo.lab.fitting.trials import Place, Search, Subject, Trial, TrialFile
from spigolo.lab.machine import this_machine
from spigolo.methods import Method

Tell = Callable[[int, int, Trial | None], None]
"""Progress callback.

The arguments of the callback are the number of finished trials, the number of trials to run, and the latest trial (None
at the start). Trials (scored sets of parameter values) that the file already contains are not counted.
"""


@dataclass(frozen=True, slots=True)
class Attempt:
    """Task of a worker process: run a method with one set of parameter values on all frames."""

    number: int
    setting: Setting
    method: Method
    frames: tuple[Entry, ...]

    def __call__(self) -> Trial:
        """Run the method on all frames, and return the scores."""
        work = Worker([self.method])
        tasks = (Task(frame, self.method.name, self.method.digest) for frame in self.frames)
        return Trial(self.number, self.setting, tuple(work(task) for task in tasks))


def search(
    frames: Sequence[Entry],
    start: Method,
    out: Path,
    trials: int = 60,
    seed: int = 0,
    jobs: int = 1,
    tell: Tell | None = None,
    engine: Engine | None = None,
) -> Search:
    """Score the initial parameter values, and `trials` random sets of parameter values.

    Parameter values that are already scored in the file `out` are skipped.

    Raises SpigoloError if optuna or scipy is not installed, or if a worker process dies. Raises FileError if no frame
    has labels, or if `out` belongs to another search.

    Parameters
    ----------
    frames
        Frames to score. Frames without labels are left out.
    start
        Method with its initial parameter values.
    out
        File of trials (scored sets of parameter values), to which new trials are appended.
    trials
        Number of random sets of parameter values.
    seed
        Random seed of the parameter values.
    jobs
        Number of worker processes.
    tell
        Progress callback. The arguments of the callback are the number of finished trials, the number of trials to run,
        and the latest trial (None at the start).
    engine
        Executor that scores the sets of parameter values. If an executor is given, `jobs` is ignored.

    """
    if importlib.util.find_spec("scipy") is None:
        raise SpigoloError('fitting needs scipy, which is not installed: pip install "spigolo[fit]"')
    for value, what, least in ((trials, "a number of trials", 1), (jobs, "a number of jobs", 1), (seed, "a seed", 0)):
        if value < least:
            raise SpigoloError(f"expected {what} of {least} or more, got {value}: leave out the value for the default")
    engine = engine_of(jobs) if engine is None else engine
    labelled = only_labelled(frames)
    settings: list[Setting] = [{}, *draw(space_of(start), trials, seed)]
    with TrialFile(out, _subject(labelled, start, seed)) as file:
        there = len(file.trials)
        attempts = [Attempt(k, s, apply(s, start), labelled) for k, s in enumerate(settings) if k >= there]
        if tell is not None:
            tell(0, len(attempts), None)
        with closing(in_order(engine, Attempt.__call__, attempts)) as done:
            for count, trial in enumerate(done, start=1):
                if isinstance(trial, Lost):
                    raise SpigoloError(f"trial {there + count - 1} failed: {trial.reason}. Earlier trials are kept")
                _check(trial)
                file.append(trial)
                if tell is not None:
                    tell(count, len(attempts), trial)
        return Search(_subject(labelled, start, seed), tuple(file.trials[: len(settings)]))


def only_labelled(frames: Sequence[Entry]) -> tuple[Entry, ...]:
    """Return the frames with labels. Raises FileError if no frame has labels."""
    labelled = tuple(frame for frame in frames if frame.labelling != "none")
    if not labelled:
        raise FileError(f"expected labelled frames, got {len(frames)} without labels: label about 20 frames")
    return labelled


def _subject(frames: Sequence[Entry], start: Method, seed: int) -> Subject:
    places = tuple(Place(f.data_set, f.name, f.group, f.labelling, f.content) for f in frames)
    return Subject(start.name, start.preset, start.digest, seed, places, str(this_machine()))


def _check(trial: Trial) -> None:
    """Raise FileError if a trial (set of parameter values) has no score for a frame.

    FileError is also raised if the method fails on a frame with the initial parameter values.
    """
    at_start = trial.number == 0
    unread = next((row for row in trial.rows if row.score is None or (at_start and row.error is not None)), None)
    if unread is not None:
        raise FileError(
            f"expected frames that can be segmented and scored, got {unread.data_set}/{unread.frame}: {unread.error}"
        )
