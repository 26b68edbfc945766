"""The verb tune: a page on which parameters are tuned by looking."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, overload

from spigolo.cli import DONE
from spigolo.cli.inputs import Inputs, configure, split_flags
from spigolo.sources.paths import FramePaths, find_frames

if TYPE_CHECKING:
    from spigolo.frames.frame import Frame


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
    """Tune the parameters by looking: a page with a slider for each, the masks and the cloud.

    Needs `pip install "spigolo[tune]"`. Example: `spigolo tune recordings/ --camera kinect-v1`. Ctrl-C ends it.

    Parameters
    ----------
    inputs
        Colour and depth images, or folders, as for `segment`. Fields of the preset are flags too.
    camera
        Intrinsics, as for `segment`.
    preset
        Preset to start from, as for `segment`.
    depth_scale
        Metres per unit of the depth image. Default: the value in the camera file.
    port
        Port of the page. If it is taken, the next free one is used.
    host
        Address to listen on. The default is this machine alone. The page has no password.
    browser
        Open the page in a browser.
    out
        Folder that "save preset" writes to. Default: the current folder.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, tune)
    frames = FilesInTurn(find_frames(words), camera, depth_scale)
    from spigolo.view.tuning import tune as show

    page = show(frames, config, port, host, open_browser=browser, folder=out, block=False)
    print(f"{page.url} shows {len(frames)} frame{'' if len(frames) == 1 else 's'}. Ctrl-C ends it.", flush=True)
    page.wait()
    return DONE


class FilesInTurn(Sequence["Frame"]):
    """Frames of files, each read when it is asked for."""

    def __init__(self, paths: Sequence[FramePaths], camera: str | None, depth_scale: float | None) -> None:
        self._paths, self._camera, self._scale = paths, camera, depth_scale

    def __len__(self) -> int:
        return len(self._paths)

    @overload
    def __getitem__(self, index: int) -> Frame: ...

    @overload
    def __getitem__(self, index: slice) -> FilesInTurn: ...

    def __getitem__(self, index: int | slice) -> Frame | FilesInTurn:
        if isinstance(index, slice):
            return FilesInTurn(self._paths[index], self._camera, self._scale)
        from spigolo.frames.files import read_frame

        paths = self._paths[index]
        given = self._camera if self._camera is not None else paths.camera
        return read_frame(paths.color, paths.depth, given, self._scale)
