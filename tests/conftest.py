"""Real frames for the tests that want them, and how Hypothesis draws."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from spigolo import Camera, Frame, read_frame

DATA = Path(os.environ.get("SPIGOLO_DATA", Path(__file__).resolve().parents[2] / "shared" / "data"))
CHOSEN = (("osd-mosd", "learn0"), ("hand-uoc", "000000"), ("hand-apcshelf", "000000"))
"""One frame each of a Kinect v1, a RealSense and a RealSense F200 that misses most of its depth."""
CROP_SIZE = (64, 80)
CROP_CORNERS = ((208, 280), (200, 300), (180, 240))
"""First row and column of the crop of each chosen frame."""

settings.register_profile(
    "spigolo", deadline=None, max_examples=40, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("long", settings.get_profile("spigolo"), max_examples=3000, derandomize=False)
settings.load_profile("spigolo")


def require(path: Path) -> Path:
    """The path. Where it is absent a test is skipped, but fails in the automatic checks (CI is set)."""
    if not path.exists():
        message = f"{path.name} is absent; SPIGOLO_DATA names the data folder"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    return path


def load_frame(folder: Path) -> Frame:
    """The frame in a folder of rgb.png, depth.png and camera.json."""
    require(folder)
    return read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")


def crop(frame: Frame, top: int, left: int, height: int, width: int) -> Frame:
    """A part of a frame, its camera moved with it."""
    rows, columns = slice(top, top + height), slice(left, left + width)
    k = frame.camera
    camera = Camera(k.fx, k.fy, k.cx - left, k.cy - top, width, height)
    return Frame(frame.color[rows, columns], frame.depth[rows, columns], camera, name=f"{frame.name}-{top}-{left}")


@pytest.fixture(scope="session")
def data() -> Path:
    """The data folder."""
    return require(DATA)


@pytest.fixture(scope="session")
def frames(data: Path) -> list[Frame]:
    """Three whole real frames of different sensors."""
    return [load_frame(data / "frames" / part / name) for part, name in CHOSEN]


@pytest.fixture(scope="session")
def crops(frames: list[Frame]) -> list[Frame]:
    """A part of 64 x 80 pixels of each of `frames`."""
    return [crop(frame, *corner, *CROP_SIZE) for frame, corner in zip(frames, CROP_CORNERS, strict=True)]
