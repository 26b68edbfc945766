"""Fit parameters like `spigolo fit`, and score them on held-out frames: `python -m spigolo.lab.studies.fit`.

The search for parameter values starts with the values of the preset TABLE. For each seed, the frames of `osd-mosd` are
split at random into two halves. For each half, the parameter values with the best score on this half are selected, and
then scored on the other half. The scores of all tested parameter values are stored in the folder given by `--out`.
Frames are read from the subfolder `frames` of the data folder. The environment variable SPIGOLO_DATA sets the data
folder (default: ../shared/data).
"""

from __future__ import annotations

import argparse
from pathlib import Path

import spigolo as sp
from spigolo.lab.evaluation import Row, pool
from spigolo.lab.experiments import Toscana2016, evaluate, find_labelled_frames
from spigolo.lab.fitting import hold_out, search
from spigolo.lab.studies import FRAMES


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=60)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("measured-fit"))
    given = parser.parse_args()
    frames = find_labelled_frames([FRAMES / "osd-mosd"])
    goal = overlap(evaluate(frames, [Toscana2016(sp.OBJECTS)], given.out / "objects.jsonl", given.jobs))
    for seed in given.seeds:
        out = given.out / f"table-{seed}.jsonl"
        made = search(frames, Toscana2016(sp.TABLE), out, given.trials, seed, given.jobs)
        start, held = overlap(made.start.rows), hold_out(made, 2, seed)
        reached = overlap(held.rows)
        print(
            f"seed {seed}: overlap F of TABLE {start:.3f}, of OBJECTS {goal:.3f}, held out with fitted parameters"
            f" {reached:.3f} ({(reached - start) / (goal - start):.0%} of the difference), best trials"
            f" {[t.number for t in held.chosen]}",
            flush=True,
        )


def overlap(rows: list[Row] | tuple[Row, ...]) -> float:
    return pool(rows).overlap_f.value


if __name__ == "__main__":
    main()
