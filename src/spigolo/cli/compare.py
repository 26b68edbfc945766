"""Command `compare`, which draws the results of several segmentation methods next to each other."""

from __future__ import annotations

import time
from pathlib import Path

from spigolo.cli import DONE
from spigolo.cli.inputs import DEMO_SCENE, Many, Out
from spigolo.errors import ConfigError, FileError
from spigolo.sources.base import counted
from spigolo.sources.paths import IMAGES, find_frames, only_frame


def compare(
    *inputs: str,
    camera: str | None = None,
    depth_scale: float | None = None,
    methods: Many = (),
    out: Out = Path("spigolo-compare.png"),
) -> int:
    """Segment one frame with several methods and draw their regions, numbers of objects and times next to each other.

    Example: `spigolo compare rgb.png depth.png --camera camera.json --methods rao2010 felzenszwalb2004`.

    Parameters
    ----------
    inputs
        Frame to segment: a colour image and a depth image, or a folder with both images. Default: the bundled demo
        scene.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    depth_scale
        Metres per unit of the depth image. Default: the depth scale in the camera file.
    methods
        Names of the methods to compare with toscana2016, the method of this package. Default: all methods.
    out
        PNG file to write, or a folder in which compare.png is written.

    """
    from spigolo.frames import files as io
    from spigolo.methods import METHODS, Toscana2016
    from spigolo.view.comparison import comparison

    ours = Toscana2016.name
    unknown = [name for name in methods if name not in METHODS]
    if unknown:
        raise ConfigError(f"unknown method {unknown[0]!r}: expected one or more of {', '.join(METHODS)}")
    paths = only_frame(find_frames(inputs or (str(DEMO_SCENE),)))
    frame = io.read_frame(paths.color, paths.depth, camera or paths.camera, depth_scale)
    if out.suffix.lower() in IMAGES and out.suffix.lower() != ".png":
        raise FileError(
            f"expected a PNG file or a folder for the picture, got {out}: use the name {out.with_suffix('.png')}"
        )
    picture = out if out.suffix.lower() == ".png" else out / "compare.png"
    answers = {}
    for name in [*(name for name in methods or METHODS if name != ours), ours]:
        METHODS[name](frame)  # the first run may compile kernels
        start = time.perf_counter()
        answers[name] = METHODS[name](frame), time.perf_counter() - start
        print(f"{name}: {counted(len(answers[name][0]), 'object')}, {1e3 * answers[name][1]:.0f} ms")
    io.write_png(picture, comparison(frame, answers, ours))
    print(f"picture: {picture}")
    return DONE
