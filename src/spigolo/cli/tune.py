"""Verb `tune`, which opens a page for tuning parameters interactively."""

from __future__ import annotations

from pathlib import Path

from spigolo.cli import DONE
from spigolo.cli.inputs import Inputs, configure, split_flags
from spigolo.cli.opening import opened
from spigolo.sources.base import counted


def tune(
    *inputs: Inputs,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    port: int = 8080,
    host: str = "127.0.0.1",
    browser: bool = True,
    out: Path = Path(),
) -> int:
    """Open a page with a slider for each parameter, the masks and the point cloud, to tune a preset interactively.

    Needs `pip install "spigolo[tune]"`. Example: `spigolo tune recordings/ --camera kinect-v1`. Ctrl-C ends it.

    Parameters
    ----------
    inputs
        Colour and depth images, folders, a recording or a camera, as for `segment`. Fields of the preset are flags too.
    camera
        Intrinsics, as for `segment`.
    preset
        Preset to start from, as for `segment`.
    depth_scale
        Metres per unit of the depth image. Default: the value in the camera file.
    port
        Port of the page. If it is taken, the next free one is used.
    host
        Address to listen on. Default: only this machine. The page has no password.
    browser
        Open the page in a browser.
    out
        Folder that "save preset" writes to. Default: the current folder.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, tune)
    from spigolo.view.tuning import tune as show

    with opened(words, camera, depth_scale) as source:
        page = show(source, config, port, host, open_browser=browser, folder=out, block=False)
        size = "live frames" if source.live else "frames" if source.count is None else counted(source.count, "frame")
        print(f"{page.url} shows {size}. Ctrl-C ends it.", flush=True)
        page.wait()
    return DONE
