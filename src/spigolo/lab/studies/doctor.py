"""Measure how often `spigolo doctor` detects simulated errors in frames, and how often it warns about correct frames.

For each simulated error, the table `SPOILT` names the check of `spigolo doctor` that must detect the error. Each
simulated error is applied to every frame. Only one frame of each group of near-identical frames is used. Shifted,
mirrored or unregistered depth is tested only on frames with enough depth steps. For example, a frame of 640x480 must
have at least 500 pixels on depth steps.

    python -m spigolo.lab.studies.doctor [FOLDER]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from spigolo import Camera, Frame, read_frame, register_depth
from spigolo.doctor import Finding, Severity, diagnose
from spigolo.doctor.alignment import MIN_CONTOUR_SHARE, check_alignment, count_contours, depth_contours
from spigolo.doctor.intrinsics import check_focal_length
from spigolo.doctor.measured import check_reach, check_unit
from spigolo.doctor.planarity import check_planarity
from spigolo.doctor.steps import check_steps
from spigolo.errors import UnitWarning
from spigolo.frames.listing import listed
from spigolo.lab.studies import FRAMES
from spigolo.settings.paper import Inpainting
from spigolo.stages.depth import inpaint_small_gaps


def with_depth(frame: Frame, depth: np.ndarray) -> Frame:
    return Frame(frame.color, np.ascontiguousarray(depth), frame.camera, name=frame.name)


def shift(frame: Frame, dx: int, dy: int) -> Frame:
    """Shift the depth map by (dx, dy) pixels. Pixels at the image border that the shifted depth map does not cover have
    missing depth.
    """
    height, width = frame.depth.shape
    moved = np.zeros_like(frame.depth)
    moved[max(dy, 0) : height + min(dy, 0), max(dx, 0) : width + min(dx, 0)] = frame.depth[
        max(-dy, 0) : height + min(-dy, 0), max(-dx, 0) : width + min(-dx, 0)
    ]
    return with_depth(frame, moved)


def scale(frame: Frame, factor: float) -> Frame:
    return with_depth(frame, frame.depth * np.float32(factor))


def zoom(frame: Frame, factor: float) -> Frame:
    """Multiply the focal length of the frame's camera by a factor, to simulate wrong intrinsics."""
    assert frame.camera is not None
    camera: Camera = replace(frame.camera, fx=frame.camera.fx * factor, fy=frame.camera.fy * factor)
    return Frame(frame.color, frame.depth, camera, name=frame.name)


def whole_pixels(frame: Frame) -> Frame:
    """Simulate the depth of a stereo camera with 50 mm baseline that measures disparity in whole pixels.

    The simulated depth is rounded to millimetres.
    """
    assert frame.camera is not None
    focal, baseline_m = frame.camera.fx, 0.05
    disparity = np.rint(focal * baseline_m / np.where(frame.depth > 0, frame.depth, np.inf))
    metres = focal * baseline_m / np.where(disparity > 0, disparity, np.inf)
    return with_depth(frame, (np.rint(1000 * metres) / 1000).astype(np.float32))


def along_rays(frame: Frame) -> Frame:
    """Replace the Z coordinates in the depth map by distances along the ray, rounded to millimetres."""
    assert frame.camera is not None
    y, x = np.ogrid[: frame.shape[0], : frame.shape[1]]
    slopes = ((x - frame.camera.cx) / frame.camera.fx) ** 2 + ((y - frame.camera.cy) / frame.camera.fy) ** 2
    return with_depth(frame, (np.rint(1000 * frame.depth * np.sqrt(1 + slopes)) / 1000).astype(np.float32))


def not_registered(frame: Frame) -> Frame:
    """Simulate a depth map of a RealSense D435 that is not registered to the colour image. The depth camera of the D435
    is 15 mm from its colour camera.
    """
    camera = frame.camera
    assert camera is not None
    ratio = 384 / 615 if camera.width * 3 < camera.height * 5 else 640 / 922.5
    middle = (camera.width - 1) / 2, (camera.height - 1) / 2
    depth_camera = Camera(camera.fx * ratio, camera.fy * ratio, *middle, camera.width, camera.height)
    T = np.eye(4)
    T[0, 3] = 0.015
    return with_depth(frame, register_depth(frame.depth, camera, depth_camera, T))


def sentinel(frame: Frame) -> Frame:
    """Write the depth value 65535 to all pixels with missing depth, and to a random 1 % of all pixels."""
    stored = np.rint(1000 * frame.depth).astype(np.uint16)
    stored[(stored == 0) | (np.random.default_rng(1).random(stored.shape) < 0.01)] = 65535
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnitWarning)
        return Frame(frame.color, stored, frame.camera, name=frame.name, depth_scale=0.001)


SPOILT: dict[str, tuple[str, Callable[[Frame], Frame]]] = {
    "shift right 8 px": ("alignment", lambda f: shift(f, 8, 0)),
    "shift left 8 px": ("alignment", lambda f: shift(f, -8, 0)),
    "shift down 8 px": ("alignment", lambda f: shift(f, 0, 8)),
    "shift up 8 px": ("alignment", lambda f: shift(f, 0, -8)),
    "mirrored": ("alignment", lambda f: with_depth(f, f.depth[:, ::-1])),
    "not registered": ("alignment", not_registered),
    "depth x10": ("depth unit", lambda f: scale(f, 10)),
    "depth x1000": ("depth unit", lambda f: scale(f, 1000)),
    "depth x0.1": ("depth unit", lambda f: scale(f, 0.1)),
    "depth x0.001": ("depth unit", lambda f: scale(f, 0.001)),
    "focal length x0.5": ("focal length", lambda f: zoom(f, 0.5)),
    "focal length x0.7": ("focal length", lambda f: zoom(f, 0.7)),
    "focal length x1.5": ("focal length", lambda f: zoom(f, 1.5)),
    "focal length x2": ("focal length", lambda f: zoom(f, 2)),
    "whole-pixel disparity": ("depth steps", whole_pixels),
    "distance along the ray": ("depth along Z", along_rays),
    "65535 for missing": ("reach of depth", sentinel),
}


def looked_at(frame: Frame, check: str) -> Finding:
    """Run one check of `spigolo doctor` on a frame, and return the result of the check.

    check: name of the check, as in `SPOILT`.
    """
    filled = inpaint_small_gaps(frame.depth, Inpainting().at_size(frame.shape))
    assert frame.camera is not None
    if check == "alignment":
        return check_alignment(frame.color, filled)
    if check == "depth unit":
        return check_unit(frame, filled)
    if check == "focal length":
        return check_focal_length(filled, frame.camera)
    if check == "depth along Z":
        return check_planarity(filled, frame.camera)
    return check_steps(frame.depth) if check == "depth steps" else check_reach(frame)


def has_steps(frame: Frame) -> bool:
    """Return True if the frame has enough depth contours to test the alignment of depth and colour."""
    return count_contours(depth_contours(frame.depth)) >= MIN_CONTOUR_SHARE * frame.depth.size


def distinct(folder: Path) -> list[str]:
    """Return the names of all frames in a folder, with only one frame per group of near-identical frames."""
    splits = json.loads((folder / "splits.json").read_text())
    repeated = {name for group in splits["near_duplicate_groups"] for name in group[1:]}
    names = (path.parent.relative_to(folder).as_posix() for path in listed(folder, "*/*/rgb.png"))
    return [name for name in names if name not in repeated]


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure detection rates and false warnings of `spigolo doctor`.")
    parser.add_argument("folder", nargs="?", type=Path, default=FRAMES, help="data folder, default: %(default)s")
    folder = parser.parse_args().folder
    if not (folder / "splits.json").is_file():
        parser.error(f"expected splits.json in {folder}: set SPIGOLO_DATA to the data folder")
    measure(folder)


def measure(folder: Path) -> None:
    """Print, for each simulated error, the share of frames in which it is detected. Also print, for each check, the
    share of correct frames with a false warning. Frames with undetected errors are printed to stderr.
    """
    found: dict[str, list[bool]] = {kind: [] for kind in SPOILT}
    false: dict[str, list[str]] = {}
    seconds = []
    names = distinct(folder)
    for name in names:
        warnings.simplefilter("ignore", UserWarning)  # ignored for all frames
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
                hit = looked_at(spoil(frame), check).severity is Severity.WARNING
                found[kind].append(hit)
                if not hit:
                    print(f"missed: {kind} in {name}", file=sys.stderr)
    print(f"{'error':22s} frames  found")
    for kind, caught in found.items():
        print(f"{kind:22s} {len(caught):6d}  {np.mean(caught):5.1%}")
    print(f"\n{'check':20s} false warnings on {len(names)} correct frames")
    for check, where in false.items():
        print(f"{check:20s} {len(where) / len(names):5.1%}  {' '.join(where)}")
    print(f"\ndiagnose: median {np.median(seconds):.2f} s, slowest {max(seconds):.2f} s")


if __name__ == "__main__":
    main()
