"""Commands for experiments: `evaluate` scores methods on labelled frames, `losses` counts lost objects, `report` writes
an HTML page of the results.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from spigolo.cli import DONE, SOME_FAILED
from spigolo.cli.engines import choose_cluster
from spigolo.cli.inputs import Inputs, Jobs, Many, Out, configure, split_flags
from spigolo.cli.progress import progress
from spigolo.errors import ConfigError, FileError
from spigolo.lab.labelled import FULL_SETS

if TYPE_CHECKING:
    from spigolo.lab.evaluation.rows import Row
    from spigolo.lab.experiments import Contender

Folders = Annotated[tuple[Path, ...], Parameter(consume_multiple=True, negative=())]


def evaluate(
    *frames: Inputs,
    methods: Many = ("toscana2016",),
    presets: Many = ("OBJECTS",),
    full: Many = FULL_SETS,
    jobs: Jobs = None,
    scheduler: str | None = None,
    out: Out = Path("rows.jsonl"),
) -> int:
    """Segment labelled frames with one or more methods, and write a JSON line of scores and times for each frame and
    method.

    An interrupted evaluation continues with the next call. Results that are already in the file are not computed again.
    Example: `spigolo evaluate frames/ --presets OBJECTS TABLE mine.toml -j 2 --out rows.jsonl`.

    Parameters
    ----------
    frames
        Folders of frames. Give the folders before all flags. Published data sets are read in their own layout (`spigolo
        datasets` lists the data sets). Store your own frames in folders SET/FRAME/ with rgb.png, depth.png, camera.json
        and label.png (0 = background, 1..N = objects, 255 = ignored). Without label.png, only times and numbers of
        objects are measured. Each field of a preset can also be set with a flag, such as `--partition.gamma 0.004`.
    methods
        Names of the methods: toscana2016, felzenszwalb2004, rao2010, abramov2012, mishra2012.
    presets
        Presets of the method toscana2016: names or TOML files.
    full
        Name patterns of data sets in which every object is labelled. Precision is reported only for data sets whose
        name matches a pattern of `--full`.
    jobs
        Number of worker processes. Default: all frames are processed in the main process, without worker processes.
    scheduler
        Dask cluster that evaluates the frames: the address of a scheduler, such as tcp://127.0.0.1:8786, or `local`.
        With `local`, a new cluster of `--jobs` processes is started on this machine.
    out
        File to which the results are appended, one JSON line for each frame and method.

    """
    words, flags = split_flags(frames)
    if not words:
        raise FileError("expected a folder of frames, got nothing: give the folders before the flags")
    from spigolo.lab.experiments import evaluate as run
    from spigolo.lab.experiments import find_labelled_frames, gather, make_methods

    configs = [configure(preset, flags, evaluate) for preset in presets]
    chosen = make_methods(methods, configs)
    if not chosen:
        raise ConfigError(
            "expected at least one method, and at least one preset for toscana2016, got none: leave out the flag for"
            " the default"
        )
    check_flags(flags, [method.name for method in chosen])
    found = find_labelled_frames([Path(word) for word in words], full)
    cluster = None if scheduler is None else choose_cluster(scheduler, jobs, "--jobs")
    new: list[Row] = []
    with progress() as bar:
        task = bar.add_task("evaluating", total=None)

        def tell(done: int, total: int, row: Row | None) -> None:
            bar.update(task, completed=done, total=total)
            if row is not None:
                new.append(row)

        rows = run(found, chosen, out, 1 if jobs is None else jobs, tell, cluster)
    failed = [row for row in rows if row.error is not None]
    for row in failed:
        print(f"spigolo: {row.data_set}/{row.frame} ({row.method} {row.preset}): {row.error}", file=sys.stderr)
    _print_pooled(gather({"": rows}))
    print(f"{len(rows)} rows, {len(rows) - len(new)} of them from an earlier run: {out}")
    return SOME_FAILED if failed else DONE


def losses(
    *frames: Inputs,
    method: str = "toscana2016",
    preset: str = "OBJECTS",
    each: bool = False,
) -> int:
    """Count the labelled objects that were not found, separately for each cause.

    The causes are: rejected by a rule, merged with another object, merged with background (flooded), split, and wrong
    outline.

    Example: `spigolo losses frames/ --preset TABLE --each`.

    Parameters
    ----------
    frames
        Folders of labelled frames, in the layouts that `spigolo evaluate` reads. Give the folders before all flags.
        Each field of the preset can also be set with a flag, such as `--partition.gamma 0.004`.
    method
        Name of the method.
    preset
        Preset of the method toscana2016: a name or a TOML file.
    each
        Also print one line for each lost object, with the rule that rejected the region of the object.

    """
    words, flags = split_flags(frames)
    if not words:
        raise FileError("expected a folder of frames, got nothing: give the folders before the flags")
    from spigolo.lab.experiments import find_labelled_frames, find_losses, loss_table, lost_objects, make_methods
    from spigolo.lab.page import to_text

    chosen = make_methods([method], [configure(preset, flags, losses)])
    check_flags(flags, [one.name for one in chosen])
    found = find_labelled_frames([Path(word) for word in words])
    with progress() as bar:
        task = bar.add_task("segmenting", total=len(found))
        fates = find_losses(found, chosen[0], lambda done: bar.update(task, completed=done))
    if each:
        print(to_text(lost_objects(fates)), end="\n\n")
    print(to_text(loss_table(fates)))
    return DONE


def report(
    *rows: Path,
    frames: Folders = (),
    against: str | None = None,
    paper: Annotated[bool, Parameter(negative=())] = False,
    out: Out = Path("spigolo-report"),
) -> int:
    """Write an HTML page from results of `spigolo evaluate`: accuracy, time, differences, worst frames and limitations.

    Files with the same frames and parameters, for example from before and after a change of the code, are compared
    separately for each preset. Examples: `spigolo report before.jsonl after.jsonl --against before --frames frames/
    --out report`, or `spigolo report rows.jsonl --paper`.

    Parameters
    ----------
    rows
        Result files of `spigolo evaluate`. Give the files before all flags.
    frames
        Folders of the evaluated frames. With the option `--frames`, the page shows images of the worst frames.
    against
        Reference method, with which the other methods are compared. Give the label of the reference method on the page,
        its preset, the digest of its preset, or its results file. Default: the first method.
    paper
        Write the paper's Tables I, II and III instead of the page index.html. Each table cell shows the value from the
        paper and the measured value. The result files must contain results on the paper's data sets or on rendered
        frames in the layout of these data sets.
    out
        Output folder for index.html, report.md and the images of the worst frames.

    """
    if not rows:
        raise FileError("expected a file of rows, got nothing: give the files before the flags")
    from spigolo.lab.experiments import find_labelled_frames, find_references, read_contenders, write_report

    contenders = read_contenders(rows)
    if paper:
        if frames or against is not None:
            raise ConfigError("expected --paper without --frames and --against: leave out --frames and --against")
        return _report_paper(contenders, out)
    find_references(contenders, against)  # reports an unknown reference method before images are drawn
    folders = find_labelled_frames(frames) if frames else []
    with progress() as bar:
        task = bar.add_task("drawing", total=None)

        def tell(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        write_report(contenders, out, folders, against, tell)
    _print_pooled(contenders)
    print(f"written: {out / 'index.html'}, {out / 'report.md'}")
    return DONE


def _report_paper(contenders: list[Contender], out: Path) -> int:
    from spigolo.lab.experiments import write_paper_tables
    from spigolo.lab.page import to_text

    for title, table in write_paper_tables(contenders, out):
        print(f"{title}\n{to_text(table)}\n")
    print(f"written: {out / 'index.html'}, {out / 'report.md'}")
    return DONE


def check_flags(flags: dict[str, str], methods: Iterable[str]) -> None:
    """Raise ConfigError if fields of a preset are given as flags, but toscana2016 is not among the methods."""
    if flags and "toscana2016" not in methods:
        raise ConfigError(
            f"expected the method toscana2016 with --{next(iter(flags)).replace('_', '-')}, got only"
            f" {', '.join(methods)}: leave out the flag, or set the fields of the method in Python (`replace`)"
        )


def _print_pooled(contenders: list[Contender]) -> None:
    from spigolo.lab.experiments.tables import brief_table
    from spigolo.lab.page import to_text

    table = brief_table(contenders)
    if table.rows:
        print(to_text(table))
