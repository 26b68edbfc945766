"""Measurement of memory use, throughput with threads, and latency."""

from __future__ import annotations

import statistics
import time
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from spigolo.frames.frame import Frame
from spigolo.lab.bench.figures import percentile
from spigolo.lab.bench.timing import Tell, silent
from spigolo.settings.config import Config
from spigolo.stream import Segmenter


@dataclass(frozen=True, slots=True)
class Memory:
    """Memory use of a `Segmenter`, in bytes per pixel."""

    workspace: float
    """Memory of the arrays that the `Segmenter` keeps between frames (workspace), bytes per pixel."""
    frame: float
    """Peak memory during the segmentation of a frame, in addition to `workspace`, bytes per pixel.

    The peak includes the memory of the segmentation result.
    """
    answer: float
    """Memory of the segmentation result of one frame, bytes per pixel."""


def measure_memory(frame: Frame, config: Config) -> Memory:
    """Measure the memory that a `Segmenter` uses. Memory that OpenCV allocates inside its functions is not included."""
    run = Segmenter(config)
    run(frame)
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        answer = run(frame)
        kept, peak = (bytes_ - before for bytes_ in tracemalloc.get_traced_memory())
    finally:
        tracemalloc.stop()
    pixels = answer.labels.size
    return Memory(run.workspace.size_bytes / pixels, peak / pixels, kept / pixels)


@dataclass(frozen=True, slots=True)
class Throughput:
    """Segmented frames per second with one thread and with two threads."""

    frames: int
    """Number of frames that each thread segments in each repeat."""
    one_thread: list[float]
    """Frames per second with one thread, in each repeat."""
    two_threads: list[float]
    """Frames per second with two threads, in each repeat."""
    ratio: float
    """Throughput with two threads divided by the throughput with one thread, median over repeats."""


def measure_throughput(frame: Frame, config: Config, frames: int, repeats: int, tell: Tell = silent) -> Throughput:
    """Measure the throughput in frames per second. Each thread segments `frames` frames with its own `Segmenter`."""
    kept = [Segmenter(config), Segmenter(config)]
    rates: dict[int, list[float]] = {1: [], 2: []}
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda run: run(frame), kept))
        for k in range(repeats):
            for threads in (1, 2) if k % 2 == 0 else (2, 1):
                tell(f"throughput of {threads} threads", sum(map(len, rates.values())) / (2 * repeats))
                start = time.perf_counter()
                list(pool.map(lambda run: _many(run, frame, frames), kept[:threads]))
                rates[threads].append(threads * frames / (time.perf_counter() - start))
    ratio = statistics.median(two / one for one, two in zip(rates[1], rates[2], strict=True))
    return Throughput(frames, rates[1], rates[2], ratio)


def _many(run: Segmenter, frame: Frame, frames: int) -> None:
    for _ in range(frames):
        run(frame)


@dataclass(frozen=True, slots=True)
class Latency:
    """Wall time of the segmentation per frame, in milliseconds."""

    frames: int
    """Number of measured frames."""
    median_ms: float
    """Median wall time per frame, in milliseconds."""
    p99_ms: float
    """99th percentile of the wall time per frame, in milliseconds."""
    worst_ms: float
    """Maximum wall time per frame, in milliseconds."""
    samples: list[float]
    """Wall time of each frame, in milliseconds."""


def measure_latency(frame: Frame, config: Config, frames: int, tell: Tell = silent) -> Latency:
    """Measure the wall time of each frame in one thread. One frame is segmented before the measurement to warm up."""
    run = Segmenter(config)
    run(frame)
    times: list[float] = []
    for k in range(frames):
        tell("latency", k / frames)
        start = time.perf_counter()
        run(frame)
        times.append(1e3 * (time.perf_counter() - start))
    return Latency(frames, statistics.median(times), percentile(times, 0.99), max(times), times)
