"""Recording.

Read the frames of a recording, a folder or a camera. Objects keep their ids from frame to frame while they are in view.
Print the ids, the number of unusable images, the frame rate and the latency. Write a picture of the last frame.

    python examples/07_recording.py [SOURCE] [--out FOLDER]

SOURCE: a folder, a ROS bag (recording.mcap), or `realsense:`. Default: the bundled scene, seen by a moving camera.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.frames.files import write_png

SCENE = Path(sp.__file__).parent / "demo_scene"


def write_scene(folder: Path, count: int = 5) -> None:
    """Write a folder of frames, in which the bundled scene moves by two pixels per frame."""
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    for k in range(count):
        color, depth = (np.roll(image, 2 * k, axis=1) for image in (frame.color, frame.depth))
        (folder / f"{k}").mkdir(parents=True)
        write_png(folder / f"{k}" / "rgb.png", color)
        write_png(folder / f"{k}" / "depth.png", np.round(depth * 1000).astype(np.uint16))
    (folder / "camera.json").write_text((SCENE / "camera.json").read_text())


def main() -> None:
    """Segment all frames of a source and print the ids of the objects."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", nargs="?", help="default: the bundled scene")
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()

    segmenter = sp.Segmenter(ids=True)
    with tempfile.TemporaryDirectory() as folder:
        if given.source is None:
            write_scene(Path(folder))
        with sp.open_source(given.source or folder, depth_scale=None if given.source else 0.001) as source:
            for frame in source:
                result = segmenter(frame)
                print(f"{frame.name}: objects {sorted(o.id for o in result)}")
                write_png(given.out / "06_last_frame.png", result.overlay())
            print(f"{source.report()}; {segmenter.pace}")


if __name__ == "__main__":
    main()
