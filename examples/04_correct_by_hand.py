"""Correct by hand.

Correct a segmentation by clicked pixels: the methods `keep`, `drop` and `merge` return a new, corrected segmentation.
The example uses the preset OBJECTS_1, because OBJECTS already joins the inside and the outside of a bowl.

    python examples/04_correct_by_hand.py [--out FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import spigolo as sp
from spigolo.frames.files import write_png
from spigolo.view.overlay import tile

SCENE = Path(sp.__file__).parent / "demo_scene"
BOWL, MUG = [(260, 170), (310, 183)], [(240, 428), (285, 420)]
"""Pixels (y, x) on the inside and on the outside of the bowl and of the mug."""
FLASHLIGHT, TABLE = (352, 360), (440, 150)


def main() -> None:
    """Find the object at a pixel, then merge, drop and keep regions of a segmentation."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()

    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    clicked = sp.segment_at(frame, FLASHLIGHT)  # finds only the object at one pixel
    print(f"at {FLASHLIGHT}: {clicked.area_px} px, {clicked.distance_m:.3f} m away")

    answer = first = sp.segment(frame, sp.PRESETS["OBJECTS_1"])
    for name, (inside, outside) in {"bowl": BOWL, "mug": MUG}.items():
        before = [answer.at(inside).area_px, answer.at(outside).area_px]
        answer = answer.merge(answer.at(inside), answer.at(outside))  # take regions from the same segmentation
        print(f"{name}: {before[0]} px and {before[1]} px are {answer.at(inside).area_px} px")

    answer = answer.drop(answer.at(FLASHLIGHT))
    print("flashlight:", answer.at(FLASHLIGHT).why)

    table = answer.at(TABLE)
    print("table:", table.why)
    kept = answer.keep(table)
    print(f"{len(first)} objects at first, {len(answer)} corrected, {len(kept)} with the table kept")

    pictures = {"as found": first, "corrected": answer, "table kept": kept}
    drawn = {title: result.overlay() for title, result in pictures.items()}
    write_png(given.out / "04_by_hand.png", tile(drawn, columns=3))


if __name__ == "__main__":
    main()
