"""Compare scores at half and full resolution: `python -m spigolo.lab.studies.resolution FOLDER --reference FRAME`.

For each frame of the data set, the script prints overlap F, number of found objects and CPU time at half and full
resolution. CPU times are divided by the CPU time of the 640x480 frame in the folder given by `--reference`.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from pathlib import Path

import spigolo as sp
from spigolo.batch.engine import one_thread
from spigolo.lab.bench.figures import paired_ratio
from spigolo.lab.bench.timing import run_rounds, timed
from spigolo.lab.datasets import Truth, guess
from spigolo.lab.evaluation.rows import RowScore, score_row

HALF = sp.OBJECTS.replace(additions={"resolution": "half"})


def main() -> None:
    parser = argparse.ArgumentParser(description="Compare half and full resolution on large frames.")
    parser.add_argument("folder", type=Path, help="data set of large frames")
    parser.add_argument("--reference", type=Path, required=True, help="folder of a 640x480 frame as time reference")
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args()
    small = read(given.reference)
    print("| frame | size | F full | F half | found full | found half | time full | time half |")
    print("|---|---|---|---|---|---|---|---|")
    with warnings.catch_warnings(), one_thread():
        warnings.simplefilter("ignore")
        for entry in guess(given.folder):
            frame, truth = entry.read_both()
            if truth is None:
                continue
            scores = [score(frame, config, truth) for config in (sp.OBJECTS, HALF)]
            cells = [f"{one.overlap_f:.3f}" for one in scores]
            cells += [f"{one.true_positives} of {one.n_objects}" for one in scores]
            runs = {"full": work(sp.OBJECTS, frame), "half": work(HALF, frame), "reference": work(sp.OBJECTS, small)}
            samples = run_rounds({name: timed(run) for name, run in runs.items()}, given.rounds)
            cells += [f"{paired_ratio(samples[name], samples['reference']):.2f}" for name in ("full", "half")]
            height, width = frame.shape
            print(f"| {entry.name} | {width}x{height} | {' | '.join(cells)} |", flush=True)


def read(folder: Path) -> sp.Frame:
    scale = sp.read_camera(folder / "camera.json")[1]
    return sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json", depth_scale=scale or 0.001)


def score(frame: sp.Frame, config: sp.Config, truth: Truth) -> RowScore:
    return score_row(truth.labels, sp.segment(frame, config).labels, None, truth.ignore)


def work(config: sp.Config, frame: sp.Frame) -> Callable[[], object]:
    segmenter = sp.Segmenter(config)
    return lambda: segmenter(frame)


if __name__ == "__main__":
    main()
