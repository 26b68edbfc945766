"""Frames of other people, read with their cameras as the authors wrote them: JSON, NumPy, MATLAB, numbers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.frames.files import read_depth, read_frame

pytestmark = pytest.mark.frames


def matrix(camera: dict[str, Any]) -> np.ndarray:
    return np.array([[camera["fx"], 0, camera["cx"]], [0, camera["fy"], camera["cy"]], [0, 0, 1]])


def open3d(folder: Path, camera: dict[str, Any]) -> Path:
    """Their Open3D camera: column by column."""
    path = folder / "camera_intrinsic.json"
    columns = matrix(camera).T.reshape(-1).tolist()
    path.write_text(json.dumps({"width": camera["width"], "height": camera["height"], "intrinsic_matrix": columns}))
    return path


def numpy_matrix(folder: Path, camera: dict[str, Any]) -> Path:
    np.save(folder / "mtx.npy", matrix(camera))
    return folder / "mtx.npy"


def graspnet(folder: Path, camera: dict[str, Any]) -> Path:
    scipy_io = pytest.importorskip("scipy.io")
    scipy_io.savemat(folder / "meta.mat", {"intrinsic_matrix": matrix(camera), "factor_depth": np.array([[1000]])})
    return folder / "meta.mat"


def numbers(folder: Path, camera: dict[str, Any]) -> str:
    """Four numbers of a script, as they are typed behind --camera."""
    return ",".join(str(camera[name]) for name in ("fx", "fy", "cx", "cy"))


@pytest.mark.parametrize(
    ("name", "form", "scale"),
    [
        ("felixplanes_000000", open3d, 0.001),
        ("morobot_bin_0", open3d, 0.001),
        ("kuleuven_disks_10", numpy_matrix, 0.001),
        ("sbtc_battery_cables", graspnet, None),
        ("anygrasp_track_000", numbers, 0.001),
        ("shiyoung_mustard_table", numbers, 0.00025),
        ("slambook_dining", numbers, 0.001),
        ("tt_yolo_tray", numbers, 0.001),
        ("pepper_greenhouse", numbers, 0.001),
        ("tumdesk_fr2_desk", numbers, 0.0002),
    ],
)
@pytest.mark.filterwarnings("ignore::spigolo.errors.UnitWarning")
def test_a_camera_is_read_as_its_author_wrote_it(
    data: Path, tmp_path: Path, name: str, form: Any, scale: float | None
) -> None:
    folder = data / "frames" / "field" / name
    wanted = read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
    given = form(tmp_path, json.loads((folder / "camera.json").read_text()))
    frame = read_frame(folder / "rgb.png", folder / "depth.png", given, scale)
    assert frame.camera == wanted.camera
    np.testing.assert_array_equal(frame.depth, wanted.depth)


@pytest.mark.parametrize("name", ["kinova_round_table", "kpick_dewbell_bin", "philip_person_mug", "femtobolt_box"])
def test_a_nominal_camera_serves_where_the_authors_gave_none(data: Path, name: str) -> None:
    folder = data / "frames" / "field" / name
    wanted = json.loads((folder / "camera.json").read_text())
    camera = sp.Camera.named("azure-kinect" if name == "femtobolt_box" else "realsense-d435", 1280, 720)
    assert camera.fx == wanted["fx"]


def test_depth_in_the_authors_containers(data: Path, tmp_path: Path) -> None:
    """16-bit .npy (anygrasp, kuleuven), .pgm (slambook) and metres in .npz (tt_yolo)."""
    stored = read_depth(data / "frames" / "field" / "slambook_dining" / "depth.png")
    np.save(tmp_path / "d.npy", stored)
    cv2.imwrite(str(tmp_path / "d.pgm"), stored)
    np.savez_compressed(tmp_path / "d.npz", depth=stored)
    for suffix in ("npy", "pgm", "npz"):
        np.testing.assert_array_equal(read_depth(tmp_path / f"d.{suffix}"), stored)
