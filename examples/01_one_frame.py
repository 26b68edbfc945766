"""One frame.

Read a colour image, a depth image and a camera file. Find the objects, and print the position and size of each object.
Write a picture of the objects to `01_objects.png`, and the points of the best object to `01_points.npz`.

    python examples/01_one_frame.py [rgb.png depth.png camera.json] [--out FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.frames.files import write_png

SCENE = Path(sp.__file__).parent / "demo_scene"


def main() -> None:
    """Find the objects of a frame and print their positions and sizes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=[SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json"])
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()
    if len(given.files) != 3:
        parser.error("expected a colour image, a depth image and a camera file")

    frame = sp.read_frame(*given.files)
    result = sp.segment(frame)

    print(f"{frame.name}: {len(result)} objects, {len(result.rejected)} regions are none")
    for o in result:
        x, y, z = o.centroid_m
        print(f"{o.label:3d}  score {o.score:.2f}  at x {x:+.3f}  y {y:+.3f}  z {z:.3f} m  {o.area_px:6d} px", end="")
        box = o.oriented_box()
        print("" if box is None else "  box " + " x ".join(f"{side:.2f}" for side in box.size_m) + " m")

    write_png(given.out / "01_objects.png", result.overlay())
    if len(result):
        best = result[0]  # objects are sorted by score, best first
        np.savez_compressed(given.out / "01_points.npz", points_m=best.points_m(), mask=best.mask)
    print(f"written to {given.out}")


if __name__ == "__main__":
    main()
