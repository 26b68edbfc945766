"""The verb that fits parameters to labelled frames: fit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from spigolo.cli import DONE
from spigolo.cli.evaluate import check_flags
from spigolo.cli.inputs import Inputs, Jobs, Many, Out, configure, split_flags
from spigolo.cli.progress import progress
from spigolo.errors import FileError

if TYPE_CHECKING:
    from spigolo.lab.fitting import Trial


def fit(
    *frames: Inputs,
    preset: str = "OBJECTS",
    method: str = "toscana2016",
    trials: int = 60,
    folds: int = 5,
    seed: int = 0,
    full: Many = ("osd-*", "hand-uoc"),
    jobs: Jobs = 1,
    out: Out = Path("spigolo-fit"),
) -> int:
    """Fits a preset to labelled frames of your own: some twenty will do.

    Draws settings at random, tries each on all frames, and writes the best one as a TOML file that every command takes,
    with a report of what it is worth on frames that had no say in it. A run that was cut off goes on; more trials can
    be added. Example: `spigolo fit frames/ --preset TABLE --out fit`.

    Parameters
    ----------
    frames
        Folders of labelled frames, before any flag, as for `evaluate`; frames without labels are left out. Any field of
        the preset is a flag as well.
    preset
        Preset of toscana2016 to start from, by name or as TOML file.
    method
        Method to fit; others than toscana2016 start from their own parameters.
    trials
        Settings to try. A trial takes as long as segmenting all frames once.
    folds
        How often some frames are left out to score the others' choice on them.
    seed
        What is drawn, and which frames share a fold, depends on it.
    full
        Sets on which every object is labelled, as patterns: on others an object too many costs nothing.
    jobs
        Worker processes.
    out
        Folder for the preset, report.md and trials.jsonl.

    """
    words, flags = split_flags(frames)
    if not words:
        raise FileError("expected a folder of labelled frames, got nothing: name folders before any flag")
    from spigolo.lab.experiments import find_labelled_frames, make_methods
    from spigolo.lab.experiments.page import to_text
    from spigolo.lab.fitting import check_folds, goodness, hold_out, only_labelled, score_table, search, write_fit

    check_flags(flags, [method])
    (start,) = make_methods([method], [configure(preset, flags, fit)])
    found = only_labelled(find_labelled_frames([Path(word) for word in words], full))
    check_folds([frame.group for frame in found], folds)
    with progress() as bar:
        task = bar.add_task("fitting", total=None)
        best = 0.0

        def tell(done: int, total: int, trial: Trial | None) -> None:
            nonlocal best
            best = max(best, goodness(trial.rows) if trial else 0.0)
            bar.update(task, completed=done, total=total, description=f"fitting, best {best:.3f} of 2")

        tried = search(found, start, out / "trials.jsonl", trials, seed, jobs, tell)
    held = hold_out(tried, folds, seed)
    print(to_text(score_table(tried, held)))
    written = write_fit(tried, held, start, out)
    print(f"written: {', '.join(map(str, written))}")
    return DONE
