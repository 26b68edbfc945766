"""Count the reasons why labelled objects are not found: `python -m spigolo.lab.studies.losses FOLDER PRESET`.

The script divides the labelled objects into four classes. The class "covered" contains objects of which a predicted
object covers more than 70 %. The class "split" contains objects of which no region covers more than 70 %. For objects
of the two other classes, a region covers more than 70 % of the object, but no predicted object covers that much. In the
class "joined with its surroundings", the area of the region is at least three times the area of the object. In the
class "rejected otherwise", the area of the region is less than three times the area of the object.

The script also prints the share of labelled objects with more than 30 % missing depth. The script also prints the share
of labelled objects whose exact ground-truth mask would be rejected by a rule of the preset. With `--gammas`, the script
also segments every second frame with each given value of `partition.gamma`. For each value of `partition.gamma`, it
prints the share of labelled objects for which a region has an IoU above 0.7.
"""

from __future__ import annotations

import argparse
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
import numpy.typing as npt

import spigolo as sp
from spigolo.lab.datasets import guess
from spigolo.lab.synthetic.household import kind_of
from spigolo.objects.selection import select_objects
from spigolo.stages.regions import Regions

Labels = npt.NDArray[np.int32]

COVERED, JOINED, SPLIT, REJECTED = "covered", "joined with its surroundings", "split", "rejected otherwise"
LARGER = 3.0
"""Minimum area of a region divided by the area of the labelled object, for the class "joined with its surroundings"."""


def main() -> None:
    parser = argparse.ArgumentParser(description="Count why labelled objects are not found with a preset.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("preset", choices=list(sp.PRESETS))
    parser.add_argument("--gammas", type=float, nargs="*", default=[], help="values of partition.gamma to try")
    arguments = parser.parse_args()
    config = sp.PRESETS[arguments.preset]
    fates: dict[str, Counter[str]] = defaultdict(Counter)
    reasons: Counter[str] = Counter()
    shares, missing, broken = [], [], []
    found: dict[float, list[bool]] = defaultdict(list)
    for number, entry in enumerate(guess(arguments.folder)):
        frame, truth = entry.read_both()
        assert truth is not None
        trace = sp.trace(frame, config)
        why = {region.region: str(region.reason.value) for region in trace.segmentation.rejected}
        for label in np.unique(truth.labels[truth.labels > 0]):
            mask = truth.labels == label
            kind = kind_of(truth.names[int(label)]) if int(label) in truth.names else "object"
            fate, region = judge(mask, trace.segmentation.labels, trace.regions.labels)
            fates[kind][fate] += 1
            if fate in (JOINED, REJECTED):
                reasons[f"{fate}: {why.get(region, 'returned')}"] += 1
                shares.append(float(np.mean(trace.regions.labels == region)))
            missing.append(float(np.mean(frame.depth[mask] == 0)))
            broken.append(breaks_a_rule(mask, trace))
        for gamma in arguments.gammas if number % 2 == 0 else ():
            regions = sp.trace(frame, config.replace(**{"partition.gamma": gamma})).regions.labels
            found[gamma] += [best_iou(truth.labels == k, regions) > 0.7 for k in np.unique(truth.labels) if k]
    print_fates(fates)
    print("reasons:", ", ".join(f"{what} {count}" for what, count in reasons.most_common()))
    print(f"median area of regions on joined or rejected objects: {np.median(shares or [0]):.2f} of the image")
    print(f"exact masks: {np.mean(np.array(missing) > 0.3):.0%} have more than 30 % missing depth,", end=" ")
    print(f"{np.mean(broken):.0%} violate a rule of {config.name}")
    for gamma, hits in found.items():
        print(f"gamma {gamma:g}: {np.mean(hits):.0%} of {len(hits)} objects have a region of IoU above 0.7")


def judge(mask: npt.NDArray[np.bool_], labels: Labels, regions: Labels) -> tuple[str, int]:
    """Return the class of a labelled object, and the number of the region that covers the largest part of the object.

    mask: ground-truth mask (H, W) of the object.
    """
    area = mask.sum()
    returned = np.bincount(labels[mask])[1:]
    counts = np.bincount(regions[mask])
    region = int(counts.argmax())
    if returned.size and returned.max() > 0.7 * area:
        return COVERED, region
    if counts.max() <= 0.7 * area:
        return SPLIT, region
    return (JOINED if np.sum(regions == region) >= LARGER * area else REJECTED), region


def best_iou(mask: npt.NDArray[np.bool_], regions: Labels) -> float:
    """Compute the IoU of a mask (H, W) with each region, and return the maximum."""
    inside = np.bincount(regions[mask], minlength=regions.max() + 1)
    return float(np.max(inside / (mask.sum() + np.bincount(regions.ravel()) - inside)))


def breaks_a_rule(mask: npt.NDArray[np.bool_], trace: sp.Trace) -> bool:
    """Return True if the preset would reject a region that consists of the pixels of a ground-truth mask (H, W)."""
    judged = select_objects(Regions(mask.astype(np.int32), 2), trace.segmentation.scene)
    return any(region.region == 1 for region in judged.rejected)


def print_fates(fates: dict[str, Counter[str]]) -> None:
    columns = (COVERED, JOINED, SPLIT, REJECTED)
    print("| kind | objects | " + " | ".join(columns) + " |\n|---|---|---|---|---|---|")
    total: Counter[str] = sum(fates.values(), Counter())
    for kind, counts in [*sorted(fates.items()), ("all", total)]:
        shares = " | ".join(f"{counts[column] / counts.total():.0%}" for column in columns)
        print(f"| {kind} | {counts.total()} | {shares} |")


if __name__ == "__main__":
    main()
