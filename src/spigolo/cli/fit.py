"""Verb `fit`, which fits parameters to labelled frames."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from spigolo.cli import DONE
from spigolo.cli.engines import choose_cluster
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
    jobs: Jobs = None,
    scheduler: str | None = None,
    out: Out = Path("spigolo-fit"),
) -> int:
    """Fit a preset to about twenty labelled frames of your own.

    Settings are drawn at random and each is tried on all frames. The best one is written as a TOML file that every verb
    takes. The report gives its scores on held-out frames. An interrupted run continues, and more trials can be added.
    Example: `spigolo fit frames/ --preset TABLE --out fit`.

    Parameters
    ----------
    frames
        Folders of labelled frames, before any flag, as for `evaluate`. Frames without labels are skipped. Any field of
        the preset is a flag too.
    preset
        Preset of toscana2016 to start from, by name or as a TOML file.
    method
        Method to fit. All but toscana2016 start from their own parameters.
    trials
        Number of settings to try. A trial takes as long as one segmentation of all frames.
    folds
        Number of folds of the cross-validation.
    seed
        Seed of the random settings and of the folds.
    full
        Patterns of data sets in which every object is labelled. Only in these do false objects lower the score.
    jobs
        Number of worker processes. Default: only this process.
    scheduler
        Dask cluster to use instead: the address of its scheduler, such as tcp://127.0.0.1:8786, or local
        for a new one of `--jobs` processes on this machine.
    out
        Folder for the preset, report.md and trials.jsonl.

    """
    words, flags = split_flags(frames)
    if not words:
        raise FileError("expected a folder of labelled frames, got nothing: name folders before any flag")
    from spigolo.lab.experiments import find_labelled_frames, make_methods
    from spigolo.lab.fitting import check_folds, goodness, hold_out, only_labelled, score_table, search, write_fit
    from spigolo.lab.page import to_text

    check_flags(flags, [method])
    (start,) = make_methods([method], [configure(preset, flags, fit)])
    found = only_labelled(find_labelled_frames([Path(word) for word in words], full))
    check_folds([frame.group for frame in found], folds)
    cluster = None if scheduler is None else choose_cluster(scheduler, jobs, "--jobs")
    with progress() as bar:
        task = bar.add_task("fitting", total=None)
        best = 0.0

        def tell(done: int, total: int, trial: Trial | None) -> None:
            nonlocal best
            best = max(best, goodness(trial.rows) if trial else 0.0)
            bar.update(task, completed=done, total=total, description=f"fitting, best {best:.3f} of 2")

        tried = search(found, start, out / "trials.jsonl", trials, seed, 1 if jobs is None else jobs, tell, cluster)
    held = hold_out(tried, folds, seed)
    print(to_text(score_table(tried, held)))
    written = write_fit(tried, held, start, out)
    print(f"written: {', '.join(map(str, written))}")
    return DONE
