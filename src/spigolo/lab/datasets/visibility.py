"""Visible masks of objects with known models and poses, computed as in BOP (module visibility of bop_toolkit).

A pixel belongs to an object if the rendered model is at most 15 mm behind the measured surface. Distances are measured
along the ray from the camera centre. Pixels without measured depth count as visible. Letters in array shapes: H, W =
image height and width.
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
"""Maximum distance of a visible model behind the measured surface, metres.

The maximum distance is called delta in bop_toolkit.
"""


def render_depth(model: Model, pose: npt.NDArray[np.float64], camera: Camera) -> DepthMap:
    """Render the depth map (H, W) of a model, metres. Pixels outside the model are 0.

    pose: transform (4, 4) from the model's frame to the camera frame. Lens distortion is not rendered.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        x, y, z = (model.vertices_m @ pose[:3, :3].T + pose[:3, 3]).T
        inverse = np.divide(1.0, z, out=np.zeros_like(z), where=z >= NEAREST_M)
        points = np.stack([camera.fx * x * inverse + camera.cx, camera.fy * y * inverse + camera.cy, inverse], axis=1)
    points[~(np.abs(points) < FARTHEST_PX).all(axis=1)] = 0  # points far outside the image are left out
    out = np.zeros((camera.height, camera.width), np.float32)
    draw_mesh(np.ascontiguousarray(points), np.ascontiguousarray(model.triangles, np.int32), out)
    return out


def visible_mask(drawn: DepthMap, measured: DepthMap, camera: Camera, tolerance_m: float = TOLERANCE_M) -> Mask:
    """Return the mask (H, W) of the pixels in which a rendered model is visible.

    Parameters
    ----------
    drawn
        Depth map (H, W) rendered from the model, metres.
    measured
        Measured depth map (H, W), metres.
    camera
        Camera intrinsics of the rendered and of the measured depth map.
    tolerance_m
        Maximum distance of a visible model behind the measured surface, metres.

    """
    behind = (drawn - measured) * ray_lengths(camera)
    return np.asarray((drawn > 0) & ((measured == 0) | (behind <= tolerance_m)))


def visible_labels(
    instances: Sequence[Instance],
    models: Sequence[Model],
    measured: DepthMap,
    camera: Camera,
    tolerance_m: float = TOLERANCE_M,
) -> npt.NDArray[np.int32]:
    """Return the label image (H, W) of the visible instances.

    Each pixel gets the label of the nearest visible instance.

    Parameters
    ----------
    instances
        Labelled objects with their poses.
    models
        Model of each instance, in the order of `instances`.
    measured
        Measured depth map (H, W), metres.
    camera
        Camera intrinsics of the measured depth map.
    tolerance_m
        Maximum distance of a visible model behind the measured surface, metres.

    """
    labels = np.zeros(measured.shape, np.int32)
    nearest = np.full(measured.shape, np.inf, np.float32)
    for instance, model in zip(instances, models, strict=True):
        drawn = render_depth(model, instance.pose, camera)
        here = visible_mask(drawn, measured, camera, tolerance_m) & (drawn < nearest)
        labels[here], nearest[here] = instance.label, drawn[here]
    return labels


def ray_lengths(camera: Camera) -> DepthMap:
    """Return the distance (H, W) from the camera centre to the point at depth Z = 1 on the ray of each pixel."""
    x = (np.arange(camera.width) - camera.cx) / camera.fx
    y = (np.arange(camera.height) - camera.cy) / camera.fy
    return np.sqrt(1 + x[None] ** 2 + y[:, None] ** 2).astype(np.float32)
