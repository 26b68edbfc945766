"""Reader of data sets in the BOP format, such as ruapc, icmi, ycbv and hope.

    DATASET/
      models/obj_000001.ply                       millimetres
      test/000001/                                any folder of scenes: test, val, train_pbr, ...
        scene_camera.json                         {"IMAGE": {"cam_K": [9, row by row], "depth_scale": mm per unit}}
        scene_gt.json                             {"IMAGE": [{"obj_id", "cam_R_m2c": [9], "cam_t_m2c": [3, mm]}]}
        rgb/000000.png (or gray/, .jpg, .tif)     8 bits
        depth/000000.png (or .tif)                16 bits, 0 = missing
        mask_visib/000000_000000.png              image, then position in the list of scene_gt; 0 and 255

The file `docs/bop_datasets_format.md` of bop_toolkit defines the format. Label k is the k-th object in the list of
objects in scene_gt.json. If the folder mask_visib is missing, masks are rendered from models and poses.

If a pattern in `full` matches the name of the data set, all objects count as labelled. If no pattern in `full` matches
the name, the labels count as incomplete (`part`). The frames of one scene form a group of near-identical frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError, FrameError
from spigolo.frames.camera import Camera
from spigolo.frames.files import read_color, read_depth, read_labels
from spigolo.frames.frame import Frame, depth_in_metres
from spigolo.frames.listing import best_of_each, listed
from spigolo.lab.datasets.entry import MILLIMETRES, DataSet, Entry, Labelling, Truth
from spigolo.lab.datasets.jsons import read_mapping
from spigolo.lab.datasets.meshes import read_model
from spigolo.lab.datasets.sample import Instance
from spigolo.lab.datasets.visibility import visible_labels
from spigolo.lab.labelled import FULL_SETS

SPLITS = ("test", "test_*", "val", "val_*", "train", "train_*")
"""Patterns of folders with scenes, in order of preference. Only the first folder that matches a pattern and contains
scenes is read.
"""

Pose = tuple[int, tuple[float, ...], tuple[float, ...]]
"""Object pose as stored in the BOP format: obj_id, rotation matrix cam_R_m2c (9 numbers), translation cam_t_m2c (3
numbers, in millimetres).
"""


@dataclass(frozen=True, slots=True)
class BopImage(Entry):
    """Image of a scene in the BOP format."""

    scene: Path
    image: int
    intrinsics: tuple[float, ...]
    """Camera matrix as 9 numbers, row by row."""
    depth_scale: float
    """Metres per unit of the stored depth image."""
    poses: tuple[Pose, ...]
    color: Path
    depth: Path

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the colour image, the depth image and the masks, or the object models if there are no masks."""
        return self.color, self.depth, *(self._masks or (self._model(obj_id) for obj_id, _, _ in self.poses))

    def read(self) -> Frame:
        """Read the colour image and the depth map.

        Raises FileError, FrameError or CameraError for missing or invalid files.
        """
        depth = read_depth(self.depth)
        return Frame(read_color(self.color), depth, self.intrinsics, self.name, depth_scale=self.depth_scale)

    def read_truth(self) -> Truth | None:
        """Return the ground truth from stored masks, or from masks rendered from models and poses.

        Raises FileError or FrameError for missing or invalid files.
        """
        if self.labelling == "none":
            return None
        instances = self.read_instances()
        labels = self._stored_labels() if self._masks else self._rendered_labels(instances)
        return Truth(labels, np.zeros(labels.shape, np.bool_), {i.label: i.model for i in instances})

    def read_instances(self) -> tuple[Instance, ...]:
        """Return the labelled objects with their poses."""
        return tuple(
            Instance(label, f"obj_{obj_id:06d}", _matrix(rotation, translation))
            for label, (obj_id, rotation, translation) in enumerate(self.poses, start=1)
        )

    @property
    def _masks(self) -> tuple[Path, ...]:
        """Return the paths of the stored masks, or an empty tuple if the scene has no masks."""
        folder = self.scene / "mask_visib"
        if not folder.is_dir():
            return ()
        return tuple(folder / f"{self.image:06d}_{n:06d}.png" for n in range(len(self.poses)))

    def _model(self, obj_id: int) -> Path:
        return self.scene.parents[1] / "models" / f"obj_{obj_id:06d}.ply"

    def _stored_labels(self) -> npt.NDArray[np.int32]:
        """Return labels (H, W) from stored masks.

        A pixel in several masks gets the label of the object that is listed last in scene_gt.json.
        """
        labels = None
        for label, path in enumerate(self._masks, start=1):
            mask = read_labels(path)
            labels = np.zeros(mask.shape, np.int32) if labels is None else labels
            if mask.shape != labels.shape:
                raise FrameError(f"expected masks of the same size, got another size in {path}")
            labels[mask > 0] = label
        assert labels is not None
        return labels

    def _rendered_labels(self, instances: tuple[Instance, ...]) -> npt.NDArray[np.int32]:
        depth, _, _ = depth_in_metres(read_depth(self.depth), self.depth_scale)
        camera = Camera.from_matrix(self.intrinsics, depth.shape[1], depth.shape[0])
        models = [read_model(self._model(obj_id), MILLIMETRES) for obj_id, _, _ in self.poses]
        return visible_labels(instances, models, depth, camera)


class Bop(DataSet):
    """Data set in the BOP layout. split: name of the folder with the scenes, such as "test"."""

    layout = "scenes with scene_camera.json, rgb/ and depth/ (BOP: DATASET/test/000001/)"

    def __init__(self, folder: Path | str, full: Sequence[str] = FULL_SETS, split: str | None = None) -> None:
        self.split = split
        super().__init__(folder, full)

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder has scenes with a file scene_camera.json, or has a subfolder with such scenes whose
        name matches a pattern in `SPLITS`.
        """
        return _split(folder, None) is not None

    def _find(self) -> Iterator[Entry]:
        split = _split(self.folder, self.split)
        if split is None:
            place = self.folder / (self.split or "test")
            raise FileError(f"expected scenes of a BOP data set as {place}/000001/scene_camera.json, got none")
        root = self.folder.parent if split == self.folder else self.folder
        for path in listed(split, "*/scene_camera.json"):
            yield from self._scene(path.parent, self._named(root.name))

    def _scene(self, scene: Path, data_set: str) -> Iterator[Entry]:
        cameras = read_mapping(scene / "scene_camera.json")
        truth = read_mapping(scene / "scene_gt.json") if (scene / "scene_gt.json").is_file() else {}
        colors, depths = _images(scene, "rgb", "gray"), _images(scene, "depth")
        for key in sorted(filter(str.isdecimal, cameras), key=int):
            image = int(key)
            try:
                poses = tuple(_pose(fields) for fields in truth.get(key, ()))
                intrinsics = tuple(float(value) for value in cameras[key]["cam_K"])
                if len(intrinsics) != 9:
                    raise ValueError
                scale = float(cameras[key].get("depth_scale", 1.0)) * MILLIMETRES
            except (KeyError, TypeError, ValueError, OverflowError):
                raise FileError(
                    f"expected nine numbers cam_K in {scene}/scene_camera.json, and obj_id, nine numbers cam_R_m2c and"
                    f" three cam_t_m2c of each object in scene_gt.json, got other content for image {key}"
                ) from None
            labelling: Labelling = self._labelled(data_set) if poses else "none"
            color = colors.get(image, scene / "rgb" / f"{image:06d}.png")
            depth = depths.get(image, scene / "depth" / f"{image:06d}.png")
            name, group = f"{scene.name}/{image:06d}", f"{data_set}/{scene.name}"
            yield BopImage(data_set, name, group, labelling, scene, image, intrinsics, scale, poses, color, depth)


def _split(folder: Path, split: str | None) -> Path | None:
    if split is None and any(folder.glob("*/scene_camera.json")):
        return folder
    patterns = SPLITS if split is None else (split,)
    found = (path for pattern in patterns for path in listed(folder, pattern))
    return next((path for path in found if any(path.glob("*/scene_camera.json"))), None)


def _images(scene: Path, *folders: str) -> dict[int, Path]:
    paths = (path for name in folders for path in listed(scene / name) if path.stem.isdecimal())
    return {int(path.stem): path for path in best_of_each(paths)}


def _pose(fields: Mapping[str, Any]) -> Pose:
    rotation, translation = tuple(map(float, fields["cam_R_m2c"])), tuple(map(float, fields["cam_t_m2c"]))
    if (len(rotation), len(translation)) != (9, 3):
        raise ValueError("nine and three")
    return int(fields["obj_id"]), rotation, translation


def _matrix(rotation: tuple[float, ...], translation: tuple[float, ...]) -> npt.NDArray[np.float64]:
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(rotation, (3, 3))
    pose[:3, 3] = np.multiply(translation, MILLIMETRES)
    return pose
