"""Commands `presets`, `warmup` and `demo`, and the list of all commands."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import cyclopts

from spigolo import __version__
from spigolo.cli import DONE
from spigolo.cli.batch import batch
from spigolo.cli.bench import bench
from spigolo.cli.compare import compare
from spigolo.cli.datasets import datasets, fetch
from spigolo.cli.evaluate import evaluate, losses, report
from spigolo.cli.export import export, view
from spigolo.cli.figures import figures
from spigolo.cli.fit import fit
from spigolo.cli.inputs import DEMO_SCENE, Out
from spigolo.cli.render import render
from spigolo.cli.ros import ros
from spigolo.cli.segment import doctor, segment, trace
from spigolo.cli.tune import tune

if TYPE_CHECKING:
    from spigolo.frames.frame import Color
    from spigolo.pipeline import Trace
    from spigolo.settings.config import Config


app = cyclopts.App(
    name="spigolo",
    version=__version__,
    help="Find the objects in RGB-D frames for robotic grasping, without learning and without a GPU.",
    help_epilogue="Start with `spigolo demo`. Then run `spigolo doctor` and `spigolo segment` on a frame of your own.",
    suppress_keyboard_interrupt=False,
)
USING, MEASURING = cyclopts.Group("Using", sort_key=1), cyclopts.Group("Measuring", sort_key=2)
app["--help"].group = app["--version"].group = cyclopts.Group("About", sort_key=3)
app.command(segment, group=USING, sort_key=1)
app.command(batch, group=USING, sort_key=2)
app.command(trace, group=USING, sort_key=2)
app.command(doctor, group=USING, sort_key=3)
app.command(export, group=USING, sort_key=3)
app.command(view, group=USING, sort_key=3)
app.command(ros, group=USING, sort_key=7)
app.command(tune, group=USING, sort_key=3)
app.command(evaluate, group=MEASURING, sort_key=1)
app.command(report, group=MEASURING, sort_key=2)
app.command(losses, group=MEASURING, sort_key=2)
app.command(fit, group=MEASURING, sort_key=3)
app.command(datasets, group=MEASURING, sort_key=4)
app.command(fetch, group=MEASURING, sort_key=5)
app.command(render, group=MEASURING, sort_key=6)
app.command(bench, group=MEASURING, sort_key=7)
app.command(figures, group=MEASURING, sort_key=8)
app.command(compare, group=MEASURING, sort_key=9)


@app.command(group=USING, sort_key=4)
def presets(name: str | None = None, *, toml: bool = False) -> int:
    """List the presets, or list every field of one preset with its value and meaning.

    Every command with the flag `--preset` or `--presets` also accepts each field of a preset as a flag.

    Parameters
    ----------
    name
        Preset to show: OBJECTS, SHELF, TABLE, CLUTTER or a TOML file.
    toml
        Print the preset in TOML format. An edited TOML file can be passed to `--preset`.

    """
    from spigolo.settings.fields import field_names
    from spigolo.settings.presets import PRESETS, SUMMARIES
    from spigolo.settings.presets import preset as find

    if name is None:
        for key, config in PRESETS.items():
            print(f"{key:10s} {config.digest}  {SUMMARIES[key]}")
        return DONE
    config = find(name)
    if toml:
        print(config.to_toml(), end="")
        return DONE
    print(f"{config.name} {config.digest}")
    for field, meaning in field_names(config).items():
        print(f"  --{field.replace('_', '-')} {_value(config, field)}\n      {meaning}")
    return DONE


@app.command(group=USING, sort_key=6)
def warmup() -> int:
    """Compile the numerical kernels now, so that the first frame is segmented without delay.

    Run this command once when you build a container image or set up a robot.
    """
    import time

    start = time.perf_counter()
    from spigolo.stream import warm_up

    warm_up()
    print(f"ready in {time.perf_counter() - start:.1f} s")
    return DONE


@app.command(group=USING, sort_key=5)
def demo(*, out: Out = Path("spigolo-demo")) -> int:
    """Segment the bundled demo scene and draw colour, depth, boundaries and objects with their boxes.

    Parameters
    ----------
    out
        Output folder. The drawn image is the file demo.png in the output folder.

    """
    from spigolo import pipeline
    from spigolo.cli import show
    from spigolo.frames import files as io
    from spigolo.settings.presets import OBJECTS

    frame = io.read_frame(DEMO_SCENE / "rgb.png", DEMO_SCENE / "depth.png", DEMO_SCENE / "camera.json")
    run = pipeline.trace(frame, OBJECTS)
    show.write_result(run.segmentation, frame, out)
    io.write_png(out / "demo.png", _panels(run))
    show.print_result(run.segmentation, out)
    print(f"picture: {out / 'demo.png'}")
    return DONE


def _value(config: Config, field: str) -> object:
    from spigolo.settings.fields import value_at

    value = value_at(config, field)
    if isinstance(value, tuple):
        return ",".join(map(str, value))
    return "none" if value is None else "..." if hasattr(value, "model_fields") else value


def _panels(run: Trace) -> Color:
    from spigolo.view import overlay

    frame, result = run.frame, run.segmentation
    drawn = result.overlay()
    return overlay.tile(
        {
            "colour": frame.color,
            "depth (black: missing)": overlay.depth_picture(frame.depth),
            "boundaries of objects": overlay.boundary_picture(run),
            f"{len(result)} objects with their boxes": overlay.draw_boxes(drawn, result, frame.camera),
        },
        columns=2,
    )
