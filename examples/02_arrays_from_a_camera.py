"""Arrays from a camera.

Create frames from arrays of a camera driver: depth as integers in millimetres or as floats in metres, and intrinsics in
several forms. Register a depth map to the colour image if it was recorded by a separate depth camera.

    python examples/02_arrays_from_a_camera.py [--out FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.frames.files import write_png
from spigolo.view.overlay import depth_picture, tile

SCENE = Path(sp.__file__).parent / "demo_scene"


def main() -> None:
    """Segment arrays in several forms, and register a depth map to the colour image."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()

    scene = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    color = scene.color  # (H, W, 3) uint8, RGB. Convert a BGR image of OpenCV with [..., ::-1]
    millimetres = np.round(scene.depth * 1000).astype(np.uint16)  # 0 = missing
    metres = np.where(scene.depth > 0, scene.depth, np.nan)  # NaN = missing

    forms = {
        "millimetres, K": (millimetres, 0.001, [[525, 0, 319.5], [0, 525, 239.5], [0, 0, 1]]),
        "NaN, (fx, fy, cx, cy)": (metres, None, (525.0, 525.0, 319.5, 239.5)),
        "NaN, field of view": (metres, None, sp.Camera.from_fov(640, 480, horizontal_deg=62.7)),
        "NaN, nominal camera": (metres, None, "kinect-v1"),
        "NaN, no camera": (metres, None, None),
    }
    for name, (depth, scale, camera) in forms.items():
        result = sp.segment(sp.Frame(color, depth, camera, depth_scale=scale))
        print(f"{name:22s} {len(result):2d} objects; left out: {', '.join(result.left_out) or 'nothing'}")

    # Simulate the depth map of a separate depth camera, 25 mm to the left of the colour camera.
    depth_camera = sp.Camera(fx=475.0, fy=475.0, cx=319.5, cy=239.5, width=640, height=480)
    T_color_depth = np.eye(4)
    T_color_depth[0, 3] = -0.025
    unregistered = sp.register_depth(scene.depth, scene.camera, depth_camera, np.linalg.inv(T_color_depth))
    moved = sp.register_depth(unregistered, depth_camera, scene.camera, T_color_depth)
    both = (moved > 0) & (scene.depth > 0)
    off_mm = np.median(np.abs(moved - scene.depth)[both]) * 1000
    result = sp.segment(sp.Frame(color, moved, scene.camera))
    print(f"moved there and back: {off_mm:.1f} mm off, {(moved > 0).mean():.0%} with depth, {len(result)} objects")
    pictures = {"its own image": depth_picture(unregistered), "moved to colour": depth_picture(moved)}
    write_png(given.out / "02_registered.png", tile(pictures, columns=2))


if __name__ == "__main__":
    main()
