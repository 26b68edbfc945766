"""Command `tune`, which opens a web page to tune parameters interactively."""

from __future__ import annotations

from pathlib import Path

from spigolo.cli import DONE
from spigolo.cli.inputs import Inputs, Port, configure, split_flags
from spigolo.cli.opening import opened
from spigolo.cli.region import NO_REGION, RegionFlags
from spigolo.frames.frame import MAX_PIXELS
from spigolo.sources.base import counted


def tune(
    *inputs: Inputs,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    region: RegionFlags = NO_REGION,
    port: Port = 8080,
    host: str = "127.0.0.1",
    browser: bool = True,
    out: Path = Path(),
) -> int:
    """Open a web page to tune a preset interactively. The page shows the masks, the point cloud and a slider for each
    parameter.

    The command `tune` requires `pip install "spigolo[tune]"`. Ctrl-C stops the program. Example: `spigolo tune
    recordings/ --camera kinect-v1`.

    Parameters
    ----------
    inputs
        Source of the frames: colour and depth images, folders, a recording or a camera, in the forms that `spigolo
        segment` accepts. Each field of the preset can also be set with a flag, such as `--partition.gamma 0.004`.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    preset
        Preset to start from: the name of a preset, such as OBJECTS, or a TOML file.
    depth_scale
        Metres per unit of the depth image. Default: the depth scale in the camera file.
    region
        Region of interest: --roi, --roi-mask or --roi-box.
    port
        Port of the web server. If the port is in use, the next free port is used.
    host
        Network address on which the web server listens. By default, only this machine can open the page, because the
        page has no password.
    browser
        Open the page in a web browser.
    out
        Folder to which the button "save preset" writes. Default: the current folder.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, tune)
    from spigolo.view.tuning import tune as show

    with opened(words, camera, depth_scale) as source:
        page = show(source, config, region.read(MAX_PIXELS), port, host, open_browser=browser, folder=out, block=False)
        size = "live frames" if source.live else "frames" if source.count is None else counted(source.count, "frame")
        print(f"{page.url} shows {size}. Ctrl-C ends it.", flush=True)
        page.wait()
    return DONE
