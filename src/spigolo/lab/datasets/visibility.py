"""Visible masks of objects with known models and poses, as in BOP (bop_toolkit, visibility).

A pixel belongs to an object if its model is rendered there and is at most 15 mm behind the measured surface. Both are
distances from the camera's centre. Pixels without depth count as visible. Letters used in shapes: H, W = image, N =
objects.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from spigolo.frames.camera import Camera
from spigolo.frames.frame import DepthMap, Mask
from spigolo.kernels.rasterising import draw_mesh
from spigolo.kernels.registration import FARTHEST_PX, NEAREST_M
from spigolo.lab.datasets.sample import Instance, Model

TOLERANCE_M = 0.015
"""Maximum distance of a model behind the measured surface, metres: bop_toolkit's delta."""


def render_depth(model: Model, pose: npt.NDArray[np.float64], camera: Camera) -> DepthMap:
    """Return the depth (H, W) in metres of a model at a pose (4, 4), model to camera. 0 outside the model. No
    distortion.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        x, y, z = (model.vertices_m @ pose[:3, :3].T + pose[:3, 3]).T
        inverse = np.divide(1.0, z, out=np.zeros_like(z), where=z >= NEAREST_M)
        points = np.stack([camera.fx * x * inverse + camera.cx, camera.fy * y * inverse + camera.cy, inverse], axis=1)
    points[~(np.abs(points) < FARTHEST_PX).all(axis=1)] = 0  # left out like points that are too near
    out = np.zeros((camera.height, camera.width), np.float32)
    draw_mesh(np.ascontiguousarray(points), np.ascontiguousarray(model.triangles, np.int32), out)
    return out


def visible_mask(drawn: DepthMap, measured: DepthMap, camera: Camera, tolerance_m: float = TOLERANCE_M) -> Mask:
    """Return the pixels (H, W) in which a rendered model is visible in the measured depth."""
    behind = (drawn - measured) * ray_lengths(camera)
    return np.asarray((drawn > 0) & ((measured == 0) | (behind <= tolerance_m)))


def visible_labels(
    instances: Sequence[Instance],
    models: Sequence[Model],
    measured: DepthMap,
    camera: Camera,
    tolerance_m: float = TOLERANCE_M,
) -> npt.NDArray[np.int32]:
    """Return labels (H, W) of the instances. models[n] is the model of instances[n]. The nearest visible one counts."""
    labels = np.zeros(measured.shape, np.int32)
    nearest = np.full(measured.shape, np.inf, np.float32)
    for instance, model in zip(instances, models, strict=True):
        drawn = render_depth(model, instance.pose, camera)
        here = visible_mask(drawn, measured, camera, tolerance_m) & (drawn < nearest)
        labels[here], nearest[here] = instance.label, drawn[here]
    return labels


def ray_lengths(camera: Camera) -> DepthMap:
    """Return the distance (H, W) from the camera's centre of points at depth 1."""
    x = (np.arange(camera.width) - camera.cx) / camera.fx
    y = (np.arange(camera.height) - camera.cy) / camera.fy
    return np.sqrt(1 + x[None] ** 2 + y[:, None] ** 2).astype(np.float32)
