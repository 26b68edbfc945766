"""Fits the OBJECTS preset by random search and scores it in five folds.

    python scripts/fit_objects.py search --trials 120 --out trials.jsonl
    python scripts/fit_objects.py report trials.jsonl
    python scripts/fit_objects.py presets

`search` draws settings without looking at scores, so that every fold may choose among the same trials. `report`
chooses in each fold by the other four and scores the choice on the fold left out. `presets` scores the presets as they
are. Frames: SPIGOLO_DATA, or ../shared/data.
"""

from __future__ import annotations

import argparse
import json
import os
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import cv2
import numpy as np

import spigolo as sp
from spigolo.evaluation import DatasetScore, FrameScore, format_table, score_frame, summarise

DATA = Path(os.environ.get("SPIGOLO_DATA", Path(__file__).parents[2] / "shared" / "data")) / "frames"
FITTED = "osd-mosd"
WATCHED = ("hand-uoc", "6dof-graspnet", "hand-misc")
EMPTY = "unlabelled/arc_tote_empty"
FOLDS = 5
IGNORE = 255


def draw(rng: np.random.Generator) -> dict[str, Any]:
    """One setting: what the paper leaves to the data, and the depth contours."""
    return {
        "partition.gamma": float(np.exp(rng.uniform(np.log(0.0015), np.log(0.008)))),
        "cost.k_x": float(np.exp(rng.uniform(np.log(1.5), np.log(10.0)))),
        "depth.noise_per_m": float(rng.choice([0.0, 0.0014, 0.0028])),
        "depth.smoothing.max_radius_px": int(rng.integers(4, 11)),
        "depth.smoothing.step_factor": float(rng.uniform(6, 18)),
        "edges.contact_low_deg": float(rng.uniform(30, 60)),
        "edges.contact_high_deg": float(rng.uniform(135, 156)),
        "edges.blur_px": int(rng.choice([7, 9])),
        "edges.depth_contours.step_m": float(rng.uniform(0.01, 0.02)),
        "edges.depth_contours.step_per_m": float(rng.uniform(0.008, 0.02)),
        "edges.depth_contours.crease_offset_px": int(rng.integers(4, 8)),
        "edges.depth_contours.crease_high_deg": float(rng.uniform(138, 153)),
        "rejection.support.min_height_m": float(rng.uniform(0.005, 0.012)),
    }


@cache
def load(name: str) -> tuple[sp.Frame, np.ndarray]:
    """A frame and its labels."""
    folder = DATA / name
    label = cv2.imread(str(folder / "label.png"), cv2.IMREAD_UNCHANGED)
    return sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json"), label


def score(task: tuple[str, sp.Config]) -> FrameScore:
    """The score of one frame with one configuration."""
    cv2.setNumThreads(1)
    frame, label = load(task[0])
    ignore = label == IGNORE
    return score_frame(np.where(ignore, 0, label), sp.segment(frame, task[1]).labels, ignore=ignore)


def count_objects(name: str, config: sp.Config) -> int:
    """Objects that a configuration sees in a frame without labels."""
    folder = DATA / name
    return len(sp.segment(sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json"), config))


def names(prefix: str) -> list[str]:
    """Labelled frames whose name starts so, in a fixed order."""
    listed = json.loads((DATA / "splits.json").read_text())["dev"]
    return sorted(name for name in listed if name.startswith(prefix))


def search(pool: ProcessPoolExecutor, trials: int, seed: int, out: Path) -> None:
    rng = np.random.default_rng(seed)
    sets = {prefix: names(prefix) for prefix in (FITTED, *WATCHED)}
    with out.open("a") as file:
        for number in range(trials):
            setting = {} if number == 0 and seed == 0 else draw(rng)
            config = sp.OBJECTS.replace(**setting)
            row: dict[str, Any] = {"setting": setting}
            for prefix, frames in sets.items():
                scores = list(pool.map(score, [(name, config) for name in frames], chunksize=4))
                row[prefix] = [[s.overlap_f, s.boundary_f, s.f75, s.found_iou_70.tolist()] for s in scores]
            row["empty"] = pool.submit(count_objects, EMPTY, config).result()
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(f"{number + 1}/{trials}", *(f"{p} F {np.mean([s[0] for s in row[p]]):.3f}" for p in sets), flush=True)


def goodness(row: dict[str, Any], which: list[int]) -> float:
    """What is fitted: overlap F and the share found with IoU above 0.7 of some frames, and that a choice carries over.

    The watched sets, of other sensors, count a quarter; an object seen in the empty tote costs 0.02.
    """
    others = np.mean([np.concatenate([f[3] for f in row[prefix]]).mean() for prefix in WATCHED])
    frames = [row[FITTED][i] for i in which]
    found = np.concatenate([f[3] for f in frames]).mean()
    overlap, elsewhere = np.mean([f[0] for f in frames]), np.mean([f[0] for f in row["hand-uoc"]])
    return float(overlap + 0.5 * found + 0.25 * elsewhere + 0.25 * others - 0.02 * row["empty"])


def describe(frames: list[Any]) -> str:
    found = np.concatenate([f[3] for f in frames])
    means = np.mean([f[:3] for f in frames], axis=0)
    return "F {:.3f}  boundary F {:.3f}  F@.75 {:.3f}  IoU>0.7 {:.3f}".format(*means, found.mean())


def report(path: Path) -> None:
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    count = len(rows[0][FITTED])
    fold_of = np.random.default_rng(0).permutation(count) % FOLDS
    held_out = []
    for fold in range(FOLDS):
        inside = [i for i in range(count) if fold_of[i] != fold]
        best = max(rows, key=lambda row: goodness(row, inside))
        left = [best[FITTED][i] for i in range(count) if fold_of[i] == fold]
        held_out += left
        print(f"fold {fold}: held out {describe(left)}  trial {rows.index(best)}")
    print(f"held out, all folds: {describe(held_out)}")
    ranked = sorted(rows, key=lambda row: goodness(row, list(range(count))), reverse=True)
    for row in ranked[:5]:
        print(f"fitted to all, trial {rows.index(row)}: {describe(row[FITTED])}  empty tote {row['empty']}")
        for prefix in WATCHED:
            print(f"    {prefix}: {describe(row[prefix])}")
    print(json.dumps(ranked[0]["setting"], indent=1))


def presets(pool: ProcessPoolExecutor) -> None:
    for prefix in (FITTED, "osd-full", "hand-uoc"):
        table: dict[str, DatasetScore] = {}
        for name in ("OBJECTS", "SHELF", "TABLE", "CLUTTER"):
            tasks = [(frame, sp.PRESETS[name]) for frame in names(prefix)]
            table[name] = summarise(list(pool.map(score, tasks, chunksize=4)))
        print(f"\n{prefix}\n{format_table(table)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    searching = verbs.add_parser("search")
    searching.add_argument("--trials", type=int, default=120)
    searching.add_argument("--seed", type=int, default=0)
    searching.add_argument("--out", type=Path, required=True)
    verbs.add_parser("report").add_argument("trials", type=Path)
    verbs.add_parser("presets")
    given = parser.parse_args()
    if given.verb == "report":
        report(given.trials)
        return
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        if given.verb == "search":
            search(pool, given.trials, given.seed, given.out)
        else:
            presets(pool)


if __name__ == "__main__":
    main()
