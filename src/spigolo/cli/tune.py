"""Verb `tune`, which opens a page for tuning parameters interactively."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, overload

from spigolo.cli import DONE
from spigolo.cli.inputs import Inputs, configure, split_flags
from spigolo.cli.opening import opened
from spigolo.sources.paths import FramePaths, find_frames

if TYPE_CHECKING:
    from spigolo.frames.frame import Frame
    from spigolo.sources.base import Source


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
        frames = frames_of(source, words, camera, depth_scale)
        page = show(frames, config, port, host, open_browser=browser, folder=out, block=False)
        size = "live frames" if source.live else "frames" if source.count is None else f"{source.count} frames"
        print(f"{page.url} shows {'1 frame' if source.count == 1 else size}. Ctrl-C ends it.", flush=True)
        page.wait()
    return DONE


def frames_of(
    source: Source, words: Sequence[str], camera: str | None = None, depth_scale: float | None = None
) -> Iterable[Frame]:
    """Return the frames that a page shows: any of several files, or the frames of a recording or camera in order."""
    from spigolo.sources.folders import FolderSource

    return FilesInTurn(find_frames(words), camera, depth_scale) if isinstance(source, FolderSource) else source


class FilesInTurn(Sequence["Frame"]):
    """Sequence of frames in files. Each frame is read when it is requested."""

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
