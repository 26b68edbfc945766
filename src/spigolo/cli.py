"""The command line: typed functions become verbs. The only module that prints and exits.

Heavy modules are imported inside the verbs, so that help is there at once.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts

from spigolo import __version__
from spigolo.errors import SpigoloError

if TYPE_CHECKING:
    from spigolo.frame import Color, Frame
    from spigolo.objects import Segmentation
    from spigolo.pipeline import Trace

DONE, FAILED = 0, 2

app = cyclopts.App(
    name="spigolo",
    version=__version__,
    help="Finds the objects in an RGB-D frame for a robot that wants to grasp them: no learning, no GPU.",
)


@app.command
def segment(
    rgb: Path,
    depth: Path,
    *,
    camera: Path,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    out: Annotated[Path, cyclopts.Parameter(alias="-o")] = Path("spigolo-out"),
) -> int:
    """Segments one frame and writes labels.png, objects.json and overlay.png.

    Parameters
    ----------
    rgb
        Colour image.
    depth
        16-bit depth PNG of the same size, registered to the colour image; 0 = missing.
    camera
        JSON file with fx, fy, cx, cy, width, height (pixels) and, if you like, depth_scale.
    preset
        OBJECTS for your own data; SHELF, TABLE or CLUTTER for the paper's; or a TOML file.
    depth_scale
        Metres per unit of the depth image: 0.001 for millimetres. Default: that of the camera file.
    out
        Folder for the results: labels.png (16-bit, 0 = background, 1..N = objects), objects.json, overlay.png.

    """
    from spigolo import io, pipeline, presets

    config = presets.preset(preset)
    frame = io.read_frame(rgb, depth, camera, depth_scale)
    _announce_compilation()
    result = pipeline.segment(frame, config)
    _write(result, frame, out)
    _show(result, out)
    return DONE


@app.command
def demo(*, out: Annotated[Path, cyclopts.Parameter(alias="-o")] = Path("spigolo-demo")) -> int:
    """Segments the bundled scene and draws what happened: colour, depth, boundaries, objects with their boxes.

    Parameters
    ----------
    out
        Folder for the results; demo.png is the picture to look at.

    """
    from spigolo import io, pipeline
    from spigolo.presets import OBJECTS

    scene = Path(__file__).parent / "demo_scene"
    frame = io.read_frame(scene / "rgb.png", scene / "depth.png", scene / "camera.json")
    _announce_compilation()
    trace = pipeline.trace(frame, OBJECTS)
    _write(trace.segmentation, frame, out)
    io.write_png(out / "demo.png", _panels(trace))
    _show(trace.segmentation, out)
    print(f"picture: {out / 'demo.png'}")
    return DONE


def main() -> None:
    """Entry point: 0 when done, 2 with one sentence when the input is at fault."""
    try:
        code = app(result_action="return_value", exit_on_error=False, print_error=True)
    except SpigoloError as error:
        print(f"spigolo: {error}", file=sys.stderr)
        code = FAILED
    except cyclopts.CycloptsError:
        code = FAILED  # already printed
    sys.exit(code)


def _announce_compilation() -> None:
    from spigolo.kernels import _jit

    if _jit.CACHE_FOLDER is None or not any(_jit.CACHE_FOLDER.iterdir()):
        print("compiling the kernels, once on this machine: about 20 s", file=sys.stderr, flush=True)


def _write(result: Segmentation, frame: Frame, out: Path) -> None:
    import numpy as np

    from spigolo import export, io
    from spigolo.view.overlay import overlay

    io.write_png(out / "labels.png", result.labels.astype(np.uint16))
    io.write_json(out / "objects.json", export.to_json(result))
    io.write_png(out / "overlay.png", overlay(result, frame.color))


def _panels(trace: Trace) -> Color:
    from spigolo.view import overlay as view

    frame, result = trace.frame, trace.segmentation
    drawn = view.overlay(result, frame.color)
    return view.tile(
        {
            "colour": frame.color,
            "depth (black: missing)": view.depth_picture(frame.depth),
            "boundaries of objects": view.boundary_picture(trace.cues),
            f"{len(result)} objects with their boxes": view.draw_boxes(drawn, result, frame.camera),
        },
        columns=2,
    )


def _show(result: Segmentation, out: Path) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(
        "object", "pixels", "centroid x, y, z (m)", "size (m)", "missing depth", box=None, header_style="bold"
    )
    for o in result:
        box = o.oriented_box()
        centroid = "-" if o.centroid_m is None else " ".join(f"{v:.3f}" for v in o.centroid_m)
        size = "-" if box is None else " x ".join(f"{v:.2f}" for v in box.size_m)
        table.add_row(str(o.label), str(o.area_px), centroid, size, f"{o.missing:.0%}")
    console = Console()
    if len(result):
        console.print(table)
    print(f"{len(result)} objects, {len(result.rejected)} regions rejected ({result.preset} {result.digest})")
    for region in result.rejected:
        print(f"  rejected {region.area_px} px at {region.box_px}: {region.why}")
    print(f"written: {out / 'labels.png'}, {out / 'objects.json'}, {out / 'overlay.png'}")
