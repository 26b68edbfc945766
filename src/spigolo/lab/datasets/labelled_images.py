"""Readers of the data sets OSD and OCID, which store colour, depth and label images in three folders."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spigolo.frames.camera import Camera
from spigolo.frames.files import read_labels
from spigolo.frames.listing import listed
from spigolo.lab.datasets.entry import MILLIMETRES, DataSet, Entry, ImageEntry, Truth

SETS = ("arid20", "arid10", "ycb10")
SURFACES = ("table", "floor")


@dataclass(frozen=True, slots=True)
class LabelledImages(ImageEntry):
    """Frame with a label image. background: label values, in addition to 0, that count as background."""

    labels: Path
    background: tuple[int, ...]

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the colour image, the depth image and the label image."""
        return self.color, self.depth, self.labels

    def read_truth(self) -> Truth | None:
        """Read the label image, with background labels set to 0.

        Raises FileError or FrameError for missing or invalid files.
        """
        stored = read_labels(self.labels)
        labels = np.where(np.isin(stored, self.background), 0, stored)
        return Truth(labels, np.zeros(labels.shape, np.bool_))


class Osd(DataSet):
    """Object Segmentation Database (Richtsfeld et al., 2012): scenes on tables.

        OSD/image_color/learn0.png            8 bits
        OSD/disparity/learn0.png              16 bits, depth in millimetres in spite of the name, 0 = missing
        OSD/annotation/learn0.png             0 = background, other values = objects
        OSD/camera.json                       optional: camera intrinsics, by default of a nominal Kinect v1

    Every object is labelled by hand.
    """

    layout = "image_color/, disparity/ and annotation/ with equally named images (OSD)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder has the subfolders image_color and annotation."""
        return (folder / "image_color").is_dir() and (folder / "annotation").is_dir()

    def _find(self) -> Iterator[Entry]:
        data_set, (camera, scale) = self._named("osd"), self._camera(Camera.named("kinect-v1"), MILLIMETRES)
        for color in listed(self.folder / "image_color", "*.png"):
            depth, labels = (self.folder / name / color.name for name in ("disparity", "annotation"))
            name, group = color.stem, f"{data_set}/{color.stem}"
            yield LabelledImages(data_set, name, group, "full", color, depth, camera, scale, labels, ())


class Ocid(DataSet):
    """Object Clutter Indoor Dataset (Suchi et al., 2019), with every object labelled.

    In each sequence, objects are added to the scene one by one.

        OCID/ARID20/floor/bottom/seq01/rgb/NAME.png     8 bits; ARID10 and YCB10 have more folder levels
        .../seq01/depth/NAME.png                        16 bits, millimetres, 0 = missing
        .../seq01/label/NAME.png                        0 and 1 = background, in table scenes 2 as well: the table
        OCID/camera.json                                optional: camera intrinsics, by default of a nominal Xtion

    The frames of a sequence form a group of near-identical frames. The labels were computed from depth differences, so
    their outlines are noisy.
    """

    layout = "sequences with rgb/, depth/ and label/ of equally named images (OCID)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder contains a sequence, that is, a folder with the subfolders rgb and label."""
        return next(_sequences(folder), None) is not None

    def _find(self) -> Iterator[Entry]:
        data_set, (camera, scale) = self._named("ocid"), self._camera(Camera.named("xtion"), MILLIMETRES)
        for sequence in sorted(_sequences(self.folder)):
            place = sequence.relative_to(self.folder).as_posix()
            background = (1, 2) if _stands_on(sequence, self.folder) == "table" else (1,)
            for color in listed(sequence / "rgb", "*.png"):
                depth, labels = (sequence / name / color.name for name in ("depth", "label"))
                name, group = f"{place}/{color.stem}", f"{data_set}/{place}"
                yield LabelledImages(data_set, name, group, "full", color, depth, camera, scale, labels, background)


def _stands_on(sequence: Path, folder: Path) -> str:
    """Return the surface below the objects, "table" or "floor", according to the folder names in the path of a
    sequence.

    Return an empty string if no folder inside the data set is named "table" or "floor".
    """
    parts = [part.lower() for part in sequence.parts]
    start = max((k for k, part in enumerate(parts) if part in SETS), default=len(folder.parts) - 1)
    return next((part for part in reversed(parts[start + 1 :]) if part in SURFACES), "")


def _sequences(folder: Path) -> Iterator[Path]:
    labels = (path for depth in range(7) for path in listed(folder, "*/" * depth + "label"))
    return (path.parent for path in labels if (path.parent / "rgb").is_dir() and path.is_dir())
