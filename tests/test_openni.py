"""Cameras of OpenNI2 through the production code, fed by the dummy device of the library."""

from __future__ import annotations

import ctypes.util
import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError, SpigoloError
from spigolo.sources import openni

pytestmark = pytest.mark.alone
HERE = Path(__file__).parent


def seen(name: str) -> dict[str, Any]:
    """What the dummy device gives, in a process of its own. Without the library a test is skipped, but fails in CI."""
    lacks = importlib.util.find_spec("openni") is None or ctypes.util.find_library("OpenNI2") is None
    if lacks and not os.environ.get("CI"):
        pytest.skip("needs the package openni, and Debian's libopenni2-0")
    command = [sys.executable, str(HERE / "openni_device.py"), name]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == 0, run.stderr
    found: dict[str, Any] = json.loads(run.stdout)
    return found


def test_frames_come_in_pairs_as_metres_and_rgb() -> None:
    found = seen("plain")
    assert found["names"] == [f"{k:06d}" for k in range(10)]
    assert found["stamps_ns"] == sorted(set(found["stamps_ns"]))
    assert found["color"] == [[240, 320, 3], "uint8", 255]
    assert found["depth"] == [[240, 320], "float32", 0.001]
    assert max(found["depths_m"]) == 2.0 and all(0.9 < z <= 2.0 for z in found["depths_m"])
    assert found["report"][:2] == [10, 0] and found["report"][3] == 20.0
    assert re.search(r"\d unmatched images? \(no partner within 20 ms\)", found["told"])


def test_what_the_device_cannot_do_is_told() -> None:
    found = seen("plain")
    assert found["camera"] is None and found["intrinsics"] == ""
    assert found["warnings"] == [
        "openni:Dummy does not register depth to colour: register it with sp.register_depth",
        "openni:Dummy reports no field of view: give the camera, such as camera='xtion', for results in 3-D",
    ]


def test_a_closed_camera_opens_again_with_the_camera_that_was_given() -> None:
    found = seen("again")
    xtion = sp.Camera.named("xtion", 320, 240)
    assert found["names"] == ["000000", "000001", "000002"]
    assert found["camera"] == [xtion.fx, xtion.cx, 320]
    assert not any("field of view" in text for text in found["warnings"])


def test_a_slow_reader_gets_the_newest_frame_and_the_others_are_counted() -> None:
    found = seen("slow")
    frames, broken, dropped, _ = found["report"]
    assert (frames, broken) == (4, 0) and dropped >= 3
    steps = np.diff(found["stamps_ns"])
    assert (steps > 2 * 33_000_000).any()  # frames in between were left out


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "size",
            "has no color stream of 640x480 at 30 Hz: choose another one with ?width=W&height=H&fps=N. Available: 320x",
        ),
        ("address", "openni:nowhere cannot be opened"),
        ("unplugged", "no OpenNI camera is connected: plug one in, or name the address of one (openni:ADDRESS)"),
    ],
)
def test_a_camera_that_does_not_fit_is_told(name: str, text: str) -> None:
    assert text in seen(name)["error"]


def test_the_field_of_view_of_a_kinect_gives_its_focal_length() -> None:
    camera = openni.nominal_camera(640, 480, 1.0144686, 0.7898090)  # as OpenNI2 reports for its depth
    assert (camera.fx, camera.fy) == (pytest.approx(575.8, abs=1), pytest.approx(575.8, abs=1))
    assert (camera.cx, camera.cy) == (319.5, 239.5)


def test_rows_may_be_padded_and_a_cut_image_is_told() -> None:
    rows = np.zeros((2, 16), np.uint8)
    rows[:, :12] = np.arange(24).reshape(2, 12)
    image = SimpleNamespace(width=4, height=2, stride=16, timestamp=5, get_buffer_as_uint8=rows.ravel)
    copied = openni._copied(image, "color")
    np.testing.assert_array_equal(copied.pixels, np.arange(24).reshape(2, 4, 3))
    assert copied.stamp_ns == 5000
    image.height = 3
    with pytest.raises(SpigoloError, match="expected 3 rows of 16 bytes of color, got 32 bytes"):
        openni._copied(image, "color")


def test_the_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "openni", None)
    monkeypatch.delitem(sys.modules, "openni.openni2", raising=False)
    with pytest.raises(FileError, match=r'pip install "spigolo\[openni\]"'):
        sp.open_source("openni:")
