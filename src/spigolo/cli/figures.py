"""Command `figures`, which draws the paper's figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from spigolo.cli import DONE
from spigolo.cli.inputs import DEMO_SCENE, Out
from spigolo.sources.paths import find_frames

if TYPE_CHECKING:
    from spigolo.frames.frame import Frame


def figures(
    *inputs: str,
    preset: str = "TABLE",
    camera: str | None = None,
    depth_scale: float | None = None,
    out: Out = Path("spigolo-figures"),
) -> int:
    """Draw the paper's Figures 2 to 5 from your own frames: smoothing, saliency, boundaries and objects.

    Figures 2 to 4 show the first frame, and Figure 5 shows all frames. Example: `spigolo figures rgb.png depth.png
    --camera camera.json`.

    Parameters
    ----------
    inputs
        A colour image and a depth image, or folders in the layouts that `spigolo segment` reads. Default: the bundled
        demo scene.
    preset
        Preset for the objects in Figures 4 and 5: SHELF, TABLE or CLUTTER for the paper's method, the name of another
        preset, or a TOML file.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    depth_scale
        Metres per unit of the depth image. Default: the depth scale in the camera file.
    out
        Output folder for figure2.png, figure3.png, figure4.png and figure5.png.

    """
    from spigolo.frames import files as io
    from spigolo.pipeline import segment
    from spigolo.settings.presets import preset as find
    from spigolo.view import figures as draw

    config = find(preset)
    frames = read_all(inputs, camera, depth_scale)
    first = next(iter(frames.values()))
    pictures = {
        "figure2": draw.figure2(first),
        "figure3": draw.figure3(first),
        "figure4": draw.figure4(first, config),
        "figure5": draw.figure5({name: (frame, segment(frame, config)) for name, frame in frames.items()}),
    }
    for name, picture in pictures.items():
        io.write_png(out / f"{name}.png", picture)
        print(out / f"{name}.png")
    return DONE


def read_all(inputs: tuple[str, ...], camera: str | None, depth_scale: float | None) -> dict[str, Frame]:
    """Read the frames of the inputs and return them in a dict, indexed by frame name."""
    from spigolo.frames import files as io

    words = list(inputs) or [str(DEMO_SCENE)]
    return {p.name: io.read_frame(p.color, p.depth, camera or p.camera, depth_scale) for p in find_frames(words)}
