"""Fits the OBJECTS preset by random search and scores it in five folds and on sets left out.

    python scripts/fit_objects.py search --trials 60 --out trials.jsonl
    python scripts/fit_objects.py report trials.jsonl
    python scripts/fit_objects.py presets

`search` draws settings without looking at scores, so that every fold may choose among the same trials; trial 0 is the
preset itself. `report` chooses among the others, in each fold by the other four, for each set by the other sets, and
scores the choice on what was left out. `presets` scores the presets as they are, `ablation` OBJECTS without one
ingredient at a time. Frames: SPIGOLO_DATA, or ../shared/data.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterable
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
FOLDED = "osd-mosd"
ALL_LABELLED = ("osd-mosd", "osd-full", "hand-uoc")
"""The sets where every object is labelled: there alone an object too many is an error."""
EMPTY = "unlabelled/arc_tote_empty"
FOLDS = 5
IGNORE = 255


def draw(rng: np.random.Generator) -> dict[str, Any]:
    """One setting: what the paper leaves to the data, the depth contours, and what joins parts."""
    return {
        "partition.gamma": float(np.exp(rng.uniform(np.log(0.003), np.log(0.01)))),
        "cost.k_x": float(np.exp(rng.uniform(np.log(1.5), np.log(5.0)))),
        "depth.smoothing.max_radius_px": int(rng.integers(4, 8)),
        "edges.contact_low_deg": float(rng.uniform(30, 45)),
        "edges.contact_high_deg": float(rng.uniform(140, 152)),
        "edges.blur_px": int(rng.choice([7, 9])),
        "edges.depth_contours.step_m": float(rng.uniform(0.012, 0.022)),
        "edges.depth_contours.crease_offset_px": int(rng.integers(4, 7)),
        "edges.depth_contours.crease_high_deg": float(rng.uniform(140, 150)),
        "joining.vessel.sure_contrast": float(rng.uniform(0.1, 0.35)),
        "joining.vessel.sure_solidity": float(rng.uniform(0.65, 0.85)),
        "joining.cap.max_gap_m": float(rng.uniform(0.01, 0.03)),
        "joining.smooth.max_bend_m": float(rng.uniform(0.0, 0.002)),
        "joining.smooth.max_gap_m": float(rng.uniform(0.015, 0.04)),
        "rejection.min_contour": float(rng.uniform(0.5, 0.7)),
        "rejection.support.min_height_m": float(rng.uniform(0.006, 0.011)),
        "rejection.support.stacked_share": float(rng.uniform(0.3, 0.8)),
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


def names() -> list[str]:
    """All labelled frames, in a fixed order."""
    return sorted(json.loads((DATA / "splits.json").read_text())["dev"])


def search(pool: ProcessPoolExecutor, trials: int, seed: int, out: Path) -> None:
    rng = np.random.default_rng(seed)
    with out.open("a") as file:
        for number in range(trials):
            setting = {} if number == 0 and seed == 0 else draw(rng)
            config = sp.OBJECTS.replace(**setting)
            scores = pool.map(score, [(name, config) for name in names()], chunksize=4)
            row: dict[str, Any] = {"setting": setting, "empty": pool.submit(count_objects, EMPTY, config).result()}
            row["frames"] = {
                name: [s.overlap_f, s.boundary_f, s.f75, s.found_iou_70.tolist()]
                for name, s in zip(names(), scores, strict=True)
            }
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(f"{number + 1}/{trials}", describe([row["frames"][name] for name in of_set(FOLDED)]), flush=True)


def of_set(data_set: str) -> list[str]:
    return [name for name in names() if name.startswith(data_set + "/")]


def goodness(row: dict[str, Any], frames: Iterable[str]) -> float:
    """What is fitted, on average over sets: the share of labelled objects found, and overlap F where it has a meaning.

    An object seen in the empty tote costs 0.02.
    """
    sets: dict[str, list[Any]] = {}
    for name in frames:
        sets.setdefault(name.split("/")[0], []).append(row["frames"][name])
    found = [float(np.concatenate([f[3] for f in rows]).mean()) for rows in sets.values()]
    overlap = [float(np.mean([f[0] for f in rows])) for name, rows in sets.items() if name in ALL_LABELLED]
    return float(np.mean(found) + (np.mean(overlap) if overlap else 0.0) - 0.02 * row["empty"])


def describe(frames: list[Any]) -> str:
    found = np.concatenate([f[3] for f in frames])
    means = np.mean([f[:3] for f in frames], axis=0)
    return "F {:.3f}  boundary F {:.3f}  F@.75 {:.3f}  IoU>0.7 {:.3f}".format(*means, found.mean())


def report(path: Path) -> None:
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    drawn = [row for row in rows if row["setting"]]  # the preset was made while looking at all frames
    folded = of_set(FOLDED)
    fold_of = np.random.default_rng(0).permutation(len(folded)) % FOLDS
    held_out = []
    for fold in range(FOLDS):
        left = [name for name, k in zip(folded, fold_of, strict=True) if k == fold]
        best = max(drawn, key=lambda row: goodness(row, set(names()) - set(left)))
        held_out += [best["frames"][name] for name in left]
        print(f"{FOLDED}, fold {fold}: held out {describe(held_out[-len(left) :])}  trial {rows.index(best)}")
    print(f"{FOLDED}, held out, all folds: {describe(held_out)}")
    fitted = max(drawn, key=lambda row: goodness(row, names()))
    for data_set in sorted({name.split("/")[0] for name in names()}):
        left = of_set(data_set)
        best = max(drawn, key=lambda row: goodness(row, set(names()) - set(left)))
        print(f"\n{data_set}\n  preset    {describe([rows[0]['frames'][name] for name in left])}")
        print(f"  fitted    {describe([fitted['frames'][name] for name in left])}  trial {rows.index(fitted)}")
        print(f"  left out  {describe([best['frames'][name] for name in left])}  trial {rows.index(best)}")
    print(json.dumps(fitted["setting"], indent=1))


def presets(pool: ProcessPoolExecutor) -> None:
    for data_set in ALL_LABELLED:
        table: dict[str, DatasetScore] = {}
        for name in ("OBJECTS_2", "OBJECTS_1", "SHELF", "TABLE", "CLUTTER"):
            tasks = [(frame, sp.PRESETS[name]) for frame in of_set(data_set)]
            table[name] = summarise(list(pool.map(score, tasks, chunksize=4)))
        print(f"\n{data_set}\n{format_table(table)}")


ABLATIONS: dict[str, dict[str, Any]] = {
    "OBJECTS_2": {},
    "without the inside of vessels": {"joining.vessel": None},
    "without caps": {"joining.cap": None},
    "without smooth borders": {"joining.smooth": None},
    "without enclosed bottoms": {"joining.enclosed": None},
    "without joining": {"joining": None},
    "without walls": {"rejection.wall": None},
    "largest plane, be it the floor": {"rejection.support.stacked_share": None},
    "limits of size in pixels": {"rejection.max_length_m": None, "rejection.max_width_m": None},
    "weak contours from 0.65 on": {"rejection.min_contour": 0.65},
    "8-connected": {"partition.connectivity": 8},
    "without depth contours": {"edges.depth_contours": None},
    "without a support plane": {"joining": None, "rejection.support": None},
    "without the noise floor": {"depth.noise_per_m": 0.0},
}


def cpu_ms(config: sp.Config) -> float:
    """Median over some frames of five sets, one thread."""
    cv2.setNumThreads(1)
    segmenter, times = sp.Segmenter(config), []
    for name in [of_set(s)[0] for s in ("osd-mosd", "hand-uoc", "ycbv", "6dof-graspnet", "hand-misc")] * 4:
        start = time.process_time()
        segmenter(load(name)[0])
        times.append(1e3 * (time.process_time() - start))
    return float(np.median(times[5:]))


def ablation(pool: ProcessPoolExecutor) -> None:
    others = [name for name in names() if not name.startswith((*ALL_LABELLED, "hand-apcshelf"))]
    print("| | mOSD: overlap F | found | RealSense: overlap F | found | five other sets: found | empty tote | time |")
    print("|---|---|---|---|---|---|---|---|")
    for name, changes in ABLATIONS.items():
        config = sp.OBJECTS_2.replace(**changes)
        scores = dict(zip(names(), pool.map(score, [(n, config) for n in names()], chunksize=4), strict=True))
        cells = []
        for frames in (of_set(FOLDED), of_set("hand-uoc"), others):
            rows = [scores[n] for n in frames]
            found = np.concatenate([r.found_iou_70 for r in rows]).mean()
            cells += [f"{np.mean([r.overlap_f for r in rows]):.3f}", f"{found:.0%}"]
        empty = pool.submit(count_objects, EMPTY, config).result()
        print(f"| {name} | {' | '.join(cells[:4])} | {cells[5]} | {empty} | {cpu_ms(config):.0f} ms |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    searching = verbs.add_parser("search")
    searching.add_argument("--trials", type=int, default=60)
    searching.add_argument("--seed", type=int, default=0)
    searching.add_argument("--out", type=Path, required=True)
    verbs.add_parser("report").add_argument("trials", type=Path)
    verbs.add_parser("presets")
    verbs.add_parser("ablation")
    given = parser.parse_args()
    if given.verb == "report":
        report(given.trials)
        return
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        if given.verb == "search":
            search(pool, given.trials, given.seed, given.out)
        elif given.verb == "ablation":
            ablation(pool)
        else:
            presets(pool)


if __name__ == "__main__":
    main()
