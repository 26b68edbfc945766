"""What the doctor finds in depth: coarse steps, distance along the ray, unregistered pairs, wrong units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from conftest import load_frame
from spigolo.cli.show import print_diagnosis
from spigolo.doctor import Diagnosis, Finding, Severity, diagnose
from spigolo.doctor.alignment import check_alignment, color_gradients, depth_contours
from spigolo.doctor.intrinsics import check_focal_length
from spigolo.doctor.measured import check_unit, unit_advice
from spigolo.doctor.planarity import along_z, check_planarity
from spigolo.doctor.scaling import best_scale
from spigolo.doctor.steps import check_saturated, check_steps
from spigolo.lab.studies.doctor import along_rays, not_registered, with_depth

CAMERA = sp.Camera(525.0, 525.0, 319.5, 239.5, 640, 480)


@pytest.fixture(scope="module")
def demo() -> sp.Frame:
    return load_frame(Path(sp.__file__).parent / "demo_scene")


def whole_disparity(depth: np.ndarray, focal_baseline: float) -> np.ndarray:
    disparity = np.rint(focal_baseline / np.where(depth > 0, depth, np.inf))
    metres = focal_baseline / np.where(disparity > 0, disparity, np.inf)
    return (np.rint(1000 * metres) / 1000).astype(np.float32)


@pytest.mark.parametrize("baseline_m", [0.075, 0.05, 0.095])
def test_whole_pixel_disparity_is_found(demo: sp.Frame, baseline_m: float) -> None:
    found = check_steps(whole_disparity(demo.depth, 525 * baseline_m))
    assert found.severity is Severity.WARNING
    assert "switch on subpixel disparity" in found.sentence
    step_mm = 1000 * np.median(demo.depth[demo.depth > 0]) ** 2 / (525 * baseline_m)
    assert float(found.sentence.split("steps of ")[2].split(" mm")[0]) == pytest.approx(step_mm, rel=0.25)


@pytest.mark.parametrize("farthest_m", [3.0, 10.0])
def test_8_bits_kept_in_16_are_found(demo: sp.Frame, farthest_m: float) -> None:
    levels = np.rint(np.minimum(demo.depth, farthest_m) / farthest_m * 255)
    assert check_steps((levels * farthest_m / 255).astype(np.float32)).severity is Severity.WARNING


@pytest.mark.parametrize("step_per_m", [2.85e-3, 1e-3, 0.0])
def test_steps_of_depth_cameras_are_fine(demo: sp.Frame, step_per_m: float) -> None:
    """A Kinect v1 has 2.85 mm at 1 m, an eighth of a pixel of disparity."""
    depth = whole_disparity(demo.depth, 1 / step_per_m) if step_per_m else demo.depth
    assert check_steps(depth).severity is Severity.OK
    near = np.rint(1000 * demo.depth / 5) / 1000  # whole millimetres at 0.17 m
    assert check_steps(near.astype(np.float32)).severity is Severity.OK


@pytest.mark.parametrize("value_m", [2.047, 4.095, 8.191, 10.0, 16.38])
def test_one_value_far_beyond_all_others_is_found(demo: sp.Frame, value_m: float) -> None:
    depth = np.where(demo.depth > 1.4, 0, demo.depth)
    assert check_saturated(depth).severity is Severity.OK
    depth[:24] = value_m
    found = check_saturated(depth)
    assert found.severity is Severity.WARNING
    assert f"found {value_m:.3f} m in" in found.sentence


def test_distance_along_the_ray_is_found(demo: sp.Frame) -> None:
    assert check_planarity(demo.depth, CAMERA).severity is Severity.OK
    found = check_planarity(along_rays(demo).depth, CAMERA)
    assert found.severity is Severity.WARNING
    assert "distance along the ray" in found.sentence
    np.testing.assert_allclose(along_z(along_rays(demo).depth, CAMERA), demo.depth, atol=6e-4)


def test_raw_disparity_is_found(demo: sp.Frame) -> None:
    raw = np.where(demo.depth > 0, np.rint((3.3309495161 - 1 / np.maximum(demo.depth, 0.4)) / 0.0030711016), 2047)
    frame = sp.Frame(demo.color, raw.astype(np.uint16), CAMERA, depth_scale=0.001)
    warned = {f.check for f in diagnose(frame).warnings}
    assert "largest depth" in warned
    zeros = sp.Frame(demo.color, np.where(raw == 2047, 0, raw).astype(np.uint16), CAMERA, depth_scale=0.001)
    assert "3.331 - 0.00307 * raw" in check_planarity(zeros.depth, CAMERA).sentence


def test_disparity_of_a_stereo_camera_is_found_and_its_advice_is_right(demo: sp.Frame) -> None:
    disparity = np.where(demo.depth > 0, 500 / np.maximum(demo.depth, 0.4), 0).astype(np.uint16)
    read = sp.Frame(demo.color, disparity, CAMERA, depth_scale=0.001).depth
    assert "fx * baseline / disparity" in check_planarity(read, CAMERA).sentence


def test_a_pair_that_was_never_registered_is_found(demo: sp.Frame) -> None:
    spoilt = not_registered(demo)
    fit = best_scale(depth_contours(spoilt.depth), color_gradients(demo.color))
    assert fit.is_clear
    assert fit.scale == pytest.approx(615 / 384, rel=0.05)
    found = check_alignment(demo.color, spoilt.depth)
    assert "register depth to colour (register_depth does)" in found.sentence
    assert not best_scale(depth_contours(demo.depth), color_gradients(demo.color)).is_clear


def test_what_could_not_be_judged_stands_out(demo: sp.Frame, capsys: pytest.CaptureFixture[str]) -> None:
    plain = sp.Frame(np.full_like(demo.color, 128), demo.depth, None)
    found = check_alignment(plain.color, plain.depth)
    assert not found.judged and found.severity is Severity.NOTE
    print_diagnosis(Diagnosis((found, Finding("size", Severity.OK, "fine"))))
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("unknown alignment")
    assert "To check the alignment, run the doctor on a frame with" in lines[0]
    assert lines[-1].startswith("could not be judged: alignment.")


# --- units ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [0.00025, 0.000125, 0.0001, 0.0002, 0.001])
def test_the_right_scale_is_advised(demo: sp.Frame, scale: float) -> None:
    """Stored in units of `scale`, read as metres or as another unit far off."""
    stored = np.rint(demo.depth / scale).astype(np.uint16)
    taken = 0.1 if scale == 0.001 else 0.001 * 20
    frame = sp.Frame(demo.color, stored, CAMERA, depth_scale=taken)
    found = check_unit(frame, frame.depth)
    assert found.severity is Severity.WARNING
    assert f"{scale:g} (" in found.sentence
    assert "RealSense L515: 0.00025" in unit_advice(800.0, None)
    assert "multiply depth_scale by 0.001 " in unit_advice(800.0, None)


@pytest.mark.parametrize("share", [1 / 5, 1 / 8, 1 / 2])
def test_a_camera_for_close_range_is_no_error(demo: sp.Frame, share: float) -> None:
    stored = np.rint(demo.depth * share * 1e4).astype(np.uint16)
    frame = sp.Frame(demo.color, stored, CAMERA, depth_scale=1e-4)
    assert check_unit(frame, frame.depth).severity is not Severity.WARNING
    d405 = sp.Frame(demo.color, (demo.depth / 5).astype(np.float32), sp.Camera.named("realsense-d405", 640, 480))
    assert check_unit(d405, d405.depth).severity is not Severity.WARNING
    far = with_depth(demo, demo.depth / 5)
    assert "multiply depth_scale by 10" in check_unit(far, far.depth).sentence


def test_a_wall_that_leans_is_no_reason_for_a_focal_length() -> None:
    """A table, and a wall that leans away so far that only an absurd focal length would raise it."""
    y, x = np.mgrid[:480, :640]
    rays = np.stack([(x - 319.5) / 525, (y - 239.5) / 525, np.ones((480, 640))], -1)
    floor, wall = np.array([0, np.cos(0.9), np.sin(0.9)]), np.array([0, np.cos(1.9), np.sin(1.9)])
    depth = np.minimum(0.8 / np.maximum(rays @ floor, 1e-3), 0.55 / np.maximum(rays @ np.abs(wall), 1e-3))
    depth += 0.001 * depth**2 * np.random.default_rng(0).standard_normal(depth.shape)
    found = check_focal_length(depth.astype(np.float32), CAMERA)
    assert found.severity is not Severity.WARNING
