"""How often the doctor finds what is wrong with a frame, and how often it complains about a good one.

Every frame is spoilt in each of the ways in SPOILT; near-identical frames count once. Depth and colour that are shifted
or mirrored are looked for in frames with enough depth steps: at least 500 contour pixels in an image of 640x480, in the
good frame.

    python -m spigolo.lab.studies.doctor [FOLDER]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from spigolo import Camera, Frame, read_frame
from spigolo.doctor import diagnose
from spigolo.doctor.alignment import MIN_CONTOUR_SHARE, count_contours, depth_contours
from spigolo.lab.studies import FRAMES


def with_depth(frame: Frame, depth: np.ndarray) -> Frame:
    return Frame(frame.color, np.ascontiguousarray(depth), frame.camera, name=frame.name)


def shift(frame: Frame, dx: int, dy: int) -> Frame:
    """Depth moved by (dx, dy) pixels; what comes in from outside is missing."""
    height, width = frame.depth.shape
    moved = np.zeros_like(frame.depth)
    moved[max(dy, 0) : height + min(dy, 0), max(dx, 0) : width + min(dx, 0)] = frame.depth[
        max(-dy, 0) : height + min(-dy, 0), max(-dx, 0) : width + min(-dx, 0)
    ]
    return with_depth(frame, moved)


def scale(frame: Frame, factor: float) -> Frame:
    return with_depth(frame, frame.depth * np.float32(factor))


def zoom(frame: Frame, factor: float) -> Frame:
    """A wrong focal length."""
    assert frame.camera is not None
    camera: Camera = replace(frame.camera, fx=frame.camera.fx * factor, fy=frame.camera.fy * factor)
    return Frame(frame.color, frame.depth, camera, name=frame.name)


SPOILT: dict[str, tuple[str, Callable[[Frame], Frame]]] = {
    "shift right 8 px": ("alignment", lambda f: shift(f, 8, 0)),
    "shift left 8 px": ("alignment", lambda f: shift(f, -8, 0)),
    "shift down 8 px": ("alignment", lambda f: shift(f, 0, 8)),
    "shift up 8 px": ("alignment", lambda f: shift(f, 0, -8)),
    "mirrored": ("alignment", lambda f: with_depth(f, f.depth[:, ::-1])),
    "depth x10": ("depth unit", lambda f: scale(f, 10)),
    "depth x1000": ("depth unit", lambda f: scale(f, 1000)),
    "depth x0.1": ("depth unit", lambda f: scale(f, 0.1)),
    "depth x0.001": ("depth unit", lambda f: scale(f, 0.001)),
    "focal length x0.5": ("focal length", lambda f: zoom(f, 0.5)),
    "focal length x0.7": ("focal length", lambda f: zoom(f, 0.7)),
    "focal length x1.5": ("focal length", lambda f: zoom(f, 1.5)),
    "focal length x2": ("focal length", lambda f: zoom(f, 2)),
}


def warned(frame: Frame) -> set[str]:
    return {finding.check for finding in diagnose(frame).warnings}


def has_steps(frame: Frame) -> bool:
    """Enough contours to judge alignment by."""
    return count_contours(depth_contours(frame.depth)) >= MIN_CONTOUR_SHARE * frame.depth.size


def distinct(folder: Path) -> list[str]:
    """Names of all frames, the first only of each group of near-identical ones."""
    splits = json.loads((folder / "splits.json").read_text())
    repeated = {name for group in splits["near_duplicate_groups"] for name in group[1:]}
    return [name for name in splits["dev"] + splits["unlabelled"] if name not in repeated]


def main() -> None:
    parser = argparse.ArgumentParser(description="How often the doctor is right about spoilt and about good frames.")
    parser.add_argument("folder", nargs="?", type=Path, default=FRAMES, help="with splits.json; default: %(default)s")
    folder = parser.parse_args().folder
    if not (folder / "splits.json").is_file():
        parser.error(f"expected splits.json in {folder}; SPIGOLO_DATA names the data folder")
    measure(folder)


def measure(folder: Path) -> None:
    """Prints what is found and what is complained about without cause; what is missed goes to stderr."""
    found: dict[str, list[bool]] = {kind: [] for kind in SPOILT}
    false: dict[str, list[str]] = {}
    seconds = []
    names = distinct(folder)
    for name in names:
        frame = read_frame(folder / name / "rgb.png", folder / name / "depth.png", folder / name / "camera.json")
        start = time.perf_counter()
        for finding in diagnose(frame).findings:
            hits = false.setdefault(finding.check, [])
            if finding.severity.value == "warning":
                hits.append(name)
        seconds.append(time.perf_counter() - start)
        steps = has_steps(frame)
        for kind, (check, spoil) in SPOILT.items():
            if steps or check != "alignment":
                hit = check in warned(spoil(frame))
                found[kind].append(hit)
                if not hit:
                    print(f"missed: {kind} in {name}", file=sys.stderr)
    print(f"{'spoilt':20s} frames  found")
    for kind, caught in found.items():
        print(f"{kind:20s} {len(caught):6d}  {np.mean(caught):5.1%}")
    print(f"\n{'check':20s} false alarms on {len(names)} good frames")
    for check, where in false.items():
        print(f"{check:20s} {len(where) / len(names):5.1%}  {' '.join(where)}")
    print(f"\ndiagnose: median {np.median(seconds):.2f} s, slowest {max(seconds):.2f} s")


if __name__ == "__main__":
    main()
