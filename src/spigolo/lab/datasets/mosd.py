"""Reader of mOSD (Alexandrov): the Object Segmentation Database with corrected labels, stored as organised point
clouds.

    mOSD/learn/learn0.pcd, mOSD/test/test0.pcd            fields x, y, z (metres), rgb, label, 640 x 480

Points without depth, and points on the floor and the walls, have label 0 and are left out of the evaluation. In the
files of mOSD, labels 1..9 are the table. Labels 20..29 are parts of the first object, labels 30..39 are parts of the
second object, and so on. The reader sets the label of the table to 0 and merges the parts of each object. The camera
intrinsics are fitted to the points of the cloud.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spigolo.errors import FileError
from spigolo.frames.frame import Frame
from spigolo.frames.listing import listed
from spigolo.lab.datasets.entry import DataSet, Entry, Truth
from spigolo.lab.datasets.pcd import camera_of, colors_of, read_pcd


@dataclass(frozen=True, slots=True)
class LabelledCloud(Entry):
    """Frame stored as an organised point cloud."""

    cloud: Path

    @property
    def files(self) -> tuple[Path, ...]:
        """Path of the point cloud."""
        return (self.cloud,)

    def read(self) -> Frame:
        """Read the colour image and the depth map from the point cloud.

        Raises FileError or CameraError for missing or invalid files.
        """
        points = read_pcd(self.cloud)
        if missing := {"x", "y", "z"} - set(points.dtype.names or ()):
            raise FileError(f"expected fields x, y, z in {self.cloud}: {', '.join(sorted(missing))} not found")
        if not {"rgb", "rgba"} & set(points.dtype.names or ()):
            raise FileError(f"expected a field rgb or rgba in {self.cloud}, got {', '.join(points.dtype.names or ())}")
        return Frame(colors_of(points), points["z"].astype(np.float32), camera_of(points), self.name)

    def read_truth(self) -> Truth | None:
        """Read the object labels from the point cloud. Raises FileError if a file cannot be read."""
        points = read_pcd(self.cloud)
        if "label" not in (points.dtype.names or ()):
            raise FileError(f"expected a field label in {self.cloud}, got {', '.join(points.dtype.names or ())}")
        stored = points["label"].astype(np.int32)
        return Truth(np.maximum(stored // 10 - 1, 0), (stored == 0) | ~np.isfinite(points["z"]))


class Mosd(DataSet):
    """Data set mOSD: the Object Segmentation Database as labelled point clouds."""

    layout = "learn/*.pcd and test/*.pcd with labelled points (mOSD)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder, or its subfolder learn or test, has point clouds with labels."""
        return any(b" label" in _beginning(path) for path in _clouds(folder)[:1])

    def _find(self) -> Iterator[Entry]:
        data_set = self._named("mosd")
        for cloud in _clouds(self.folder):
            yield LabelledCloud(data_set, cloud.stem, f"{data_set}/{cloud.stem}", "full", cloud)


def _clouds(folder: Path) -> list[Path]:
    return [p for part in (".", "learn", "test") for p in listed(folder / part, "*.pcd")]


def _beginning(path: Path) -> bytes:
    """Return the first 512 bytes of a file, which contain the field names of its header."""
    with path.open("rb") as file:
        return file.read(512)
