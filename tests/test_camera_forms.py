"""Cameras as drivers, calibrators and data sets write them: each field is used, or refused by name."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import CameraError, FileError, FrameError
from spigolo.frames.camera import NOMINAL, Camera
from spigolo.frames.files import read_camera, read_frame, write_png
from spigolo.frames.intrinsics import as_camera, camera_from_mapping
from spigolo.frames.nominal import SOURCES
from spigolo.frames.scale import scale_from_mapping

WIDTH, HEIGHT = 640, 480
CAMERA = Camera(600.0, 601.0, 319.0, 240.0, WIDTH, HEIGHT)
K = np.array([[600.0, 0, 319], [0, 601, 240], [0, 0, 1]])
ROWS, COLUMNS = K.reshape(-1).tolist(), K.T.reshape(-1).tolist()
BARREL = (-0.2, 0.05, 0.001, -0.001, 0.0)
BENT = Camera(600.0, 601.0, 319.0, 240.0, WIDTH, HEIGHT, BARREL)
FIELDS = {"fx": 600, "fy": 601, "cx": 319, "cy": 240}

OPENCV = f"""%YAML:1.0
---
calibration_time: "Mon 01 Jan 2024 10:00:00"
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: {ROWS}
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.0e-1, 5e-2, 1e-3, -1e-3, 0. ]
"""
KALIBR = """cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.05, 0.001, -0.001]
  distortion_model: radtan
  intrinsics: [600.0, 601.0, 319.0, 240.0]
  resolution: [640, 480]
  rostopic: /camera/color/image_raw
"""
ORB_SLAM = """%YAML:1.0
Camera.type: "PinHole"
Camera.fx: 600.0
Camera.fy: 601.0
Camera.cx: 319.0
Camera.cy: 240.0
Camera.k1: -0.2
Camera.k2: 0.05
Camera.p1: 0.001
Camera.p2: -0.001
Camera.width: 640
Camera.height: 480
DepthMapFactor: 5000.0
"""
DEXYCB = """color:
  fx: 600.0
  fy: 601.0
  ppx: 319.0
  ppy: 240.0
depth:
  fx: 380.0
  fy: 380.0
  ppx: 318.0
  ppy: 238.0
"""

EXPONENTS = "fx: 6e2\nfy: 6.01e+2\ncx: 319\ncy: 2.4e2\ndepth_scale: 1e-3"
NERF = {"fl_x": 600, "fl_y": 601, "cx": 319, "cy": 240, "w": 640, "h": 480}
COLMAP = "1 OPENCV 640 480 600 601 319.5 240.5 -0.2 0.05 0.001 -0.001\n"
K4 = np.vstack([np.hstack([K, np.zeros((3, 1))]), [0, 0, 0, 1]])


def stored(folder: Path, name: str, content: Any) -> Path:
    path = folder / name
    if isinstance(content, np.ndarray):
        (np.save if name.endswith(".npy") else np.savetxt)(path, content)
    else:
        path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


@pytest.mark.parametrize(
    ("name", "content", "camera", "scale"),
    [
        pytest.param("c.yml", OPENCV, BENT, None, id="OpenCV FileStorage"),
        pytest.param("c.yaml", OPENCV.replace("%YAML:1.0\n---\n", ""), BENT, None, id="camera_calibration"),
        pytest.param("c.yaml", KALIBR, None, None, id="kalibr"),
        pytest.param("c.yaml", ORB_SLAM, None, 0.0002, id="ORB-SLAM"),
        pytest.param("c.yml", DEXYCB, CAMERA, None, id="DexYCB"),
        pytest.param("c.yaml", EXPONENTS, CAMERA, 0.001, id="1e-3"),
        pytest.param("c.json", {"intrinsic_matrix": COLUMNS, "depth_scale": 1000.0}, CAMERA, 0.001, id="Open3D"),
        pytest.param("c.json", {"intrinsic": {"intrinsic_matrix": COLUMNS}}, CAMERA, None, id="Open3D view"),
        pytest.param("c.json", {"intrinsic_matrix": K.tolist(), "factor_depth": 1000}, CAMERA, 0.001, id="GraspNet"),
        pytest.param("c.json", NERF, CAMERA, None, id="NeRF"),
        pytest.param(
            "scene_camera.json",
            {str(k): {"cam_K": ROWS, "depth_scale": 0.1} for k in range(3)},
            CAMERA,
            0.0001,
            id="BOP",
        ),
        pytest.param("cam_K.txt", K, CAMERA, None, id="3x3 text"),
        pytest.param("intrinsic_color.txt", K4, CAMERA, None, id="4x4"),
        pytest.param("k.txt", "600, 601, 319, 240\n", CAMERA, None, id="four numbers"),
        pytest.param("k.txt", "fx = 600\nfy = 601\ncx: 319\ncy: 240\n", CAMERA, None, id="name = value"),
        pytest.param("camK.npy", K, CAMERA, None, id="npy"),
        pytest.param("P.npy", np.hstack([K, np.zeros((3, 1))]), CAMERA, None, id="3x4 npy"),
        pytest.param("cameras.txt", "# list\n1 PINHOLE 640 480 600 601 319.5 240.5\n", CAMERA, None, id="COLMAP"),
        pytest.param("cameras.txt", COLMAP, None, None, id="COLMAP OPENCV"),
    ],
)  # fmt: skip
def test_a_camera_file_is_read(
    tmp_path: Path, name: str, content: Any, camera: Camera | None, scale: float | None
) -> None:
    wanted = camera or Camera(600.0, 601.0, 319.0, 240.0, WIDTH, HEIGHT, BARREL[:4])
    assert read_camera(stored(tmp_path, name, content), WIDTH, HEIGHT) == (wanted, pytest.approx(scale))


def test_matlab_and_npz_files_are_cameras(tmp_path: Path) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    scipy_io.savemat(tmp_path / "meta.mat", {"intrinsic_matrix": K, "factor_depth": [[1000]], "poses": np.eye(4)})
    assert read_camera(tmp_path / "meta.mat", WIDTH, HEIGHT) == (CAMERA, 0.001)
    np.savez(tmp_path / "calib.npz", mtx=K, dist=np.array([BARREL]))
    assert read_camera(tmp_path / "calib.npz", WIDTH, HEIGHT) == (BENT, None)
    np.savez(tmp_path / "two.npz", a=np.eye(3), b=np.eye(3))
    with pytest.raises(FileError, match=r"a camera matrix as K in .*two\.npz, got the arrays a, b"):
        read_camera(tmp_path / "two.npz", WIDTH, HEIGHT)


def test_one_image_of_many_has_its_camera(tmp_path: Path) -> None:
    other = {"cam_K": [500.0, *ROWS[1:]], "depth_scale": 1.0}
    many = {"0": {"cam_K": ROWS}, "1": {"cam_K": ROWS}, "7": other}
    path = stored(tmp_path, "scene_camera.json", many)
    with pytest.raises(CameraError, match="one camera, got 3 images"):
        read_camera(path, WIDTH, HEIGHT)
    camera, scale = read_camera(path, WIDTH, HEIGHT, image="000007")
    assert (camera.fx, scale) == (500.0, 0.001)
    write_png(tmp_path / "000007.png", np.zeros((HEIGHT, WIDTH, 3), np.uint8))
    write_png(tmp_path / "d.png", np.full((HEIGHT, WIDTH), 900, np.uint16))
    frame = read_frame(tmp_path / "000007.png", tmp_path / "d.png", path)
    assert frame.camera is not None and frame.camera.fx == 500.0 and frame.depth[0, 0] == pytest.approx(0.9)


def test_cameras_that_differ_are_refused_with_their_names(tmp_path: Path) -> None:
    two = {"cam0": {"intrinsics": [600, 601, 319, 240]}, "cam1": {"intrinsics": [500, 501, 319, 240]}}
    with pytest.raises(CameraError, match=r"one camera, got 2 cameras \(cam0, cam1\)"):
        camera_from_mapping(two, WIDTH, HEIGHT)
    path = stored(tmp_path, "cameras.txt", "1 PINHOLE 640 480 1 2 3 4\n2 PINHOLE 640 480 5 6 7 8\n")
    with pytest.raises(CameraError, match="one camera, got 2 cameras"):
        read_camera(path)


@pytest.mark.parametrize(
    ("name", "content", "error", "words"),
    [
        ("k.txt", "a poem\n", FileError, "Supported: JSON or YAML"),
        ("k.txt", "1 2 3\n", FileError, r"an array of shape \(3,\)"),
        ("k.npy", np.zeros((480, 640)), FileError, "an array of shape"),
        ("cameras.txt", "1 OPENCV_FISHEYE 640 480 6 6 3 2 0 0 0 0\n", CameraError, "got OPENCV_FISHEYE: undistort"),
        ("cameras.txt", "1 PINHOLE 640 480 600\n", FileError, "the parameters fx fy cx cy of PINHOLE"),
        ("cameras.txt", "1 PINHOLE 640 480 6 6 3 2\n2 PINHOLE\n", FileError, "lines ID MODEL WIDTH HEIGHT PARAMETERS"),
        ("c.xml", "<x/>", FileError, "Supported: JSON or YAML"),
    ],
)  # fmt: skip
def test_a_file_that_is_not_a_camera_file_is_reported(
    tmp_path: Path, name: str, content: Any, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words) as caught:
        read_camera(stored(tmp_path, name, content), WIDTH, HEIGHT)
    assert "\n" not in str(caught.value)


# --- CameraInfo -----------------------------------------------------------------------------------------------

FULL = {"width": 1280, "height": 960, "k": [1200.0, 0, 639, 0, 1202, 480, 0, 0, 1], "d": [], "distortion_model": ""}


def test_binning_divides_the_camera_and_the_size() -> None:
    camera = camera_from_mapping({**FULL, "binning_x": 2, "binning_y": 2, "roi": {"width": 0}}, WIDTH, HEIGHT)
    assert (camera.fx, camera.fy, camera.width, camera.height) == (600, 601, 640, 480)
    assert (camera.cx, camera.cy) == (319.25, 239.75)
    rows = camera_from_mapping({**FULL, "binning_x": 1, "binning_y": 3}, 1280, 320)
    assert (rows.fx, rows.fy, rows.height) == (1200, pytest.approx(1202 / 3), 320)


def test_a_region_of_interest_moves_the_principal_point() -> None:
    roi = {"x_offset": 320, "y_offset": 240, "width": 640, "height": 480, "do_rectify": False}
    camera = camera_from_mapping({**FULL, "roi": roi}, 640, 480)
    assert (camera.fx, camera.cx, camera.cy, camera.width, camera.height) == (1200, 319, 240, 640, 480)
    both = camera_from_mapping({**FULL, "roi": roi, "binning_x": 2, "binning_y": 2}, 320, 240)
    assert (both.fx, both.width, both.height) == (600, 320, 240)
    whole = {"x_offset": 0, "y_offset": 0, "width": 1280, "height": 960}
    assert camera_from_mapping({**FULL, "roi": whole, "binning_x": 1}).width == 1280


def test_a_window_that_does_not_fit_the_images_is_reported_by_name() -> None:
    with pytest.raises(CameraError, match=r"binning_x 2 and binning_y 2 of 1280x960, got 1280x960: set these"):
        camera_from_mapping({**FULL, "binning_x": 2, "binning_y": 2}, 1280, 960)
    roi = {"x_offset": 1000, "y_offset": 0, "width": 640, "height": 480}
    with pytest.raises(CameraError, match="roi 640x480 at x_offset 1000, y_offset 0 inside of the full image"):
        camera_from_mapping({**FULL, "roi": roi})
    with pytest.raises(CameraError, match=r"whole number of pixels as binning_x, got 1\.5"):
        camera_from_mapping({**FULL, "binning_x": 1.5})


P = [600.0, 0, 319, 0, 0, 601, 240, 0, 0, 0, 1, 0]


@pytest.mark.parametrize(
    "fields", [{"k": [0.0] * 9, "p": P}, {"K": [], "P": P}, {"P": P}, {"projection_matrix": {"data": P}}]
)
def test_an_empty_matrix_leaves_that_of_the_projection(fields: dict[str, Any]) -> None:
    assert camera_from_mapping({**fields, "width": 640, "height": 480, "d": [0.0] * 8}) == CAMERA


def test_an_uncalibrated_driver_is_reported() -> None:
    for fields in ({"k": [0.0] * 9, "p": [0.0] * 12}, {"K": [0.0] * 9}):
        with pytest.raises(CameraError, match="not calibrated") as caught:
            camera_from_mapping({**fields, "width": 0, "height": 0}, 640, 480)
        assert "transpose" not in str(caught.value)
    with pytest.raises(CameraError, match="zeros, distortion coefficients and p"):
        camera_from_mapping({"k": [0.0] * 9, "p": P, "d": [0.1, 0, 0, 0, 0]}, 640, 480)
    assert camera_from_mapping({"K": ROWS, "width": 0, "height": 0}, 640, 480) == CAMERA


# --- lens models ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("coefficients", [[], [0.0] * 4, [0.01, 0, 0, 0]])
@pytest.mark.parametrize(
    "model", ["equidistant", "kannala_brandt4", "Kannala Brandt4", "fisheye", "distortion.ftheta", 5, "double_sphere"]
)
def test_a_lens_that_is_no_pinhole_is_refused_whatever_its_coefficients(model: Any, coefficients: list[float]) -> None:
    with pytest.raises(CameraError, match="undistort the images first"):
        camera_from_mapping({"K": ROWS, "d": coefficients, "distortion_model": model}, WIDTH, HEIGHT)


def test_other_fields_name_lenses_too() -> None:
    for field in ({"camera_model": "omni"}, {"type": "KannalaBrandt8"}, {"model": "OPENCV_FISHEYE"}, {"fisheye": True}):
        with pytest.raises(CameraError, match="undistort the images first"):
            camera_from_mapping({**FIELDS, **field}, WIDTH, HEIGHT)
    for field in ({"model": "Intel RealSense D435"}, {"type": "color"}, {"distortion_model": "radtan"}, {"model": 4}):
        assert camera_from_mapping({**FIELDS, **field}, WIDTH, HEIGHT) == CAMERA
    with pytest.raises(CameraError, match="got narrow"):
        camera_from_mapping({**FIELDS, "distortion_model": "narrow"}, WIDTH, HEIGHT)


def test_an_inverse_distortion_model_is_refused_with_the_error_of_leaving_it_out() -> None:
    fields = {**FIELDS, "coeffs": [-0.0565, 0.0682, 0.0004, 0.0007, -0.0218], "model": "Inverse Brown Conrady"}
    with pytest.raises(CameraError, match=r"inverse_brown_conrady: .*Without the coefficients.* up to [3-9]\.\d px"):
        camera_from_mapping(fields, WIDTH, HEIGHT)
    assert camera_from_mapping({**fields, "coeffs": [0.0] * 5}, WIDTH, HEIGHT) == CAMERA


# --- scales ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value", "wanted"),
    [
        ("scale", 1000, "0.001"),
        ("factor_depth", 1000.0, "0.001"),
        ("depthScale", 0.001, "0.001"),
        ("depth_factor", 5000, "0.0002"),
        ("depth_units", 0.00025, "0.00025"),
        ("depth_map_factor", 4000, "0.00025"),
        ("scale", 0.25, "0.00025"),
    ],
)
def test_another_name_for_the_scale_is_reported(name: str, value: float, wanted: str) -> None:
    with pytest.raises(CameraError, match=f"got {name} .*replace the field with depth_scale {wanted}"):
        scale_from_mapping({**FIELDS, name: value})
    assert scale_from_mapping({**FIELDS, name: value, "depth_scale": 0.001}) == 0.001


def test_a_scale_that_is_given_needs_none_of_the_file(tmp_path: Path) -> None:
    write_png(tmp_path / "c.png", np.zeros((HEIGHT, WIDTH, 3), np.uint8))
    write_png(tmp_path / "d.png", np.full((HEIGHT, WIDTH), 900, np.uint16))
    path = stored(tmp_path, "c.json", {**FIELDS, "scale": 1000})
    with pytest.raises(CameraError, match=r"replace the field with depth_scale 0\.001"):
        read_frame(tmp_path / "c.png", tmp_path / "d.png", path)
    assert read_frame(tmp_path / "c.png", tmp_path / "d.png", path, 0.001).depth[0, 0] == pytest.approx(0.9)
    with pytest.raises(FrameError, match="expected depth_scale with the integers"):
        read_frame(tmp_path / "c.png", tmp_path / "d.png", stored(tmp_path, "e.json", FIELDS))


# --- Python ---------------------------------------------------------------------------------------------------


def test_a_drivers_object_is_a_camera() -> None:
    rs = SimpleNamespace(
        fx=600.0,
        fy=601.0,
        ppx=319.0,
        ppy=240.0,
        width=640,
        height=480,
        coeffs=[0.0] * 5,
        model="distortion.inverse_brown_conrady",
    )
    info = SimpleNamespace(k=K.reshape(-1), d=[], width=640, height=480, distortion_model="plumb_bob", binning_x=0)
    ros1 = SimpleNamespace(K=ROWS, D=BARREL, width=640, height=480, distortion_model="plumb_bob")
    o3d = SimpleNamespace(intrinsic_matrix=K, width=640, height=480)
    view = SimpleNamespace(intrinsic=o3d, extrinsic=np.eye(4))
    for value in (rs, info, o3d, view, np.hstack([K, np.zeros((3, 1))]), P, "600,601,319,240", "600 601 319 240"):
        assert as_camera(value, WIDTH, HEIGHT) == CAMERA
    assert as_camera(ros1, WIDTH, HEIGHT) == BENT
    half = SimpleNamespace(k=FULL["k"], d=[], width=1280, height=960, binning_x=2, binning_y=2, roi=SimpleNamespace())
    assert as_camera(half, WIDTH, HEIGHT).fx == 600  # type: ignore[union-attr]
    for value in (object(), 3.0, (1, 2, 3)):
        with pytest.raises(CameraError, match="an object with fx, fy, ppx, ppy"):
            as_camera(value, WIDTH, HEIGHT)
    with pytest.raises(CameraError, match="four numbers fx, fy, cx, cy or nine of a matrix, got 3"):
        as_camera("1,2,3", WIDTH, HEIGHT)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((600 / 640, 601 / 480, 0.5, 0.5), "shares of the image size: multiply fx and cx by the width"),
        ((1.9, 2.5, 0.0, 0.0), "shares of the image"),
        ((3.8, 3.8, 319.5, 239.5), "a focal length in millimetres"),
    ],
)
def test_intrinsics_that_are_no_pixels_are_refused(numbers: tuple[float, ...], words: str) -> None:
    color, depth = np.zeros((HEIGHT, WIDTH, 3), np.uint8), np.ones((HEIGHT, WIDTH))
    with pytest.raises(CameraError, match=rf"a field of view of 1[67]\d|180 degrees.*{words}") as caught:
        sp.Frame(color, depth, numbers)
    assert words in str(caught.value)


@pytest.mark.parametrize("name", NOMINAL)
def test_each_nominal_camera_names_its_source(name: str) -> None:
    assert len(SOURCES[name]) > 10
    assert 0.4 < NOMINAL[name][0][0] / NOMINAL[name][0][4] < 1.2


def test_cameras_of_today_are_known() -> None:
    for name in (
        "realsense-d405",
        "RealSense D435",
        "realsense_d455",
        "realsense-l515",
        "azure-kinect",
        "femto-bolt",
        "oak-d",
    ):
        assert Camera.named(name, 1280, 720).width == 1280
