"""mOSD, the Object Segmentation Database with corrected labels near edges (Alexandrov), as labelled organised clouds.

    mOSD/learn/learn0.pcd, mOSD/test/test0.pcd            fields x, y, z (metres), rgb, label, 640 x 480

Points that were not measured, or cropped with the floor and the walls, are NaN with label 0 and are ignored. Labels
1..9 = the table, 20..29 = parts of the first object, 30..39 of the second, and so on. This reader sets the table to 0
and joins parts to objects 1, 2, ... The camera is fitted to the cloud.
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
    """Frame that is stored as an organised cloud."""

    cloud: Path

    @property
    def files(self) -> tuple[Path, ...]:
        """Path of the cloud."""
        return (self.cloud,)

    def read(self) -> Frame:
        """Return the frame. Raises FileError or CameraError."""
        points = read_pcd(self.cloud)
        if missing := {"x", "y", "z"} - set(points.dtype.names or ()):
            raise FileError(f"expected fields x, y, z in {self.cloud}: {', '.join(sorted(missing))} not found")
        if not {"rgb", "rgba"} & set(points.dtype.names or ()):
            raise FileError(f"expected a field rgb or rgba in {self.cloud}, got {', '.join(points.dtype.names or ())}")
        return Frame(colors_of(points), points["z"].astype(np.float32), camera_of(points), self.name)

    def read_truth(self) -> Truth | None:
        """Return the labels of the objects. Raises FileError."""
        points = read_pcd(self.cloud)
        if "label" not in (points.dtype.names or ()):
            raise FileError(f"expected a field label in {self.cloud}, got {', '.join(points.dtype.names or ())}")
        stored = points["label"].astype(np.int32)
        return Truth(np.maximum(stored // 10 - 1, 0), (stored == 0) | ~np.isfinite(points["z"]))


class Mosd(DataSet):
    """Data set in the layout of mOSD."""

    layout = "learn/*.pcd and test/*.pcd with labelled points (mOSD)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder, or its subfolder learn or test, has clouds with labels."""
        return any(b" label" in _beginning(path) for path in _clouds(folder)[:1])

    def _find(self) -> Iterator[Entry]:
        data_set = self._named("mosd")
        for cloud in _clouds(self.folder):
            yield LabelledCloud(data_set, cloud.stem, f"{data_set}/{cloud.stem}", "full", cloud)


def _clouds(folder: Path) -> list[Path]:
    return [p for part in (".", "learn", "test") for p in listed(folder / part, "*.pcd")]


def _beginning(path: Path) -> bytes:
    """Return the first bytes of a file, enough for the header's fields."""
    with path.open("rb") as file:
        return file.read(512)
