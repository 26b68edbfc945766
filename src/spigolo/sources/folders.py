"""Source for image files and folders."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from spigolo.errors import SpigoloError
from spigolo.frames.files import read_frame
from spigolo.frames.frame import Frame
from spigolo.sources.base import SizedSource
from spigolo.sources.options import Options
from spigolo.sources.paths import FramePaths, find_frames


class FolderSource(SizedSource):
    """Source for image files and folders. The frames keep the order in which the files are listed."""

    def __init__(self, words: Sequence[str], options: Options) -> None:
        self.paths = find_frames(words)
        self._options = options
        found = self.paths[0].camera
        super().__init__(words[0] if len(words) == 1 else self.paths[0].name, options, len(self.paths))
        if options.camera is None and found is not None:
            self.intrinsics = str(found)

    def __getitem__(self, number: int) -> Frame:
        return self._read(self.paths[number])

    def name_of(self, number: int) -> str:
        """Return the name of a frame without reading the frame."""
        return self.paths[number].name

    def files_of(self, number: int) -> tuple[Path, ...]:
        """Return the paths of the images of a frame and of its camera file."""
        paths = self.paths[number]
        return (paths.color, paths.depth) if paths.camera is None else (paths.color, paths.depth, paths.camera)

    def _frames(self) -> Iterator[Frame]:
        for paths in self.paths:
            try:
                frame = self._read(paths)
            except SpigoloError as error:
                self._skip(paths.name, error)
                continue
            yield frame

    def _read(self, paths: FramePaths) -> Frame:
        own = self._options
        given = own.camera if own.camera is not None else paths.camera
        return read_frame(paths.color, paths.depth, given, own.depth_scale, name=paths.name, max_pixels=own.max_pixels)
