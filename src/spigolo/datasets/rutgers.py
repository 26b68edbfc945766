"""Rutgers APC RGB-D (Rennie, Shome, Bekris, De Souza 2016), original file names.

    FOLDER/OBJECT-image-BIN-CLUTTER-POSITION-SHOT.png     8 bits; in any folder below
    FOLDER/OBJECT-depth-BIN-CLUTTER-POSITION-SHOT.png     16 bits, millimetres, 0 = missing
    FOLDER/OBJECT-pose-BIN-CLUTTER-POSITION-SHOT.yml      OpenCV's YAML: object_rotation_wrt_camera (3 x 3 matrix) and
                                                          object_translation_wrt_camera (3 numbers, metres)
    FOLDER/OBJECT-mask-BIN-CLUTTER-POSITION-SHOT.png      of the shelf bin, not of the object; not read
    FOLDER/models/OBJECT.ply (or .obj, .stl, or in OBJECT/), metres
    FOLDER/camera.json                                    optional, another camera than BOP's for this set

BIN is A..L; the four shots of one position are near-identical. Only OBJECT is labelled, 1: its visible mask is rendered.
Frames without a pose have no labels. That the letters stand for clutter and position is inferred from their numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from spigolo.camera import Camera
from spigolo.datasets.entry import DataSet, Entry, Truth, read_images
from spigolo.datasets.meshes import find_model, read_model
from spigolo.datasets.sample import Instance
from spigolo.datasets.visibility import visible_labels
from spigolo.errors import FileError
from spigolo.frame import Frame

CAMERA = Camera(572.41140, 573.57043, 325.26110, 242.04899, 640, 480)
"""BOP's for this set."""
NAME = re.compile(r"(?P<object>.+)-image-(?P<bin>[A-L])-(?P<rest>\d+-\d+)-(?P<shot>\d+)\.png")
ROTATION, TRANSLATION = "object_rotation_wrt_camera", "object_translation_wrt_camera"


@dataclass(frozen=True, slots=True)
class RutgersFrame(Entry):
    """One shot. object_name: what its pose is of; pose and model: None where it has none."""

    object_name: str
    color: Path
    depth: Path
    pose: Path | None
    model: Path | None
    camera: Camera

    @property
    def files(self) -> tuple[Path, ...]:
        """Colour and depth, pose and model where there are."""
        return tuple(path for path in (self.color, self.depth, self.pose, self.model) if path is not None)

    def read(self) -> Frame:
        """The frame; raises FileError, FrameError or CameraError."""
        return read_images(self.name, self.color, self.depth, self.camera)

    def read_truth(self) -> Truth | None:
        """The visible mask of its object, None without a pose; raises FileError."""
        if self.model is None:
            return None
        frame = self.read()
        labels = visible_labels(self.read_instances(), [read_model(self.model)], frame.depth, self.camera)
        return Truth(labels, np.zeros(labels.shape, np.bool_), {1: self.object_name})

    def read_instances(self) -> tuple[Instance, ...]:
        """Its object with its pose; raises FileError."""
        return () if self.pose is None else (Instance(1, self.object_name, read_pose(self.pose)),)


class Rutgers(DataSet):
    """Frames of the Rutgers APC set."""

    layout = "files OBJECT-image-BIN-CLUTTER-POSITION-SHOT.png (Rutgers APC)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Whether a file below has such a name."""
        return any(NAME.fullmatch(path.name) for path in folder.rglob("*-image-*.png"))

    def _find(self) -> Iterator[Entry]:
        data_set, camera = self._named("rutgers-apc"), self._camera(CAMERA)
        for path in sorted(self.folder.rglob("*-image-*.png")):
            found = NAME.fullmatch(path.name)
            if found is None:
                continue
            name, place = found["object"], f"{found['object']}-{found['bin']}-{found['rest']}"
            pose: Path | None = _beside(path, "pose", ".yml")
            pose = pose if pose is not None and pose.is_file() else None
            yield RutgersFrame(
                data_set,
                f"{place}-{found['shot']}",
                f"{data_set}/{place}",
                "none" if pose is None else "part",
                name,
                path,
                _beside(path, "depth", ".png"),
                pose,
                None if pose is None else find_model(self.folder / "models", name) or self._lacking(name),
                camera,
            )

    def _lacking(self, name: str) -> Path:
        """Where the model of an object would be expected."""
        return self.folder / "models" / f"{name}.ply"


def read_pose(path: Path) -> np.ndarray:
    """Pose (4, 4) of the object in the camera, metres; raises FileError."""
    pose = np.eye(4)
    try:
        stored = cv2.FileStorage(path.read_text(encoding="utf-8"), cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
        translation = stored.getNode(TRANSLATION)
        pose[:3, :3] = stored.getNode(ROTATION).mat()
        pose[:3, 3] = [translation.at(k).real() for k in range(translation.size())]
    except (OSError, ValueError, TypeError, SystemError, cv2.error):
        raise FileError(
            f"expected {ROTATION} as an OpenCV matrix and {TRANSLATION} as three numbers in {path}, got something else"
        ) from None
    return pose


def pose_to_yaml(pose: np.ndarray) -> str:
    """What `read_pose` reads."""
    translation, rotation = (", ".join(f"{v:.17g}" for v in part.ravel()) for part in (pose[:3, 3], pose[:3, :3]))
    return (
        f"%YAML:1.0\n{TRANSLATION}: [ {translation} ]\n"
        f"{ROTATION}: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {rotation} ]\n"
    )


def _beside(image: Path, kind: str, ending: str) -> Path:
    head, _, tail = image.stem.rpartition("-image-")
    return image.with_name(f"{head}-{kind}-{tail}{ending}")
