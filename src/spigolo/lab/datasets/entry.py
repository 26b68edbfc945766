"""Base classes of data set readers. A data set is a sequence of entries, and an entry refers to the files of one frame.

Letters in array shapes: H, W = image height and width.
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
from spigolo.frames.camera_files import camera_in
from spigolo.frames.files import read_camera, read_color, read_depth
from spigolo.frames.frame import Frame, Mask
from spigolo.frames.scale import check_scale
from spigolo.lab.datasets.sample import Instance, Sample
from spigolo.lab.labelled import FULL_SETS

Labelling = Literal["full", "part", "none"]
"""Completeness of the labels of a frame: all (`full`), some (`part`) or none (`none`) of the objects have a label."""

MILLIMETRES = 0.001
RENDERED = "rendered.json"
"""Name of the file that marks a data set of rendered frames."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Ground truth of a frame."""

    labels: npt.NDArray[np.integer[Any]]
    """Label image (H, W), 0 = background, other values = objects."""
    ignore: Mask
    """Mask (H, W) of pixels to leave out of the evaluation."""
    names: Mapping[int, str] = field(default_factory=dict)
    """Object names, indexed by label, empty if the data set has no names."""


@dataclass(frozen=True, slots=True)
class Entry(ABC):
    """Reference to one frame of a data set, without its images. Entries can be pickled and sent to other processes."""

    data_set: str
    """Name of the data set."""
    name: str
    """Name of the frame in its data set."""
    group: str
    """Name shared by all frames of a group of near-identical frames, for example the frames of one video."""
    labelling: Labelling
    """Completeness of the labels: all (`full`), some (`part`) or none (`none`) of the objects have a label."""

    @property
    @abstractmethod
    def files(self) -> tuple[Path, ...]:
        """Paths of all files of the frame. Files with ground truth are at the end of the returned tuple."""

    @property
    def reading(self) -> str:
        """Return the settings of the reader that change the labels, as a string.

        The string is empty for the default settings of the reader.
        """
        return ""

    @property
    def content(self) -> str:
        """Return a checksum of the frame's files and of `reading`, as eight hexadecimal digits.

        Raises FileError if a file cannot be read.
        """
        value = zlib.crc32(self.reading.encode())
        for path in self.files:
            try:
                value = zlib.crc32(path.read_bytes(), value)
            except OSError as error:
                raise FileError(f"expected {path}, but the file cannot be read: {error.strerror or error}") from None
        return f"{value:08x}"

    @abstractmethod
    def read(self) -> Frame:
        """Read the colour image and the depth map.

        Raises FileError, FrameError or CameraError for missing or invalid files.
        """

    @abstractmethod
    def read_truth(self) -> Truth | None:
        """Read the ground truth.

        Return None if the frame has no labels. Raises FileError or FrameError for missing or invalid files.
        """

    def read_instances(self) -> tuple[Instance, ...]:
        """Read the labelled objects with their poses.

        The returned tuple is empty if the data set has no poses. Raises FileError if a file cannot be read.
        """
        return ()

    def read_both(self) -> tuple[Frame, Truth | None]:
        """Read the frame and its ground truth. Raises FrameError if the images have different sizes."""
        frame, truth = self.read(), self.read_truth()
        if truth is not None and truth.labels.shape != frame.shape:
            raise FrameError(
                f"expected labels of {frame.shape[1]} x {frame.shape[0]} pixels as the colour image has, got"
                f" {truth.labels.shape[1]} x {truth.labels.shape[0]} in {self.files[-1]}"
            )
        return frame, truth

    def read_sample(self) -> Sample:
        """Read the frame with labels and object poses.

        Labels are 0 at ignored pixels. In frames without ground truth, all labels are 0.
        """
        frame, truth = self.read_both()
        labels = np.zeros(frame.shape, np.int32) if truth is None else np.where(truth.ignore, 0, truth.labels)
        return Sample(frame, labels, self.read_instances())


@dataclass(frozen=True, slots=True)
class ImageEntry(Entry):
    """Frame stored as a colour image and a depth image.

    Subclasses of `ImageEntry` also read ground truth.
    """

    color: Path
    depth: Path
    camera: Camera | None
    depth_scale: float
    """Metres per unit of the stored depth image."""

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the colour image and the depth image."""
        return self.color, self.depth

    def read(self) -> Frame:
        """Read the colour image and the depth map.

        Raises FileError, FrameError or CameraError for missing or invalid files.
        """
        return Frame(
            read_color(self.color), read_depth(self.depth), self.camera, self.name, depth_scale=self.depth_scale
        )

    def read_truth(self) -> Truth | None:
        """Return None, because the frame has no labels."""
        return None


class DataSet(ABC):
    """Sequence of the frames in a folder. The constructor lists the files, and `Entry.read` reads the images.

    full: name patterns, such as "osd-*", of data sets in which every object is labelled. Raises FileError if the folder
    does not have the file layout that the class reads, or if a file of a frame is missing.
    """

    layout: ClassVar[str]
    """Description of the file layout that the class reads, for error messages."""
    mend: ClassVar[str] = "fetch or unpack the data set again"
    """Advice in the error message for a missing file."""

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
        """Return True if the folder has the typical files of the layout that this class reads."""

    @abstractmethod
    def _find(self) -> Iterable[Entry]:
        """Yield the frames of the folder in a fixed order.

        Element k of the data set is the k-th frame that this method yields, counted from 0.
        """

    @property
    def rendered(self) -> bool:
        """Return True if the file rendered.json marks the frames as rendered."""
        return (self.folder / RENDERED).is_file()

    def __len__(self) -> int:
        return len(self._entries)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries)

    def __getitem__(self, number: int) -> Entry:
        return self._entries[number]

    def _named(self, name: str) -> str:
        """Return the name of the data set, with the suffix "-rendered" for rendered frames."""
        return f"{name}-rendered" if self.rendered else name

    def _labelled(self, data_set: str) -> Labelling:
        """Return "full" if a pattern in `full` matches the name of the data set, else "part"."""
        return "full" if any(fnmatch(data_set, pattern) for pattern in self._full) else "part"

    def _camera(self, usual: Camera, scale: float, folder: Path | None = None) -> tuple[Camera, float]:
        """Return the camera and the depth scale (metres per unit) from a camera file such as camera.json, or the given
        defaults if there is no camera file.

        Raises CameraError for a depth scale above 0.02 m per unit. Raises FileError for a camera with distortion,
        because undistortion would change the images but not the labels.

        Parameters
        ----------
        usual
            Camera to return if there is no camera file.
        scale
            Depth scale to return if no camera file contains a depth scale, metres per unit.
        folder
            Folder with the camera file. If `folder` has no camera file, the file is read from the folder of the data
            set.

        """
        found = (camera_in(place) for place in (folder, self.folder) if place is not None)
        path = next((place for place in found if place is not None), None)
        if path is None:
            return usual, scale
        camera, own = read_camera(path, usual.width, usual.height)
        if camera.distortion:
            raise FileError(f"expected a camera without distortion in {path}: undistort the images first")
        if own is not None:
            check_scale(own, path)
        return camera, scale if own is None else own


def existing_folder(folder: Path | str) -> Path:
    """Return the absolute path of a folder. Raises FileError if the folder does not exist."""
    if not Path(folder).is_dir():
        raise FileError(f"expected a folder of frames, but there is no folder {folder}")
    return Path(folder).resolve()


def _require_files(entries: Iterable[Entry], mend: str) -> None:
    """Raise FileError if a file of a frame is missing, for example after an incomplete download."""
    lacking = [(entry, path) for entry in entries for path in entry.files if not path.is_file()]
    if lacking:
        entry, path = lacking[0]
        more = f" ({len(lacking)} missing files in all)" if len(lacking) > 1 else ""
        raise FileError(
            f"expected {path} with frame {entry.name} of {entry.data_set}, but there is no such file{more}: {mend}"
        )
