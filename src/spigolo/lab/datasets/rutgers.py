"""Reader of the Rutgers APC RGB-D data set (Rennie, Shome, Bekris, De Souza 2016) with its original file names.

    FOLDER/OBJECT-image-BIN-CLUTTER-POSITION-SHOT.png     8 bits; also in a folder OBJECT/
    FOLDER/OBJECT-depth-BIN-CLUTTER-POSITION-SHOT.png     16 bits, millimetres, 0 = missing
    FOLDER/OBJECT-pose-BIN-CLUTTER-POSITION-SHOT.yml      OpenCV's YAML: object_rotation_wrt_camera (3 x 3 matrix) and
                                                          object_translation_wrt_camera (3 numbers, metres)
    FOLDER/OBJECT-mask-BIN-CLUTTER-POSITION-SHOT.png      of the shelf bin, not of the object; not read
    FOLDER/models/OBJECT.ply (or .obj, .stl, or in OBJECT/), metres
    FOLDER/camera.json                                    optional: camera intrinsics, by default as published by BOP

BIN, the shelf bin, is a letter from A to L. The four frames (SHOT) from one camera POSITION form a group of
near-identical frames. Only the object that the file name contains is labelled, with label 1. The visible mask of the
labelled object is rendered from its model and pose. Frames without a pose have no labels.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from spigolo.errors import FileError
from spigolo.frames.camera import Camera
from spigolo.frames.listing import listed
from spigolo.frames.yaml_text import parse_yaml
from spigolo.lab.datasets.entry import MILLIMETRES, DataSet, Entry
from spigolo.lab.datasets.meshes import find_model
from spigolo.lab.datasets.posed import Pose, PosedImage

CAMERA = Camera(572.41140, 573.57043, 325.26110, 242.04899, 640, 480)
"""Camera intrinsics of the Rutgers APC data set, as published by BOP."""
NAME = re.compile(r"(?P<object>.+)-image-(?P<bin>[A-L])-(?P<rest>\d+-\d+)-(?P<shot>\d+)\.png")
ROTATION, TRANSLATION = "object_rotation_wrt_camera", "object_translation_wrt_camera"


class Rutgers(DataSet):
    """Data set Rutgers APC RGB-D with its original file names."""

    layout = "files OBJECT-image-BIN-CLUTTER-POSITION-SHOT.png (Rutgers APC)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder has a file named OBJECT-image-BIN-CLUTTER-POSITION-SHOT.png."""
        return next(_colors(folder), None) is not None

    def _find(self) -> Iterator[Entry]:
        data_set, (camera, scale) = self._named("rutgers-apc"), self._camera(CAMERA, MILLIMETRES)
        for path, found in sorted(_colors(self.folder), key=lambda pair: pair[0]):
            name, place = found["object"], f"{found['object']}-{found['bin']}-{found['rest']}"
            pose = _beside(path, "pose", ".yml")
            posed = pose.is_file()
            yield PosedImage(
                data_set,
                f"{place}-{found['shot']}",
                f"{data_set}/{place}",
                self._labelled(data_set) if posed else "none",
                path,
                _beside(path, "depth", ".png"),
                camera,
                scale,
                name,
                pose if posed else None,
                self._model(name) if posed else None,
                read_pose,
            )

    def _model(self, name: str) -> Path:
        """Return the path of an object's model. If the model file is missing, return the expected path of the file."""
        return find_model(self.folder / "models", name) or self.folder / "models" / f"{name}.ply"


def _colors(folder: Path) -> Iterator[tuple[Path, re.Match[str]]]:
    for pattern in ("*-image-*.png", "*/*-image-*.png"):
        for path in listed(folder, pattern):
            found = NAME.fullmatch(path.name)
            if found and path.parent.name in (folder.name, found["object"]):
                yield path, found


def read_pose(path: Path) -> list[Pose]:
    """Read the pose (4, 4) of the object in the camera frame, metres. Raises FileError if the file cannot be read."""
    pose = np.eye(4)
    try:
        values = parse_yaml(path.read_text(encoding="utf-8"))
        pose[:3, :3] = np.reshape(np.array(values[ROTATION]["data"], np.float64), (3, 3))
        pose[:3, 3] = np.reshape(np.array(values[TRANSLATION], np.float64), 3)
        if not np.isfinite(pose).all():
            raise ValueError("not all numbers are finite")
    except (OSError, ValueError, TypeError, KeyError, OverflowError, RecursionError):
        raise FileError(
            f"expected {ROTATION} as an OpenCV matrix and {TRANSLATION} as three numbers in {path}, got other content"
        ) from None
    return [pose]


def pose_to_yaml(pose: Pose) -> str:
    """Format a pose (4, 4) as YAML text for `read_pose`."""
    translation, rotation = (", ".join(f"{v:.17g}" for v in part.ravel()) for part in (pose[:3, 3], pose[:3, :3]))
    return (
        f"%YAML:1.0\n{TRANSLATION}: [ {translation} ]\n"
        f"{ROTATION}: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {rotation} ]\n"
    )


def _beside(image: Path, kind: str, ending: str) -> Path:
    head, _, tail = image.stem.rpartition("-image-")
    return image.with_name(f"{head}-{kind}-{tail}{ending}")
