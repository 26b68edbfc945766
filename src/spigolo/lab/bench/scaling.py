"""Measurement of the CPU time as a function of the number of pixels."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2

from spigolo.frames.frame import Frame
from spigolo.lab.bench.contestants import CONFIGS, SEGMENTING_PEERS
from spigolo.lab.bench.figures import PowerLaw, fit_power_law, summarise
from spigolo.lab.bench.peers import Peers
from spigolo.lab.bench.timing import Run, Sample, Tell, run_rounds, silent, timed
from spigolo.stream import Segmenter

Size = tuple[int, int]
"""Image size (width, height) in pixels."""

SIZES: tuple[Size, ...] = ((320, 240), (640, 480), (1280, 960), (1920, 1080), (2560, 1920))
SCALED = ("TABLE 8c", "SHELF 8c")
VGA, FULL_HD = (640, 480), (1920, 1080)


@dataclass(frozen=True, slots=True)
class Growth:
    """CPU times of one function at several image sizes."""

    cpu_ms: list[float]
    """Median CPU time at each image size, in milliseconds."""
    pixels: PowerLaw | None
    """Power law t = c N^p, fitted to the CPU time t and the number of pixels N.

    The value is None if only one image size was measured.
    """
    pixels_log: PowerLaw | None
    """Power law t = c (N log N)^p, fitted to the CPU time t and the number of pixels N.

    The value is None if only one image size was measured.
    """
    hd_per_vga: float | None
    """CPU time per pixel at 1920x1080 divided by CPU time per pixel at 640x480.

    The value is None if 1920x1080 or 640x480 was not measured.
    """
    samples: list[list[Sample]]
    """Measured times of all runs at each image size."""


def rescaled(frame: Frame, size: Size) -> Frame:
    """Resize the images of a frame, and scale its camera intrinsics.

    Colours are averaged over areas if the image becomes smaller. Colours are interpolated linearly if the image becomes
    larger. The depth of a pixel in the new image is the depth of the nearest pixel in the old image.
    """
    width, height = size
    shrinks = width * height < frame.depth.size
    color = cv2.resize(frame.color, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR)
    depth = cv2.resize(frame.depth, size, interpolation=cv2.INTER_NEAREST)
    camera = None if frame.camera is None else frame.camera.scaled(width, height)
    return Frame(color, depth, camera, max_pixels=width * height)


def study(frame: Frame, sizes: Sequence[Size], rounds: int, peers: Peers, tell: Tell = silent) -> dict[str, Growth]:
    """Time the presets TABLE and SHELF, and one segmentation function of another library, at each image size.

    Return the times, indexed by the name of the timed function.
    """
    if not sizes:
        return {}
    runs: dict[str, Run] = {}
    methods = {name: Segmenter(CONFIGS[name]) for name in SCALED}
    rivals = [name for name in peers.names if name in SEGMENTING_PEERS][:1]
    for size in sizes:
        scaled = rescaled(frame, size)
        for name, method in methods.items():
            runs[_key(name, size)] = _on(method, scaled)
        if rivals:
            key = _key("scaled", size)
            peers.load(key, scaled.color)
            runs |= {_key(name, size): peers.contestants(key)[name] for name in rivals}
    samples = run_rounds(runs, rounds, tell, "sizes")
    return {name: growth(sizes, [samples[_key(name, size)] for size in sizes]) for name in (*methods, *rivals)}


def growth(sizes: Sequence[Size], samples: list[list[Sample]]) -> Growth:
    """Fit the CPU time of a function to the number of pixels. samples: measured times at each image size."""
    cpu = [summarise(s).cpu_ms for s in samples]
    pixels = [float(width * height) for width, height in sizes]
    several = len(set(pixels)) > 1
    per_pixel = {size: t / n for size, t, n in zip(sizes, cpu, pixels, strict=True)}
    return Growth(
        cpu_ms=cpu,
        pixels=fit_power_law(pixels, cpu) if several else None,
        pixels_log=fit_power_law([n * math.log(n) for n in pixels], cpu) if several else None,
        hd_per_vga=per_pixel[FULL_HD] / per_pixel[VGA] if {FULL_HD, VGA} <= set(sizes) else None,
        samples=samples,
    )


def _key(name: str, size: Size) -> str:
    return f"{name} {size[0]}x{size[1]}"


def _on(method: Callable[[Frame], object], frame: Frame) -> Run:
    return timed(lambda: method(frame))
