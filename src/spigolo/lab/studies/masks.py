"""Compare masks computed from object models and poses with exact masks: `python -m spigolo.lab.studies.masks`.

All frames are rendered images. The renderer also gives the exact mask of each object. To compute the mask of an object,
the model of the object is rendered in its pose. The computed mask contains the pixels where the model is at most a
tolerance behind the surface in the depth map. The first test uses noise-free depth and a tolerance of 2 mm, to check
the poses and models. The second test uses the depth of the simulated camera and a tolerance of 15 mm, as in the BOP
benchmark and in `spigolo.lab.datasets`. The last column of the printed table counts the discarded scenes. A scene is
discarded if the IoU of a computed mask with its exact mask is below `LEAST_IOU`, or if no object is visible.
"""

from __future__ import annotations

import argparse

import numpy as np

from spigolo.lab.datasets.visibility import TOLERANCE_M
from spigolo.lab.synthetic.families import FAMILIES, LEAST_IOU, arrangements, drawn_iou, is_told_by_poses

EXACT_M = 0.002


def main() -> None:
    parser = argparse.ArgumentParser(description="Compare masks rendered from models and poses with exact masks.")
    parser.add_argument("--count", type=int, default=24, help="number of frames per family and seed")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1])
    given = parser.parse_args()
    print(f"| family | depth | objects | minimum IoU | median | at least {LEAST_IOU} | frames | discarded scenes |")
    print("|---|---|---|---|---|---|---|---|")
    for family in FAMILIES:
        ideal, measured, refused = [], [], 0
        for seed, number in ((seed, number) for seed in given.seeds for number in range(given.count)):
            for made in arrangements(family, number, seed):
                if is_told_by_poses(family, made.sample):
                    break
                refused += 1
            ideal += [*drawn_iou(family, made.sample, made.ideal_m, EXACT_M)]
            measured += [*drawn_iou(family, made.sample, made.sample.frame.depth, TOLERANCE_M)]
        for depth, ious in (("ideal, 2 mm", ideal), ("measured, 15 mm", measured)):
            figures = (
                f"{len(ious)} | {min(ious):.4f} | {np.median(ious):.4f} | {np.mean(np.array(ious) >= LEAST_IOU):.0%}"
            )
            frames = len(given.seeds) * given.count
            print(f"| {family} | {depth} | {figures} | {frames} | {refused} |", flush=True)


if __name__ == "__main__":
    main()
