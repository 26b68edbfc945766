"""Reader of the data set by Tejani et al., 2014, with several instances of one object among clutter.

    FOLDER/test/scene_01/RGB/img_000.png                  8 bits; also scene_01/ directly in FOLDER, or object's name
    FOLDER/test/scene_01/Depth/img_000.png                16 bits, millimetres, 0 = missing
    FOLDER/annotation_new_models/scene_01/poses0.txt      number of instances, then for each 4 lines of 4 numbers,
                                                          separated by blanks or commas: model to camera, metres
    FOLDER/models/obj_01.ply                              metres; also by name, as Coffee_Cup.ply
    FOLDER/camera.json                                    optional: camera intrinsics, by default as published by BOP

Scene N shows instances of object N: 1 Coffee_Cup, 2 Shampoo, 3 Joystick, 4 Camera, 5 Juice, 6 Milk. Label k is the k-th
instance in the file with the poses. The visible mask of an instance is rendered from its model and pose. Images without
a file of poses have no labels. The frames of a scene form a group of near-identical frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from spigolo.errors import FileError
from spigolo.frames.camera import Camera
from spigolo.frames.listing import listed
from spigolo.lab.datasets.entry import MILLIMETRES, DataSet, Entry
from spigolo.lab.datasets.meshes import find_model
from spigolo.lab.datasets.posed import Pose, PosedImage

CAMERA = Camera(572.41140, 573.57043, 325.26110, 242.04899, 640, 480)
"""Camera intrinsics of the data set by Tejani et al., as published by BOP."""
OBJECTS = ("Coffee_Cup", "Shampoo", "Joystick", "Camera", "Juice", "Milk")
ANNOTATION, MODELS = "annotation_new_models", ("models", "new_models")


class Tejani(DataSet):
    """Data set by Tejani et al. with its original file names."""

    layout = "test/scene_XX/RGB/img_NNN.png and Depth/ (Tejani et al.)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder, or its subfolder test, contains a scene with images RGB/img_NNN.png."""
        return bool(_scenes(folder))

    def _find(self) -> Iterator[Entry]:
        data_set, (camera, scale) = self._named("tejani"), self._camera(CAMERA, MILLIMETRES)
        for scene in _scenes(self.folder):
            number, name = _object(scene.name)
            for color in listed(scene / "RGB", "img_*.png"):
                poses = self._poses(f"scene_{number:02d}", scene.name, color.stem.removeprefix("img_"))
                yield PosedImage(
                    data_set,
                    f"{scene.name}/{color.stem}",
                    f"{data_set}/{scene.name}",
                    "none" if poses is None else self._labelled(data_set),
                    color,
                    scene / "Depth" / color.name,
                    camera,
                    scale,
                    name,
                    poses,
                    None if poses is None else self._model(number, name),
                    read_poses,
                )

    def _poses(self, usual: str, scene: str, number: str) -> Path | None:
        names = {f"poses{number}.txt", f"poses{number.lstrip('0') or '0'}.txt"}
        places = (self.folder / ANNOTATION / folder / name for folder in (usual, scene) for name in names)
        return next((path for path in places if path.is_file()), None)

    def _model(self, number: int, name: str) -> Path:
        """Return the path of the object's model. If the model file is missing, return the expected path of the file."""
        stems = (f"obj_{number:02d}", name)
        found = (find_model(self.folder / folder, stem) for folder in MODELS for stem in stems)
        return next((path for path in found if path), self.folder / MODELS[0] / f"obj_{number:02d}.ply")


def read_poses(path: Path) -> list[Pose]:
    """Read the poses (4, 4) of all instances in the camera frame. Raises FileError if the file cannot be read."""
    try:
        count, *numbers = path.read_text(encoding="utf-8").replace(",", " ").split()
        poses = np.array(numbers, np.float64).reshape(int(count), 4, 4)
    except (OSError, ValueError):
        raise FileError(
            f"expected the number of instances and 16 numbers for each in {path}, got other content"
        ) from None
    return list(poses)


def poses_to_text(poses: Sequence[Pose]) -> str:
    """Format poses (4, 4) as text for `read_poses`."""
    rows = [",".join(f"{value:.17g}" for value in row) for pose in poses for row in pose]
    return "\n".join([str(len(poses)), *rows, ""])


def _scenes(folder: Path) -> list[Path]:
    return [path.parent for below in ("test", ".") for path in listed(folder / below, "*/RGB") if _is_scene(path)]


def _is_scene(colors: Path) -> bool:
    return _object(colors.parent.name)[0] > 0 and any(colors.glob("img_*.png"))


def _object(scene: str) -> tuple[int, str]:
    """Return the number and the name of the object in a scene.

    scene: folder name, such as scene_01. The returned number is 0 if the scene is unknown.
    """
    known = [name.lower() for name in OBJECTS]
    digits = scene.removeprefix("scene_")
    number = int(digits) if digits.isdigit() else known.index(scene.lower()) + 1 if scene.lower() in known else 0
    return (number, OBJECTS[number - 1]) if 0 < number <= len(OBJECTS) else (0, "")
