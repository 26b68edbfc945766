"""Depth moved from one camera's image into another's, on surfaces whose depth is known."""

from __future__ import annotations

import dataclasses
from typing import Any

import cv2
import numpy as np
import pytest

from spigolo import Camera, Frame
from spigolo.errors import CameraError, FrameError
from spigolo.frames.registration import register_depth

Array = np.ndarray
DEPTH_CAMERA = Camera(100.0, 102.0, 39.2, 30.7, 80, 60)
IDENTITY = np.eye(4)


def transform(axis_deg: tuple[float, float, float], translation_m: tuple[float, float, float]) -> Array:
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(np.radians(np.array(axis_deg, float)))[0]
    T[:3, 3] = translation_m
    return T


BESIDE = transform((0, 0, 0), (0.05, 0, 0))


def plane_depth(camera: Camera, normal: Array, offset_m: float) -> Array:
    """Depth (H, W) of the plane normal . p = offset_m."""
    y, x = np.mgrid[: camera.height, : camera.width]
    rays = np.stack([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, np.ones(x.shape)], -1)
    return offset_m / (rays @ normal)


def sees(camera: Camera, other: Camera, depth: Array, T_other_camera: Array, margin_px: float) -> Array:
    """Where (H, W) the points of a camera's depth lie inside the other camera's image, off its border."""
    points = camera.back_project(np.where(depth > 0, depth, 1)).astype(np.float64)
    moved = points @ T_other_camera[:3, :3].T + T_other_camera[:3, 3]
    u, v, _ = other.matrix @ (moved / moved[:, 2:]).T
    inside = (u > margin_px) & (u < other.width - 1 - margin_px) & (v > margin_px) & (v < other.height - 1 - margin_px)
    return inside.reshape(depth.shape)


def test_the_same_camera_gives_the_depth_back() -> None:
    rng = np.random.default_rng(0)
    depth = np.where(rng.random((60, 80)) < 0.3, 0, rng.uniform(0.4, 5, (60, 80))).astype(np.float32)
    depth[20:50, 10:60] = plane_depth(DEPTH_CAMERA, np.array([0.3, 0.4, 1]), 1.2)[20:50, 10:60]
    depth[30:33, 20:22] = 0
    out = register_depth(depth, DEPTH_CAMERA, DEPTH_CAMERA, IDENTITY)
    np.testing.assert_array_equal(out == 0, depth == 0)
    np.testing.assert_allclose(out, depth, atol=1e-4, rtol=0)
    assert (out.dtype, out.shape) == (np.float32, (60, 80))


@pytest.mark.frames
def test_the_same_camera_gives_the_depth_of_real_frames_back(frames: list[Frame]) -> None:
    for frame in frames:
        out = register_depth(frame.depth, frame.camera, frame.camera, IDENTITY)
        np.testing.assert_array_equal(out == 0, frame.depth == 0)
        np.testing.assert_allclose(out, frame.depth, atol=1e-4, rtol=0)


@pytest.mark.parametrize("scale", [0.5, 1, 2, 5])
@pytest.mark.parametrize("T", [BESIDE, transform((3, -5, 10), (0.05, 0.02, -0.03)), transform((0, 0, 180), (0, 0, 0))])
def test_a_plane_has_its_analytic_depth_and_no_hole(T: Array, scale: float) -> None:
    normal, offset = np.array([0.35, -0.2, 1.0]), 1.1
    color_camera = DEPTH_CAMERA.scaled(int(80 * scale), int(60 * scale))
    turned = T[:3, :3] @ normal
    expected = plane_depth(color_camera, turned, offset + turned @ T[:3, 3])
    depth = plane_depth(DEPTH_CAMERA, normal, offset)
    out = register_depth(depth, DEPTH_CAMERA, color_camera, T)
    interior = sees(color_camera, DEPTH_CAMERA, expected, np.linalg.inv(T), 0.01)
    assert interior.mean() > 0.4
    assert (out[interior] > 0).all()
    assert np.abs(out - expected)[interior].max() < 1e-3
    outside = ~sees(color_camera, DEPTH_CAMERA, expected, np.linalg.inv(T), -0.6)
    assert not out[outside].any()


@pytest.mark.parametrize("scale", [1, 2])
def test_an_occluder_hides_the_background_and_leaves_a_shadow(scale: int) -> None:
    depth = np.full((60, 80), 2.0)
    depth[15:45, 30:50] = 1.0
    color_camera = DEPTH_CAMERA.scaled(80 * scale, 60 * scale)
    out = register_depth(depth, DEPTH_CAMERA, color_camera, transform((0, 0, 0), (0.1, 0, 0)))
    assert set(np.unique(out).round(6)) == {0.0, 1.0, 2.0}, "depth is mixed across the step"
    row = out[30 * scale]
    # by 0.1 m the occluder moves 10 pixels to the right and the background 5
    near = np.nonzero(np.isclose(row, 1))[0]
    assert (near.min(), near.max()) == (40 * scale, 60 * scale - 1)
    assert np.isclose(row[35 * scale : 40 * scale], 0).all(), "the shadow is on its left"
    assert np.isclose(row[60 * scale :], 2).all(), "background stands on its right at once"


def test_a_thing_of_one_pixel_keeps_its_footprint() -> None:
    depth = np.zeros((60, 80))
    depth[30, 40] = 1.0
    color_camera = DEPTH_CAMERA.scaled(320, 240)
    out = register_depth(depth, DEPTH_CAMERA, color_camera, IDENTITY)
    y, x = np.nonzero(out)
    assert (y.min(), y.max(), x.min(), x.max(), y.size) == (120, 123, 160, 163, 16)


def test_there_and_back_again() -> None:
    y, x = np.mgrid[:60, :80]
    depth = 1.2 - 0.1 * np.exp(-((x - 40) ** 2 + (y - 30) ** 2) / 300)
    T, color_camera = transform((2, 4, -6), (0.05, -0.02, 0.03)), DEPTH_CAMERA.scaled(240, 180)
    there = register_depth(depth, DEPTH_CAMERA, color_camera, T)
    back = register_depth(there, color_camera, DEPTH_CAMERA, np.linalg.inv(T))
    interior = sees(DEPTH_CAMERA, color_camera, depth, T, 1) & (np.minimum(x, 79 - x) > 1) & (np.minimum(y, 59 - y) > 1)
    assert interior.mean() > 0.6
    assert np.abs(back - depth)[interior].max() < 1e-3


def test_what_lies_behind_the_colour_camera_is_left_out() -> None:
    out = register_depth(np.ones((60, 80)), DEPTH_CAMERA, DEPTH_CAMERA, transform((0, 0, 0), (0, 0, -1.5)))
    assert not out.any()


def test_integers_have_a_scale_and_missing_stays_missing() -> None:
    depth = np.full((60, 80), 1500, np.uint16)
    depth[10:20, 10:20] = 0
    out = register_depth(depth, DEPTH_CAMERA, DEPTH_CAMERA, IDENTITY, depth_scale=0.001)
    np.testing.assert_allclose(out, depth * 0.001, atol=1e-6)


def test_depth_of_a_camera_with_distortion_is_undistorted() -> None:
    camera = dataclasses.replace(DEPTH_CAMERA, distortion=(-0.2, 0.05, 0, 0))
    depth = np.random.default_rng(1).choice([0.8, 1.2], (60, 80)).astype(np.float32)
    out = register_depth(depth, camera, DEPTH_CAMERA, IDENTITY)
    np.testing.assert_allclose(out, camera.undistort(depth, nearest=True), atol=1e-6)
    assert (out != depth).any()


SHEARED = np.eye(4)
SHEARED[0, 1] = 0.1


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        ({"depth": np.ones((60, 81))}, FrameError, "camera's size 80x60, got 81x60"),
        ({"depth": np.ones((60, 80), np.uint16)}, FrameError, "depth_scale"),
        ({"T_color_depth": np.eye(3)}, CameraError, r"shape \(4, 4\), got shape \(3, 3\)"),
        ({"T_color_depth": "identity"}, CameraError, r"numbers of shape \(4, 4\)"),
        ({"T_color_depth": np.full((4, 4), np.nan)}, CameraError, "finite"),
        ({"T_color_depth": BESIDE.T}, CameraError, "transpose"),
        ({"T_color_depth": SHEARED}, CameraError, "scales, shears or mirrors"),
        ({"T_color_depth": np.diag([-1.0, 1, 1, 1])}, CameraError, "scales, shears or mirrors"),
        ({"T_color_depth": transform((0, 0, 0), (25, 0, 0))}, CameraError, "in metres"),
        (
            {"color_camera": dataclasses.replace(DEPTH_CAMERA, distortion=(0.1, 0, 0, 0))},
            CameraError,
            "without distortion",
        ),
    ],
)
def test_what_cannot_be_registered_is_refused_with_one_sentence(
    changes: dict[str, Any], error: type[Exception], words: str
) -> None:
    arguments = {
        "depth": np.ones((60, 80)),
        "depth_camera": DEPTH_CAMERA,
        "color_camera": DEPTH_CAMERA,
        "T_color_depth": IDENTITY,
    }
    with pytest.raises(error, match=words) as caught:
        register_depth(**(arguments | changes))
    assert "\n" not in str(caught.value)


def test_what_lies_nowhere_near_the_image_is_not_drawn() -> None:
    """Corners 2.5e9 px apart: for a loop over their pixels nobody could wait."""
    wide, narrow = Camera(0.04, 0.04, 0.0, 0.0, 2, 2), Camera(1e8, 1e8, 2.0, 2.0, 5, 5)
    assert not register_depth(np.ones((2, 2)), wide, narrow, np.eye(4)).any()
    assert register_depth(np.ones((2, 2)), wide, Camera(1e6, 1e6, 2.0, 2.0, 5, 5), np.eye(4)).any()
