"""Do models drawn at the truth poses give the exact masks of rendered frames? `python scripts/measure_masks.py`.

In the depth that a perfect camera would have measured, of which a model may lie 2 mm behind: that tests poses and
models alone. There by BOP's rule of 15 mm as well, by which what has no label and stands close in front hides nothing.
And by that rule in the depth of the simulated camera, as readers of data sets do: there an occluder without depth hides
nothing.
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np

from spigolo.datasets.visibility import TOLERANCE_M, visible_labels
from spigolo.synthetic.families import FAMILIES, family_models, record_family
from spigolo.synthetic.staging import Recording

EXACT_M = 0.002
Counts = list[tuple[int, int]]
"""Pixels of intersection and union of each object."""


def main() -> None:
    parser = argparse.ArgumentParser(description="Masks drawn at the truth poses beside exact ones.")
    parser.add_argument("--count", type=int, default=12, help="frames a family")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    print("| family | depth | objects | IoU, pooled | least | at least 0.98 |\n|---|---|---|---|---|---|")
    for family in FAMILIES:
        counts: dict[str, Counts] = defaultdict(list)
        for number in range(arguments.count):
            for depth, some in overlaps(record_family(family, number, arguments.seed), family).items():
                counts[depth] += some
        for depth, some in counts.items():
            shared, union = np.array(some).T
            iou = shared / union
            least = f"{iou.min():.4f} | {np.mean(iou >= 0.98):.0%}"
            print(f"| {family} | {depth} | {len(iou)} | {shared.sum() / union.sum():.4f} | {least} |", flush=True)


def overlaps(recording: Recording, family: str) -> dict[str, Counts]:
    """By the depth that they are seen in and the tolerance."""
    sample = recording.sample
    assert sample.frame.camera is not None
    known = {model.name: model for model in family_models(family)}
    models = [known[instance.model] for instance in sample.instances]
    answer = {}
    seen = {
        "ideal, 2 mm": (recording.ideal_m, EXACT_M),
        "ideal, 15 mm": (recording.ideal_m, TOLERANCE_M),
        "measured, 15 mm": (sample.frame.depth, TOLERANCE_M),
    }
    for name, (depth, tolerance_m) in seen.items():
        drawn = visible_labels(sample.instances, models, depth, sample.frame.camera, tolerance_m)
        pairs = [(sample.labels == i.label, drawn == i.label) for i in sample.instances]
        answer[name] = [(int(np.sum(a & b)), int(np.sum(a | b))) for a, b in pairs]
    return answer


if __name__ == "__main__":
    main()
