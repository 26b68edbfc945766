"""Do models drawn at the truth poses give the exact masks of rendered frames? `python scripts/measure_masks.py`.

By BOP's rule, with the depth that a perfect camera would have measured, which tests poses and models alone; and with
that of the simulated camera, as the readers of data sets do: there an occluder without depth hides nothing.
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np

from spigolo.datasets.visibility import visible_labels
from spigolo.synthetic.families import FAMILIES, family_models, record_family
from spigolo.synthetic.staging import Recording

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
    """By the depth that they are seen in."""
    sample = recording.sample
    assert sample.frame.camera is not None
    known = {model.name: model for model in family_models(family)}
    models = [known[instance.model] for instance in sample.instances]
    answer = {}
    for name, depth in (("ideal", recording.ideal_m), ("measured", sample.frame.depth)):
        drawn = visible_labels(sample.instances, models, depth, sample.frame.camera)
        pairs = [(sample.labels == i.label, drawn == i.label) for i in sample.instances]
        answer[name] = [(int(np.sum(a & b)), int(np.sum(a | b))) for a, b in pairs]
    return answer


if __name__ == "__main__":
    main()
