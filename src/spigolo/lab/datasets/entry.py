"""Interface of data sets: a sized sequence of entries. An entry is a frame before it is read, with its properties.

Letters used in shapes: H, W = image.
"""

from __future__ import annotations

import zlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError, FrameError
from spigolo.frames.camera import Camera
from spigolo.frames.files import read_camera, read_color, read_depth
from spigolo.frames.frame import Frame, Mask
from spigolo.frames.scale import check_scale
from spigolo.lab.datasets.sample import Instance, Sample

Labelling = Literal["full", "part", "none"]
"""Extent of the labels in a frame: every object, some objects, or none."""

FULL_SETS = ("osd-*", "hand-uoc")
"""Patterns of data sets in which every object is labelled, for layouts that do not say it."""
MILLIMETRES = 0.001
RENDERED = "rendered.json"
"""Name of the file that marks a set of rendered frames."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Ground truth. labels (H, W): 0 = background, other values = objects. ignore (H, W) bool: pixels not evaluated.

    names: object names indexed by label, if the set has them.
    """

    labels: npt.NDArray[np.integer[Any]]
    ignore: Mask
    names: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Entry(ABC):
    """Frame of a data set before it is read. An entry is small and can be sent to other processes.

    data_set and name: unique together. group: name shared by near-identical frames, such as those of one video.
    """

    data_set: str
    name: str
    group: str
    labelling: Labelling

    @property
    @abstractmethod
    def files(self) -> tuple[Path, ...]:
        """Paths of all files that the entry needs, ground truth last."""

    @property
    def reading(self) -> str:
        """Return the settings outside the files that affect the labels. "" for ordinary sets."""
        return ""

    @property
    def content(self) -> str:
        """Return a checksum of the files and `reading`, eight hexadecimal digits. Raises FileError."""
        value = zlib.crc32(self.reading.encode())
        for path in self.files:
            try:
                value = zlib.crc32(path.read_bytes(), value)
            except OSError as error:
                raise FileError(f"expected {path}, but it cannot be read: {error.strerror or error}") from None
        return f"{value:08x}"

    @abstractmethod
    def read(self) -> Frame:
        """Return the frame. Raises FileError, FrameError or CameraError."""

    @abstractmethod
    def read_truth(self) -> Truth | None:
        """Return the labels. None without labels. Raises FileError or FrameError."""

    def read_instances(self) -> tuple[Instance, ...]:
        """Return the objects with their poses. () without poses. Raises FileError."""
        return ()

    def read_both(self) -> tuple[Frame, Truth | None]:
        """Return frame and labels. Raises FrameError also if their sizes differ."""
        frame, truth = self.read(), self.read_truth()
        if truth is not None and truth.labels.shape != frame.shape:
            raise FrameError(
                f"expected labels of {frame.shape[1]} x {frame.shape[0]} pixels as the colour image has, got"
                f" {truth.labels.shape[1]} x {truth.labels.shape[0]} in {self.files[-1]}"
            )
        return frame, truth

    def read_sample(self) -> Sample:
        """Return frame, labels and poses. `labels` is 0 for a frame without labels, and for ignored pixels."""
        frame, truth = self.read_both()
        labels = np.zeros(frame.shape, np.int32) if truth is None else truth.labels
        return Sample(frame, labels, self.read_instances())


@dataclass(frozen=True, slots=True)
class ImageEntry(Entry):
    """Colour image with a depth image. depth_scale: metres per stored unit. Subclasses add labels."""

    color: Path
    depth: Path
    camera: Camera | None
    depth_scale: float

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of colour and depth."""
        return self.color, self.depth

    def read(self) -> Frame:
        """Return the frame. Raises FileError, FrameError or CameraError."""
        return Frame(
            read_color(self.color), read_depth(self.depth), self.camera, self.name, depth_scale=self.depth_scale
        )

    def read_truth(self) -> Truth | None:
        """Return None, as there are no labels."""
        return None


class DataSet(ABC):
    """Entries of a folder. Entries are found when the data set is opened, and frames are read on request.

    full: patterns such as "osd-*" of data sets in which every object is labelled, for layouts that do not say it.
    Raises FileError if the folder does not match `layout`, or if an entry lacks a file.
    """

    layout: ClassVar[str]
    """Description of the folder's content, for messages."""
    mend: ClassVar[str] = "fetch or unpack the set again"
    """Advice if a file is missing."""

    def __init__(self, folder: Path | str, full: Sequence[str] = FULL_SETS) -> None:
        self.folder = existing_folder(folder)
        self._full = full
        self._entries = tuple(self._find())
        if not self._entries:
            raise FileError(f"expected {self.layout} in {folder}, got none")
        _require_files(self._entries, self.mend)

    @classmethod
    @abstractmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder looks like this layout."""

    @abstractmethod
    def _find(self) -> Iterable[Entry]:
        """Yield the entries in their order."""

    @property
    def rendered(self) -> bool:
        """Return True if the frames are rendered stand-ins."""
        return (self.folder / RENDERED).is_file()

    def __len__(self) -> int:
        return len(self._entries)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries)

    def __getitem__(self, number: int) -> Entry:
        return self._entries[number]

    def _named(self, name: str) -> str:
        """Return the name of the set. Stand-ins have a different name."""
        return f"{name}-rendered" if self.rendered else name

    def _labelled(self, data_set: str) -> Labelling:
        """Return the extent of the labels, by the patterns in `full`."""
        return "full" if any(fnmatch(data_set, pattern) for pattern in self._full) else "part"

    def _camera(self, usual: Camera, scale: float, folder: Path | None = None) -> tuple[Camera, float]:
        """Return camera and depth_scale from camera.json in the set's folder, or else the known ones of the set.

        folder: another folder that is searched first, such as that of a sequence. Raises CameraError for an impossible
        scale. Raises FileError for distortion, because labels of a published set would not be undistorted with its
        images.
        """
        places = [place / "camera.json" for place in (folder, self.folder) if place is not None]
        path = next((place for place in places if place.is_file()), None)
        if path is None:
            return usual, scale
        camera, own = read_camera(path, usual.width, usual.height)
        if camera.distortion:
            raise FileError(f"expected a camera without distortion in {path}, got one with: undistort the images first")
        if own is not None:
            check_scale(own, path)
        return camera, scale if own is None else own


def existing_folder(folder: Path | str) -> Path:
    """Return the absolute path of a folder. Raises FileError if it does not exist."""
    if not Path(folder).is_dir():
        raise FileError(f"expected a folder of frames, but there is no folder {folder}")
    return Path(folder).resolve()


def _require_files(entries: Iterable[Entry], mend: str) -> None:
    """Raise FileError for an incomplete download, before any frame is read."""
    lacking = [(entry, path) for entry in entries for path in entry.files if not path.is_file()]
    if lacking:
        entry, path = lacking[0]
        more = f" ({len(lacking)} files are missing in all)" if len(lacking) > 1 else ""
        raise FileError(
            f"expected {path} with frame {entry.name} of {entry.data_set}, but there is no such file{more}: {mend}"
        )
