"""What OBJECTS is worth on frames that had no say in its numbers, and what each of its ingredients brings.

    python -m spigolo.lab.studies.objects_preset search --trials 48 --out DIR
    python -m spigolo.lab.studies.objects_preset ablation --out DIR

`search` draws settings as `spigolo fit` does and scores each fifth of the frames with the setting that is best on the
others, each set with the one that is best on the other sets. The preset itself may not be chosen: its rules were made
while looking at all of these frames. `ablation` leaves one ingredient out at a time. Rows are kept in --out. Frames:
SPIGOLO_DATA, or ../shared/data.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import spigolo as sp
from spigolo.lab.evaluation import Row, pool
from spigolo.lab.experiments import Contender, Toscana2016, evaluate, find_labelled_frames
from spigolo.lab.experiments.tables import set_table
from spigolo.lab.fitting import Trial, best_trial, hold_out, hold_out_sets, search
from spigolo.lab.page import to_text
from spigolo.lab.studies import FRAMES

WHOLE = ("osd-*", "hand-uoc")
"""The sets where every object is labelled: there alone an object too many is an error."""
MOSD, REALSENSE, EMPTY = ("osd-mosd",), ("hand-uoc",), "arc_tote_empty"
OTHERS = ("6dof-graspnet", "cleargrasp-opaque", "dexnet-single", "hand-misc", "ycbv")

ABLATIONS: dict[str, dict[str, Any]] = {
    "`OBJECTS_2`": {},
    "without the inside of vessels": {"joining.vessel": None},
    "without caps": {"joining.cap": None},
    "without smooth borders": {"joining.smooth": None},
    "without enclosed bottoms": {"joining.enclosed": None},
    "without joining": {"joining": None},
    "without walls": {"additions.rules.wall": None},
    "largest plane, be it the floor": {"additions.support.stacked_share": None},
    "limits of size in pixels": {"additions.rules.max_length_m": None, "additions.rules.max_width_m": None},
    "weak contours from 0.65 on": {"additions.rules.min_contour": 0.65},
    "8-connected": {"partition.connectivity": 8},
    "without depth contours": {"additions.contours": None},
    "without a support plane": {"joining": None, "additions.support": None},
    "without the noise floor": {"additions.noise_per_m": 0.0},
}


def held_out(out: Path, trials: int, jobs: int) -> None:
    """The preset, the best of what was drawn, and what is best without the frames or sets that it is scored on."""
    frames = find_labelled_frames([FRAMES], WHOLE)
    tried = search(frames, Toscana2016(sp.OBJECTS), out / "trials.jsonl", trials, jobs=jobs, tell=tell)
    rows = {
        "preset": tried.start.rows,
        "fitted": best_trial(tried.trials[1:]).rows,
        "held out": hold_out(tried, with_start=False).rows,
        "set held out": hold_out_sets(tried, with_start=False).rows,
    }
    print(to_text(set_table([Contender(name, "", held) for name, held in rows.items()])))


def tell(done: int, total: int, trial: Trial | None) -> None:
    if trial is not None:
        print(f"{done}/{total}", flush=True)


def ablation(out: Path, jobs: int) -> None:
    """A line for each ingredient left out."""
    frames = find_labelled_frames([FRAMES], WHOLE)
    print("| | mOSD: overlap F | found | RealSense: overlap F | found | five other sets: found | empty tote |")
    print("|---|---|---|---|---|---|---|")
    for name, changes in ABLATIONS.items():
        method = Toscana2016(sp.PRESETS["OBJECTS_2"].replace(**changes))
        rows = evaluate(frames, [method], out / "ablation.jsonl", jobs)
        cells = [*figures(rows, MOSD), *figures(rows, REALSENSE), figures(rows, OTHERS)[1]]
        empty = sum(r.n_predicted for r in rows if r.frame == EMPTY)
        print(f"| {name} | {' | '.join(cells)} | {empty} |", flush=True)


def figures(rows: Sequence[Row], sets: Sequence[str]) -> tuple[str, str]:
    """Overlap F, and the share of labelled objects found."""
    pooled = pool([row for row in rows if row.data_set in sets])
    return f"{pooled.overlap_f.value:.3f}", f"{pooled.true_positives / pooled.n_objects:.0%}".replace("%", " %")


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
