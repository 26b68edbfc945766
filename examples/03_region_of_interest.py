"""Region of interest.

Find objects only in a region of interest: a box in the image, a box in the robot's base frame, or a mask of any shape.
Regions outside the region of interest are rejected with the reason `OUTSIDE`.

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

# Pose of the camera of the bundled scene in the robot's base frame (x right, y away, z up, table at z = 0).
# The camera is 0.57 m above the table and looks down by 40 degrees.
S, C = np.sin(np.radians(40)), np.cos(np.radians(40))
T_BASE_CAMERA = np.array(
    [[1, 0, 0, -0.005], [0, -S, C, 0.03 - 0.81 * C], [0, -C, -S, 0.05 + 0.81 * S], [0, 0, 0, 1]]
)  # columns: X, Y, Z axes and position of the camera


def main() -> None:
    """Segment one frame without and with three regions of interest."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()

    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    y, x = np.mgrid[: frame.shape[0], : frame.shape[1]]
    regions = {
        "everywhere": None,
        "pixel box (y0, x0, y1, x1)": (220, 80, 420, 600),
        # box above the rear left part of the table
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
