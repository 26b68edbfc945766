"""Interrupt batch runs and compare their results with an uninterrupted run: `python -m spigolo.lab.studies.kills`.

A batch of 2,000 small frames is segmented four times. The first run is not interrupted. The second run is killed by
SIGKILL at five random moments. In the third run, workers of a Dask cluster are killed twice. In the fourth run, the
disk is full at two moments. The second and the fourth run are restarted until all frames are segmented. The exit code
is 1 if the output files of a run differ from those of the first run. The fourth run requires Linux and root rights. The
fourth run is left out if its small file system cannot be mounted.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import spigolo as sp
from spigolo.batch import Engine, FrameFiles, dask_local, local, run_batch
from spigolo.batch.manifest import FILE
from spigolo.errors import SpigoloError
from spigolo.frames.files import write_json, write_png

SIZE = 90, 120
WORKERS = 2
SETTLING_S = 0.05
"""Maximum of the random delay before a process is killed, in seconds. Without a delay, every process would be killed
directly after it has added a frame to the list of finished frames.
"""


@dataclass(frozen=True, kw_only=True)
class Logged(FrameFiles):
    """Frame of a batch run. Each time the frame is read, its name and the id of the reading process are appended to a
    log file.
    """

    log: Path

    def read(self) -> sp.Frame:
        with self.log.open("ab", buffering=0) as file:
            file.write(f"{self.name} {os.getpid()}\n".encode())
        return super().read()


@dataclass(frozen=True, slots=True)
class Outcome:
    """Results of one interrupted run."""

    name: str
    disturbances: int
    twice: int
    """Number of frames that were read more than once because the run was killed and started again."""
    different: list[str]
    """Output files that differ from those of the uninterrupted run, or that only one of the two runs has written."""
    files: int
    wall_s: float


def write_frames(folder: Path, count: int) -> None:
    """Write `count` random frames, each with three boxes in front of a plane."""
    height, width = SIZE
    camera = {"fx": 110.0, "fy": 110.0, "cx": 59.5, "cy": 44.5, "width": width, "height": height}
    write_json(folder / "camera.json", {**camera, "depth_scale": 0.001})
    for k in range(count):
        rng = np.random.default_rng(k)
        color, depth = np.full((height, width, 3), 90, np.uint8), np.full(SIZE, 1000, np.uint16)
        for _ in range(3):
            y, x = rng.integers(5, height - 35), rng.integers(5, width - 35)
            color[y : y + 28, x : x + 28] = rng.integers(0, 255, 3)
            depth[y : y + 28, x : x + 28] = rng.integers(700, 900)
        write_png(folder / "rgb" / f"{k:06d}.png", color + rng.integers(0, 6, color.shape, dtype=np.uint8))
        write_png(folder / "depth" / f"{k:06d}.png", depth)


def work(source: Path, out: Path, log: Path, engine: Engine) -> int:
    """Segment all frames in this process, which may be killed during the run. Return the exit code of the run."""
    names = sorted(path.stem for path in (source / "rgb").iterdir())
    camera = source / "camera.json"
    jobs = [Logged(n, source / "rgb" / f"{n}.png", source / "depth" / f"{n}.png", camera, log=log) for n in names]
    try:
        run_batch(jobs, sp.OBJECTS, out, engine)
    except SpigoloError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


class Study:
    """Test of interrupted batch runs. All files of the runs are in the folder `root`.

    The attribute `plain` is the output folder of the run that is not interrupted.
    """

    def __init__(self, root: Path, count: int) -> None:
        self.root, self.count, self.rng = root, count, random.Random(0)
        self.source, self.plain = root / "source", root / "undisturbed"

    def start(self, out: Path, engine: str = "local") -> subprocess.Popen[str]:
        arguments = ["--work", str(self.source), str(out), str(self.log_of(out)), engine]
        return subprocess.Popen([sys.executable, "-m", __spec__.name, *arguments], stderr=subprocess.PIPE, text=True)

    def finish(self, out: Path, engine: str = "local") -> None:
        process = self.start(out, engine)
        told = process.communicate()[1]
        if process.returncode:
            raise SystemExit(f"the run to {out} ended with {process.returncode}: {told}")

    def log_of(self, out: Path) -> Path:
        return self.root / f"{out.name}.log"

    def moments(self, count: int) -> list[int]:
        """Return `count` random moments for interruptions. Each moment is given by the number of frames that are
        finished at this moment. The moments are returned in ascending order.
        """
        return sorted(self.rng.sample(range(1, self.count * 9 // 10), count))

    def wait_for(self, out: Path, lines: int, process: subprocess.Popen[str]) -> None:
        """Wait until the manifest (list of finished frames) has `lines` lines, or the process has ended.

        Wait for an additional random time of up to `SETTLING_S` seconds.
        """
        while process.poll() is None and lines_in(out / FILE) < lines:
            time.sleep(0.002)
        time.sleep(self.rng.random() * SETTLING_S)

    def killed(self, out: Path, times: int) -> int:
        for moment in self.moments(times):
            process = self.start(out)
            self.wait_for(out, moment, process)
            if process.poll() is not None:
                raise SystemExit(f"the run ended before it could be killed after {moment} frames")
            process.kill()
            process.communicate()
        self.finish(out)
        return times

    def robbed(self, out: Path, times: int) -> int:
        """Segment all frames on a Dask cluster, and kill workers at `times` random moments of the run. At each moment,
        the worker that was the last to read a frame is killed.

        Return the number of killed workers.
        """
        process = self.start(out, "dask")
        for moment in self.moments(times):
            self.wait_for(out, moment, process)
            worker = int(self.log_of(out).read_text().split()[-1])
            os.kill(worker, signal.SIGKILL)
        told = process.communicate()[1]
        if process.returncode:
            raise SystemExit(f"the run on the cluster ended with {process.returncode}: {told}")
        return times

    def filled(self, out: Path, times: int) -> int:
        needed = sum(path.stat().st_blocks * 512 for path in self.plain.rglob("*"))
        for k in range(times):
            mount("-o", f"remount,size={needed * (k + 1) // (times + 1)}", str(out.parent))
            process = self.start(out)
            told = process.communicate()[1]
            if process.returncode != 2 or "o space left" not in told:
                raise SystemExit(f"expected a full disk, got exit code {process.returncode}: {told}")
        mount("-o", f"remount,size={2 * needed}", str(out.parent))
        self.finish(out)
        return times

    def outcome(self, name: str, out: Path, disturbances: int, wall_s: float) -> Outcome:
        begun = Counter(line.split()[0] for line in self.log_of(out).read_text().splitlines())
        mine, theirs = contents(out), contents(self.plain)
        different = [path for path in sorted(mine | theirs) if mine.get(path) != theirs.get(path)]
        return Outcome(name, disturbances, begun.total() - len(begun), different, len(theirs), wall_s)


def lines_in(path: Path) -> int:
    return path.read_bytes().count(b"\n") if path.exists() else 0


def contents(out: Path) -> dict[str, bytes]:
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in out.rglob("*") if path.is_file()}


def mount(*arguments: str) -> None:
    subprocess.run(["mount", *arguments], check=True, capture_output=True)


@contextmanager
def small_disk(folder: Path) -> Iterator[Path | None]:
    """Create a folder, and mount a small in-memory file system in this folder. Yield the folder, or None if the system
    does not allow mounting.
    """
    folder.mkdir()
    try:
        mount("-t", "tmpfs", "-o", "size=1m", "tmpfs", str(folder))
    except (OSError, subprocess.CalledProcessError):
        yield None
        return
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def run(root: Path, count: int, kills: int) -> Iterator[Outcome]:
    study = Study(root, count)
    write_frames(study.source, count)
    start = time.perf_counter()
    study.finish(study.plain)
    yield study.outcome("undisturbed", study.plain, 0, time.perf_counter() - start)
    with small_disk(root / "disk") as disk:
        ways = [
            ("SIGKILL of the run", study.killed, root / "killed", kills),
            ("SIGKILL of a Dask worker", study.robbed, root / "robbed", 2),
        ]
        if disk is not None:
            ways.append(("full disk", study.filled, disk / "filled", 2))
        for name, disturb, out, times in ways:
            start = time.perf_counter()
            done = disturb(out, times)
            yield study.outcome(name, out, done, time.perf_counter() - start)
        if disk is None:
            print("full disk: left out, because mounting a file system is not permitted", file=sys.stderr)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--work", nargs=4, help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.work:
        source, out, log, engine = given.work
        return work(Path(source), Path(out), Path(log), local(WORKERS) if engine == "local" else dask_local(WORKERS))
    print(
        "| run | interruptions | frames | frames started twice | files | different files | s |",
        "|---" * 7 + "|",
        sep="\n",
    )
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for o in run(Path(folder), given.frames, given.kills):
            figures = f"{o.disturbances} | {given.frames} | {o.twice} | {o.files} | {len(o.different)} | {o.wall_s:.0f}"
            print(f"| {o.name} | {figures} |", flush=True)
            failed |= bool(o.different)
            with contextlib.suppress(IndexError):
                print(f"first different file: {o.different[0]}", file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
