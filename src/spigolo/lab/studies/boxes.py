"""Accuracy of the oriented boxes of objects. `python -m spigolo.lab.studies.boxes` prints a table for boxes of known
size that stand on a table, seen from different directions, with three kinds of depth:

- exact: depth without noise
- structured light: noise and random holes at the outline, as of a Kinect
- stereo: more noise, and depth steps that are smeared over five pixels
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.camera import Camera
from spigolo.frames.frame import DepthMap, Mask
from spigolo.objects.boxes import OrientedBox, fit_box

VIEWS = 60
CAMERA = Camera(600, 600, 319.5, 239.5, 640, 480)
SIDES_M = 0.04, 0.25
DISTANCES_M = 0.5, 1.3
TILTS_DEG = 20.0, 70.0
NOISE_PER_M = 0.0012
"""Standard deviation of the depth noise divided by the squared depth, 1/m."""
SMEAR_PX = 5

Vectors = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Box on a table."""

    depth: DepthMap
    """Exact depth map (H, W) in metres."""
    mask: Mask
    """Mask (H, W) of the pixels of the box."""
    size_m: Vectors
    """Side lengths (3,) of the box, the height last."""
    center_m: Vectors
    """Centre (3,) of the box in the camera's frame."""
    axes: Vectors
    """Rotation matrix (3, 3) whose columns are the directions of the sides."""


def draw_scene(rng: np.random.Generator) -> Scene:
    """Return a box of random size and direction on a table, and its depth map."""
    y, x = np.mgrid[: CAMERA.height, : CAMERA.width]
    rays = np.stack([(x - CAMERA.cx) / CAMERA.fx, (y - CAMERA.cy) / CAMERA.fy, np.ones(x.shape)], axis=-1)
    tilt = np.radians(rng.uniform(*TILTS_DEG))
    up = np.array([0.0, -np.sin(tilt), -np.cos(tilt)])
    foot = np.array([rng.uniform(-0.2, 0.2), 0.05, rng.uniform(*DISTANCES_M)])
    turn, size = rng.uniform(0, np.pi), rng.uniform(*SIDES_M, 3)
    along = np.array([np.cos(turn), 0.0, 0.0]) + np.sin(turn) * np.cross(up, [1.0, 0.0, 0.0])
    axes = np.column_stack([along, np.cross(up, along), up])
    center = foot + up * size[2] / 2
    table = (foot @ up) / (rays @ up)
    with np.errstate(divide="ignore"):
        ends = (np.array([-1, 1])[:, None, None, None] * size / 2 + center @ axes) / (rays @ axes)
    first, last = ends.min(0).max(-1), ends.max(0).min(-1)
    hit = (first < last) & (first > 0)
    return Scene(np.where(hit, first, table).astype(np.float32), hit, size, center, axes)


def spoil(scene: Scene, kind: str, rng: np.random.Generator) -> tuple[DepthMap, Mask]:
    """Return the depth map and the mask of a scene with the errors of a kind of camera."""
    if kind == "exact":
        return scene.depth, scene.mask
    noise = cv2.GaussianBlur(rng.normal(size=scene.depth.shape).astype(np.float32), (0, 0), 1)
    noise *= np.float32(NOISE_PER_M) * scene.depth**2 / noise.std()
    wide = cv2.dilate(scene.mask.view(np.uint8), np.ones((3, 3), np.uint8)) > 0
    if kind == "stereo":
        return (cv2.blur(scene.depth, (SMEAR_PX, SMEAR_PX)) + np.float32(1.5) * noise).astype(np.float32), wide
    rim = wide & (cv2.erode(scene.mask.view(np.uint8), np.ones((3, 3), np.uint8)) == 0)
    return np.where(rim & (rng.random(rim.shape) < 0.3), 0, scene.depth + noise).astype(np.float32), scene.mask


def errors_mm(box: OrientedBox, scene: Scene) -> Vectors:
    """Return three errors in millimetres: the median and the largest absolute error of a side, and the distance of the
    centre from the true centre.
    """
    same = np.abs(box.R_camera_box.T @ scene.axes).argmax(1)
    sides = box.size_m - scene.size_m[same]
    return 1e3 * np.array([np.median(sides), np.abs(sides).max(), np.linalg.norm(box.center_m - scene.center_m)])


def main() -> None:
    """Print the median errors for each kind of depth."""
    print("| depth | error of a side (median) | largest error of a side | distance of the centre |")
    print("|---|---:|---:|---:|")
    for kind in ("exact", "structured light", "stereo"):
        errors = []
        for seed in range(VIEWS):
            rng = np.random.default_rng(seed)
            scene = draw_scene(rng)
            depth, mask = spoil(scene, kind, rng)
            box = fit_box(mask, depth, CAMERA, scene.axes[:, 2])
            if box is not None:
                errors.append(errors_mm(box, scene))
        cells = " | ".join(f"{value:.1f} mm" for value in np.median(errors, axis=0))
        print(f"| {kind} | {cells} |")


if __name__ == "__main__":
    main()
