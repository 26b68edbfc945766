"""Region of interest.

Objects are wanted in one place only: a box in the image, a box in the robot's space, or a mask of any shape.
What lies outside is not forgotten but rejected, with that reason.

    python examples/03_region_of_interest.py [--out FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.frames.files import write_png
from spigolo.view.overlay import tile

SCENE = Path(sp.__file__).parent / "demo_scene"

# Where the camera of the bundled scene is in the robot's base frame (x right, y away, z up, table at z = 0):
# 0.57 m above the table, looking down by 40 degrees.
S, C = np.sin(np.radians(40)), np.cos(np.radians(40))
T_BASE_CAMERA = np.array(
    [[1, 0, 0, -0.005], [0, -S, C, 0.03 - 0.81 * C], [0, -C, -S, 0.05 + 0.81 * S], [0, 0, 0, 1]]
)  # columns: the camera's X, Y, Z axes and its place


def main() -> None:
    """Segments one frame with four regions of interest."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()

    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    y, x = np.mgrid[: frame.shape[0], : frame.shape[1]]
    regions = {
        "everywhere": None,
        "pixel box (y0, x0, y1, x1)": (220, 80, 420, 600),
        # back left, above the table
        "robot's box": sp.MetricBox((-0.45, 0.05, 0.01), (0.10, 0.4, 0.40), T_BASE_CAMERA),
        "mask": (y - 290) ** 2 + (x - 470) ** 2 < 130**2,
    }
    pictures = {}
    for name, roi in regions.items():
        result = sp.segment(frame, roi=roi)
        outside = sum(r.reason is sp.Reason.OUTSIDE for r in result.rejected)
        print(f"{name:28s} {len(result):2d} objects, {outside:2d} regions outside")
        pictures[name] = result.overlay()
    write_png(given.out / "03_region_of_interest.png", tile(pictures, columns=2))


if __name__ == "__main__":
    main()
