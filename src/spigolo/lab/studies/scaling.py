"""Measure the throughput of batch runs, and extrapolate to 10 million frames: `python -m spigolo.lab.studies.scaling
FRAMES`.

The overhead of the Dask scheduler is measured with jobs that do nothing, in groups of 1 to 1000 jobs. The time for
writing results is measured with results that were computed in advance. The scheduler and the writer of the results run
in the same process, as in a batch run with `--scheduler local`.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import spigolo as sp
from spigolo.batch import Engine, FrameFiles, dask_local, local, run_batch
from spigolo.batch.cluster import TASK_S
from spigolo.batch.results import Work
from spigolo.errors import FileError
from spigolo.lab.machine import this_machine

JOBS = {1: 2_000, 10: 20_000, 100: 200_000, 1000: 1_000_000}
"""Number of empty jobs in a measurement, indexed by the number of jobs per group."""
FRAMES = 10_000_000
CORES = 16
"""Number of processor cores per machine that the extrapolated table assumes."""
MACHINES = 1, 4, 16, 64, 256
DISK_MB_PER_S = 500
"""Data rate of the shared storage that the extrapolated table assumes, MB/s."""


@dataclass(frozen=True, slots=True)
class Overhead:
    """Measured scheduling time of empty jobs, which are sent to the workers in groups."""

    group: int
    """Number of jobs in each group that is sent to a worker."""
    jobs: int
    """Total number of empty jobs."""
    wall_s: float
    """Wall time from the start of the first job to the end of the last job, in seconds."""

    @property
    def task_ms(self) -> float:
        """Return the scheduling time per group of jobs, in milliseconds."""
        return 1e3 * self.wall_s / (self.jobs / self.group)

    @property
    def job_us(self) -> float:
        """Return the scheduling time per job, microseconds."""
        return 1e6 * self.wall_s / self.jobs


@dataclass(frozen=True, slots=True)
class Frames:
    """Measured throughput of a batch run, and amount of data per frame."""

    rates: dict[int, float]
    """Frames per second, indexed by the number of worker processes."""
    read_bytes: float
    written_bytes: float
    """Mean number of bytes written per frame, including the tables of the whole batch."""
    files: float
    """Number of files written per frame."""
    writer_ms: float
    """Time to write the results of one frame, in milliseconds."""


def tiny(job: int) -> int:
    """Return `job` unchanged. This function is the empty job that measures the overhead of the scheduler."""
    return job


def overhead(group: int, jobs: int, workers: int) -> Overhead:
    """Run empty jobs on a Dask cluster, and return the scheduling time.

    Additional empty jobs run before the measurement, to warm up the scheduler.
    """
    warm, start, done = jobs // 10, 0.0, 0
    for done, (job, answer) in enumerate(dask_local(workers, group)(tiny, range(jobs + warm)), start=1):
        if done == warm:
            start = time.perf_counter()
        assert job == answer
    assert done == jobs + warm
    return Overhead(group, jobs, time.perf_counter() - start)


def real_jobs(folder: Path, count: int) -> list[FrameFiles]:
    """Return `count` jobs for the frames in a folder. If there are fewer than `count` frames, frames are repeated with
    different names.
    """
    found = sorted(path.parent for path in folder.glob("*/*/depth.png"))
    if not found:
        raise FileError(f"expected frames in {folder}/SET/FRAME, got none")
    frames = (found[k * len(found) // count % len(found)] for k in range(count))
    return [
        FrameFiles(f"{k:06d}", frame / "rgb.png", frame / "depth.png", frame / "camera.json")
        for k, frame in enumerate(frames)
    ]


def measure(jobs: list[FrameFiles], workers: Iterable[int]) -> Frames:
    rates = {count: rate(jobs, local(count)) for count in workers}
    answers = ready(jobs)
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        run_batch(jobs, sp.OBJECTS, Path(folder), answers)
        writer_ms = 1e3 * (time.perf_counter() - start) / len(jobs)
        written = [path for path in Path(folder).rglob("*") if path.is_file()]
        sizes = [path.stat().st_size for path in written]
    read = sum(os.path.getsize(path) for job in jobs for path in (job.color, job.depth))
    return Frames(rates, read / len(jobs), sum(sizes) / len(jobs), round(len(written) / len(jobs)), writer_ms)


def rate(jobs: list[FrameFiles], engine: Engine) -> float:
    """Measure the throughput of a batch run in frames per second.

    The first fifth of the frames is not timed, because the worker processes start while these frames are segmented.
    """
    times: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        run_batch(jobs, sp.OBJECTS, Path(folder), engine, tell=lambda _: times.append(time.perf_counter()))
    warm = len(times) // 5
    return (len(times) - 1 - warm) / (times[-1] - times[warm])


def ready(jobs: list[FrameFiles]) -> Engine:
    """Segment all frames in advance. Return an engine that returns the stored results without computing them again."""
    work = Work(sp.OBJECTS)
    answers = {job.name: work(job) for job in jobs}

    def run(do: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
        return ((item, answers[item.name]) for item in items)

    return run


def costs(frames: Frames, schedulers: list[Overhead]) -> Iterator[str]:
    """Yield the rows of the table of extrapolated costs. A row of the extrapolated table gives the throughput, the
    total time and the limiting component for one number of machines.
    """
    frame_s = core_s(frames)
    group = max(int(TASK_S / frame_s), 1)  # same group size as in `dask_local`
    task_s = median(one.task_ms for one in schedulers) / 1e3
    moved_mb = (frames.read_bytes + frames.written_bytes) / 1e6
    for machines in MACHINES:
        limits = {
            "cores": machines * CORES / frame_s,
            "scheduler": group / task_s,
            "writing process": 1e3 / frames.writer_ms,
            "storage": DISK_MB_PER_S / moved_mb,
        }
        slowest = min(limits, key=lambda name: limits[name])
        hours = FRAMES / limits[slowest] / 3600
        yield f"| {machines} | {machines * CORES} | {limits[slowest]:.0f} | {hours:.1f} | {slowest} |"


def core_s(frames: Frames) -> float:
    """Return the processor time per frame in core seconds, measured with the maximum number of worker processes."""
    workers = max(frames.rates)
    return workers / frames.rates[workers]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frames", type=Path, help="folder SET/FRAME/ with rgb.png, depth.png and camera.json")
    parser.add_argument("--count", type=int, default=200, help="number of frames to segment per measurement")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--share", type=float, default=1.0, help="share of the empty jobs to run, 0..1")
    given = parser.parse_args()
    machine = this_machine()
    print(f"{machine}; load {machine.load}\n")
    print("| jobs per group | jobs | s | ms per group | us per job |", "|---" * 5 + "|", sep="\n")
    schedulers = []
    for group, jobs in JOBS.items():
        found = overhead(group, max(round(given.share * jobs), 10 * group), max(given.workers))
        print(f"| {group} | {found.jobs} | {found.wall_s:.1f} | {found.task_ms:.2f} | {found.job_us:.1f} |", flush=True)
        schedulers.append(found)
    frames = measure(real_jobs(given.frames, given.count), given.workers)
    print("\n| processes | frames/s | efficiency |", "|---" * 3 + "|", sep="\n")
    for workers, one in frames.rates.items():
        first = min(frames.rates)
        print(f"| {workers} | {one:.2f} | {100 * one * first / workers / frames.rates[first]:.0f} % |")
    print(
        f"\nper frame: {frames.read_bytes / 1e3:.0f} kB read, {frames.written_bytes / 1e3:.1f} kB written in"
        f" {frames.files:.0f} files, {frames.writer_ms:.2f} ms in the writing process\n"
    )
    hours = FRAMES * core_s(frames) / 3600
    print(f"{FRAMES} frames: {hours:.0f} core-hours, {FRAMES * frames.written_bytes / 1e9:.0f} GB written\n")
    print("| machines | cores | frames/s | hours | limit |", "|---" * 5 + "|", *costs(frames, schedulers), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
