"""The plane that objects stand on."""

from __future__ import annotations

import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.plane import above_mask, foot_contour, support_mask
from spigolo.additions.support import find_support

CAMERA = sp.Camera(fx=260.0, fy=260.0, cx=79.5, cy=59.5, width=160, height=120)
TILT = np.deg2rad(50)
NORMAL = np.array([0.0, -np.cos(TILT), -np.sin(TILT)])
"""A table seen from above: up is towards the camera and against Y."""
DISTANCE_M = 0.7


def table(box: bool = True, noise_m: float = 0.0) -> np.ndarray:
    """Depth (120, 160) of a table at 0.7 m along its normal, with a 4 cm high box on it."""
    y, x = np.mgrid[0:120, 0:160]
    rays = np.stack([(x - CAMERA.cx) / CAMERA.fx, (y - CAMERA.cy) / CAMERA.fy, np.ones(x.shape)], axis=-1)
    depth = -DISTANCE_M / (rays @ NORMAL)
    if box:
        depth[40:70, 60:100] = (-(DISTANCE_M - 0.04) / (rays @ NORMAL))[40:70, 60:100]
    return (depth + np.random.default_rng(0).normal(0, noise_m, depth.shape)).astype(np.float32)


@pytest.mark.parametrize("noise_m", [0.0, 0.002])
def test_the_table_is_found_with_its_normal_and_distance(noise_m: float) -> None:
    plane = find_support(table(noise_m=noise_m), CAMERA, sp.settings.Support())
    assert plane is not None
    assert plane.normal @ NORMAL > np.cos(np.deg2rad(0.5))
    assert plane.offset_m == pytest.approx(DISTANCE_M, abs=0.002)
    points = CAMERA.back_project(table(noise_m=0.0)).astype(float)
    heights = plane.height_m(points)
    flat = plane.height_map_m(table(noise_m=0.0), CAMERA)
    assert flat.ravel() == pytest.approx(heights, abs=1e-5)
    assert flat[50, 80] == pytest.approx(0.04, abs=0.003)


def test_what_stands_on_it_is_above_and_its_foot_runs_around_it() -> None:
    depth, rule = table(), sp.settings.Support()
    plane = find_support(depth, CAMERA, rule)
    assert plane is not None
    above = above_mask(plane, depth, CAMERA, rule)
    assert above[40:70, 60:100].all()
    assert np.count_nonzero(above) == 30 * 40
    assert not (above & support_mask(plane, depth, CAMERA, rule)).any()
    foot = foot_contour(plane, depth, CAMERA, rule)
    assert foot[40, 65:95].all()
    assert foot[45:65, 60].all()
    assert not foot[44:66, 64:96].any()


def test_missing_depth_neither_stands_nor_supports() -> None:
    depth, rule = table(), sp.settings.Support()
    depth[30:80, 20:55] = 0
    plane = find_support(depth, CAMERA, rule)
    assert plane is not None
    assert not above_mask(plane, depth, CAMERA, rule)[30:80, 20:55].any()
    assert not support_mask(plane, depth, CAMERA, rule)[30:80, 20:55].any()


@pytest.mark.parametrize("depth", [np.zeros((120, 160)), np.eye(120, 160), np.zeros((120, 160)) + np.eye(120, 160, 3)])
def test_without_enough_depth_there_is_no_plane_or_a_plane_but_no_error(depth: np.ndarray) -> None:
    find_support(depth.astype(np.float32), CAMERA, sp.settings.Support())


def test_a_plane_with_too_small_a_share_supports_nothing() -> None:
    rng = np.random.default_rng(1)
    cloud = rng.uniform(0.5, 3, (120, 160)).astype(np.float32)
    assert find_support(cloud, CAMERA, sp.settings.Support(min_share=0.3)) is None


def test_the_same_frame_gives_the_same_plane() -> None:
    first, second = (find_support(table(noise_m=0.002), CAMERA, sp.settings.Support()) for _ in range(2))
    assert first is not None
    assert second is not None
    assert np.array_equal(first.normal, second.normal)


def test_the_table_and_what_lies_below_it_are_no_objects() -> None:
    depth = np.kron(table(), np.ones((4, 4)))  # 640x480
    depth[:, 520:] += 0.4  # the floor beside it
    depth += np.random.default_rng(0).normal(0, 0.002, depth.shape)
    color = np.full((480, 640, 3), 120, np.uint8)
    color[160:280, 240:400] = (200, 40, 40)
    color += np.random.default_rng(0).integers(0, 5, color.shape, dtype=np.uint8)
    camera = sp.Camera(fx=1040.0, fy=1040.0, cx=319.5, cy=239.5, width=640, height=480)
    config = sp.OBJECTS.replace(rejection={"max_lambda1_px2": None, "max_lambda2_px2": None, "max_eccentricity": None})
    result = sp.segment(sp.Frame(color, depth, camera), config)
    assert len(result) == 1
    assert result[0].area_px == pytest.approx(120 * 160, rel=0.05)
    assert result[0].above == pytest.approx(1, abs=0.05)
    assert {r.reason for r in result.rejected} == {sp.Reason.SUPPORT}
    assert result.support is not None
    assert result.support[400, 80]
    assert not (result.support & (result.labels > 0)).any()
    assert not result.support[400, 600]


def test_the_papers_presets_look_for_no_support() -> None:
    for config in (sp.SHELF, sp.TABLE, sp.CLUTTER):
        assert config.additions is None
        result = sp.segment(sp.Frame(np.zeros((120, 160, 3), np.uint8), table(), CAMERA), config)
        assert result.support is None
        assert all(r.above is None for r in result.rejected)
