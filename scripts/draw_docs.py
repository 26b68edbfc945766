"""Draw the pictures of the documentation: `python scripts/draw_docs.py [--out DIR] [NAME ...]`.

The pictures show the output of `spigolo demo`, and compare presets, additions, open choices of the paper and faults.
Most pictures show the bundled scene. Other pictures show scenes that MuJoCo renders (`pip install
"spigolo[synthetic]"`).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

import spigolo as sp
from pictures import additions, failures, paper
from pictures.layout import smaller
from spigolo.frames.files import write_bytes
from spigolo.frames.frame import Color
from spigolo.view.overlay import boundary_picture, depth_picture, draw_boxes, tile

SCENE = Path(sp.__file__).parent / "demo_scene"
IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
QUALITY = 88
MOST_BYTES = 200_000


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw the pictures of the docs.")
    names = [*BUNDLED, *RENDERED]
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all of {', '.join(names)}")
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder to write to")
    arguments = parser.parse_args()
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    for name in arguments.names or names:
        picture = RENDERED[name]() if name in RENDERED else BUNDLED[name](frame)
        write_jpeg(arguments.out / f"{name}.jpg", picture)


def demo(frame: sp.Frame) -> Color:
    """Draw the picture of `spigolo demo` at a smaller size."""
    run = sp.trace(frame)
    result = run.segmentation
    pictures = {
        "colour": frame.color,
        "depth (black: missing)": depth_picture(frame.depth),
        "boundaries of objects": boundary_picture(run),
        f"{len(result)} objects with their boxes": draw_boxes(result.overlay(), result, frame.camera),
    }
    picture = tile(pictures, columns=2)
    size = 1000, round(picture.shape[0] * 1000 / picture.shape[1])
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)


def presets(frame: sp.Frame) -> Color:
    """Draw the objects that each preset finds."""
    pictures = {"colour": frame.color}
    for name, config in (("OBJECTS", sp.OBJECTS), ("TABLE", sp.TABLE), ("CLUTTER", sp.CLUTTER), ("SHELF", sp.SHELF)):
        result = sp.segment(frame, config)
        pictures[f"{name}: {len(result)} objects"] = result.overlay()
    pictures["depth (black: missing)"] = depth_picture(frame.depth)
    return tile({title: smaller(picture) for title, picture in pictures.items()}, columns=3)


def write_jpeg(path: Path, picture: Color) -> None:
    """Write a picture as JPEG of at most `MOST_BYTES` bytes, and print its size."""
    done, data = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not done or data.size > MOST_BYTES:
        raise ValueError(f"{path.name} would have {data.size} bytes (maximum {MOST_BYTES})")
    write_bytes(path, data.tobytes())
    print(f"{path.name}: {picture.shape[1]}x{picture.shape[0]}, {data.size // 1000} kB")


BUNDLED: dict[str, Callable[[sp.Frame], Color]] = {
    "demo": demo,
    "presets": presets,
    "additions": additions.additions,
    "wrong-inputs": failures.wrong_inputs,
    "mean-of-windows": paper.mean_of_windows,
    "sign-of-step": paper.sign_of_step,
    "missing-samples": paper.missing_samples,
    "sign-rule": paper.sign_rule,
    "texture-edges": paper.texture_edges,
    "soft-boundary": paper.soft_boundary,
    "larger-end": paper.larger_end,
    "depth-contours": additions.depth_contours,
    "support-plane": additions.support_plane,
    "noise-floor": additions.noise_floor,
}
"""Functions that draw pictures of the bundled scene, indexed by file name."""
RENDERED: dict[str, Callable[[], Color]] = {
    "merging": additions.merging,
    "ledge": additions.ledge,
    "flats": additions.flats,
    "packing": additions.packing,
    "touching-objects": failures.touching_objects,
    "flat-objects": failures.flat_objects,
}
"""Functions that draw pictures of rendered scenes, indexed by file name."""

if __name__ == "__main__":
    main()
