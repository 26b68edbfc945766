"""Compare statistics of rendered and real frames: `python -m spigolo.lab.studies.realism FRAMES --count 24`.

FRAMES are folders of real frames, in any supported file layout. Only frames that match a name pattern in `REAL` are
used. Statistics of real frames are averaged over the frames of each scene. With `--slant`, the script also prints the
depth noise on slanted surfaces, for several ranges of disparity gradient. The disparity gradient is the change of
disparity per image pixel. With `--presets`, the script also prints the share of objects that each preset finds in the
rendered frames.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import astuple
from fnmatch import fnmatch
from itertools import pairwise
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.doctor.local_planes import fit_local_planes
from spigolo.lab.datasets import Sample, find_labelled_frames
from spigolo.lab.synthetic.families import FAMILIES, render_family
from spigolo.lab.synthetic.realism import Realism, quartiles, realism

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
"""Name patterns of real frames, indexed by the family of rendered scenes with which the frames are compared. A pattern
has the form SET/FRAME, and selects the frames of one real scene.
"""
CHANGES_PX = (0.02, 0.04, 0.06, 0.09, 0.13, 0.2)
"""Limits between the ranges of disparity gradient (change of disparity per image pixel)."""
BASELINE_M, NEAR_M, FAR_M = 0.075, 0.4, 2.5
PRESETS = ("SHELF", "TABLE", "CLUTTER", "OBJECTS")


def main() -> None:
    parser = argparse.ArgumentParser(description="Compare statistics of rendered and real frames.")
    parser.add_argument("frames", type=Path, nargs="*", help="folders of real frames, in any supported file layout")
    parser.add_argument("--count", type=int, default=24, help="number of rendered frames per family")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--families", nargs="+", default=list(FAMILIES), choices=list(FAMILIES))
    parser.add_argument("--slant", action="store_true", help="also print the depth noise by disparity gradient")
    parser.add_argument("--presets", action="store_true", help="also print the share of found objects")
    arguments = parser.parse_args()
    real = real_figures(arguments.frames)
    print("| family | statistic | rendered: lower quartile, median, upper quartile | real |\n|---|---|---|---|")
    found = {}
    for family in arguments.families:
        samples = [render_family(family, k, arguments.seed) for k in range(arguments.count)]
        rendered = quartiles([realism(sample.frame) for sample in samples])
        measured = quartiles(real[family]) if real[family] else {}
        for name, values in rendered.items():
            print(f"| {family} | {name} | {numbers(values)} | {numbers(measured.get(name, ()))} |")
        found[family] = samples
    if arguments.slant:
        print_slant(found, arguments.frames)
    if arguments.presets:
        print("\n| cell | objects | " + " | ".join(PRESETS) + " |\n" + "|---" * (len(PRESETS) + 2) + "|")
        for family, samples in found.items():
            print_recall(family, samples)


def real_figures(folders: list[Path]) -> dict[str, list[Realism]]:
    """Return the statistics of real scenes, averaged over the frames of each scene and indexed by family."""
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


def print_slant(rendered: dict[str, list[Sample]], folders: list[Path]) -> None:
    """Print the depth noise, in pixels of disparity, for each range of disparity gradient.

    The noise at a pixel is the root mean square deviation of its neighbourhood from a fitted plane. The printed noise
    of rendered frames is a median over frames. The printed noise of real frames is a median over scenes.
    """
    print("\n| frames | " + " | ".join(f"{low}-{high}" for low, high in pairwise(CHANGES_PX)) + " |")
    print("|---" * len(CHANGES_PX) + "|")
    scenes: dict[str, list[list[float]]] = defaultdict(list)
    patterns = [pattern for some in REAL.values() for pattern in some]
    for entry in find_labelled_frames(folders) if folders else []:
        for pattern in patterns:
            if fnmatch(f"{entry.data_set}/{entry.name}", pattern):
                scenes[pattern].append(noise_by_slant(entry.read()))
    real = [np.ma.masked_invalid(some).mean(axis=0).filled(np.nan) for some in scenes.values()]
    table = {"real": real} if real else {}
    table |= {family: [np.array(noise_by_slant(s.frame)) for s in samples] for family, samples in rendered.items()}
    for name, rows in table.items():
        middle = np.nanmedian(np.where(np.isfinite(rows), rows, np.nan), axis=0)
        print(f"| {name} | {' | '.join(f'{value:.3f}' for value in middle)} |")


def noise_by_slant(frame: sp.Frame) -> list[float]:
    """Return the median depth noise, in pixels of disparity, for each range of disparity gradient.

    Only pixels at a depth of 0.4 to 2.5 m are used. A pixel is not used if depth is missing in the 7x7 pixels around
    it. The noise is NaN for ranges with fewer than 400 used pixels, and for frames without intrinsics.
    """
    planes = fit_local_planes(frame.depth)
    focal_px = frame.camera.fx if frame.camera else float("nan")
    there = planes.whole & (frame.depth > NEAR_M) & (frame.depth < FAR_M)
    noise_px = planes.residual[there] * focal_px * BASELINE_M
    change_px = np.hypot(planes.slope_x, planes.slope_y)[there] * focal_px * BASELINE_M
    bands = [noise_px[(low <= change_px) & (change_px < high)] for low, high in pairwise(CHANGES_PX)]
    return [float(np.median(band)) if band.size >= 400 else float("nan") for band in bands]


def print_recall(family: str, samples: list[Sample]) -> None:
    """Print two shares of the objects: objects of which a segment covers more than 70 %, and objects that have an IoU
    above 0.7 with a segment.

    Each row of the printed table is for one kind of object (family `table`) or for one scene (other families).
    """
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
