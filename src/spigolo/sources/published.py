"""Source for published data sets in their original layout, and for folders with the file lists of the TUM data set."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from spigolo.errors import SpigoloError
from spigolo.frames.files import known_camera
from spigolo.frames.frame import Frame
from spigolo.lab.datasets import Entry, guess
from spigolo.lab.datasets.entry import ImageEntry
from spigolo.sources.base import SizedSource
from spigolo.sources.options import Options
from spigolo.sources.paths import distinct


class PublishedSource(SizedSource):
    """Source for a data set. Every frame gets a unique name.

    A camera or depth_scale in the options replaces the camera or depth_scale of the data set.
    """

    def __init__(self, folder: Path, options: Options) -> None:
        found = guess(folder)
        names = distinct([entry.name for entry in found], [entry.data_set for entry in found])
        self.entries = [replace(entry, name=name) for entry, name in zip(found, names, strict=True)]
        super().__init__(str(folder), options, len(self.entries))
        if options.camera is None:
            self.intrinsics = f"from the data set ({type(found).__name__})"

    def __getitem__(self, number: int) -> Frame:
        return self._read(self.entries[number])

    def name_of(self, number: int) -> str:
        """Return the name of a frame without reading the frame."""
        return self.entries[number].name

    def files_of(self, number: int) -> tuple[Path, ...]:
        """Return the paths of the files of a frame."""
        return self.entries[number].files

    def _frames(self) -> Iterator[Frame]:
        for entry in self.entries:
            try:
                frame = self._read(entry)
            except SpigoloError as error:
                self._skip(entry.name, error)
                continue
            yield frame

    def _read(self, entry: Entry) -> Frame:
        if isinstance(entry, ImageEntry) and self.options.camera is not None:
            entry = replace(entry, camera=None)  # the camera of the data set may have another image size
        return self._changed(entry.read())

    def _changed(self, frame: Frame) -> Frame:
        """Return a copy of a frame with the camera and the depth scale of the options."""
        camera, scale = self.options.camera, self.options.depth_scale
        if camera is None and scale is None:
            return frame
        height, width = frame.shape
        known = frame.camera
        if camera is not None:
            known, own_scale = known_camera(camera, width, height)
            scale = own_scale if scale is None else scale
        depth = frame.depth
        if scale is not None and frame.unit_m is not None:
            depth = depth * (scale / frame.unit_m)
        return Frame(frame.color, depth, known, frame.name, frame.stamp_ns)
