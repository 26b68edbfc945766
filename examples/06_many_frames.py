"""Many frames.

Segment many frames in two processes, and read the objects of all frames from one COCO file. If a run was stopped, a
repetition of the call continues the run, and produces the files of an uninterrupted run.

    python examples/06_many_frames.py [--out FOLDER]
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from pathlib import Path

import spigolo as sp
from spigolo.batch import FrameFiles, local, run_batch
from spigolo.frames.files import write_png

SCENE = Path(sp.__file__).parent / "demo_scene"
MOST = 5  # maximum number of frames that are printed


def main() -> None:
    """Segment frames in two processes, twice. The second run keeps all results of the first run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    out = parser.parse_args().out

    files = SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json"
    jobs = [FrameFiles(f"morning/{k:04d}", *files) for k in range(3)]  # / in a frame name creates a folder
    jobs.append(FrameFiles("lost", SCENE / "no-such.png", *files[1:]))  # this frame fails, but the run continues

    for _ in range(2):
        summary = run_batch(jobs, sp.OBJECTS, out / "06_batch", local(workers=2), table="coco")
        state = summary.progress
        print(f"{state.computed} computed, {state.kept} kept from an earlier run, {state.failed} failed")
    for name, reason in summary.failures:
        print(f"{name}: {reason.partition(':')[2].strip()}")

    coco = json.loads(summary.table.read_text(encoding="utf-8"))
    count = Counter(annotation["image_id"] for annotation in coco["annotations"])
    for image in coco["images"][:MOST]:
        print(f"{image['file_name']}: {count[image['id']]} objects")

    write_png(out / "06_first.png", sp.segment(jobs[0].read()).overlay())
    print(f"written to {out}")


if __name__ == "__main__":
    main()
