"""Segments frames for a long while and watches memory and answers: `python -m spigolo.lab.studies.soak --frames 5000`.

One Segmenter for each preset sees the bundled scene, moved, darkened, with more holes and at half the size, in turn.
Whatever it saw before, each answer must be the one that a fresh run gives, and the process must not grow: else the exit
code is 1. Memory is read from /proc, so it asks for Linux.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import spigolo as sp

MIB = 2**20
SETTLED = 0.1
MAY_GROW_MIB = 16.0
"""Memory is compared from when a tenth of the frames were seen. A frame and its answer have 15 MiB."""


def variants() -> list[sp.Frame]:
    """The bundled scene in twelve ways, two of them of another size."""
    folder = Path(sp.__file__).parent / "demo_scene"
    seen = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
    assert seen.camera is not None
    rng, frames = np.random.default_rng(7), []
    for k in range(10):
        depth = np.roll(seen.depth, 17 * k, axis=1)
        depth[rng.random(depth.shape) < 0.06 * k] = 0
        frames.append(
            sp.Frame((np.roll(seen.color, 17 * k, axis=1) * (1 - 0.08 * k)).astype(np.uint8), depth, seen.camera)
        )
    c = seen.camera
    half = sp.Camera(c.fx / 2, c.fy / 2, c.cx / 2, c.cy / 2, c.width // 2, c.height // 2)
    frames.append(sp.Frame(seen.color[::2, ::2], seen.depth[::2, ::2], half))
    return [*frames, sp.Frame(seen.color, seen.depth, None)]


def resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MIB


def soak(config: sp.Config, frames: Sequence[sp.Frame], count: int) -> tuple[int, float, float, float]:
    """Answer that differ, MiB when settled and at the end, the longest time of a frame in seconds."""
    expected = [sp.segment(frame, config).labels for frame in frames]
    segmenter = sp.Segmenter(config)
    settled, worst, wrong = 0.0, 0.0, 0
    for n in range(count):
        start = time.perf_counter()
        labels = segmenter(frames[n % len(frames)]).labels
        worst = max(worst, time.perf_counter() - start)
        wrong += not np.array_equal(labels, expected[n % len(frames)])
        if n == round(SETTLED * count):
            settled = resident_mib()
    return wrong, settled, resident_mib(), worst


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=5000, help="how many for each preset")
    parser.add_argument("--presets", nargs="+", default=["OBJECTS", "TABLE", "SHELF"])
    given = parser.parse_args()
    warnings.simplefilter("ignore")  # the frame without a camera is meant
    failed = False
    print(
        "| preset | frames | other answers | MiB when settled | MiB at the end | longest ms |",
        "|---" * 6 + "|",
        sep="\n",
    )
    for name in given.presets:
        wrong, settled, end, worst = soak(sp.preset(name), variants(), given.frames)
        print(f"| `{name}` | {given.frames} | {wrong} | {settled:.0f} | {end:.0f} | {1e3 * worst:.0f} |", flush=True)
        failed |= wrong > 0 or end - settled > MAY_GROW_MIB
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
