"""Render the bundled demo scene: ``MUJOCO_GL=egl python scripts/render_demo.py [--out DIR]``."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

import cv2
import numpy as np

from spigolo.lab.synthetic.demo_scene import CAMERA, make_demo_frame

DEPTH_SCALE_M = 0.001
DEMO_SCENE = Path(__file__).resolve().parents[1] / "src" / "spigolo" / "demo_scene"


def main() -> None:
    """Render the scene and write rgb.png, depth.png, label.png and camera.json."""
    parser = argparse.ArgumentParser(description="Render the bundled demo scene with MuJoCo.")
    parser.add_argument("--out", type=Path, default=DEMO_SCENE, help="folder to write to (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sensor noise (default: %(default)s)")
    arguments = parser.parse_args()

    frame = make_demo_frame(arguments.seed)
    depth_units = np.round(frame.depth_m / DEPTH_SCALE_M).astype(np.uint16)
    arguments.out.mkdir(parents=True, exist_ok=True)
    packing = [cv2.IMWRITE_PNG_COMPRESSION, 9, cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_FILTERED]
    images = {"rgb.png": frame.rgb[..., ::-1], "depth.png": depth_units, "label.png": frame.label}
    for name, image in images.items():
        if not cv2.imwrite(str(arguments.out / name), image, packing):
            raise OSError(f"could not write {arguments.out / name}")
    # the rendered camera has no distortion
    camera = {key: value for key, value in asdict(CAMERA).items() if key != "distortion"}
    camera["depth_scale"] = DEPTH_SCALE_M
    (arguments.out / "camera.json").write_text(json.dumps(camera, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
