"""Measure the accuracy of the preset OBJECTS on held-out frames, and the effect of each extension of the paper's
method.

    python -m spigolo.lab.studies.objects_preset search --trials 48 --out DIR
    python -m spigolo.lab.studies.objects_preset ablation --out DIR

The command `search` draws random parameter values. The command `search` scores the best values on held-out frames
(cross-validation with five folds), and on held-out sources (one source at a time). Data sets of the same camera and
place are one source. The values of the preset OBJECTS are not candidates in the search, because the rules of OBJECTS
were developed on the same frames. The command `ablation`
scores variants of the preset. In each variant of the preset, one extension of the paper's method is removed or changed.
All scores are stored in the folder given by `--out`. Frames are read from the subfolder `frames` of the data folder.
The environment variable SPIGOLO_DATA sets the data folder (default: ../shared/data).
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import spigolo as sp
from spigolo.lab.evaluation import Row, pool
from spigolo.lab.experiments import Contender, Toscana2016, evaluate, find_labelled_frames
from spigolo.lab.experiments.tables import set_table
from spigolo.lab.fitting import Trial, best_trial, hold_out, hold_out_sets, search
from spigolo.lab.page import to_text
from spigolo.lab.studies import FRAMES
from spigolo.settings.additions import NEED_SUPPORT

SAME = {"osd-full/learn6": "osd-mosd/learn6"}
"""Frames that show the scene of another frame, and the group of near-identical frames to which they belong."""
GROUPS = {
    "mOSD": ("osd-mosd",),
    "mOSD, test split": ("osd-mosd-b",),
    "table-tops": ("hand-uoc",),
    "other table-tops": ("osd-full-b", "hand-uoc-b", "hand-pcpt-b", "hand-posecnn-b"),
    "partly labelled": ("6dof-graspnet", "cleargrasp-opaque", "dexnet-single", "hand-misc", "ycbv"),
    "others, partly labelled": ("cleargrasp-opaque-b", "dexnet-single-b", "hand-misc-b", "ycbv-b"),
    "field": ("field",),
}
EMPTY = "arc_tote_empty"
LITTLE_WORTH = {"femtobolt_box", "pepper_greenhouse", "slambook_dining", "sbtc_battery_cables", "kpick_dewbell_bin"}
"""Names of frames that are left out, because of unregistered depth or poor labels."""

ABLATIONS: dict[str, dict[str, Any]] = {
    "`OBJECTS`": {},
    "`OBJECTS` without refinement of outlines": {"additions.refinement": None},
    "`OBJECTS` without refinement of the background inside convex hulls": {"additions.refinement.min_solidity": None},
    "`OBJECTS` without merging of regions by their whole border": {"additions.merging": None},
    "`OBJECTS` without joining of parts": {"additions.joining": None},
    "`OBJECTS` without the rules `wall` and `ledge`": {"additions.rules.wall": None, "additions.rules.ledge": None},
    "`OBJECTS` without flat objects (`flats`)": {"additions.flats": None},
    "`OBJECTS` without the rule `ledge`": {"additions.rules.ledge": None},
    "`OBJECTS` without the rule `rim`": {"additions.rules.rim": None},
    "`OBJECTS` with a maximum object size of 0.40 x 0.25 m": {
        "additions.rules.max_length_m": 0.4,
        "additions.rules.max_width_m": 0.25,
    },
    "`OBJECTS` with a minimum object height of 8 mm in all frames": {"additions.support.noise_factor": None},
    "`OBJECTS` without `facing` and `min_things`": {
        "additions.support.facing": None,
        "additions.support.min_things": None,
    },
    "`OBJECTS` without `stacked_share`: the largest plane is the support plane, even if it is the floor": {
        "additions.support.stacked_share": None
    },
    "`OBJECTS` without `max_below`: the plane on top of a heap is not lowered": {"additions.support.max_below": None},
    "`OBJECTS` without `within_reach`: planes at any distance are accepted": {"additions.support.within_reach": False},
    "`OBJECTS` without a minimum depth of creases": {"additions.contours.crease_noise": None},
    "`OBJECTS` without depth contours": {"additions.contours": None},
    "`OBJECTS` without a support plane": {f"additions.{name}": None for name in ("support", *NEED_SUPPORT)},
    "`OBJECTS` without the noise floor": {"additions.noise_per_m": 0.0},
    "`OBJECTS` with 8 instead of 4 neighbours per pixel": {"partition.connectivity": 8},
}


def held_out(out: Path, trials: int, jobs: int) -> None:
    """Print the accuracy of the preset and of fitted parameters. The fitted parameters are scored on all frames, on
    held-out frames and on held-out sources.
    """
    frames = [
        replace(frame, group=SAME.get(f"{frame.data_set}/{frame.name}", frame.group))
        for frame in find_labelled_frames([FRAMES])
    ]
    tried = search(frames, Toscana2016(sp.OBJECTS), out / "trials.jsonl", trials, jobs=jobs, tell=tell)
    rows = {
        "preset": tried.start.rows,
        "fitted": best_trial(tried.trials[1:]).rows,
        "held out": hold_out(tried, with_start=False).rows,
        "source held out": hold_out_sets(tried, with_start=False, source_of=source_of).rows,
    }
    print(to_text(set_table([Contender(name, "", held) for name, held in rows.items()])))
    print(f"\n| | {' | '.join(GROUPS)} |\n" + "|---" * (1 + len(GROUPS)) + "|")
    for name, held in rows.items():
        print(f"| {name} | {' | '.join(figures(held, sets) for sets in GROUPS.values())} |")


def source_of(data_set: str) -> str:
    """Return the source of a data set: the data sets `osd-*` have one source, and so have `NAME` and `NAME-b`."""
    return "osd" if data_set.startswith("osd-") else data_set.removesuffix("-b")


def tell(done: int, total: int, trial: Trial | None) -> None:
    if trial is not None:
        print(f"{done}/{total}", flush=True)


def ablation(out: Path, jobs: int) -> None:
    """Print overlap F, boundary F and the share of found objects for variants of the preset. In each variant, one
    extension of the paper's method is removed or changed.
    """
    frames = find_labelled_frames([FRAMES])
    print(f"| | {' | '.join(f'{group}: F / boundary F / found' for group in GROUPS)} | empty tote |")
    print("|---" * (2 + len(GROUPS)) + "|")
    for name, changes in ABLATIONS.items():
        rows = evaluate(frames, [Toscana2016(sp.OBJECTS.replace(**changes))], out / "ablation.jsonl", jobs)
        cells = [figures(rows, sets) for sets in GROUPS.values()]
        empty = sum(row.n_predicted for row in rows if row.frame == EMPTY)
        print(f"| {name} | {' | '.join(cells)} | {empty} |", flush=True)


def figures(rows: Sequence[Row], sets: Sequence[str]) -> str:
    """Format overlap F, boundary F and the share of found objects, pooled over the data sets `sets`.

    If some objects in the data sets are not labelled, only the share of found objects is returned.
    """
    pooled = pool([row for row in rows if row.data_set in sets and row.frame not in LITTLE_WORTH])
    found = f"{pooled.true_positives / pooled.n_objects:.0%}".replace("%", " %")
    if np.isnan(pooled.overlap_f.value):
        return found
    return f"{pooled.overlap_f.value:.3f} / {pooled.boundary_f:.3f} / {found}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=("search", "ablation"))
    parser.add_argument("--trials", type=int, default=48)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    if given.verb == "search":
        held_out(given.out, given.trials, given.jobs)
    else:
        ablation(given.out, given.jobs)


if __name__ == "__main__":
    main()
