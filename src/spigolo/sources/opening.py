"""Function `open_source`, which opens a source by its name."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

from spigolo.errors import FileError
from spigolo.frames.intrinsics import CameraLike
from spigolo.frames.listing import OPENED, listed
from spigolo.sources.base import Source
from spigolo.sources.options import Options, options_from

Uri = str | os.PathLike[str]


def open_source(
    uri: Uri | Sequence[Uri], camera: CameraLike = None, depth_scale: float | None = None, **options: Any
) -> Source:
    """Open a source of frames by its name. A source is an iterable, and should be used inside `with`.

    uri: image files (colour and depth), a folder of frames, a data set (`dataset:FOLDER`), a ROS bag (.bag, .db3,
    .mcap, or its folder), `realsense:`, `realsense:SERIAL`, `realsense:RECORDING`, `openni:` or `openni:ADDRESS`.
    Options may follow after `?`: `recording.mcap?color=/camera/color/image_raw&tolerance_ms=5`. camera: intrinsics in
    any form that `read_frame` accepts. If None, the intrinsics of the source are used. depth_scale: metres per unit of
    integer depth. options: fields of `spigolo.sources.options.Options`. Raises FileError.
    """
    words = [uri] if isinstance(uri, str | os.PathLike) else list(uri)
    given = {"camera": camera, "depth_scale": depth_scale, **options}
    if len(words) != 1:
        return _folders([os.fspath(word) for word in words], options_from({}, given))
    name, after = _parted(os.fspath(words[0]))
    return _open(name, options_from(after, given))


def is_recording(path: Path) -> bool:
    """Return True if a path is a ROS bag: a file with the suffix of a bag, or a folder with metadata.yaml and bag
    files.
    """
    if path.is_dir():
        return (path / "metadata.yaml").is_file() and any(_bags_in(path))
    return path.suffix.lower() in OPENED


def _parted(name: str) -> tuple[str, dict[str, str]]:
    """Split a source name at `?` into the name and its options. A name that contains `?` is not split if it is the path
    of an existing file.
    """
    before, mark, after = name.partition("?")
    if not mark or Path(name).exists():
        return name, {}
    return before, dict(parse_qsl(after, keep_blank_values=True))


def _open(name: str, options: Options) -> Source:
    kind, colon, rest = name.partition(":")
    if colon and kind == "realsense":
        return _realsense(rest, options)
    if colon and kind == "openni":
        from spigolo.sources.openni import OpenNICamera

        return OpenNICamera(rest, options)
    if colon and kind == "dataset":
        from spigolo.sources.published import PublishedSource

        return PublishedSource(Path(rest), options)
    path = Path(name)
    if is_recording(path):
        return _bag(path, options)
    return _folder(path, options) if path.is_dir() else _folders([name], options)


def _folder(path: Path, options: Options) -> Source:
    """Return the source for a folder. The folder contains frames, a single bag or a published data set."""
    from spigolo.lab.datasets import Tum

    if Tum.matches(path):
        from spigolo.sources.published import PublishedSource

        return PublishedSource(path, options)
    try:
        return _folders([str(path)], options)
    except FileError as error:
        bags = _bags_in(path)
        if len(bags) == 1:
            return _bag(bags[0], options)
        return _published(path, options, error)


def _published(path: Path, options: Options, error: FileError) -> Source:
    from spigolo.sources.published import PublishedSource

    try:
        return PublishedSource(path, options)
    except FileError:
        raise error from None  # the error of `_folders` explains which folders are accepted


def _bag(path: Path, options: Options) -> Source:
    """Return the source for a bag. Recordings of the RealSense SDK are opened with the SDK, which aligns depth to
    colour.
    """
    from spigolo.sources.bag_files import is_of_realsense
    from spigolo.sources.bags import BagSource

    if not path.exists():
        raise FileError(f"expected a recording, but there is no {path}")
    if options.color is None and options.depth is None and path.is_file() and is_of_realsense(path):
        return _realsense(str(path), options)
    return BagSource(path, options)


def _realsense(rest: str, options: Options) -> Source:
    from spigolo.sources.realsense import RealSenseCamera, RealSenseRecording

    if Path(rest).suffix.lower() in OPENED:
        return RealSenseRecording(Path(rest), options)
    return RealSenseCamera(rest, options)


def _folders(words: Sequence[str], options: Options) -> Source:
    from spigolo.sources.folders import FolderSource

    return FolderSource(words, options)


def _bags_in(path: Path) -> list[Path]:
    return [one for one in listed(path) if one.suffix.lower() in OPENED]
