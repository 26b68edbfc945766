"""Group predicted objects by their score, and print the share of correct objects in each group, as in docs/score.md.

    python -m spigolo.lab.studies.calibration [--preset OBJECTS] [--sets PATTERN ...]

A predicted object is correct if its IoU with a labelled object is above 0.7. Only frames in which every object is
labelled are used. The ground truth marks some pixels as ignored. A predicted object is not counted if more than half of
its pixels are ignored. The script also prints the 95 % confidence interval of each share (Wilson score interval).
"""

from __future__ import annotations

import argparse
import warnings
from fnmatch import fnmatch
from itertools import pairwise

import numpy as np

import spigolo as sp
from spigolo.lab.datasets import FULL_SETS, Truth
from spigolo.lab.evaluation import wilson_interval
from spigolo.lab.experiments import find_labelled_frames
from spigolo.lab.studies import FRAMES
from spigolo.lab.studies.objects_preset import LITTLE_WORTH

EDGES = (0.0, 0.3, 0.5, 0.7, 0.85, 1.0)


def best_iou(mask: np.ndarray, truth: Truth) -> float:
    """Return the maximum IoU between a predicted mask (H, W) and the labelled objects. Ignored pixels do not count in
    the IoU.

    Return NaN if more than half of the pixels of the mask are ignored.
    """
    seen, label = mask & ~truth.ignore, np.where(truth.ignore, 0, truth.labels)
    if np.count_nonzero(seen) < 0.5 * np.count_nonzero(mask):
        return float("nan")
    ids = np.setdiff1d(label[seen], [0])
    return max(
        (np.count_nonzero(seen & (label == k)) / np.count_nonzero(seen | (label == k)) for k in ids), default=0.0
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", default="OBJECTS")
    parser.add_argument("--sets", nargs="+", default=FULL_SETS, help="name patterns of data sets")
    given = parser.parse_args()
    config = sp.preset(given.preset)
    warnings.simplefilter("ignore", UserWarning)
    scores, right = [], []
    for entry in find_labelled_frames([FRAMES]):
        asked = any(fnmatch(entry.data_set, pattern) for pattern in given.sets)
        if not asked or entry.labelling != "full" or entry.name in LITTLE_WORTH:
            continue
        frame, truth = entry.read_both()
        assert truth is not None
        for o in sp.segment(frame, config):
            iou = best_iou(o.mask, truth)
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
