"""Reader of UW RGB-D Scenes v1 (Lai, Bo, Ren, Fox 2011) with the masks of QuickFind (Zhong, Kanhere, Chou 2016).

    rgbd-scenes/SCENE/SCENE_K/SCENE_K_N.png               8 bits, 640 x 480; N from 1, without leading zeros
    rgbd-scenes/SCENE/SCENE_K/SCENE_K_N_depth.png         16 bits, millimetres, 0 = missing
    rgbd-scenes/SCENE/SCENE_K.mat                         optional: boxes, see `read_boxes`
    rgbd-scenes/camera.json                               optional: camera intrinsics, by default `CAMERA`
    quickfind_mask_data/SCENE_K_N_mask.png                optional, next to rgbd-scenes or in it: a colour per object

QuickFind's masks were drawn by hand and label 22 objects. Label k is the k-th object in the table `MASK_COLORS`, which
gives the colour of each object. Black mask pixels are background. Mask pixels with a colour that is not in
`MASK_COLORS` are left out of the evaluation. Frames without a mask have no labels. The frames of one sequence SCENE_K
form a group of near-identical frames.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spigolo.frames.camera import Camera
from spigolo.frames.files import read_color
from spigolo.frames.frame import Color
from spigolo.frames.listing import listed
from spigolo.lab.datasets.boxes import ObjectBox, read_boxes
from spigolo.lab.datasets.entry import MILLIMETRES, DataSet, Entry, ImageEntry, Truth, existing_folder
from spigolo.lab.labelled import FULL_SETS

CAMERA = Camera(570.3, 570.3, 320.0, 240.0, 640, 480)
NAME = re.compile(r"(?P<sequence>(?P<scene>.+)_\d+)_(?P<number>\d+)\.png")
MASK_FOLDER = "quickfind_mask_data"
MASK_COLORS = {
    "bowl_2": (255, 0, 0), "bowl_3": (255, 255, 0), "bowl_4": (0, 255, 0), "cap_1": (0, 255, 255),
    "cap_3": (0, 0, 255), "cap_4": (255, 0, 255), "cereal_1": (192, 0, 0), "cereal_2": (192, 192, 0),
    "cereal_4": (0, 192, 0), "coffee_mug_1": (128, 0, 0), "coffee_mug_4": (128, 128, 0), "coffee_mug_5": (0, 128, 0),
    "coffee_mug_6": (0, 128, 128), "flashlight_1": (64, 0, 0), "flashlight_2": (64, 64, 0), "flashlight_3": (0, 64, 0),
    "flashlight_5": (0, 64, 64), "soda_can_1": (0, 0, 192), "soda_can_3": (192, 0, 192), "soda_can_4": (64, 64, 64),
    "soda_can_5": (192, 192, 192), "soda_can_6": (128, 128, 128),
}  # fmt: skip
"""RGB colour of each object in QuickFind's masks."""


@dataclass(frozen=True, slots=True)
class UwFrame(ImageEntry):
    """Frame of UW RGB-D Scenes v1. mask, boxes: files with the mask and the bounding boxes, None if missing."""

    number: int
    mask: Path | None
    boxes: Path | None

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the colour image and the depth image, and of the bounding boxes and the mask if they exist."""
        return tuple(path for path in (self.color, self.depth, self.boxes, self.mask) if path is not None)

    def read_truth(self) -> Truth | None:
        """Read the labels from QuickFind's mask.

        Return None if the frame has no mask. Raises FileError if a file cannot be read.
        """
        return None if self.mask is None else labels_of(read_color(self.mask))

    def read_boxes(self) -> tuple[ObjectBox, ...]:
        """Read the bounding boxes of the objects.

        The returned tuple is empty if the data set has no bounding boxes. Raises FileError if the file cannot be read.
        """
        return () if self.boxes is None else read_boxes(self.boxes, self.number)


class UwScenes(DataSet):
    """Data set UW RGB-D Scenes v1.

    masks: folder of QuickFind's masks. The default is the folder quickfind_mask_data in the folder of the data set or
    next to it.
    """

    layout = "SCENE/SCENE_K/SCENE_K_N.png and SCENE_K_N_depth.png (UW RGB-D Scenes v1)"

    def __init__(self, folder: Path | str, full: Sequence[str] = FULL_SETS, masks: Path | str | None = None) -> None:
        self.masks = None if masks is None else existing_folder(masks)
        super().__init__(folder, full)

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder has images SCENE/SCENE_K/SCENE_K_N.png."""
        return next(_colors(folder), None) is not None

    def _find(self) -> Iterator[Entry]:
        data_set, (camera, scale) = self._named("uw-scenes-v1"), self._camera(CAMERA, MILLIMETRES)
        masks = self.masks or next((f for f in self._usual_masks() if f.is_dir()), None)
        for sequence, number, color in sorted(_colors(self.folder)):
            mask = None if masks is None else masks / f"{color.stem}_mask.png"
            mask = mask if mask is not None and mask.is_file() else None
            boxes = color.parent.with_suffix(".mat")
            yield UwFrame(
                data_set,
                color.stem,
                f"{data_set}/{sequence}",
                "none" if mask is None else self._labelled(data_set),
                color,
                color.with_name(f"{color.stem}_depth.png"),
                camera,
                scale,
                number,
                mask,
                boxes if boxes.is_file() else None,
            )

    def _usual_masks(self) -> tuple[Path, Path]:
        return self.folder / MASK_FOLDER, self.folder.parent / MASK_FOLDER


def labels_of(picture: Color) -> Truth:
    """Convert the colours of a mask image (H, W, 3) to labels."""
    colors = {color: label for label, color in enumerate(MASK_COLORS.values(), start=1)}
    labels = np.zeros(picture.shape[:2], np.int32)
    ignore = np.zeros(picture.shape[:2], np.bool_)
    packed = picture.astype(np.int32) @ np.array([65536, 256, 1])
    for value in np.unique(packed).tolist():
        label = colors.get((value >> 16, value >> 8 & 255, value & 255), 0)
        labels[packed == value] = label
        if value and not label:
            ignore |= packed == value
    names = dict(enumerate(MASK_COLORS, start=1))
    return Truth(labels, ignore, {label: names[label] for label in np.unique(labels).tolist() if label})


def category_of(name: str) -> tuple[str, int]:
    """Convert an object's name to the category and number that the files of bounding boxes contain.

    "cereal_2" becomes ("cereal_box", 2).
    """
    kind, _, number = name.rpartition("_")
    return ("cereal_box" if kind == "cereal" else kind), int(number)


def _colors(folder: Path) -> Iterator[tuple[str, int, Path]]:
    """Yield the name of the sequence, the frame number and the path of the colour image of each frame."""
    for path in listed(folder, "*/*/*.png"):
        found = NAME.fullmatch(path.name)
        if found and path.parent.name == found["sequence"]:
            yield found["sequence"], int(found["number"]), path
