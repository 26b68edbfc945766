"""Compare all segmentation methods in `spigolo.METHODS`. The parameters of each method are fitted by random search with
cross-validation.

    python -m spigolo.lab.studies.comparison search --trials 30
    python -m spigolo.lab.studies.comparison table
    python -m spigolo.lab.studies.comparison depth
    python -m spigolo.lab.studies.comparison points
    python -m spigolo.lab.studies.comparison pictures --out pictures

The command `search` scores random parameter values of every method, and writes the scores to
docs/data/trials-METHOD.jsonl.gz. The command `table` reads the files written by `search`, and prints scores and CPU
times of the fitted methods. The command `depth` scores `rao2010`, `abramov2012` and `mishra2012` with fitted
parameters, once with depth and once without depth. The command `points` scores the method `mishra2009`, which segments
one object around a start pixel. The start pixel of a labelled object is the pixel farthest from the outline of its
ground-truth mask. The command `pictures` draws the regions that each method returns, for every fifth frame.

Frames are read from the subfolder `frames` of the data folder. The environment variable SPIGOLO_DATA sets the data
folder (default: ../shared/data).
"""

from __future__ import annotations

import argparse
import gzip
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np

import spigolo as sp
from spigolo.frames.files import write_png
from spigolo.lab.datasets import Entry
from spigolo.lab.evaluation import Row, compare, pool
from spigolo.lab.evaluation.measures import FOUND_SHARE
from spigolo.lab.experiments import Method, find_labelled_frames
from spigolo.lab.experiments.running import Task, Worker
from spigolo.lab.fitting import Search, apply, best_trial, hold_out, read_search, search
from spigolo.lab.fitting.trials import Trial
from spigolo.lab.studies import FRAMES
from spigolo.methods.mishra2009 import innermost
from spigolo.view.comparison import comparison

LOG = Path("docs/data")
SETS = ("osd-mosd", "hand-uoc")
"""Names of the data sets of the comparison, in which every object is labelled."""
SEED, FOLDS, EVERY = 0, 5, 5
"""Random seed, number of cross-validation folds, and step between frames for timing and drawing (5 = every fifth
frame).
"""
DISC = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (11, 11))
OFF: dict[str, dict[str, Any]] = {
    "rao2010": {"levels_per_m": 0},
    "abramov2012": {"step_m": None},
    "mishra2012": {"depth": False},
}
"""Parameter values, indexed by method, with which the method forms regions without depth. The rules that reject regions
still use depth.
"""


def frames() -> list[Entry]:
    return find_labelled_frames([FRAMES / name for name in SETS])


def log(name: str) -> Path:
    return LOG / f"trials-{name}.jsonl.gz"


def logged(name: str) -> Search:
    """Read the scores of all tested parameter values of a method from docs/data.

    Exit with an error if the default parameters of the method have changed since the scores were written.
    """
    held = read_search(log(name))
    if held.subject.digest != sp.METHODS[name].digest:
        raise SystemExit(f"{log(name)} has trials of other parameters ({held.subject.digest}): run `search` again")
    return held


def search_all(trials: int, jobs: int, out: Path) -> None:
    LOG.mkdir(exist_ok=True)
    for name, method in sp.METHODS.items():

        def tell(done: int, total: int, _: Trial | None, name: str = name) -> None:
            print(f"{name}: {done} of {total} trials", flush=True)

        path = out / f"trials-{name}.jsonl"
        search(frames(), method, path, trials, SEED, jobs, tell)
        lines = path.read_bytes().splitlines(keepends=True)[: trials + 2]  # description and trial 0 come first
        log(name).write_bytes(gzip.compress(b"".join(lines), mtime=0))


def fitted(held: Search) -> Method:
    """Return the method with the best of the tested parameter values. The best values maximise the sum of two scores:
    share of found objects and mean overlap F.
    """
    return apply(best_trial(held.trials).setting, sp.METHODS[held.subject.method])


def time_all(methods: dict[str, Method]) -> dict[str, float]:
    """Return the relative CPU time of each method: its CPU time divided by the CPU time of `toscana2016` on the same
    frame. The returned relative CPU times are medians over frames.
    """
    cv2.setNumThreads(1)
    chosen = frames()[::EVERY]
    taken: dict[str, list[float]] = {name: [] for name in methods}
    for frame in (chosen[0], *chosen):
        image = frame.read()
        for name, method in methods.items():
            start = time.process_time()
            method(image)
            taken[name].append(time.process_time() - start)
    ours = np.array(taken["toscana2016"][1:])  # without the first frame, which may include compilation
    return {name: float(np.median(np.array(times[1:]) / ours)) for name, times in taken.items()}


BESIDE = (
    "F, defaults",
    "F, best on all frames",
    "F, random only",
    "best region, random only",
    "pieces",
    "leaks",
)
HEAD = ("overlap P", "R", "F", "boundary F", "F@.75", "70 %", "70 %, precise", "best region", "pieces", "leaks", "time")


def table() -> None:
    searches = {name: logged(name) for name in sp.METHODS}
    times = time_all({name: fitted(held) for name, held in searches.items()})
    rows = {name: hold_out(held, FOLDS, SEED).rows for name, held in searches.items()}
    counts = ", ".join(str(len(held.trials) - 1) for held in searches.values())
    print(f"{counts} trials, {FOLDS} folds, {len(rows['toscana2016'])} frames; time: relative to ours\n")
    print(line("", *HEAD, "F minus ours"), line("---", *["---:"] * (len(HEAD) + 1)), sep="\n")
    for name, held_out in rows.items():
        change = compare(rows["toscana2016"], held_out).overlap_f
        told = "" if name == "toscana2016" else "{:+.3f} ({:+.3f} to {:+.3f})".format(*change)
        print(line(f"`{name}`", *figures(held_out), f"{times[name]:.1f}", told), flush=True)
    print()
    for data_set in SETS:
        print(data_set, *(f"{name} {pool(of_set(held, data_set)).overlap_f.value:.3f}" for name, held in rows.items()))
    print("\nPieces and leaks are measured with the defaults on the first data set:\n")
    print(line("", "folds that chose the defaults", *BESIDE), line("---", *["---:"] * (len(BESIDE) + 1)), sep="\n")
    for name, held in searches.items():
        kept = sum(trial is held.start for trial in hold_out(held, FOLDS, SEED).chosen)
        drawn = hold_out(held, FOLDS, SEED, with_start=False).rows
        values = (pool(r).overlap_f.value for r in (held.start.rows, best_trial(held.trials).rows, drawn))
        best, regions = pool(drawn).best_iou_of_regions, pool(of_set(held.start.rows, SETS[0]))
        ends = f"{best:.3f}", f"{regions.pieces:.2f}", f"{regions.leaks:.2f}"
        print(line(f"`{name}`", f"{kept} of {FOLDS}", *(f"{v:.3f}" for v in values), *ends))


def figures(rows: Iterable[Row]) -> list[str]:
    p = pool(list(rows))
    shares = (p.overlap_precision, p.overlap_recall, p.overlap_f.value, p.boundary_f, p.f75)
    found = f"{p.found_70_recall:.0%}", f"{p.found_70_both:.0%}"
    return [*(f"{v:.3f}" for v in shares), *found, f"{p.best_iou_of_regions:.2f}", f"{p.pieces:.2f}", f"{p.leaks:.2f}"]


def of_set(rows: Iterable[Row], data_set: str) -> list[Row]:
    return [row for row in rows if row.data_set == data_set]


def without_depth() -> None:
    print(line("", *HEAD[:-1]), line("---", *["---:"] * (len(HEAD) - 1)), sep="\n")
    for name, off in OFF.items():
        held = logged(name)
        print(line(f"`{name}`, fitted", *figures(best_trial(held.trials).rows)))
        blind = fitted(held).replace(**off)
        print(line(f"`{name}`, depth off", *figures(run(blind))), flush=True)


def run(method: Method) -> Iterator[Row]:
    cv2.setNumThreads(1)
    work = Worker([method])
    return (work(Task(frame, method.name, method.digest)) for frame in frames())


def draw_all(out: Path) -> None:
    methods = {name: fitted(logged(name)) for name in reversed(sp.METHODS)}
    for folder in frames()[::EVERY]:
        frame, answers = folder.read(), {}
        for name, method in methods.items():
            start = time.perf_counter()
            answers[name] = method(frame), time.perf_counter() - start
        write_png(out / f"{folder.data_set}-{folder.name}.png", comparison(frame, answers, "toscana2016"))
    print(out)


def fixate() -> None:
    """Print the share of found objects and the mean IoU of `mishra2009`, for all objects and for isolated objects.

    The start pixel of an object is the pixel of its ground-truth mask that is farthest from the outline of the mask. An
    object is isolated if its mask, dilated by 5 px, does not overlap the mask of another object.
    """
    for data_set in SETS:
        found: list[tuple[bool, float]] = []
        for folder in find_labelled_frames([FRAMES / data_set]):
            frame, truth = folder.read_both()
            masks = [truth.labels == k for k in np.unique(truth.labels) if k] if truth is not None else []
            for mask in masks:
                around = sp.segment_around(frame, innermost(mask)).mask
                near = cv2.dilate(mask.view(np.uint8), DISC) > 0
                apart = not any((near & other).any() for other in masks if other is not mask)
                found.append((apart, np.count_nonzero(around & mask) / np.count_nonzero(around | mask)))
        for name, ious in (("all", [i for _, i in found]), ("apart", [i for apart, i in found if apart])):
            share = np.mean(np.array(ious) > FOUND_SHARE)
            print(
                f"{data_set}, {name}: {share:.0%} of {len(ious)} with IoU > 0.7, mean {np.mean(ious):.2f}", flush=True
            )


def line(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    searching = verbs.add_parser("search")
    searching.add_argument("--trials", type=int, default=30)
    searching.add_argument("--jobs", type=int, default=1)
    searching.add_argument("--out", type=Path, default=Path("measured-methods"))
    verbs.add_parser("table")
    verbs.add_parser("depth")
    verbs.add_parser("points")
    drawing = verbs.add_parser("pictures")
    drawing.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    match given.verb:
        case "search":
            search_all(given.trials, given.jobs, given.out)
        case "table":
            table()
        case "depth":
            without_depth()
        case "points":
            fixate()
        case "pictures":
            draw_all(given.out)


if __name__ == "__main__":
    main()
