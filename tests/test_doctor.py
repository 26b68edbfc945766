"""The doctor: what it finds in frames that are spoilt, and that it leaves good ones alone."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from conftest import load_frame
from spigolo import Camera, Frame
from spigolo.doctor import Diagnosis, Finding, Severity, checkup, diagnose, intrinsics, measured
from spigolo.doctor.local_planes import fit_local_planes
from spigolo.lab.studies import doctor as study

ROOT = Path(__file__).resolve().parents[1]
KINECT = Camera(525.0, 525.0, 319.5, 239.5, 640, 480)
SEEN = (
    *("osd-mosd/learn0", "osd-mosd/learn7", "osd-mosd/learn24", "osd-mosd/learn37", "osd-full/learn6"),
    *("hand-uoc/000000", "hand-uoc/000005", "ycbv/0001_000001", "unlabelled/lm_scene", "6dof-graspnet/blue_mug"),
)
"""Frames of every kind of sensor with things of clear outline."""


SPOILT: dict[str, tuple[str, Callable[[Frame], Frame]]] = study.SPOILT


def finding(frame: Frame, check: str) -> Finding:
    return next(f for f in diagnose(frame).findings if f.check == check)


def scene() -> Frame:
    return load_frame(Path(sp.__file__).parent / "demo_scene")


def plain(depth_m: float = 0.8, camera: Camera = KINECT) -> Frame:
    """A wall of one colour, with noise in whole millimetres."""
    rng = np.random.default_rng(3)
    shape = camera.height, camera.width
    depth = np.rint(1000 * (depth_m + 0.0015 * depth_m**2 * rng.standard_normal(shape))) / 1000
    return Frame(np.full((*shape, 3), 128, np.uint8), depth.astype(np.float32), camera)


@pytest.fixture(scope="module")
def demo() -> Frame:
    return scene()


def test_the_bundled_scene_is_good(demo: Frame) -> None:
    diagnosis = diagnose(demo)
    assert diagnosis.warnings == ()
    assert "cost function" in finding(demo, "cost function").sentence


@pytest.mark.parametrize("kind", SPOILT)
def test_every_spoiling_of_the_bundled_scene_is_found(demo: Frame, kind: str) -> None:
    check, spoil = SPOILT[kind]
    found = finding(spoil(demo), check)
    assert found.severity is Severity.WARNING
    assert found.sentence.startswith("expected ") and ", found " in found.sentence


def test_the_shift_is_told_with_its_direction(demo: Frame) -> None:
    sentence = finding(study.shift(demo, 8, 0), "alignment").sentence
    assert any(f"moved by {dx:+d} px in x" in sentence for dx in (-7, -8, -9))


@pytest.mark.parametrize(("axes", "says"), [((1,), "left to right"), ((0,), "top to bottom"), ((0, 1), "upside down")])
def test_mirrored_depth_is_reported_with_its_axis(demo: Frame, axes: tuple[int, ...], says: str) -> None:
    assert says in finding(study.with_depth(demo, np.flip(demo.depth, axes)), "alignment").sentence


@pytest.mark.parametrize("factor", [10, 1000, 0.1, 0.001])
def test_the_scale_is_guessed(demo: Frame, factor: float) -> None:
    sentence = finding(study.scale(demo, factor), "depth unit").sentence
    assert f"multiply depth_scale by {1 / factor:g} " in sentence


def test_a_camera_that_is_mounted_upside_down_is_told(demo: Frame) -> None:
    assert finding(demo, "support plane").severity is Severity.OK
    c = demo.camera
    assert c is not None
    around = Camera(c.fx, c.fy, c.width - 1 - c.cx, c.height - 1 - c.cy, c.width, c.height)
    turned = Frame(demo.color[::-1, ::-1], demo.depth[::-1, ::-1], around)
    told = finding(turned, "support plane")
    assert told.severity is Severity.WARNING
    up = [float(word) for word in re.findall(r"-?\d\.\d\d", told.sentence)[:3]]
    result = sp.segment(turned, sp.OBJECTS.replace(**{"additions.support.facing.up": up}))
    assert len(result) == len(sp.segment(demo))
    assert finding(plain(3.5), "support plane").severity is Severity.NOTE


def test_one_wall_says_nothing_of_alignment() -> None:
    found = finding(plain(), "alignment")
    assert found.severity is Severity.NOTE
    assert "pixels of depth steps. To check the alignment, run the doctor on a frame with" in found.sentence
    assert diagnose(plain()).warnings == ()


def test_depth_that_is_far_and_noisy_is_left_alone() -> None:
    assert finding(plain(4.0), "depth unit").severity is Severity.OK


def test_depth_that_is_too_fine_for_its_distance() -> None:
    near = plain(0.7)
    fine = Frame(near.color, near.depth * np.float32(8.0007), KINECT)  # no whole multiples of anything
    assert "expected depth noise" in finding(fine, "depth unit").sentence


def test_stored_unit() -> None:
    depth = np.arange(300, 900, dtype=np.float32)[None] / 1000
    assert measured.stored_unit_m(depth) == pytest.approx(0.001)
    assert measured.stored_unit_m(10 * depth) == pytest.approx(0.01)


def test_no_depth_at_all() -> None:
    frame = Frame(np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.float32), KINECT)
    diagnosis = diagnose(frame)
    assert [w.check for w in diagnosis.warnings] == ["missing depth"]
    assert finding(frame, "cost function").sentence == "no cost function can be recommended: the frame has no depth"


def test_negative_depth() -> None:
    good = plain()
    depth = good.depth.copy()
    depth[:10] *= -1
    with pytest.warns(UserWarning, match="negative"):
        frame = Frame(good.color, depth, KINECT)
    assert "found 6400 negative pixels" in finding(frame, "negative depth").sentence


def test_missing_depth_is_reported_by_place() -> None:
    good = plain()
    depth = good.depth.copy()
    depth[:, :160] = 0  # a quarter, at the border
    depth[200:264, 300:396] = 0  # 2 %, inside
    frame = Frame(good.color, depth, KINECT)
    sentence = finding(frame, "missing depth").sentence
    assert sentence == (
        "27.0% of the depth is missing: 25.0% at the image border, 2.0% in large holes inside, 0.0% in small holes"
    )
    assert "chooses the second cost function" in finding(frame, "cost function").sentence


def test_large_shadows_advise_the_first_cost_function() -> None:
    good = plain()
    depth = good.depth.copy()
    depth[100:300, 200:400] = 0
    shadows = Frame(good.color, depth, KINECT)
    assert "chooses the first cost function" in finding(shadows, "cost function").sentence


def test_a_grid_of_sampling_holes() -> None:
    good = plain()
    depth = good.depth.copy()
    depth[::4], depth[:, ::4] = 0, 0
    frame = Frame(good.color, depth, KINECT)
    assert finding(frame, "sampling holes").severity is Severity.NOTE
    assert "chooses the second cost function" in finding(frame, "cost function").sentence


@pytest.mark.parametrize(
    ("camera", "check"),
    [
        (Camera(525, 525, 100, 239.5, 640, 480), "intrinsics"),
        (Camera(525, 580, 319.5, 239.5, 640, 480), "intrinsics"),
        (Camera(1050, 1050, 319.5, 239.5, 640, 480), "focal length"),
        (Camera(262, 262, 319.5, 239.5, 640, 480), "focal length"),
    ],
)
def test_intrinsics_that_no_camera_has(camera: Camera, check: str) -> None:
    assert finding(plain(camera=camera), check).severity is Severity.WARNING


def test_a_known_wide_camera_is_a_note() -> None:
    assert "Azure Kinect" in finding(plain(camera=Camera(303, 303, 320, 180, 640, 360)), "focal length").sentence


def test_right_angles_tell_the_focal_length(demo: Frame) -> None:
    factor = intrinsics.upright_factor(study.zoom(demo, 0.5).depth, study.zoom(demo, 0.5).camera)
    assert factor == pytest.approx(2.0, rel=0.1)
    assert intrinsics.upright_factor(demo.depth, demo.camera) == 1.0


def test_without_intrinsics_nothing_is_said_of_3d(demo: Frame) -> None:
    frame = study.with_depth(demo, demo.depth)
    object.__setattr__(frame, "camera", None)
    assert "expected intrinsics, got none" in finding(frame, "intrinsics").sentence


def test_local_planes_of_a_slanted_plane() -> None:
    y, x = np.mgrid[:40, :60]
    depth = (1 / (1.0 + 0.002 * x - 0.003 * y)).astype(np.float32)
    planes = fit_local_planes(depth)
    inner = (slice(3, -3), slice(3, -3))
    assert np.allclose(planes.slope_x[inner], 0.002, atol=1e-6)
    assert np.allclose(planes.slope_y[inner], -0.003, atol=1e-6)
    assert planes.residual[inner].max() < 1e-4
    assert planes.whole[inner].all() and not planes.whole[:3].any()


def test_several_wheels_of_opencv(monkeypatch: pytest.MonkeyPatch) -> None:
    present = {"opencv-python", "opencv-contrib-python"}

    def version(name: str) -> str:
        if name not in present:
            raise metadata.PackageNotFoundError(name)
        return "4.10"

    monkeypatch.setattr(metadata, "version", version)
    found = checkup.check_wheels()
    assert found.severity is Severity.WARNING
    assert "pip uninstall -y opencv-python opencv-contrib-python && pip install" in found.sentence
    present.clear()
    present.add("opencv-python-headless")
    assert checkup.check_wheels().severity is Severity.OK


def test_tiny_frames_pass_through() -> None:
    tiny = Camera(10, 10, 3.5, 3.5, 8, 8)
    frame = Frame(np.zeros((8, 8, 3), np.uint8), np.full((8, 8), 0.8, np.float32), tiny)
    assert isinstance(diagnose(frame), Diagnosis)
    assert finding(frame, "size").severity is Severity.NOTE


@pytest.mark.frames
@pytest.mark.filterwarnings("ignore:depth .* farther than 50 m")
def test_rates_on_real_frames(data: Path) -> None:
    loaded = [load_frame(data / "frames" / name) for name in SEEN]
    assert sum(bool(diagnose(frame).warnings) for frame in loaded) <= 0.1 * len(loaded)
    for kind, (check, spoil) in SPOILT.items():
        rate = np.mean([finding(spoil(frame), check).severity is Severity.WARNING for frame in loaded])
        assert rate >= 0.8, kind


def test_swapped_principal_points_are_noticed() -> None:
    assert "swap cx and cy" in intrinsics.check_intrinsics(Camera(525, 525, 239.5, 319.5, 640, 480)).sentence
    for cx, cy in ((319.5, 239.5), (330.0, 250.0), (300.0, 220.0), (360.0, 239.5)):
        assert intrinsics.check_intrinsics(Camera(525, 525, cx, cy, 640, 480)).severity is Severity.OK


def test_no_factor_of_one_is_advised() -> None:
    assert "multiply depth_scale by 1 " not in measured.unit_advice(0.73, 0.01)
    assert "multiply depth_scale by 0.001" in measured.unit_advice(730.0, None)
