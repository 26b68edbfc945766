"""Printed tables, printed messages and files that the commands write."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.progress import track
from rich.table import Table

from spigolo.frames import files as io
from spigolo.sources.base import counted

if TYPE_CHECKING:
    from spigolo.doctor import Diagnosis
    from spigolo.frames.frame import Frame
    from spigolo.objects.segmentation import Segmentation
    from spigolo.settings.config import Config
    from spigolo.sources.base import Source

MOST_REJECTED = 10
"""Maximum number of rejected regions that are printed, largest first. The file objects.json contains all rejected
regions.
"""


def progress(source: Source, what: str) -> Iterable[Frame]:
    """Return the frames of a source as an iterator that shows a progress bar on the error stream."""
    console, total = Console(stderr=True), source.count
    return track(source, description=what, total=total, console=console, disable=not sys.stderr.isatty())


def write_result(result: Segmentation, frame: Frame, out: Path) -> None:
    """Write labels.png, objects.json and overlay.png to a folder, and undistorted.png if the camera has distortion."""
    picture = result.overlay()
    io.write_png(out / "labels.png", result.labels.astype(np.uint16))
    io.write_json(out / "objects.json", result.to_dict())
    io.write_png(out / "overlay.png", picture)
    if frame.undistorted:
        io.write_png(out / "undistorted.png", frame.color)


def write_array(path: Path, array: npt.NDArray[np.generic]) -> None:
    """Write an array to a .npy file. An interrupted write leaves no incomplete file."""
    buffer = BytesIO()
    np.save(buffer, array)
    io.write_bytes(path, buffer.getvalue())


@contextmanager
def warnings_of(name: str) -> Iterator[None]:
    """Put the name of a frame before each warning that is issued inside the `with` block. Equal warnings of a frame are
    printed once.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", append=True)  # filters that ignore a warning keep their effect
        try:
            yield
        finally:
            for message in dict.fromkeys(str(warning.message) for warning in caught):
                print(f"spigolo: warning: {name}: {message}", file=sys.stderr)


def print_result(result: Segmentation, out: Path) -> None:
    """Print one line for each object, the rejected regions with reasons, and the names of the written files."""
    table = Table("object", "score", "pixels", "centroid x, y, z (m)", "size (m)", "missing depth", box=None)
    for o in result:
        box = o.oriented_box()
        centroid = "-" if o.centroid_m is None else " ".join(f"{v:.3f}" for v in o.centroid_m)
        size = "-" if box is None else " x ".join(f"{v:.2f}" for v in box.size_m)
        table.add_row(str(o.label), f"{o.score:.2f}", str(o.area_px), centroid, size, f"{o.missing:.0%}")
    if len(result):
        Console().print(table)
    rejected = counted(len(result.rejected), "region")
    print(f"{counted(len(result), 'object')}, {rejected} rejected ({result.preset} {result.digest})")
    for region in sorted(result.rejected, key=lambda r: -r.area_px)[:MOST_REJECTED]:
        print(f"  rejected {region.area_px} px at {region.box_px}: {region.why}")
    if len(result.rejected) > MOST_REJECTED:
        more = counted(len(result.rejected) - MOST_REJECTED, "smaller region")
        print(f"  and {more}: {out / 'objects.json'} lists all of them")
    if result.left_out:
        print(f"left out, because no intrinsics were given: {', '.join(result.left_out)}")
        print("far more objects are found with an estimated field of view: --camera 60deg")
    print(f"written: {out / 'labels.png'}, {out / 'objects.json'}, {out / 'overlay.png'}")


def print_without_intrinsics(without: int, count: int) -> None:
    """Print how many frames lack intrinsics, and which results are therefore missing."""
    if without:
        print(
            f"no intrinsics for {without} of {count} frames: results in metres, the support plane and contact"
            " boundaries are left out. Give --camera, or put camera.json into the folder"
        )


def print_diagnosis(diagnosis: Diagnosis) -> None:
    """Print one line for each finding of a diagnosis, and then the checks that are not possible with this frame."""
    marks = {"ok": "[green]ok     [/]", "note": "[cyan]note   [/]", "warning": "[bold red]warning[/]"}
    console = Console(highlight=False, soft_wrap=True)
    for finding in diagnosis.findings:
        mark = marks[finding.severity.value] if finding.judged else "[bold yellow]unknown[/]"
        console.print(f"{mark} [bold]{finding.check}[/]: {finding.sentence}", markup=True)
    if diagnosis.unjudged:
        names = ", ".join(finding.check for finding in diagnosis.unjudged)
        console.print(
            f"[bold yellow]could not be judged[/]: {names}. The frame lacks the evidence: check these points yourself"
        )


def warn_of(diagnosis: Diagnosis, name: str, config: Config) -> None:
    """Print the warnings of a frame's diagnosis on the error stream.

    The warning about missing intrinsics is not printed, because `print_result` reports missing intrinsics. The warning
    about the support plane is not printed if the preset states the direction that points up.
    """
    from spigolo.doctor.findings import INTRINSICS
    from spigolo.doctor.planarity import SUPPORT

    support = config.additions and config.additions.support
    told_up = support and support.facing and support.facing.up
    known = {INTRINSICS, SUPPORT} if told_up else {INTRINSICS}
    for finding in diagnosis.warnings:
        if finding.check not in known:
            print(f"spigolo: warning: {name}: {finding.sentence}", file=sys.stderr)
