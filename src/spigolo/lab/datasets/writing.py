"""Writers of rendered frames in the file layouts of published data sets. The readers in `spigolo.lab.datasets` can read
the written files.

The file rendered.json marks the frames as rendered. The file camera.json contains the camera intrinsics if the layout
has no other file for camera intrinsics. File names are derived from frame names. Use `rutgers_name`, `uw_scenes_name`
and `tejani_name` to create frame names.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from spigolo.errors import FrameError
from spigolo.frames.camera import Camera
from spigolo.frames.files import write_bytes, write_json, write_png
from spigolo.frames.frame import Color
from spigolo.lab.datasets.bop_writing import SceneFiles, write_description, write_models
from spigolo.lab.datasets.boxes import ObjectBox, box_of, boxes_to_mat
from spigolo.lab.datasets.entry import MILLIMETRES, RENDERED
from spigolo.lab.datasets.meshes import write_model
from spigolo.lab.datasets.posed import Pose
from spigolo.lab.datasets.rutgers import pose_to_yaml
from spigolo.lab.datasets.sample import Instance, Model, Sample
from spigolo.lab.datasets.tejani import ANNOTATION, MODELS, poses_to_text
from spigolo.lab.datasets.tejani import OBJECTS as TEJANI_OBJECTS
from spigolo.lab.datasets.uw_scenes import MASK_COLORS, MASK_FOLDER, category_of


def rutgers_name(object_name: str, bin_letter: str, clutter: int, position: int, shot: int) -> str:
    """Return the name that a frame must have for `write_rutgers`.

    Parameters
    ----------
    object_name
        Name of the labelled object.
    bin_letter
        Letter of the shelf bin, A..L.
    clutter
        Degree of clutter in the shelf bin, 0..2.
    position
        Number of the camera position, 0..2.
    shot
        Number of the frame at the camera position, 0..3.

    """
    return f"{object_name}-{bin_letter}-{clutter}-{position}-{shot}"


def uw_scenes_name(sequence: str, number: int) -> str:
    """Return the name that a frame must have for `write_uw_scenes`.

    Parameters
    ----------
    sequence
        Name of the sequence, such as table_1 or kitchen_small_1.
    number
        Number of the frame in the sequence, counted from 1.

    """
    return f"{sequence}_{number}"


def tejani_name(object_name: str, number: int) -> str:
    """Return the name that a frame must have for `write_tejani`.

    Raises FrameError if `object_name` is not an object of the data set by Tejani et al.

    Parameters
    ----------
    object_name
        Name of the scene's object: Coffee_Cup, Shampoo, Joystick, Camera, Juice or Milk.
    number
        Number of the frame in the scene, counted from 0.

    """
    if object_name not in TEJANI_OBJECTS:
        raise FrameError(f"expected one of {', '.join(TEJANI_OBJECTS)}, got {object_name}")
    return f"scene_{TEJANI_OBJECTS.index(object_name) + 1:02d}/img_{number:03d}"


def write_rutgers(folder: Path, samples: Iterable[Sample], models: Sequence[Model], about: str) -> int:
    """Write frames in the file layout of the reader `Rutgers`. A pose is written only for the object that the frame
    name contains.

    Returns the number of written frames. Raises FileError if a file cannot be written. Raises FrameError if a frame
    name does not have the form of `rutgers_name`, or if two frames have different cameras. Also raises FrameError if a
    frame does not show the object that the frame name contains exactly once.

    Parameters
    ----------
    folder
        Folder to write to.
    samples
        Frames with ground truth.
    models
        Models of all objects.
    about
        One-sentence description of the rendering, which is written to rendered.json.

    """
    images = _Images(folder, about)
    for model in models:
        write_model(folder / "models" / f"{model.name}.ply", model)
    for sample in samples:
        name, place = _parts(sample, r"(.+)-([A-L]-\d+-\d+-\d+)", "OBJECT-BIN-CLUTTER-POSITION-SHOT")
        poses = _poses_of(sample, name, models)
        if len(poses) > 1:
            raise FrameError(f"expected one {name} in frame {sample.frame.name}, got {len(poses)}")
        images.write(sample, f"{name}-image-{place}.png", f"{name}-depth-{place}.png")
        write_bytes(folder / f"{name}-pose-{place}.yml", pose_to_yaml(poses[0]).encode())
    return images.count


def write_uw_scenes(folder: Path, samples: Iterable[Sample], about: str) -> int:
    """Write frames in the file layout of the reader `UwScenes`. Masks and bounding boxes are written for the objects in
    the table `MASK_COLORS`.

    about: one-sentence description of the rendering, which is written to rendered.json. Returns the number of written
    frames. Raises FileError if a file cannot be written. Raises FrameError if a frame name does not have the form of
    `uw_scenes_name`. Also raises FrameError if two frames have different cameras, or if a frame shows an object twice.
    """
    images = _Images(folder, about)
    boxes: dict[str, dict[int, list[ObjectBox]]] = defaultdict(dict)
    for sample in samples:
        sequence, number = _parts(sample, r"(.+_\d+)_([1-9]\d*)", "SCENE_K_N")
        place = f"{_scene(sequence)}/{sequence}/{sequence}_{number}"
        images.write(sample, f"{place}.png", f"{place}_depth.png")
        shown = _shown(sample)
        write_png(folder / MASK_FOLDER / f"{sequence}_{number}_mask.png", _mask_picture(sample, shown))
        boxes[sequence][int(number)] = [box_of(*category_of(i.model), sample.labels == i.label) for i in shown]
    for sequence, frames in boxes.items():
        write_bytes(folder / _scene(sequence) / f"{sequence}.mat", boxes_to_mat(frames))
    return images.count


def write_tejani(folder: Path, samples: Iterable[Sample], models: Sequence[Model], about: str) -> int:
    """Write frames in the file layout of the reader `Tejani`, with the poses of all instances of the scene's object.

    Returns the number of written frames. Raises FileError if a file cannot be written. Raises FrameError if a frame
    name does not have the form of `tejani_name`, or if two frames have different cameras. Also raises FrameError if a
    frame has no instance of the scene's object.
    """
    images = _Images(folder, about)
    for model in models:
        if model.name in TEJANI_OBJECTS:
            write_model(folder / MODELS[0] / f"obj_{TEJANI_OBJECTS.index(model.name) + 1:02d}.ply", model)
    for sample in samples:
        scene, number = _parts(sample, r"scene_(0[1-6])/img_(\d+)", "scene_XX/img_NNN, XX from 01 to 06")
        poses = _poses_of(sample, TEJANI_OBJECTS[int(scene) - 1], models)
        place = f"test/scene_{scene}"
        images.write(sample, f"{place}/RGB/img_{number}.png", f"{place}/Depth/img_{number}.png")
        write_bytes(folder / ANNOTATION / f"scene_{scene}/poses{int(number)}.txt", poses_to_text(poses).encode())
    return images.count


def write_bop(folder: Path, samples: Iterable[Sample], models: Sequence[Model], about: str) -> int:
    """Write frames in the file layout of the reader `Bop`, with full and visible masks. Models are numbered from 1.

    A frame name of the form "SCENE/IMAGE" gives the numbers of scene and image, for example "3/12". Frames with other
    names are numbered and written to scene 1. about: one-sentence description of the rendering, which is written to
    rendered.json and dataset_info.md. Returns the number of written frames. Raises FileError if a file cannot be
    written. Raises FrameError if a frame has no camera, if two frames have the same scene and image numbers, or if an
    object has no model.
    """
    write_json(folder / RENDERED, {"about": about})
    write_description(folder, models, about)
    write_models(folder / "models", models)
    scenes: dict[int, SceneFiles] = {}
    count = 0
    for count, sample in enumerate(samples, start=1):
        found = re.fullmatch(r"(\d+)/(\d+)", sample.frame.name)
        scene, image = (int(found[1]), int(found[2])) if found else (1, count - 1)
        files = scenes.setdefault(scene, SceneFiles(folder / "test" / f"{scene:06d}", models))
        files.write(image, sample)
    for files in scenes.values():
        files.close()
    return count


class _Images:
    """Writer of the colour and depth images of frames. All frames must have the same camera intrinsics."""

    def __init__(self, folder: Path, about: str) -> None:
        self.count = 0
        self._folder = folder
        self._camera: Camera | None = None
        write_json(folder / RENDERED, {"about": about})

    def write(self, sample: Sample, color: str, depth: str) -> None:
        """Write the colour image and the depth image of a frame. The first call of `write` also writes camera.json."""
        camera = sample.frame.camera
        if camera is None or camera not in (self._camera, camera if self._camera is None else None):
            raise FrameError(f"expected one camera in all frames, got {camera} in {sample.frame.name}")
        if self._camera is None:
            names = ("fx", "fy", "cx", "cy", "width", "height")
            write_json(self._folder / "camera.json", {name: getattr(camera, name) for name in names})
            self._camera = camera
        write_png(self._folder / color, sample.frame.color)
        write_png(self._folder / depth, np.round(sample.frame.depth / MILLIMETRES).clip(0, 65535).astype(np.uint16))
        self.count += 1


def _parts(sample: Sample, pattern: str, shape: str) -> tuple[str, str]:
    found = re.fullmatch(pattern, sample.frame.name)
    if found is None:
        raise FrameError(
            f"expected a frame named {shape}, got {sample.frame.name!r}: the name becomes the path in the data set"
        )
    return found[1], found[2]


def _poses_of(sample: Sample, name: str, models: Sequence[Model]) -> list[Pose]:
    if name not in (model.name for model in models):
        raise FrameError(f"expected a model named {name} for frame {sample.frame.name}, got none")
    poses = [instance.pose for instance in sample.instances if instance.model == name]
    if not poses:
        raise FrameError(f"expected an instance of {name} in frame {sample.frame.name}, got none")
    return poses


def _shown(sample: Sample) -> list[Instance]:
    """Return the objects that have a colour in `MASK_COLORS` and at least one pixel in the frame."""
    present = set(np.unique(sample.labels).tolist())
    shown = [i for i in sample.instances if i.model in MASK_COLORS and i.label in present]
    names = [instance.model for instance in shown]
    if len(set(names)) < len(names):
        raise FrameError(f"expected each object once in frame {sample.frame.name}, got {', '.join(sorted(names))}")
    return shown


def _mask_picture(sample: Sample, shown: Iterable[Instance]) -> Color:
    picture = np.zeros((*sample.labels.shape, 3), np.uint8)
    for instance in shown:
        picture[sample.labels == instance.label] = MASK_COLORS[instance.model]
    return picture


def _scene(sequence: str) -> str:
    return sequence.rpartition("_")[0]
