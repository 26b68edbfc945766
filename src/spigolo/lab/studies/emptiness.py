"""Count false objects in rendered scenes without objects. After that, add one box to each rendered scene, and count the
boxes that are found.

By default, the script renders the fifty scenes on which the rules of the presets were developed. With `--first 500`,
the script renders fifty held-out scenes instead.
"""

from __future__ import annotations

import argparse
from collections import Counter

import numpy as np

import spigolo as sp
from spigolo.lab.synthetic.empty_scenes import FAMILIES, empty_scene, scene_with_a_box

PRESETS = ("OBJECTS_1", "OBJECTS", "TABLE")
PLACES = [(family, seed) for seed in range(17) for family in FAMILIES][:50]


def finds(frame: sp.Frame, box: np.ndarray, config: sp.Config) -> bool:
    """Segment a frame. Return True if a predicted object has an IoU above 0.7 with the mask `box`."""
    masks = [o.mask for o in sp.segment(frame, config)]
    return max((np.sum(m & box) / np.sum(m | box) for m in masks), default=0.0) > 0.7


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0, help="random seed of the first scene of each family")
    first = parser.parse_args().first
    false, found, boxes = Counter[str](), Counter[str](), Counter[str]()
    for k, (family, seed) in enumerate(PLACES, start=1):
        empty, (frame, box) = empty_scene(family, first + seed), scene_with_a_box(family, first + seed)
        boxes[family] += 1
        for name in PRESETS:
            false[f"{name} {family}"] += len(sp.segment(empty, sp.PRESETS[name]))
            found[f"{name} {family}"] += finds(frame, box, sp.PRESETS[name])
        print(f"{k}/{len(PLACES)}", end="\r", flush=True)
    print("| | false objects on empty tables / bins / shelves | boxes found |")
    print("|---|---|---|")
    for name in PRESETS:
        counts = " / ".join(str(false[f"{name} {family}"]) for family in FAMILIES)
        shares = " / ".join(f"{found[f'{name} {family}']} of {boxes[family]}" for family in FAMILIES)
        print(f"| `{name}` | {counts} | {shares} |")


if __name__ == "__main__":
    main()
