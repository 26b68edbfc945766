"""Interface of data sets: a sized sequence of entries, each a frame that is not yet read, with its facts.

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
"""Which objects of a frame are labelled: every one, some, none."""

FULL_SETS = ("osd-*", "hand-uoc")
"""Sets on which every object is labelled, where nothing else says it."""
MILLIMETRES = 0.001
RENDERED = "rendered.json"
"""Lies in the folder of a set whose frames are rendered rather than photographed."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """labels (H, W): 0 = background, other values = objects. ignore (H, W) bool: neither right nor wrong.

    names: what the objects are, by label, where the set says it.
    """

    labels: npt.NDArray[np.integer[Any]]
    ignore: Mask
    names: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Entry(ABC):
    """A frame of a data set before it is read. Small, and can be sent to other processes.

    data_set and name: unique together. group: shared by near-identical frames, as those of one video.
    """

    data_set: str
    name: str
    group: str
    labelling: Labelling

    @property
    @abstractmethod
    def files(self) -> tuple[Path, ...]:
        """The files that it needs. Truth last."""

    @property
    def reading(self) -> str:
        """Return everything outside its files that decides how its labels are read. "" in ordinary sets. "" where
        nothing is out of the ordinary.
        """
        return ""

    @property
    def content(self) -> str:
        """A checksum of its files and its `reading`, eight hexadecimal digits. Raises FileError."""
        value = zlib.crc32(self.reading.encode())
        for path in self.files:
            try:
                value = zlib.crc32(path.read_bytes(), value)
            except OSError as error:
                raise FileError(f"expected {path}, but it cannot be read: {error.strerror or error}") from None
        return f"{value:08x}"

    @abstractmethod
    def read(self) -> Frame:
        """The frame. Raises FileError, FrameError or CameraError."""

    @abstractmethod
    def read_truth(self) -> Truth | None:
        """Its labels, None if it has none. Raises FileError or FrameError."""

    def read_instances(self) -> tuple[Instance, ...]:
        """Its objects with their poses, () where the set has none. Raises FileError."""
        return ()

    def read_both(self) -> tuple[Frame, Truth | None]:
        """Frame and labels. Raises FrameError also if they differ in size."""
        frame, truth = self.read(), self.read_truth()
        if truth is not None and truth.labels.shape != frame.shape:
            raise FrameError(
                f"expected labels of {frame.shape[1]} x {frame.shape[0]} pixels as the colour image has, got"
                f" {truth.labels.shape[1]} x {truth.labels.shape[0]} in {self.files[-1]}"
            )
        return frame, truth

    def read_sample(self) -> Sample:
        """Frame, labels and poses. `labels` is 0 for a frame without labels, and for ignored pixels."""
        frame, truth = self.read_both()
        labels = np.zeros(frame.shape, np.int32) if truth is None else truth.labels
        return Sample(frame, labels, self.read_instances())


@dataclass(frozen=True, slots=True)
class ImageEntry(Entry):
    """A colour image with a depth image, depth_scale metres per stored unit. No labels, unless a layout adds them."""

    color: Path
    depth: Path
    camera: Camera
    depth_scale: float

    @property
    def files(self) -> tuple[Path, ...]:
        """Colour and depth."""
        return self.color, self.depth

    def read(self) -> Frame:
        """The frame. Raises FileError, FrameError or CameraError."""
        return Frame(
            read_color(self.color), read_depth(self.depth), self.camera, self.name, depth_scale=self.depth_scale
        )

    def read_truth(self) -> Truth | None:
        """None."""
        return None


class DataSet(ABC):
    """The entries of a folder, found when it is opened and read when they are asked for.

    full: sets on which every object is labelled, as patterns such as "osd-*", where the layout does not say.
    Raises FileError if the folder does not hold what `layout` says, or an entry lacks a file.
    """

    layout: ClassVar[str]
    """Content of the folder, for messages."""
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
        """True if the folder looks like this layout."""

    @abstractmethod
    def _find(self) -> Iterable[Entry]:
        """The entries in their order."""

    @property
    def rendered(self) -> bool:
        """True if its frames are rendered stand-ins rather than photographs."""
        return (self.folder / RENDERED).is_file()

    def __len__(self) -> int:
        return len(self._entries)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries)

    def __getitem__(self, number: int) -> Entry:
        return self._entries[number]

    def _named(self, name: str) -> str:
        """Name of the set. Stand-ins have one of their own."""
        return f"{name}-rendered" if self.rendered else name

    def _labelled(self, data_set: str) -> Labelling:
        """True if all of its objects are labelled or some, by the patterns."""
        return "full" if any(fnmatch(data_set, pattern) for pattern in self._full) else "part"

    def _camera(self, usual: Camera, scale: float, folder: Path | None = None) -> tuple[Camera, float]:
        """Return camera and depth_scale of camera.json in the set's folder, or those known for the set without one.

        folder: another place to look first, such as that of a sequence. Raises CameraError for an impossible scale, and
        FileError for distortion: labels of a published set would not be undistorted with its images.
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
    """Its full path. Raises FileError if there is none."""
    if not Path(folder).is_dir():
        raise FileError(f"expected a folder of frames, but there is no folder {folder}")
    return Path(folder).resolve()


def _require_files(entries: Iterable[Entry], mend: str) -> None:
    """Report an incomplete download at once."""
    lacking = [(entry, path) for entry in entries for path in entry.files if not path.is_file()]
    if lacking:
        entry, path = lacking[0]
        more = f" ({len(lacking)} files are missing in all)" if len(lacking) > 1 else ""
        raise FileError(
            f"expected {path} with frame {entry.name} of {entry.data_set}, but there is no such file{more}: {mend}"
        )
