"""Command `fit`, which fits the parameters of a method to labelled frames."""

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

    Random sets of parameter values are tried on all frames. The best set is written as a TOML file, which every command
    accepts as a preset. The report contains cross-validated scores. An interrupted fit continues with the next call.
    The next call may also increase the number of trials. Example: `spigolo fit frames/ --preset TABLE --out fit`.

    Parameters
    ----------
    frames
        Folders of labelled frames, in the layouts that `spigolo evaluate` reads. Give the folders before all flags.
        Frames without labels are skipped. Each field of the preset can also be set with a flag, such as
        `--partition.gamma 0.004`.
    preset
        Start preset of the fit, for the method toscana2016: a name or a TOML file.
    method
        Name of the method to fit. Methods other than toscana2016 start from their default parameters, not from a
        preset.
    trials
        Number of random sets of parameter values to try. Each trial segments all frames once.
    folds
        Number of folds of the cross-validation.
    seed
        Seed of the random parameter values and of the random folds.
    full
        Name patterns of data sets in which every object is labelled. False objects lower the score only in data sets
        whose name matches a pattern of `--full`.
    jobs
        Number of worker processes. Default: all trials run in the main process, without worker processes.
    scheduler
        Dask cluster that runs the trials: the address of a scheduler, such as tcp://127.0.0.1:8786, or `local`. With
        `local`, a new cluster of `--jobs` processes is started on this machine.
    out
        Output folder for the fitted preset, report.md and trials.jsonl.

    """
    words, flags = split_flags(frames)
    if not words:
        raise FileError("expected a folder of labelled frames, got nothing: give the folders before the flags")
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
            bar.update(task, completed=done, total=total, description=f"fitting, best score {best:.3f} (maximum 2)")

        tried = search(found, start, out / "trials.jsonl", trials, seed, 1 if jobs is None else jobs, tell, cluster)
    held = hold_out(tried, folds, seed)
    print(to_text(score_table(tried, held)))
    written = write_fit(tried, held, start, out)
    print(f"written: {', '.join(map(str, written))}")
    return DONE
