"""Reader of UW RGB-D Scenes v2 (Lai, Bo, Fox 2014): videos of furniture and tables.

    rgbd-scenes-v2/imgs/scene_01/00000-color.png          8 bits, 640 x 480
    rgbd-scenes-v2/imgs/scene_01/00000-depth.png          16 bits, tenths of a millimetre, 0 = missing
    rgbd-scenes-v2/camera.json                            optional: camera intrinsics, by default as in the reader of v1

The frames have no labels, because the data set labels points of a point cloud instead of image pixels. The frames of a
scene form a group of near-identical frames.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from spigolo.frames.listing import listed
from spigolo.lab.datasets.entry import DataSet, Entry, ImageEntry
from spigolo.lab.datasets.uw_scenes import CAMERA

DEPTH_SCALE = 0.0001


class UwScenesV2(DataSet):
    """Data set UW RGB-D Scenes v2."""

    layout = "imgs/scene_XX/NNNNN-color.png and NNNNN-depth.png (UW RGB-D Scenes v2)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder has images imgs/scene_XX/NNNNN-color.png."""
        return any(folder.glob("imgs/scene_*/*-color.png"))

    def _find(self) -> Iterator[Entry]:
        data_set, (camera, scale) = self._named("uw-scenes-v2"), self._camera(CAMERA, DEPTH_SCALE)
        for color in listed(self.folder, "imgs/scene_*/*-color.png"):
            scene, number = color.parent.name, color.stem.removesuffix("-color")
            depth = color.with_name(f"{number}-depth.png")
            group = f"{data_set}/{scene}"
            yield ImageEntry(data_set, f"{scene}/{number}", group, "none", color, depth, camera, scale)
