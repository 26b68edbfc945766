"""Figures of rendered families beside those of real frames: `python scripts/measure_realism.py FRAMES --count 24`.

FRAMES is a folder of sets as SET/FRAME/ with rgb.png, depth.png and camera.json. Frames of one scene count once. With
`--presets` it also measures how many objects each preset finds in the rendered frames.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import astuple
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.datasets import Sample, find_labelled_frames
from spigolo.synthetic.families import FAMILIES, render_family
from spigolo.synthetic.realism import Realism, quartiles, realism

REAL = {
    "shelf": ("*apcshelf*", "*stanley*"),
    "table": (
        "hand-uoc/00000[01]", "hand-uoc/00000[45]", "ycbv/0000_*", "ycbv/0001_*", "osd-full/*", "*desk_1_1",
        "*meeting_small_1_1", "*00490*",
    ),
    "multi": (
        "hand-misc/felix*", "hand-misc/milk*", "6dof-graspnet/*", "dexnet-single/*", "cleargrasp*", "*lm_scene",
        "*pcl_bottles",
    ),
}  # fmt: skip
"""Patterns SET/FRAME of the real scenes that each family is held against."""
PRESETS = ("SHELF", "TABLE", "CLUTTER", "OBJECTS")


def main() -> None:
    parser = argparse.ArgumentParser(description="Figures of rendered families beside those of real frames.")
    parser.add_argument("frames", type=Path, nargs="*", help="folders of real frames, in any layout that is read")
    parser.add_argument("--count", type=int, default=24, help="rendered frames a family")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--families", nargs="+", default=list(FAMILIES), choices=list(FAMILIES))
    parser.add_argument("--presets", action="store_true", help="also segment the rendered frames")
    arguments = parser.parse_args()
    real = real_figures(arguments.frames)
    print("| family | figure | rendered: quartile, median, quartile | real |\n|---|---|---|---|")
    found = {}
    for family in arguments.families:
        samples = [render_family(family, k, arguments.seed) for k in range(arguments.count)]
        rendered = quartiles([realism(sample.frame) for sample in samples])
        measured = quartiles(real[family]) if real[family] else {}
        for name, values in rendered.items():
            print(f"| {family} | {name} | {numbers(values)} | {numbers(measured.get(name, ()))} |")
        found[family] = samples
    if arguments.presets:
        print("\n| cell | objects | " + " | ".join(PRESETS) + " |\n" + "|---" * (len(PRESETS) + 2) + "|")
        for family, samples in found.items():
            print_recall(family, samples)


def real_figures(folders: list[Path]) -> dict[str, list[Realism]]:
    """One entry a scene: the mean of its frames."""
    scenes: dict[tuple[str, str], list[Realism]] = defaultdict(list)
    for entry in find_labelled_frames(folders) if folders else []:
        for family, patterns in REAL.items():
            for pattern in patterns:
                if fnmatch(f"{entry.data_set}/{entry.name}", pattern):
                    scenes[family, pattern].append(realism(entry.read()))
    answer: dict[str, list[Realism]] = {family: [] for family in FAMILIES}
    for (family, _), figures in scenes.items():
        answer[family].append(Realism(*np.array([astuple(one) for one in figures]).mean(axis=0)))
    return answer


def print_recall(family: str, samples: list[Sample]) -> None:
    """Share of objects of which one segment covers more than 70 %, and with IoU above 0.7, by object or scene."""
    hits: dict[str, list[list[bool]]] = defaultdict(list)
    for sample in samples:
        labels = [sp.segment(sample.frame, sp.PRESETS[name]).labels for name in PRESETS]
        for truth, cell in cells(family, sample):
            hits[cell].append([hit for found in labels for hit in judge(truth, found)])
    for cell, rows in sorted(hits.items()):
        shares = 100 * np.mean(rows, axis=0)
        texts = [f"{covered:.0f} / {iou:.0f}" for covered, iou in shares.reshape(-1, 2)]
        print(f"| {family} {cell} | {len(rows)} | {' | '.join(texts)} |")


def cells(family: str, sample: Sample) -> Iterator[tuple[np.ndarray, str]]:
    scene = sample.frame.name.rpartition("_")[0]
    for instance in sample.instances:
        kind = instance.model.rpartition("_")[0]
        yield sample.labels == instance.label, kind if family == "table" else scene


def judge(truth: np.ndarray, found: np.ndarray) -> tuple[bool, bool]:
    inside = np.bincount(found[truth], minlength=found.max() + 1).astype(float)
    inside[0] = 0
    union = truth.sum() + np.bincount(found.ravel()) - inside
    return bool(inside.max() > 0.7 * truth.sum()), bool((inside / union).max() > 0.7)


def numbers(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.3g}" for value in values) or "-"


if __name__ == "__main__":
    main()
