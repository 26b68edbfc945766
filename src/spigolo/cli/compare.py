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
    presets: Many = ("OBJECTS",),
    out: Out = Path("spigolo-compare.png"),
) -> int:
    """Segment one frame with several methods and draw their regions, numbers of objects and times next to each other.

    The paper's Figure 6 is a comparison of this kind. Example: `spigolo compare rgb.png depth.png --camera camera.json
    --methods rao2010 felzenszwalb2004 --presets TABLE OBJECTS`.

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
    presets
        Presets of toscana2016: names, such as TABLE for the paper's method, or TOML files. The objects of the first
        preset are drawn, too.
    out
        PNG file to write, or a folder in which compare.png is written.

    """
    from spigolo.frames import files as io
    from spigolo.methods import METHODS, Toscana2016
    from spigolo.settings.presets import preset as find
    from spigolo.view.comparison import comparison

    unknown = [name for name in methods if name not in METHODS]
    if unknown:
        raise ConfigError(f"unknown method {unknown[0]!r}: expected one or more of {', '.join(METHODS)}")
    if not presets:
        raise ConfigError("expected at least one preset of toscana2016, got none: leave out --presets for OBJECTS")
    others = {name: METHODS[name] for name in methods or METHODS if name != Toscana2016.name}
    ours = {f"{Toscana2016.name} {Path(word).stem}": Toscana2016(find(word)) for word in presets}
    paths = only_frame(find_frames(inputs or (str(DEMO_SCENE),)))
    frame = io.read_frame(paths.color, paths.depth, camera or paths.camera, depth_scale)
    if out.suffix.lower() in IMAGES and out.suffix.lower() != ".png":
        raise FileError(
            f"expected a PNG file or a folder for the picture, got {out}: use the name {out.with_suffix('.png')}"
        )
    picture = out if out.suffix.lower() == ".png" else out / "compare.png"
    answers = {}
    for name, method in {**others, **ours}.items():
        method(frame)  # the first run may compile kernels
        start = time.perf_counter()
        answers[name] = method(frame), time.perf_counter() - start
        print(f"{name}: {counted(len(answers[name][0]), 'object')}, {1e3 * answers[name][1]:.0f} ms")
    io.write_png(picture, comparison(frame, answers, next(iter(ours))))
    print(f"picture: {picture}")
    return DONE
