"""Segment many frames in one process and check memory, time and results: `python -m spigolo.lab.studies.soak`.

A thousand different scenes are segmented twenty times each. Consecutive scenes are segmented with different presets.
The exit code is 1 if memory use varies by more than 5 MiB during the last three quarters of the frames. The exit code
is also 1 if the last thousand frames take more than 5 % longer than the first thousand. The exit code is also 1 if two
results for the same scene differ. The exit code is also 1 if a result differs from the result of `spigolo.segment`,
which is tested for every 50th frame. The test requires Linux, because memory is read from /proc.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

import spigolo as sp

MIB = 2**20
SCENES = 1000
"""Number of different scenes.

The last thousand frames show the same scenes as the first thousand frames, so that their CPU times are comparable.
"""
SETTLED = 0.25
"""Share of the frames that count as warm-up, 0..1. After the warm-up, memory use may vary by at most `MAY_GROW_MIB`."""
MAY_GROW_MIB = 5.0
MAY_SLOW = 1.05
"""Maximum CPU time of the last thousand frames, divided by the CPU time of the first thousand frames.

The maximum ratio is above 1, because CPU times vary by a few per cent on a busy machine.
"""
EVERY = 50
"""Step between the frames whose results are compared with the result of `spigolo.segment` (50 = every 50th frame)."""
WIDTHS_PX = 96, 200


@dataclass(frozen=True, slots=True)
class Soak:
    """Results of the long-run test."""

    frames: int
    other_answers: int
    """Number of results that differ from the result of `spigolo.segment`, or from an earlier result for the same scene.
    """
    settled_mib: float
    """Resident memory of the process after the first quarter of the frames, MiB."""
    range_mib: float
    """Difference between maximum and minimum resident memory after the first quarter of the frames, MiB."""
    slower: float
    """CPU time of a scene in the last thousand frames divided by its CPU time in the first thousand frames. The value
    is a median over all scenes.
    """
    first_ms: float
    """Median CPU time per frame in the first thousand frames, in milliseconds."""

    @property
    def failed(self) -> bool:
        """Return True if the test failed: a result differs, or memory range or CPU time exceeds its limit."""
        return self.other_answers > 0 or self.range_mib > MAY_GROW_MIB or self.slower > MAY_SLOW


class Scenes:
    """Random variations of the bundled scene: cropped, scaled and darkened, with added boxes and missing depth."""

    def __init__(self) -> None:
        folder = Path(sp.__file__).parent / "demo_scene"
        self.seen = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")

    def __call__(self, number: int) -> sp.Frame:
        """Create the frame with index `number`. The same `number` always gives the same frame."""
        rng = np.random.default_rng(number)
        height, width = self.seen.depth.shape
        share = rng.uniform(0.6, 1)
        rows, columns = round(share * height), round(share * width)
        y, x = rng.integers(0, height - rows + 1), rng.integers(0, width - columns + 1)
        size = int(rng.integers(*WIDTHS_PX)), int(rng.integers(WIDTHS_PX[0] * 3 // 4, WIDTHS_PX[1] * 3 // 4))
        color = cv2.resize(self.seen.color[y : y + rows, x : x + columns], size, interpolation=cv2.INTER_AREA)
        depth = cv2.resize(self.seen.depth[y : y + rows, x : x + columns], size, interpolation=cv2.INTER_NEAREST)
        for _ in range(rng.integers(0, 4)):
            top, left = rng.integers(0, size[1] - 20), rng.integers(0, size[0] - 20)
            box = slice(top, top + rng.integers(8, 40)), slice(left, left + rng.integers(8, 40))
            color[box] = rng.integers(0, 255, 3)
            depth[box] = rng.uniform(0.6, 1.0)
        depth[rng.random(depth.shape) < rng.uniform(0, 0.3)] = 0
        scale = size[0] / columns
        assert self.seen.camera is not None
        fx = self.seen.camera.fx * scale
        camera = sp.Camera(fx=fx, fy=fx, cx=size[0] / 2, cy=size[1] / 2, width=size[0], height=size[1])
        return sp.Frame((color * rng.uniform(0.4, 1)).astype(np.uint8), depth, camera)


def resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MIB


def soak(configs: Sequence[sp.Config], count: int) -> Soak:
    scenes, segmenters = Scenes(), [sp.Segmenter(config) for config in configs]
    answers: dict[int, bytes] = {}
    times = np.full((2, SCENES), np.nan)
    memory: list[float] = []
    wrong = 0
    for n in range(count):
        k = n % SCENES
        frame, which = scenes(k), k % len(configs)
        start = time.process_time()
        labels = segmenters[which](frame).labels
        took = time.process_time() - start
        answer = hashlib.sha256(labels.tobytes()).digest()
        same = answers.setdefault(k, answer) == answer
        if n % EVERY == 0:
            same &= np.array_equal(labels, sp.segment(frame, configs[which]).labels)
        wrong += not same
        if n < SCENES:
            times[0, k] = took
        if n >= count - SCENES:
            times[1, k] = took
        if n >= SETTLED * count:
            memory.append(resident_mib())
    slower = float(np.nanmedian(times[1] / times[0]))
    return Soak(count, wrong, memory[0], max(memory) - min(memory), slower, 1e3 * float(np.nanmedian(times[0])))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=20_000, help="number of frames to segment, at least 2000")
    parser.add_argument("--presets", nargs="+", default=["OBJECTS", "TABLE", "SHELF"])
    given = parser.parse_args()
    if given.frames < 2 * SCENES:
        parser.error(
            f"expected at least {2 * SCENES} frames, got {given.frames}: the first and last {SCENES} are compared"
        )
    cv2.setNumThreads(1)
    configs = [sp.preset(name) for name in given.presets]
    for config in configs:  # compile before time is measured
        sp.segment(Scenes()(0), config)
    found = soak(configs, given.frames)
    print(
        "| presets | frames | different results | MiB after warm-up | MiB range | median ms | last / first thousand |",
        "|---" * 7 + "|",
        f"| {', '.join(given.presets)} | {found.frames} | {found.other_answers} | {found.settled_mib:.1f}"
        f" | {found.range_mib:.2f} | {found.first_ms:.1f} | {found.slower:.3f} |",
        sep="\n",
    )
    return int(found.failed)


if __name__ == "__main__":
    sys.exit(main())
