"""Group predicted objects by their score, and print the share of correct objects in each group, as in docs/score.md.

    python -m spigolo.lab.studies.calibration [--preset OBJECTS]

A predicted object is correct if its IoU with a labelled object is above 0.7. The frames are from data sets in which
every object is labelled (osd-mosd, osd-full, hand-uoc). The ground truth marks some pixels as ignored (label 255). A
predicted object is not counted if more than half of its pixels are ignored. The script also prints the 95 % confidence
interval of each share (Wilson score interval).
"""

from __future__ import annotations

import argparse
import json
from itertools import pairwise

import numpy as np

import spigolo as sp
from spigolo.frames.files import read_labels
from spigolo.lab.evaluation import wilson_interval
from spigolo.lab.studies import FRAMES

SETS = ("osd-mosd", "osd-full", "hand-uoc")
EDGES = (0.0, 0.3, 0.5, 0.7, 0.85, 1.0)
IGNORE = 255


def best_iou(mask: np.ndarray, label: np.ndarray) -> float:
    """Return the maximum IoU between a predicted mask (H, W) and the labelled objects. Pixels with the label 255
    (ignored) do not count in the IoU.

    Return NaN if more than half of the pixels of the mask are ignored.
    """
    seen = mask & (label != IGNORE)
    if np.count_nonzero(seen) < 0.5 * np.count_nonzero(mask):
        return float("nan")
    ids = np.setdiff1d(label[seen], [0, IGNORE])
    return max(
        (np.count_nonzero(seen & (label == k)) / np.count_nonzero(seen | (label == k)) for k in ids), default=0.0
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", default="OBJECTS")
    config = sp.preset(parser.parse_args().preset)
    names = json.loads((FRAMES / "splits.json").read_text())["dev"]
    scores, right = [], []
    for folder in (FRAMES / name for name in sorted(names) if name.startswith(SETS)):
        label = read_labels(folder / "label.png")
        for o in sp.segment(sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json"), config):
            iou = best_iou(o.mask, label)
            if np.isfinite(iou):
                scores.append(o.score)
                right.append(iou > 0.7)
    score, hit = np.array(scores), np.array(right)
    print("| score | objects | mean score | correct (IoU > 0.7) | 95 % interval |\n|---|---|---|---|---|")
    for low, high in pairwise(EDGES):
        of = (score >= low) & ((score < high) | (high == 1.0))
        if of.any():
            hits, n = int(hit[of].sum()), int(of.sum())
            bottom, top = wilson_interval(hits, n)
            print(
                f"| {low:.2f} - {high:.2f} | {n} | {score[of].mean():.2f} | {hits / n:.0%} | {bottom:.0%} - {top:.0%} |"
            )
    worse = (score[hit][:, None] > score[~hit]).mean() + 0.5 * (score[hit][:, None] == score[~hit]).mean()
    print(
        f"\n{len(score)} objects, {hit.mean():.0%} correct. A correct object scores above a wrong object in"
        f" {worse:.0%} of the pairs"
    )


if __name__ == "__main__":
    main()
