"""Writer of data sets in the BOP layout, which `spigolo.lab.datasets.bop` reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from spigolo.errors import FrameError
from spigolo.frames.files import write_bytes, write_json, write_png
from spigolo.frames.frame import Mask
from spigolo.lab.datasets.entry import MILLIMETRES
from spigolo.lab.datasets.meshes import write_model
from spigolo.lab.datasets.sample import Instance, Model, Sample
from spigolo.lab.datasets.visibility import render_depth

FINE_MM, COARSE_MM = 0.1, 1.0
"""Depth units of stored depth images, in millimetres. The depth unit is `COARSE_MM` if a depth value in units of
`FINE_MM` does not fit into 16 bits.
"""
FULL = 65535


def write_models(folder: Path, models: Sequence[Model]) -> None:
    """Write the object models as obj_000001.ply, obj_000002.ply, ..., and write models_info.json with the sizes of the
    models in millimetres.
    """
    sizes = {}
    for obj_id, model in enumerate(models, start=1):
        write_model(folder / f"obj_{obj_id:06d}.ply", model, MILLIMETRES)
        low, high = model.vertices_m.min(0) / MILLIMETRES, model.vertices_m.max(0) / MILLIMETRES
        corner = dict(zip(("min_x", "min_y", "min_z"), low.tolist(), strict=True))
        size = dict(zip(("size_x", "size_y", "size_z"), (high - low).tolist(), strict=True))
        sizes[str(obj_id)] = {"diameter": _diameter(model) / MILLIMETRES, **corner, **size}
    write_json(folder / "models_info.json", sizes)


def write_description(folder: Path, models: Sequence[Model], about: str) -> None:
    """Write dataset_info.md with a description of the data set and a list of its objects."""
    objects = [f"- {obj_id}: {model.name}" for obj_id, model in enumerate(models, start=1)]
    lines = [f"# {folder.name}: rendered frames", "", about, "", "Objects:", "", *objects, ""]
    write_bytes(folder / "dataset_info.md", "\n".join(lines).encode())


class SceneFiles:
    """Writer of one BOP scene. Call `close` after the last frame to write the JSON files, which readers require."""

    def __init__(self, folder: Path, models: Sequence[Model]) -> None:
        self._folder = folder
        self._models = {model.name: (obj_id, model) for obj_id, model in enumerate(models, start=1)}
        self._cameras: dict[str, Any] = {}
        self._truth: dict[str, Any] = {}
        self._info: dict[str, Any] = {}

    def write(self, image: int, sample: Sample) -> None:
        """Write the colour image, depth image and masks of one frame.

        Raises FileError if a file cannot be written. Raises FrameError if the frame has no camera, if the image number
        was written before, or if an object has no model.
        """
        frame, key = sample.frame, str(image)
        if frame.camera is None or key in self._cameras:
            raise FrameError(f"expected frame {frame.name} with a camera and only once in its scene")
        unit_mm = FINE_MM if frame.depth.max() < FULL * FINE_MM * MILLIMETRES else COARSE_MM
        stored = np.round(frame.depth / (unit_mm * MILLIMETRES)).clip(0, FULL).astype(np.uint16)
        write_png(self._folder / f"rgb/{image:06d}.png", frame.color)
        write_png(self._folder / f"depth/{image:06d}.png", stored)
        self._cameras[key] = {"cam_K": frame.camera.matrix.ravel().tolist(), "depth_scale": unit_mm}
        self._truth[key] = [self._pose(instance, sample) for instance in sample.instances]
        self._info[key] = [self._masks(image, n, instance, sample) for n, instance in enumerate(sample.instances)]

    def close(self) -> None:
        """Write the JSON files of the scene."""
        write_json(self._folder / "scene_gt.json", self._truth)
        write_json(self._folder / "scene_gt_info.json", self._info)
        write_json(self._folder / "scene_camera.json", self._cameras)

    def _pose(self, instance: Instance, sample: Sample) -> dict[str, Any]:
        if instance.model not in self._models:
            raise FrameError(f"expected a model named {instance.model} for frame {sample.frame.name}, got none")
        return {
            "obj_id": self._models[instance.model][0],
            "cam_R_m2c": instance.pose[:3, :3].ravel().tolist(),
            "cam_t_m2c": (instance.pose[:3, 3] / MILLIMETRES).tolist(),
        }

    def _masks(self, image: int, number: int, instance: Instance, sample: Sample) -> dict[str, Any]:
        """Write the full mask and the visible mask of an object. Return the bounding box and the number of pixels of
        each mask.
        """
        camera = sample.frame.camera
        assert camera is not None
        whole = render_depth(self._models[instance.model][1], instance.pose, camera) > 0
        visible = sample.labels == instance.label
        for name, mask in (("mask", whole), ("mask_visib", visible)):
            write_png(self._folder / f"{name}/{image:06d}_{number:06d}.png", mask.astype(np.uint8) * 255)
        total, seen = int(whole.sum()), int(visible.sum())
        return {
            "bbox_obj": _box(whole),
            "bbox_visib": _box(visible),
            "px_count_all": total,
            "px_count_valid": int((whole & (sample.frame.depth > 0)).sum()),
            "px_count_visib": seen,
            "visib_fract": min(1.0, seen / total) if total else 0.0,
        }


def _box(mask: Mask) -> list[int]:
    """Return the bounding box x, y, width, height of a mask in pixels.

    For an empty mask, all four values are -1, as in the BOP format.
    """
    y, x = np.nonzero(mask)
    if not x.size:
        return [-1, -1, -1, -1]
    return [int(x.min()), int(y.min()), int(np.ptp(x)) + 1, int(np.ptp(y)) + 1]


def _diameter(model: Model) -> float:
    """Return the largest distance between two vertices of a model, metres."""
    points = np.unique(model.vertices_m, axis=0)
    blocks = (points[k : k + 256] for k in range(0, len(points), 256))
    return max(float(np.linalg.norm(block[:, None] - points, axis=2).max()) for block in blocks)
