"""Visible masks of objects whose models and poses are known, as BOP makes them (bop_toolkit, visibility).

A pixel belongs to an object where its model is drawn and is not more than 15 mm behind what was measured, both as
distances from the camera's centre. If nothing was measured it counts as visible.
Letters used in shapes: H, W = image, N = objects.
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
"""Maximum distance of a model behind the measured surface: bop_toolkit's delta."""


def render_depth(model: Model, pose: npt.NDArray[np.float64], camera: Camera) -> DepthMap:
    """Depth (H, W) in metres of a model at a pose (4, 4), model to camera. 0 if it is not. No distortion."""
    with np.errstate(over="ignore", invalid="ignore"):
        x, y, z = (model.vertices_m @ pose[:3, :3].T + pose[:3, 3]).T
        inverse = np.divide(1.0, z, out=np.zeros_like(z), where=z >= NEAREST_M)
        points = np.stack([camera.fx * x * inverse + camera.cx, camera.fy * y * inverse + camera.cy, inverse], axis=1)
    points[~(np.abs(points) < FARTHEST_PX).all(axis=1)] = 0  # left out, as what is too near
    out = np.zeros((camera.height, camera.width), np.float32)
    draw_mesh(np.ascontiguousarray(points), np.ascontiguousarray(model.triangles, np.int32), out)
    return out


def visible_mask(drawn: DepthMap, measured: DepthMap, camera: Camera, tolerance_m: float = TOLERANCE_M) -> Mask:
    """Return the pixels (H, W) in which a drawn model is visible in the measured depth."""
    behind = (drawn - measured) * ray_lengths(camera)
    return np.asarray((drawn > 0) & ((measured == 0) | (behind <= tolerance_m)))


def visible_labels(
    instances: Sequence[Instance],
    models: Sequence[Model],
    measured: DepthMap,
    camera: Camera,
    tolerance_m: float = TOLERANCE_M,
) -> npt.NDArray[np.int32]:
    """Labels (H, W) of the instances, models[n] being that of instances[n]. If several are visible the nearest."""
    labels = np.zeros(measured.shape, np.int32)
    nearest = np.full(measured.shape, np.inf, np.float32)
    for instance, model in zip(instances, models, strict=True):
        drawn = render_depth(model, instance.pose, camera)
        here = visible_mask(drawn, measured, camera, tolerance_m) & (drawn < nearest)
        labels[here], nearest[here] = instance.label, drawn[here]
    return labels


def ray_lengths(camera: Camera) -> DepthMap:
    """Distance (H, W) from the camera's centre of what lies at depth 1."""
    x = (np.arange(camera.width) - camera.cx) / camera.fx
    y = (np.arange(camera.height) - camera.cy) / camera.fy
    return np.sqrt(1 + x[None] ** 2 + y[:, None] ** 2).astype(np.float32)
