"""The depth-camera model, and the bundled demo scene."""

from __future__ import annotations

import ctypes.util
import importlib.util
import json
import os
from importlib.resources import files
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from spigolo.lab.synthetic import meshes
from spigolo.lab.synthetic.demo_scene import CAMERA, OBJECT_NAMES, load_model, render_geometry, scene_objects
from spigolo.lab.synthetic.structured_light import (
    StructuredLight,
    correlated_noise,
    projector_shadow,
    simulate_structured_light,
)

FX_PX = 525.0
BASELINE_M = 0.075
DEMO_SCENE = Path(str(files("spigolo"))) / "demo_scene"
DEMO_FILES = ("rgb.png", "depth.png", "label.png", "camera.json")


def need_renderer() -> None:
    """Skips where MuJoCo or the library it draws with is missing, but not in the automatic checks."""
    lacks = importlib.util.find_spec("mujoco") is None or ctypes.util.find_library("EGL") is None
    if lacks and not os.environ.get("CI"):
        pytest.skip("MuJoCo or libEGL is not installed")
    os.environ.setdefault("MUJOCO_GL", "egl")


def measured(depth_m: npt.NDArray[np.float64], brightness: int = 128, seed: int = 0) -> npt.NDArray[np.float32]:
    rgb = np.full((*depth_m.shape, 3), brightness, dtype=np.uint8)
    return simulate_structured_light(depth_m, rgb, FX_PX, np.random.default_rng(seed))


def facing_plane(distance_m: float, shape: tuple[int, int] = (120, 160)) -> npt.NDArray[np.float64]:
    return np.full(shape, distance_m)


def box_before_wall(near_m: float, far_m: float) -> npt.NDArray[np.float64]:
    depth_m = facing_plane(far_m, (60, 320))
    depth_m[10:50, 160:220] = near_m
    return depth_m


def as_disparity_px(depth_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return FX_PX * BASELINE_M / depth_m


def expected_spread_m(distance_m: float, sensor: StructuredLight) -> float:
    spread_px = np.hypot(sensor.noise_px, sensor.disparity_step_px / np.sqrt(12))
    return float(distance_m**2 / (FX_PX * sensor.baseline_m) * spread_px)


@pytest.mark.parametrize("distance_m", [0.6, 1.0, 2.0, 3.5])
def test_a_facing_plane_stays_within_the_noise_of_its_distance(distance_m: float) -> None:
    depth_m = measured(facing_plane(distance_m))
    assert np.all(depth_m > 0)
    spread_m = expected_spread_m(distance_m, StructuredLight())
    assert np.std(depth_m) == pytest.approx(spread_m, rel=0.15)
    assert abs(np.mean(depth_m) - distance_m) < 0.3 * spread_m


def test_noise_grows_with_the_square_of_distance() -> None:
    near, far = (np.std(measured(facing_plane(distance_m))) for distance_m in (1.0, 3.0))
    assert far / near == pytest.approx(9.0, rel=0.15)


def test_disparity_comes_in_eighths_of_a_pixel() -> None:
    eighths = 8 * FX_PX * BASELINE_M / measured(facing_plane(1.3)).astype(np.float64)
    np.testing.assert_allclose(eighths, np.round(eighths), atol=1e-3)


def test_correlated_noise_has_unit_variance_and_like_neighbours() -> None:
    noise = correlated_noise((400, 400), 1.2, np.random.default_rng(1))
    assert np.std(noise) == pytest.approx(1.0, rel=0.05)
    assert np.corrcoef(noise[:, 1:].ravel(), noise[:, :-1].ravel())[0, 1] > 0.5


@pytest.mark.parametrize(("near_m", "far_m"), [(0.7, 1.0), (0.9, 1.8), (0.6, 0.65)])
def test_a_shadow_lies_left_of_its_occluder_and_is_as_wide_as_the_disparities_differ(
    near_m: float, far_m: float
) -> None:
    shadow = projector_shadow(as_disparity_px(box_before_wall(near_m, far_m)))
    width_px = FX_PX * BASELINE_M * (1 / near_m - 1 / far_m)
    columns = np.flatnonzero(shadow[30])
    assert len(columns) == pytest.approx(width_px, abs=1.5)
    assert columns[-1] == 159
    assert np.all(np.diff(columns) == 1)
    assert not shadow[:10].any() and not shadow[50:].any()


def test_the_shadow_of_a_thin_rod_is_apart_from_it() -> None:
    depth_m = facing_plane(1.5, (4, 200))
    depth_m[:, 120:124] = 0.6
    shadow_columns = np.flatnonzero(projector_shadow(as_disparity_px(depth_m))[0])
    offset_px = FX_PX * BASELINE_M * (1 / 0.6 - 1 / 1.5)
    assert len(shadow_columns) == pytest.approx(4, abs=2)
    assert shadow_columns.mean() == pytest.approx(121.5 - offset_px, abs=1.0)


def test_a_slanted_surface_casts_no_shadow_on_itself() -> None:
    depth_m = np.tile(np.linspace(0.8, 1.4, 160), (4, 1))
    for slant in (depth_m, depth_m[:, ::-1]):
        assert not projector_shadow(as_disparity_px(slant)).any()


def test_shadows_are_missing_from_the_measurement() -> None:
    depth_m = box_before_wall(0.7, 1.0)
    shadow = projector_shadow(as_disparity_px(depth_m))
    assert np.all(measured(depth_m)[shadow] == 0)


@pytest.mark.parametrize("brightness", [0, 10, 255])
def test_dark_and_glaring_surfaces_drop_out(brightness: int) -> None:
    depth_m = measured(facing_plane(1.0), brightness)
    assert np.mean(depth_m == 0) > 0.9


def test_a_steeply_slanted_surface_drops_out_and_a_gentle_one_does_not() -> None:
    down = (np.arange(120)[:, None] - 59.5) / FX_PX
    for slope_deg, lost in ((82.0, True), (50.0, False)):
        # The plane y = (1 - z) / tan(slope), whose normal is slope_deg away from the axis.
        depth_m = np.broadcast_to(1.0 / (1.0 + down * np.tan(np.radians(slope_deg))), (120, 160))
        share = np.mean(measured(depth_m)[50:70] == 0)
        assert share > 0.9 if lost else share < 0.01


def test_the_rim_of_an_occluder_is_ragged() -> None:
    depth_m = measured(box_before_wall(0.7, 1.0))
    right_rim = depth_m[12:48, 218:222]
    assert 0.05 < np.mean(right_rim == 0) < 0.95
    assert np.all(depth_m[15:45, 175:205] > 0)


def test_missing_and_out_of_range_depth_is_missing() -> None:
    depth_m = facing_plane(1.0)
    depth_m[:, :40], depth_m[:, 40:80], depth_m[:, 80:120] = 0.0, np.nan, 20.0
    result = measured(depth_m)
    assert np.all(result[:, :120] == 0)
    assert np.all(np.isfinite(result))
    assert np.all(measured(facing_plane(0.2)) == 0)


def test_equal_seeds_give_equal_depth() -> None:
    depth_m = box_before_wall(0.8, 1.1)
    first, again, other = (measured(depth_m, seed=seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first, again)
    assert np.any(first != other)


def test_colour_of_another_size_is_refused() -> None:
    with pytest.raises(ValueError, match="must be"):
        simulate_structured_light(np.ones((4, 5)), np.zeros((5, 4, 3), np.uint8), FX_PX, np.random.default_rng(0))


def test_objects_are_named_in_label_order_and_their_meshes_are_sound() -> None:
    objects = scene_objects()
    assert tuple(thing.name for thing in objects) == OBJECT_NAMES
    for thing in objects:
        for part in thing.parts:
            np.testing.assert_allclose(np.linalg.norm(part.mesh.normals, axis=1), 1.0, atol=1e-6)
            assert part.mesh.triangles.max() < len(part.mesh.vertices_m)
            assert part.mesh.uv.min() >= 0 and part.mesh.uv.max() <= 1


@pytest.mark.parametrize(
    ("mesh", "volume_m3"),
    [
        (meshes.box((0.1, 0.2, 0.3)), 0.006),
        (meshes.lathe([meshes.arc((0, 0), 0.1, -90, 90, 90)]), 4 / 3 * np.pi * 0.1**3),
        (meshes.tube([(0, 0, 0), (0, 0, 0.5), (0, 0, 1)], 0.1, around=64), np.pi * 0.1**2),
        (meshes.gable_roof(0.1, 0.2, 0.0, 0.1, 0.02), 0.1 * 0.1 * (0.2 + 0.003) / 2 + 0.1 * 0.02 * 0.003),
    ],
    ids=["box", "sphere", "tube", "roof"],
)
def test_meshes_enclose_their_volume_facing_outward(mesh: meshes.Mesh, volume_m3: float) -> None:
    a, b, c = np.moveaxis(mesh.vertices_m[mesh.triangles], 1, 0)
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(volume_m3, rel=0.01)
    facing = np.sum(np.cross(b - a, c - a) * mesh.normals[mesh.triangles[:, 0]], axis=1)
    assert np.all(facing >= -1e-12)


def test_the_bundled_frame_is_complete_and_small() -> None:
    assert sum((DEMO_SCENE / name).stat().st_size for name in DEMO_FILES) <= 500_000
    rgb, depth, label = (cv2.imread(str(DEMO_SCENE / name), cv2.IMREAD_UNCHANGED) for name in DEMO_FILES[:3])
    camera = json.loads((DEMO_SCENE / "camera.json").read_text(encoding="utf-8"))
    size = (camera["height"], camera["width"])
    assert size == (CAMERA.height, CAMERA.width)
    assert (rgb.shape, depth.shape, label.shape) == ((*size, 3), size, size)
    assert (rgb.dtype, depth.dtype, label.dtype) == (np.uint8, np.uint16, np.uint8)
    assert all(camera[name] == getattr(CAMERA, name) for name in ("fx", "fy", "cx", "cy"))

    assert list(np.unique(label)) == list(range(len(OBJECT_NAMES) + 1))
    border = np.concatenate([label[0], label[-1], label[:, 0], label[:, -1]])
    assert not border.any()
    depth_m = depth * camera["depth_scale"]
    assert 0.01 < np.mean(depth_m == 0) < 0.10
    for k in range(1, len(OBJECT_NAMES) + 1):
        on_object_m = depth_m[label == k]
        seen_m = on_object_m[on_object_m > 0]
        assert len(seen_m) > 0.8 * len(on_object_m)
        assert seen_m.min() > 0.5
        assert seen_m.max() < 1.3


def test_rendering_afresh_gives_the_bundled_labels_and_depth() -> None:
    need_renderer()
    depth_m, label = render_geometry(load_model())
    bundled = cv2.imread(str(DEMO_SCENE / "label.png"), cv2.IMREAD_UNCHANGED)
    assert np.mean(label == bundled) >= 0.99

    measured_m = 0.001 * cv2.imread(str(DEMO_SCENE / "depth.png"), cv2.IMREAD_UNCHANGED)
    both = (measured_m > 0) & (label > 0)
    assert np.median(np.abs(measured_m - depth_m)[both]) < 0.004


def test_the_rendered_depth_is_that_of_the_pinhole_camera() -> None:
    need_renderer()
    depth_m, label = render_geometry(load_model())
    table = (label == 0) & (np.arange(CAMERA.height)[:, None] > 150)
    points = CAMERA.back_project(depth_m, table).astype(np.float64)
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points[::7] - middle, full_matrices=False)[2][2]
    assert np.max(np.abs((points - middle) @ normal)) < 1e-3
    # Pitched down by 40 degrees: the table's normal in camera axes is (0, -cos 40, -sin 40).
    up = -normal * np.sign(normal[1])
    np.testing.assert_allclose(up, (0, -np.cos(np.radians(40)), -np.sin(np.radians(40))), atol=1e-3)
