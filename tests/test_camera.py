"""Cameras in every form that they come in, and what a frame makes of them."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from spigolo import Frame
from spigolo.errors import CameraError, FileError, FrameError
from spigolo.frames import files as io
from spigolo.frames.camera import NOMINAL, Camera
from spigolo.frames.intrinsics import as_camera

WIDTH, HEIGHT = 64, 48
CAMERA = Camera(60.0, 61.0, 31.0, 24.0, WIDTH, HEIGHT)
ROWS = [60.0, 0.0, 31.0, 0.0, 61.0, 24.0, 0.0, 0.0, 1.0]
BARREL = (-0.2, 0.05, 0.001, -0.001, 0.0)

# --- making cameras -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "form",
    [
        CAMERA,
        ROWS,
        np.array(ROWS).reshape(3, 3),
        [ROWS[:3], ROWS[3:6], ROWS[6:]],
        (60, 61, 31, 24),
        {"fx": 60, "fy": 61, "cx": 31, "cy": 24, "width": WIDTH, "height": HEIGHT},
        {"fx": 60, "fy": 61, "ppx": 31, "ppy": 24, "model": 4, "coeffs": [0, 0, 0, 0, 0]},
        {"K": ROWS, "D": np.zeros(5)},
    ],
)
def test_every_form_is_the_same_camera(form: Any) -> None:
    assert as_camera(form, WIDTH, HEIGHT) == CAMERA


def test_none_stays_none() -> None:
    assert as_camera(None, WIDTH, HEIGHT) is None


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ((60, 61, 31), "got shape"),
        ("kinnect", "kinect-v1, .* got 'kinnect'"),
        (np.array(ROWS).reshape(3, 3).T, "transpose"),
        ([60.0, 5.0, 31.0, *ROWS[3:]], r"expected a camera matrix \[\[fx, 0, cx\]"),
        (["a", "b", "c", "d"], "expected the numbers of a camera"),
        ((0, 61, 31, 24), "positive finite focal lengths"),
        ((60, 61, np.nan, 24), "finite number in pixels as cx"),
        ((0.001, 61, 31, 24), r"a focal length of 0\.01 to 1e\+08, got fx=0\.001"),
        ((60, 2e8, 31, 24), "fy=2e[+]08"),
        ((60, 61, -2e8, 24), "cx=-2e[+]08"),
        ({"fx": 60, "fy": "wide", "cx": 1, "cy": 1}, "fy, got 'wide'"),
        ({"K": ROWS, "D": [0.1, 0.2]}, "4, 5, 8, 12 or 14"),
        ({"K": ROWS[:8]}, "nine numbers in K"),
        ({"K": ROWS, "D": [0.1, 0, 0, 0], "distortion_model": "equidistant"}, "undistort the images first"),
        ({"K": ROWS, "coeffs": [0.1, 0, 0, 0, 0], "model": 2}, "inverse_brown_conrady: undistort"),
        ({"focal": 60}, "fx, fy, cx, cy not found"),
    ],
)
def test_what_is_no_camera_is_refused_with_one_sentence(form: Any, words: str) -> None:
    with pytest.raises(CameraError, match=words) as caught:
        as_camera(form, WIDTH, HEIGHT)
    assert "\n" not in str(caught.value)


def test_sizes_are_whole_pixels() -> None:
    with pytest.raises(CameraError, match=r"whole pixels as width, got 64\.5"):
        Camera(60, 61, 31, 24, 64.5, 48)  # type: ignore[arg-type]
    assert type(Camera(60, 61, 31, 24, np.int64(64), 48.0).width) is int  # type: ignore[arg-type]


def test_nothing_but_zeros_is_no_distortion() -> None:
    assert Camera(60, 61, 31, 24, 64, 48, (0.0,) * 5) == CAMERA
    assert Camera(60, 61, 31, 24, 64, 48, [0.1, 0, 0, 0]).distortion == (0.1, 0, 0, 0)  # type: ignore[arg-type]


def test_a_field_of_view_of_90_degrees_is_as_far_as_half_the_image() -> None:
    camera = Camera.from_fov(640, 480, horizontal_deg=90)
    assert (camera.fx, camera.fy) == pytest.approx((320, 320))
    assert (camera.cx, camera.cy) == (319.5, 239.5)
    assert Camera.from_fov(640, 480, vertical_deg=90).fx == pytest.approx(240)
    both = Camera.from_fov(640, 480, horizontal_deg=90, vertical_deg=90)
    assert (both.fx, both.fy) == pytest.approx((320, 240))
    for angles in ({}, {"horizontal_deg": 180}, {"vertical_deg": 0}, {"vertical_deg": float("nan")}):
        with pytest.raises(CameraError, match="between 0 and 180"):
            Camera.from_fov(640, 480, **angles)


def test_scaling_keeps_the_rays_of_the_image_corners() -> None:
    scaled = CAMERA.scaled(160, 24)
    for camera, right, bottom in ((CAMERA, 63.5, 47.5), (scaled, 159.5, 23.5)):
        assert (-0.5 - camera.cx) / camera.fx == pytest.approx((-0.5 - CAMERA.cx) / CAMERA.fx)
        assert (right - camera.cx) / camera.fx == pytest.approx((63.5 - CAMERA.cx) / CAMERA.fx)
        assert (bottom - camera.cy) / camera.fy == pytest.approx((47.5 - CAMERA.cy) / CAMERA.fy)


@pytest.mark.parametrize("text", ["60deg", "60.0 deg", " 60-DEG"])
def test_a_field_of_view_is_a_camera(text: str) -> None:
    wanted = Camera.from_fov(WIDTH, HEIGHT, horizontal_deg=60)
    assert as_camera(text, WIDTH, HEIGHT) == Camera.named(text, WIDTH, HEIGHT) == wanted
    assert Camera.named(text) == Camera.from_fov(640, 480, horizontal_deg=60)
    with pytest.raises(CameraError, match="between 0 and 180 degrees"):
        Camera.named("200deg", WIDTH, HEIGHT)


@pytest.mark.parametrize("name", NOMINAL)
def test_named_cameras_scale_and_keep_their_aspect_ratio(name: str) -> None:
    camera = Camera.named(name)
    assert Camera.named(name.upper().replace("-", "_"), camera.width // 2, camera.height // 2).fx == camera.fx / 2
    for fx, fy, cx, cy, width, height in NOMINAL[name]:
        assert Camera.named(name, width, height) == Camera(fx, fy, cx, cy, width, height)
    with pytest.raises(CameraError, match=r"aspect ratio of .* got 100x300"):
        Camera.named(name, 100, 300)


# --- distortion -----------------------------------------------------------------------------------------------


def _distorted_pair() -> tuple[Camera, np.ndarray, np.ndarray]:
    """A camera with barrel distortion; where its pixels lie in the ideal image, x and y (H, W)."""
    camera = Camera(60.0, 61.0, 31.0, 24.0, WIDTH, HEIGHT, BARREL)
    grid = np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), -1).reshape(-1, 1, 2).astype(np.float64)
    ideal = cv2.undistortPoints(grid, camera.matrix, np.array(BARREL), P=camera.matrix).reshape(HEIGHT, WIDTH, 2)
    return camera, ideal[..., 0], ideal[..., 1]


def test_a_frame_is_undistorted_once_at_the_door() -> None:
    camera, x, y = _distorted_pair()
    color = np.repeat(np.clip(2 * x + y + 40, 0, 255).astype(np.uint8)[..., None], 3, axis=2)
    depth = np.where(x < 30, 0.8, 1.6)
    frame = Frame(color, depth, camera)
    assert frame.camera == CAMERA
    inner = np.s_[8:-8, 8:-8]
    ideal_y, ideal_x = np.mgrid[:HEIGHT, :WIDTH]
    assert np.abs(frame.color[inner][..., 0] - (2.0 * ideal_x + ideal_y + 40)[inner]).max() < 2
    assert set(np.unique(frame.depth)) <= set(np.float32([0, 0.8, 1.6])), "depth is mixed"
    wrong = (frame.depth != np.where(ideal_x < 30, np.float32(0.8), np.float32(1.6)))[inner]
    assert not wrong[:, :20].any()
    assert not wrong[:, 24:].any()
    again = Frame(frame.color, frame.depth, frame.camera)
    np.testing.assert_array_equal(again.depth, frame.depth)


def test_undistorting_without_distortion_is_nothing() -> None:
    image = np.arange(WIDTH * HEIGHT, dtype=np.float32).reshape(HEIGHT, WIDTH)
    assert CAMERA.undistort(image) is image


# --- frames ---------------------------------------------------------------------------------------------------


def _images(height: int = HEIGHT, width: int = WIDTH) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros((height, width, 3), np.uint8), np.ones((height, width))


@pytest.mark.parametrize("form", [ROWS, (60, 61, 31, 24), {"K": ROWS}], ids=["K", "four numbers", "mapping"])
def test_a_frame_takes_every_form(form: Any) -> None:
    assert Frame(*_images(), form).camera == CAMERA


def test_a_frame_needs_no_camera() -> None:
    frame = Frame(*_images(), None)
    assert frame.camera is None
    assert frame.shape == (HEIGHT, WIDTH)


def test_a_frame_takes_a_name_for_its_size() -> None:
    frame = Frame(*_images(240, 320), "Kinect v1")
    assert frame.camera == Camera(262.5, 262.5, 159.5, 119.5, 320, 240)


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (7, 1)])
@pytest.mark.parametrize("camera", [None, (60, 60, 0, 0)], ids=["no camera", "camera"])
def test_the_smallest_frames_are_frames(shape: tuple[int, int], camera: Any) -> None:
    assert Frame(*_images(*shape), camera).shape == shape


def test_large_images_are_refused_unless_asked_for() -> None:
    images = _images()
    with pytest.raises(FrameError, match=r"at most 3071 pixels, got 64x48: .* max_pixels=3072"):
        Frame(*images, CAMERA, max_pixels=3071)
    assert Frame(*images, CAMERA, max_pixels=3072).shape == (HEIGHT, WIDTH)


def test_frames_and_cameras_load_nothing_heavy() -> None:
    code = "import sys, spigolo.frames.frame; print({'numba', 'cv2', 'pydantic'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


# --- files ----------------------------------------------------------------------------------------------------

DISTORTED = Camera(60.0, 61.0, 31.0, 24.0, WIDTH, HEIGHT, BARREL)
SIZE = {"width": WIDTH, "height": HEIGHT}
COLUMNS = np.array(ROWS).reshape(3, 3).T.reshape(-1).tolist()

ROS2 = f"""header:
  stamp: {{sec: 1, nanosec: 5}}
  frame_id: camera_color_optical_frame
height: 48
width: 64
distortion_model: plumb_bob
d:
- -0.2
- 0.05
- 0.001
- -0.001
- 0.0
k: {ROWS}
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [60.0, 0.0, 31.0, 0.0, 0.0, 61.0, 24.0, 0.0, 0.0, 0.0, 1.0, 0.0]
---
"""
ROS1 = ROS2.replace("\nd:", "\nD:").replace("\nk:", "\nK:").replace("\nr:", "\nR:").replace("\np:", "\nP:")
CALIBRATION = f"""image_width: 64
image_height: 48
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: {ROWS}
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: {list(BARREL)}
"""


@pytest.mark.parametrize(
    ("values", "camera", "scale"),
    [
        pytest.param({"K": ROWS, **SIZE}, CAMERA, None, id="K"),
        pytest.param({"camera_matrix": [ROWS[:3], ROWS[3:6], ROWS[6:]]}, CAMERA, None, id="3x3, no size"),
        pytest.param({"cam_K": ROWS, "depth_scale": 0.1}, CAMERA, 0.0001, id="BOP"),
        pytest.param({"K": ROWS, "depth_scale": 0.001}, CAMERA, 0.001, id="K with metres per unit"),
        pytest.param({"intrinsic_matrix": COLUMNS, **SIZE}, CAMERA, None, id="Open3D"),
        pytest.param(
            {"fx": 60, "fy": 61, "ppx": 31, "ppy": 24, "model": "distortion.brown_conrady", "coeffs": BARREL, **SIZE},
            DISTORTED,
            None,
            id="RealSense",
        ),
    ],
)
def test_camera_files_in_json(tmp_path: Path, values: dict[str, Any], camera: Camera, scale: float | None) -> None:
    io.write_json(tmp_path / "camera.json", values)
    assert io.read_camera(tmp_path / "camera.json", WIDTH, HEIGHT) == (camera, scale)


def test_a_file_without_size_wants_it(tmp_path: Path) -> None:
    io.write_json(tmp_path / "camera.json", {"K": ROWS})
    with pytest.raises(CameraError, match=r"camera\.json: .* width, height not found"):
        io.read_camera(tmp_path / "camera.json")


def test_a_file_of_many_images_is_refused(tmp_path: Path) -> None:
    other = [61.0, *ROWS[1:]]
    io.write_json(tmp_path / "scene_camera.json", {"0": {"cam_K": ROWS}, "1": {"cam_K": other}})
    with pytest.raises(CameraError, match="one camera, got 2 images"):
        io.read_camera(tmp_path / "scene_camera.json", WIDTH, HEIGHT)


@pytest.mark.parametrize("text", [ROS2, ROS1, CALIBRATION], ids=["ROS 2", "ROS 1", "camera_calibration"])
def test_camera_files_in_yaml(tmp_path: Path, text: str) -> None:
    (tmp_path / "camera.yaml").write_text(text)
    assert io.read_camera(tmp_path / "camera.yaml") == (DISTORTED, None)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        (lambda text: text.replace("plumb_bob", "equidistant"), CameraError, "undistort the images first"),
        (lambda text: text.replace(f"{ROWS}", f"{[0.0] * 9}"), CameraError, "camera matrix"),
        (lambda text: text + "\n: [", FileError, "YAML in .* cannot be read"),
        (lambda text: "", CameraError, "got NoneType"),
        (lambda text: "!!python/object:os.system {}", FileError, "cannot be read"),
    ],
)
def test_bad_yaml_is_refused_with_one_sentence(
    tmp_path: Path, change: Callable[[str], str], error: type[Exception], words: str
) -> None:
    (tmp_path / "camera.yml").write_text(change(CALIBRATION))
    with pytest.raises(error, match=words) as caught:
        io.read_camera(tmp_path / "camera.yml")
    assert "\n" not in str(caught.value)


@pytest.fixture
def images(tmp_path: Path) -> tuple[Path, Path]:
    io.write_png(tmp_path / "rgb.png", np.zeros((HEIGHT, WIDTH, 3), np.uint8))
    io.write_png(tmp_path / "depth.png", np.full((HEIGHT, WIDTH), 1234, np.uint16))
    return tmp_path / "rgb.png", tmp_path / "depth.png"


def test_a_frame_of_files_takes_a_camera_in_every_form(images: tuple[Path, Path], tmp_path: Path) -> None:
    file = tmp_path / "bop.json"
    io.write_json(file, {"cam_K": ROWS, "depth_scale": 0.1})
    (tmp_path / "intrinsics").write_text(json.dumps({"K": ROWS, "depth_scale": 0.0001}))
    for camera in (file, str(file), str(tmp_path / "intrinsics")):
        frame = io.read_frame(*images, camera)
        assert frame.camera == CAMERA
        assert frame.depth[0, 0] == pytest.approx(0.1234)
    assert io.read_frame(*images, ROWS, 0.001).camera == CAMERA
    assert io.read_frame(*images, None, 0.001).camera is None
    assert io.read_frame(*images, "xtion", 0.001).camera == Camera.named("xtion", WIDTH, HEIGHT)
    with pytest.raises(CameraError, match="camera file that exists, one of kinect-v1"):
        io.read_frame(*images, "intrinsics.txt")
    with pytest.raises(FileError, match="cannot be read"):
        io.read_frame(*images, "nowhere.json", 0.001)
    with pytest.raises(FrameError, match="expected depth_scale with the integers"):
        io.read_frame(*images, "xtion")
    with pytest.raises(FrameError, match="max_pixels=3072"):
        io.read_frame(*images, None, 0.001, max_pixels=10)


def test_a_mapping_brings_its_scale_as_a_file_does(images: tuple[Path, Path], tmp_path: Path) -> None:
    stored, color = np.full((HEIGHT, WIDTH), 1234, np.uint16), np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    for fields in ({"K": ROWS, "depth_scale": 0.0001}, {"cam_K": ROWS, "depth_scale": 0.1}):
        for frame in (io.read_frame(*images, fields), Frame(color, stored, fields)):
            assert frame.camera == CAMERA
            assert frame.depth[0, 0] == pytest.approx(0.1234)
        assert Frame(color, stored, fields, depth_scale=0.001).depth[0, 0] == pytest.approx(1.234)
        assert Frame(color, np.full((HEIGHT, WIDTH), 0.5), fields).depth[0, 0] == 0.5
    for make in (lambda fields: io.read_frame(*images, fields), lambda fields: Frame(color, stored, fields)):
        with pytest.raises(CameraError, match="in the camera as metres per unit"):
            make({"K": ROWS, "depth_scale": 1000})
        with pytest.raises(CameraError, match="depth_scale as a number, got True"):
            make({"K": ROWS, "depth_scale": True})
        with pytest.raises(FrameError, match="expected depth_scale"):
            make({"K": ROWS})


def test_a_number_may_be_an_array_of_one_and_no_truth_value() -> None:
    stored, color = np.full((HEIGHT, WIDTH), 1234, np.uint16), np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    assert Frame(color, stored, CAMERA, depth_scale=np.array(0.001)).depth[0, 0] == pytest.approx(1.234)
    for scale in (True, "0.001", np.array([0.001])):
        with pytest.raises(FrameError, match="depth_scale as positive metres per unit"):
            Frame(color, stored, CAMERA, depth_scale=scale)
    with pytest.raises(CameraError, match="focal length in pixels as fx, got True"):
        Camera(True, 60.0, 31.0, 24.0, WIDTH, HEIGHT)


def test_a_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    (tmp_path / "camera.json").write_text(json.dumps({"K": ROWS}), encoding="utf-8-sig")
    assert io.read_camera(tmp_path / "camera.json", WIDTH, HEIGHT) == (CAMERA, None)


@pytest.mark.parametrize("scale", [0.1, 1.0, 1000.0])
def test_a_scale_of_another_unit_is_refused(images: tuple[Path, Path], tmp_path: Path, scale: float) -> None:
    io.write_json(tmp_path / "camera.json", {"K": ROWS, "depth_scale": scale})
    with pytest.raises(CameraError, match="divide the value by 1000"):
        io.read_frame(*images, tmp_path / "camera.json")
    assert io.read_frame(*images, tmp_path / "camera.json", 0.001).depth[0, 0] == pytest.approx(1.234)


def test_a_file_in_place_of_a_camera_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text("{}")
    for given in (path, str(path)):
        with pytest.raises(CameraError, match=r"got the file .*camera.json: read it with spigolo.read_camera"):
            as_camera(given, 4, 3)  # type: ignore[arg-type]
