"""Command `bench`, which measures the time and memory that a frame takes on this machine."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from spigolo.cli import DONE
from spigolo.cli.inputs import DEMO_SCENE
from spigolo.cli.progress import progress
from spigolo.errors import ConfigError, FrameError
from spigolo.frames.frame import MAX_PIXELS
from spigolo.sources.paths import find_frames

if TYPE_CHECKING:
    from spigolo.frames.frame import Color, Frame
    from spigolo.lab.bench import Plan, Report, Size
    from spigolo.lab.bench.timing import Tell

NONE = "none"


def bench(
    *folders: str,
    rounds: int | None = None,
    quick: bool = False,
    sizes: str | None = None,
    peers: Path | None = None,
    latency: int = 0,
    startup: bool = False,
    json: Path | None = None,
    plot: Path | None = None,
    markdown: Path | None = None,
) -> int:
    """Measure the time and memory of each preset, compared with OpenCV and scikit-image.

    Each measurement round runs every preset and every reference algorithm once. A ratio of two times is always computed
    from times of the same round. The reference algorithms are OpenCV's GraphSegmentation and fine-grained saliency,
    scikit-image's felzenszwalb, and a graph partition that sorts all edges and merges regions by union-find. Close
    other programs before you measure. Examples: `spigolo bench --quick`, or `spigolo bench recordings/ --latency 1000
    --startup --json bench.json`.

    Parameters
    ----------
    folders
        Folders of frames, in the layouts that `spigolo segment` reads. Default: the bundled demo scene. The measurement
        rounds run on all frames. All other measurements run on the first frame only.
    rounds
        Number of measurement rounds, which follow one warm-up round. Default: 15, or 3 with --quick.
    quick
        Shorten the measurement to about 15 seconds, by fewer rounds, image sizes and frames.
    sizes
        Image sizes to which the first frame is rescaled, such as `640x480,1280x960`. The word `none` skips the
        measurement of image sizes.
    peers
        Python interpreter that runs the reference algorithms of opencv-contrib-python-headless and scikit-image.
        Default: .venv-oracle/bin/python in the current folder if this file exists, else the interpreter of spigolo. If
        a package is not installed, its reference algorithms are skipped.
    latency
        Number of frames that are segmented in a row to measure the median, the 99th percentile and the maximum of the
        latency.
    startup
        Also measure how long the program takes to start if its numerical kernels are not compiled yet. The measurement
        of the start takes up to a minute more.
    json
        JSON file to write, with all measured values of every round.
    plot
        PNG file to write, with a plot of time against number of pixels.
    markdown
        Markdown file to which the tables of times and memory are written.

    """
    plan = _plan(quick, rounds, sizes, latency, startup)
    if plot is not None and not plan.sizes:
        raise ConfigError("expected sizes to plot, got none")
    frames = _read(folders)
    from spigolo.frames import files as io
    from spigolo.lab.bench import bench as measure
    from spigolo.lab.bench import markdown as as_markdown

    with _progress() as tell:
        report = measure(frames, plan, peers, tell)
    _print(report)
    if json is not None:
        io.write_json(json, report.to_json())
    if markdown is not None:
        io.write_bytes(markdown, as_markdown(report).encode())
    if plot is not None:
        io.write_png(plot, _chart(report))
    written = [str(path) for path in (json, markdown, plot) if path is not None]
    if written:
        print(f"written: {', '.join(written)}")
    return DONE


def _plan(quick: bool, rounds: int | None, sizes: str | None, latency: int, startup: bool) -> Plan:
    from spigolo.lab.bench import QUICK, Plan

    plan = dataclasses.replace(QUICK if quick else Plan(), latency=latency, cold=startup)
    if latency < 0:
        raise ConfigError(f"expected a number of frames as --latency, got {latency}")
    if rounds is not None:
        if rounds < 1:
            raise ConfigError(f"expected at least one round, got {rounds}")
        plan = dataclasses.replace(plan, rounds=rounds, size_rounds=min(rounds, Plan().size_rounds))
    return plan if sizes is None else dataclasses.replace(plan, sizes=_sizes(sizes))


def _sizes(text: str) -> tuple[Size, ...]:
    if text.lower() == NONE:
        return ()
    sizes = []
    for word in text.split(","):
        width, _, height = word.strip().lower().partition("x")
        if not (width.isdecimal() and height.isdecimal() and int(width) * int(height)):
            raise ConfigError(f"expected --sizes as 640x480,1280x960 or none, got {text!r}")
        if int(width) * int(height) > MAX_PIXELS:
            raise ConfigError(f"expected --sizes of at most {MAX_PIXELS} pixels, got {word.strip()}")
        sizes.append((int(width), int(height)))
    return tuple(dict.fromkeys(sizes))


def _read(folders: tuple[str, ...]) -> dict[str, Frame]:
    """Read the frames of the folders and return them in a dict, indexed by frame name."""
    from spigolo.frames import files as io

    found = find_frames(folders or [str(DEMO_SCENE)])
    frames = {paths.name: io.read_frame(paths.color, paths.depth, paths.camera) for paths in found}
    if small := [name for name, frame in frames.items() if min(frame.shape) < 16]:
        raise FrameError(f"expected frames of at least 16x16 pixels to time, got {small[0]}")
    return frames


@contextmanager
def _progress() -> Iterator[Tell]:
    """Show a progress bar that is redrawn only between measurements, because redrawing in a background thread would
    change the measured times.
    """
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn

    columns = (TimeElapsedColumn(), BarColumn(), TextColumn("{task.description}"))
    with progress(*columns, auto_refresh=False, transient=True) as bar:
        task = bar.add_task("", total=1.0)

        def tell(what: str, done: float) -> None:
            bar.update(task, description=what, completed=done, refresh=True)

        yield tell


def _print(report: Report) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    from spigolo.lab.bench import tables

    console = Console(highlight=False, markup=False, width=None if sys.stdout.isatty() else 120)
    for table in tables(report):
        drawn = Table(box=SIMPLE_HEAD, show_header=any(table.head))
        for k, (name, side) in enumerate(zip(table.head, table.sides, strict=True)):
            drawn.add_column(name, justify=side, overflow="fold", no_wrap=k == 0)
        for row in table.rows:
            drawn.add_row(*(cell.text for cell in row))
        console.print(table.title, style="bold")
        console.print(drawn)
        if table.note:
            console.print(f"{table.note}\n", style="dim")


def _chart(report: Report) -> Color:
    from spigolo.view.chart import Curve, log_log

    pixels = [1e-6 * width * height for width, height in report.plan.sizes]
    curves = []
    for name, growth in report.growth.items():
        ordered = sorted(zip(pixels, growth.cpu_ms, strict=True))
        fit = "" if growth.pixels is None else f"\ngrows as N^{growth.pixels.exponent:.2f}"
        curves.append(Curve(name + fit, [x for x, _ in ordered], [y for _, y in ordered]))
    return log_log(
        curves,
        "Time per frame against number of pixels",
        "million pixels (dashed: time proportional to the number of pixels)",
        "CPU time, ms, one thread",
        f"{report.machine.cpu}; {report.contests[0].frame} rescaled, median of {report.plan.size_rounds} rounds",
    )
