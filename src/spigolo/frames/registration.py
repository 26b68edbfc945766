"""Registration of a depth map to the image of a colour camera next to the depth camera."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError, FrameError, UnitWarning, warn
from spigolo.frames.camera import Camera
from spigolo.frames.frame import DepthMap, depth_in_metres
from spigolo.kernels import registration as kernel

STEP_M = 0.03
STEP_SHARE = 0.03
"""At the depth Z, a depth step is a difference of more than max(STEP_M, STEP_SHARE * Z) metres between neighbouring
pixels.
"""
ROTATION_TOLERANCE = 1e-3
FARTHEST_M = 10.0
"""Maximum distance between depth camera and colour camera in metres. A longer translation between the cameras is
probably in millimetres and is rejected.
"""


def register_depth(
    depth: npt.ArrayLike,
    depth_camera: Camera,
    color_camera: Camera,
    T_color_depth: npt.ArrayLike,
    *,
    depth_scale: float | None = None,
) -> DepthMap:
    """Return the depth map (H, W) of the colour camera, float32 in metres, 0 where depth is unknown.

    Each square of four neighbouring depth pixels is drawn as a surface, so that surfaces have no holes in a larger
    colour image. If surfaces overlap in the image, the nearest surface is kept. No surface is drawn across a depth
    step.

    - depth: depth map (h, w) of `depth_camera`, floating-point metres, or integers with `depth_scale` metres per unit.
    - depth_camera: intrinsics of the depth camera. If the depth camera has distortion, the depth map is undistorted
      first.
    - color_camera: intrinsics of the colour camera, which must have no distortion.
    - T_color_depth: transform (4, 4) from the depth camera's frame to the colour camera's frame, translation in metres.

    Raises FrameError for an invalid depth map, and CameraError for an invalid camera or transform.
    """
    for camera in (depth_camera, color_camera):
        if not isinstance(camera, Camera):
            raise CameraError(
                f"expected a Camera with an image size, got {type(camera).__name__}:"
                " make one with spigolo.Camera.from_matrix(K, width, height)"
            )
    metres, _, beyond = depth_in_metres(np.asarray(np.ma.filled(depth, 0)), depth_scale)
    if beyond is not None:
        warn(str(beyond), UnitWarning)
    if metres.shape != (depth_camera.height, depth_camera.width):
        raise FrameError(
            f"expected depth of its camera's size {depth_camera.width}x{depth_camera.height},"
            f" got {metres.shape[1]}x{metres.shape[0]}: take the intrinsics of the depth stream, at this image size"
        )
    if color_camera.distortion:
        raise CameraError(
            "expected a colour camera without distortion: undistort the colour image (color_camera.undistort) and give"
            " color_camera.without_distortion()"
        )
    metres = np.ascontiguousarray(depth_camera.undistort(metres, nearest=True))
    out = np.zeros((color_camera.height, color_camera.width), np.float32)
    P = projection(depth_camera, color_camera, rigid_transform(T_color_depth, "T_color_depth", FARTHEST_M))
    kernel.splat_depth(metres, P, STEP_M, STEP_SHARE, out)
    return out


def projection(source: Camera, target: Camera, T_target_source: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the matrix P (3, 4) that converts pixel coordinates and depth in camera `source` to those in camera
    `target`.

    Pixel (x, y) at depth z maps to pixel (u, v) at depth Z by (u Z, v Z, Z) = P (x z, y z, z, 1).
    """
    rotated = T_target_source[:3, :3] @ np.linalg.inv(source.matrix)
    return np.ascontiguousarray(target.matrix @ np.column_stack([rotated, T_target_source[:3, 3]]))


def rigid_transform(value: npt.ArrayLike, name: str, farthest_m: float) -> npt.NDArray[np.float64]:
    """Return a validated rigid transform (4, 4) as float64.

    - name: name of the transform in error messages.
    - farthest_m: maximum length of the translation in metres.

    Raises CameraError for an invalid transform.
    """
    try:
        T: npt.NDArray[Any] = np.array(value, np.float64, order="C")
    except (TypeError, ValueError):
        raise CameraError(f"expected {name} as numbers of shape (4, 4)") from None
    if T.shape != (4, 4):
        raise CameraError(f"expected {name} as numbers of shape (4, 4), got shape {T.shape}")
    if not np.isfinite(T).all():
        raise CameraError(f"expected {name} as finite numbers, got some that are NaN or infinite")
    if not np.allclose(T[3], (0, 0, 0, 1), rtol=0, atol=ROTATION_TOLERANCE):
        raise CameraError(f"expected the last row of {name} as 0 0 0 1, got {T[3].tolist()}: transpose the matrix")
    R = T[:3, :3]
    if np.abs(R @ R.T - np.eye(3)).max() > ROTATION_TOLERANCE or np.linalg.det(R) < 0:
        raise CameraError(f"expected a rotation in {name}[:3, :3], got a matrix that scales, shears or mirrors")
    if np.linalg.norm(T[:3, 3]) > farthest_m:
        raise CameraError(f"expected the translation of {name} in metres, got {T[:3, 3].tolist()}")
    return T
