"""Times each preset beside OpenCV's GraphSegmentation on the same frame, round by round.

    python scripts/time_presets.py [FOLDER ...]     folders with rgb.png, depth.png, camera.json; default: bundled scene

GraphSegmentation (colour alone, default parameters) runs in .venv-oracle, which `make test` builds. Both are timed in
CPU time of one thread; a round holds one run of each, ratios are medians over rounds.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from pathlib import Path

import cv2

import spigolo as sp

ROOT = Path(__file__).parents[1]
ORACLE = ROOT / ".venv-oracle" / "bin" / "python"
ROUNDS = 9
RIVAL = """
import sys, time, cv2
cv2.setNumThreads(1)
image = cv2.imread(sys.argv[1])
rival = cv2.ximgproc.segmentation.createGraphSegmentation()
rival.processImage(image)
for _ in sys.stdin:
    start = time.process_time()
    rival.processImage(image)
    print(1e3 * (time.process_time() - start), flush=True)
"""


def time_folder(folder: Path) -> None:
    frame = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
    rival = subprocess.Popen(
        [ORACLE, "-c", RIVAL, folder / "rgb.png"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert rival.stdin is not None
    assert rival.stdout is not None
    configs = {name: sp.PRESETS[name] for name in ("OBJECTS", "SHELF", "TABLE", "CLUTTER")}
    times: dict[str, list[float]] = {name: [] for name in (*configs, "GraphSegmentation")}
    for config in configs.values():
        sp.segment(frame, config)
    for _ in range(ROUNDS):
        print("go", file=rival.stdin, flush=True)
        times["GraphSegmentation"].append(float(rival.stdout.readline()))
        for name, config in configs.items():
            start = time.process_time()
            sp.segment(frame, config)
            times[name].append(1e3 * (time.process_time() - start))
    rival.stdin.close()
    rival.wait()
    print(f"\n{folder}  {frame.camera.width}x{frame.camera.height}, median of {ROUNDS} rounds, CPU time, one thread")
    for name, taken in times.items():
        ratio = statistics.median(r / t for r, t in zip(times["GraphSegmentation"], taken, strict=True))
        print(f"  {name:18s} {statistics.median(taken):7.1f} ms   GraphSegmentation takes {ratio:.2f} times that")


if __name__ == "__main__":
    cv2.setNumThreads(1)
    for given in sys.argv[1:] or [str(Path(sp.__file__).parent / "demo_scene")]:
        time_folder(Path(given))
