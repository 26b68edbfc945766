"""Command `batch`, which segments many frames."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from spigolo.cli import DONE, SOME_FAILED
from spigolo.cli.engines import choose_cluster
from spigolo.cli.inputs import Inputs, Out, configure, split_flags
from spigolo.cli.opening import opened
from spigolo.cli.progress import progress
from spigolo.cli.region import NO_REGION, RegionFlags
from spigolo.errors import SpigoloError
from spigolo.frames.frame import MAX_PIXELS
from spigolo.sources.base import counted

if TYPE_CHECKING:
    from collections.abc import Callable

    from spigolo.batch import Engine, FrameFiles, Progress, Summary
    from spigolo.settings.config import Config
    from spigolo.sources.numbered import NumberedFrame

MOST_FAILURES = 10
"""Maximum number of failed frames that are printed. The file manifest.jsonl lists all failed frames."""


def batch(
    *inputs: Inputs,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    region: RegionFlags = NO_REGION,
    max_pixels: int = MAX_PIXELS,
    workers: int | None = None,
    scheduler: str | None = None,
    format: Literal["parquet", "coco"] = "parquet",
    out: Out = Path("spigolo-batch"),
) -> int:
    """Segment many frames. Write labels/FRAME.png for each frame, and one table of all objects.

    Repeat the command to continue an interrupted run. The exit code is 1 if a frame failed.

    Example: `spigolo batch recordings/ --camera kinect-v1 --depth-scale 0.001 --out results`.

    Parameters
    ----------
    inputs
        Frames to segment: image files, folders, a data set or a ROS bag, in the forms that `spigolo segment` accepts.
        Each field of the preset can also be set with a flag, such as `--partition.gamma 0.004`.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    preset
        Preset for the segmentation: the name of a preset, such as OBJECTS, or a TOML file.
    depth_scale
        Metres per unit of the depth image. Default: the depth scale in the camera file.
    region
        Region of interest: --roi, --roi-mask or --roi-box.
    max_pixels
        Maximum number of pixels of an image. Larger images are rejected, to limit memory.
    workers
        Number of processes on this machine. Default: one per core.
    scheduler
        Address of a Dask scheduler, such as tcp://127.0.0.1:8786. `local` starts a Dask cluster of `--workers`
        processes on this machine. Default: no cluster.
    format
        File format of the table of all objects: `parquet` writes objects.parquet, `coco` writes coco.json.
    out
        Output folder.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, batch)
    jobs = _jobs(words, camera, depth_scale, max_pixels)
    engine = _engine(workers, scheduler)
    _check_first(jobs, config)
    from spigolo.batch import run_batch

    with _bar(len(jobs)) as tell:
        summary = run_batch(jobs, config, out, engine, roi=region.read(max_pixels), table=format, tell=tell)
    _print_summary(summary, out)
    return SOME_FAILED if summary.failures else DONE


def _jobs(
    words: Sequence[str], camera: str | None, depth_scale: float | None, max_pixels: int
) -> Sequence[FrameFiles] | Sequence[NumberedFrame]:
    """Return the frames of a source as jobs. Each job reads image files, or one frame of a bag or data set."""
    from spigolo.batch import FrameFiles
    from spigolo.sources.bags import BagSource
    from spigolo.sources.folders import FolderSource
    from spigolo.sources.numbered import numbered_frames, open_numbered

    given = camera, depth_scale, max_pixels
    source = open_numbered(words[0], *given) if len(words) == 1 else opened(words, *given)
    if isinstance(source, FolderSource):
        return [
            FrameFiles(p.name, p.color, p.depth, p.camera if camera is None else camera, depth_scale, max_pixels)
            for p in source.paths
        ]
    if isinstance(source, BagSource) and source.content.unpaired:
        single = counted(source.content.unpaired, "image")
        print(f"{source.name}: {single} without a partner within {source.options.tolerance_ms:g} ms")
    return numbered_frames(words[0], camera, depth_scale, max_pixels)


def _check_first(jobs: Sequence[FrameFiles] | Sequence[NumberedFrame], config: Config) -> None:
    """Print the warnings of `spigolo doctor` for the first frame. An unreadable frame is reported by the run."""
    from spigolo.cli import show
    from spigolo.doctor import diagnose

    with suppress(SpigoloError):
        show.warn_of(diagnose(jobs[0].read()), jobs[0].name, config)


def _engine(workers: int | None, scheduler: str | None) -> Engine:
    from spigolo.batch import local
    from spigolo.batch.engine import cores

    if scheduler is not None:
        return choose_cluster(scheduler, workers, "--workers")
    return local(cores() if workers is None else workers)


@contextmanager
def _bar(total: int) -> Iterator[Callable[[Progress], None]]:
    """Show a progress bar with frame rate, remaining time and number of failures. Yield the function that updates the
    bar.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn

    text = TextColumn("{task.fields[rate]}  {task.fields[failed]} failed")
    with progress(BarColumn(), MofNCompleteColumn(), text, TimeRemainingColumn()) as bar:
        task = bar.add_task("", total=total, rate="", failed=0)

        def tell(state: Progress) -> None:
            elapsed = bar.tasks[0].elapsed or 0
            rate = f"{state.computed / elapsed:.1f} frames/s" if state.computed and elapsed else ""
            finished = state.kept + state.computed + state.failed
            bar.update(task, completed=finished, rate=rate, failed=state.failed)

        yield tell


def _print_summary(summary: Summary, out: Path) -> None:
    for name, reason in summary.failures[:MOST_FAILURES]:
        print(f"spigolo: {name}: {reason}", file=sys.stderr)
    if len(summary.failures) > MOST_FAILURES:
        more = len(summary.failures) - MOST_FAILURES
        print(f"spigolo: {more} more frames failed: {out / 'manifest.jsonl'} has the reasons", file=sys.stderr)
    if summary.warnings:
        name, text = summary.warnings[0]
        frames = counted(len(summary.warnings), "frame")
        print(f"spigolo: {name}: {text} ({frames} with warnings: {out / 'manifest.jsonl'})", file=sys.stderr)
    if summary.left:
        named = ", ".join(summary.left[:3]) + (", ..." if len(summary.left) > 3 else "")
        frames = counted(len(summary.left), "frame")
        print(f"spigolo: files of {frames} that are not part of this run stay in {out}: {named}", file=sys.stderr)
    state = summary.progress
    print(f"{counted(state.total, 'frame')}: {state.computed} computed, {state.kept} kept, {state.failed} failed")
    print(f"{counted(summary.objects, 'object')}: {summary.table}")
