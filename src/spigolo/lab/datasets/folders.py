"""Reader of data sets with one folder per frame. The layout with one folder per frame is recommended for your own
frames.

    FOLDER/splits.json                  optional: {"near_duplicate_groups": [["SET/FRAME", ...], ...]}
    FOLDER/SET/FRAME/rgb.png            8 bits
    FOLDER/SET/FRAME/depth.png          16 bits, 0 = missing
    FOLDER/SET/FRAME/camera.json        intrinsics and depth_scale; also in SET or FOLDER, for all that is below
    FOLDER/SET/FRAME/label.png          0 = background, 1..N = objects, 255 = ignore; absent where nothing is labelled
    FOLDER/SET/FRAME/info.json          optional: {"fully_labelled": true, "ignore_label": 255}, both optional too

The reader also accepts the path of one data set (FOLDER/SET) or of one frame (FOLDER/SET/FRAME).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from spigolo.errors import FileError, SpigoloError, warn
from spigolo.frames.camera import Camera
from spigolo.frames.camera_files import camera_for
from spigolo.frames.files import read_camera, read_frame, read_labels
from spigolo.frames.frame import Frame
from spigolo.frames.listing import listed
from spigolo.lab.datasets.entry import DataSet, Entry, Labelling, Truth
from spigolo.lab.datasets.jsons import read_mapping

IGNORE_LABEL = 255

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class FrameFolder(Entry):
    """Frame stored in a folder of its own. ignore_label: label of pixels to leave out of the evaluation."""

    folder: Path
    ignore_label: int = IGNORE_LABEL
    camera: Path | None = None

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the colour image, the depth image, the camera file and the label image."""
        labels = () if self.labelling == "none" else (self.folder / "label.png",)
        return self.folder / "rgb.png", self.folder / "depth.png", self._camera_file, *labels

    @property
    def _camera_file(self) -> Path:
        return self.camera or self.folder / "camera.json"

    @property
    def reading(self) -> str:
        """Return "ignore LABEL" if the label of ignored pixels is not the default 255, else an empty string."""
        return "" if self.ignore_label == IGNORE_LABEL else f"ignore {self.ignore_label}"

    def read(self) -> Frame:
        """Read the colour image and the depth map.

        Raises FileError, FrameError or CameraError for missing or invalid files.
        """
        return read_frame(self.folder / "rgb.png", self.folder / "depth.png", self._camera_file, name=self.name)

    def read_truth(self) -> Truth | None:
        """Read the label image.

        Return None if the frame has no labels. Raises FileError or FrameError for missing or invalid files.
        """
        if self.labelling == "none":
            return None
        labels = read_labels(self.folder / "label.png")
        ignore = labels == self.ignore_label
        if self.ignore_label == IGNORE_LABEL and set(np.unique(labels).tolist()) == {0, IGNORE_LABEL}:
            warn(
                f"{self.folder / 'label.png'} holds only 0 and 255, and 255 is the ignored label: no object is"
                " labelled. Store objects as 1..N, or another ignore_label in info.json"
            )
        camera = self._distorting_camera(labels.shape[1], labels.shape[0])
        if camera is not None and (camera.height, camera.width) == labels.shape:
            labels = camera.undistort(labels, nearest=True)
            ignore = camera.undistort(1 - ignore.view(np.uint8), nearest=True) == 0  # ignored, or outside the image
        return Truth(np.where(ignore, 0, labels), ignore)

    def _distorting_camera(self, width: int, height: int) -> Camera | None:
        """Return the camera if its lens distortion must be removed from the label image, else None.

        Also return None if the camera file cannot be read. If the camera file cannot be read, the method `read` raises
        an error.
        """
        try:
            camera, _ = read_camera(self._camera_file, width, height)
        except SpigoloError:
            return None
        return camera if camera.distortion else None


class Folders(DataSet):
    """Data set with one folder per frame."""

    layout = "SET/FRAME/ with rgb.png, depth.png and camera.json"
    mend = "add the file, or remove the folder of the frame"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if there is a file rgb.png in the folder or up to two folder levels below."""
        return next(_places(folder), None) is not None

    def _find(self) -> Iterator[Entry]:
        groups: dict[Path, Mapping[str, str]] = {}
        for place in _places(self.folder):
            root = place.parent.parent
            if root not in groups:
                groups[root] = _groups(root)
            yield self._describe(place, groups[root])

    def _describe(self, place: Path, groups: Mapping[str, str]) -> FrameFolder:
        data_set, name = self._named(place.parent.name), place.name
        info = place / "info.json"
        told = _mapping(info)
        whole = _field(told, info, "fully_labelled", bool, self._labelled(data_set) == "full")
        ignored = _field(told, info, "ignore_label", int, IGNORE_LABEL)
        labelling: Labelling = "none"
        if (place / "label.png").is_file():
            labelling = "full" if whole else "part"
        key = f"{place.parent.name}/{name}"
        return FrameFolder(
            data_set, name, groups.get(key, key), labelling, place, ignored, camera_for(place, self.folder)
        )


def _places(folder: Path) -> Iterator[Path]:
    return (path.parent for pattern in ("", "*/", "*/*/") for path in listed(folder, f"{pattern}rgb.png"))


def _groups(root: Path) -> Mapping[str, str]:
    """Read the groups of near-identical frames from splits.json.

    Return the name of the group of each frame, indexed by the frame name. A group of near-identical frames has the name
    of its first frame. Frames that belong to no group are not in the returned dictionary.

    Warns if splits.json names a frame that does not exist.
    """
    groups = _mapping(root / "splits.json").get("near_duplicate_groups", [])
    if not isinstance(groups, list) or not all(isinstance(g, list) and g for g in groups):
        raise FileError(f"expected lists of frames as near_duplicate_groups in {root / 'splits.json'}, got {groups!r}")
    groups = [[str(name) for name in members] for members in groups]
    absent = [name for members in groups for name in members if _is_absent(root, name)]
    if absent:
        warn(f"{root / 'splits.json'} names {absent[0]}, but there is no such frame: write SET/FRAME")
    return {name: members[0] for members in groups for name in members}


def _is_absent(root: Path, name: str) -> bool:
    """Return True if `name` is not of the form SET/FRAME, or if the folder SET exists but has no frame FRAME."""
    data_set, slash, _ = name.partition("/")
    return not slash or ((root / data_set).is_dir() and not (root / name / "rgb.png").is_file())


def _field(told: Mapping[str, Any], path: Path, name: str, kind: type[T], default: T) -> T:
    """Return the value of a field of a JSON object, or the default if the field is missing.

    path: JSON file, for the error message. Raises FileError if the value has the wrong type.
    """
    value = told.get(name)
    if value is None:
        return default
    if type(value) is not kind:
        meant = "true or false" if kind is bool else "a label"
        raise FileError(f"expected {meant} as {name} in {path}, got {value!r}")
    return value


def _mapping(path: Path) -> Mapping[str, Any]:
    """Read the fields of a JSON file. The returned dictionary is empty if the file does not exist."""
    return read_mapping(path) if path.is_file() else {}
