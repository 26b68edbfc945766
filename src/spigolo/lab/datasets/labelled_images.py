"""OSD and OCID: colour, depth and labels as equally named images in three folders."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spigolo.frames.camera import Camera
from spigolo.frames.files import read_labels
from spigolo.lab.datasets.entry import MILLIMETRES, DataSet, Entry, ImageEntry, Truth


@dataclass(frozen=True, slots=True)
class LabelledImages(ImageEntry):
    """A frame with a label image. background: labels that are no objects, beside 0."""

    labels: Path
    background: tuple[int, ...]

    @property
    def files(self) -> tuple[Path, ...]:
        """Colour, depth, labels."""
        return self.color, self.depth, self.labels

    def read_truth(self) -> Truth | None:
        """Its labels; raises FileError or FrameError."""
        stored = read_labels(self.labels)
        labels = np.where(np.isin(stored, self.background), 0, stored)
        return Truth(labels, np.zeros(labels.shape, np.bool_))


class Osd(DataSet):
    """Object Segmentation Database (Richtsfeld et al. 2012): table-tops, every object labelled by hand.

    OSD/image_color/learn0.png            8 bits
    OSD/disparity/learn0.png              16 bits, depth in millimetres in spite of the name, 0 = missing
    OSD/annotation/learn0.png             0 = background, other values = objects
    OSD/camera.json                       optional, another camera than a nominal Kinect v1
    """

    layout = "image_color/, disparity/ and annotation/ with equally named images (OSD)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Whether it has a folder of colour and one of annotation."""
        return (folder / "image_color").is_dir() and (folder / "annotation").is_dir()

    def _find(self) -> Iterator[Entry]:
        data_set, camera = self._named("osd"), self._camera(Camera.named("kinect-v1"))
        for color in sorted((self.folder / "image_color").glob("*.png"), key=natural_order):
            depth, labels = (self.folder / name / color.name for name in ("disparity", "annotation"))
            name, group = color.stem, f"{data_set}/{color.stem}"
            yield LabelledImages(data_set, name, group, "full", color, depth, camera, MILLIMETRES, labels, ())


class Ocid(DataSet):
    """Object Clutter Indoor Dataset (Suchi et al. 2019): scenes that grow object by object, every object labelled.

        OCID/ARID20/floor/bottom/seq01/rgb/NAME.png     8 bits; ARID10 and YCB10 have more folders on the way
        .../seq01/depth/NAME.png                        16 bits, millimetres, 0 = missing
        .../seq01/label/NAME.png                        0 and 1 = background, in table scenes 2 as well: the table
        OCID/camera.json                                optional, another camera than a nominal Xtion

    The frames of a sequence are near-identical. Labels come from differences of depth: their boundaries are noisy.
    """

    layout = "sequences with rgb/, depth/ and label/ of equally named images (OCID)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Whether a folder below is such a sequence."""
        return next(_sequences(folder), None) is not None

    def _find(self) -> Iterator[Entry]:
        data_set, camera = self._named("ocid"), self._camera(Camera.named("xtion"))
        for sequence in sorted(_sequences(self.folder)):
            place = sequence.relative_to(self.folder).as_posix()
            background = (1, 2) if "table" in sequence.parts[-5:] else (1,)
            for color in sorted((sequence / "rgb").glob("*.png")):
                depth, labels = (sequence / name / color.name for name in ("depth", "label"))
                name, group = f"{place}/{color.stem}", f"{data_set}/{place}"
                yield LabelledImages(
                    data_set, name, group, "full", color, depth, camera, MILLIMETRES, labels, background
                )


def natural_order(path: Path) -> list[tuple[int, str]]:
    """A key that puts learn2 before learn10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", path.name)]


def _sequences(folder: Path) -> Iterator[Path]:
    labels = (path for depth in range(7) for path in folder.glob("*/" * depth + "label"))
    return (path.parent for path in labels if (path.parent / "rgb").is_dir() and path.is_dir())
