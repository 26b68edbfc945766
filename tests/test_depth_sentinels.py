"""Stored values that no camera measured are missing, and are told once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from spigolo.doctor import diagnose
from spigolo.errors import UnitWarning
from spigolo.frames.camera import Camera
from spigolo.frames.files import write_png
from spigolo.frames.reach import REACH_M

CAMERA = Camera(60.0, 60.0, 31.5, 23.5, 64, 48)


def frame_of(depth: np.ndarray, scale: float | None = None) -> sp.Frame:
    return sp.Frame(np.zeros((*depth.shape, 3), np.uint8), depth, CAMERA, depth_scale=scale)


def scattered(kind: str, value: float, far: float) -> np.ndarray:
    depth = np.full((48, 64), value, kind)
    depth[::4, ::4] = far
    return depth


@pytest.mark.parametrize(
    ("kind", "scale", "value", "far", "words"),
    [
        ("u2", 0.001, 800, 65535, "65535, the largest value of uint16"),
        ("u2", 0.00025, 3200, 65535, "65535, the largest value of uint16"),
        ("i2", 0.001, 800, 32767, "32767, the largest value of int16"),
        ("i4", 0.0001, 8000, 65535, "65535, the largest value of uint16"),
        ("u4", 1e-6, 800000, 4294967295, "largest value of uint32"),
        ("f4", None, 0.8, 65.535, "65.535, farther than 50 m"),
        ("f8", None, 0.8, 1e300, "farther than 50 m"),
        ("f4", None, 0.8, 1e6, "farther than 50 m"),
        ("u2", 0.001, 800, 60000, "60000, farther than 50 m"),
    ],
)
def test_a_value_that_stands_for_missing_is_missing(
    kind: str, scale: float | None, value: float, far: float, words: str
) -> None:
    with pytest.warns(UnitWarning, match=words) as told:
        frame = frame_of(scattered(kind, value, far), scale)
    assert len(told) == 1
    assert "at 6.2% of the pixels" in str(told[0].message)
    assert (frame.depth[::4, ::4] == 0).all()
    assert np.unique(frame.depth[frame.depth > 0]) == pytest.approx([0.8])
    assert frame.out_of_reach is not None and frame.out_of_reach.pixels == 192


def test_areas_and_few_pixels_are_missing_too() -> None:
    depth = np.full((48, 64), 800, np.uint16)
    depth[:, 20:] = 65535
    with pytest.warns(
        UnitWarning, match=r"depth 65535, the largest value of uint16, counts as missing \(at 68\.8% of the pixels\)"
    ):
        assert frame_of(depth, 0.001).depth.astype(bool).sum() == 48 * 20
    depth[:] = 800
    depth[3, 3] = 65535
    with pytest.warns(UnitWarning, match=r"depth 65535, .* counts as missing \(at 1 pixel\)"):
        assert frame_of(depth, 0.001).depth[3, 3] == 0


def test_what_is_not_finite_is_missing_without_a_word() -> None:
    depth = scattered("f4", 0.8, np.inf)
    depth[1, 1] = np.nan
    frame = frame_of(depth)
    assert frame.out_of_reach is None
    assert (frame.depth == 0).sum() == 193


def test_a_wrong_unit_is_no_sentinel() -> None:
    """All depth beyond reach is a unit: the advice about it needs the values."""
    frame = frame_of(np.full((48, 64), 800.0, np.float32))
    assert frame.out_of_reach is None
    assert frame.depth.max() == 800
    assert REACH_M == 50
    spread = np.linspace(20, 300, 48 * 64).reshape(48, 64)
    assert frame_of(spread).depth.max() == 300


def test_most_of_a_frame_may_be_missing() -> None:
    depth = np.full((48, 64), 65.535, np.float32)
    depth[:10] = np.linspace(0.5, 2, 640).reshape(10, 64)
    with pytest.warns(UnitWarning, match=r"depth 65\.535, farther than 50 m"):
        assert frame_of(depth).depth.max() == 2


def test_the_largest_value_of_a_mask_of_distances_near_the_reach_counts() -> None:
    depth = np.linspace(1, 49.9, 48 * 64).reshape(48, 64)
    assert (frame_of(depth).depth > 0).all()


def test_segment_and_doctor_say_it_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from spigolo.cli.segment import doctor

    rng = np.random.default_rng(0)
    depth = (800 + 20 * rng.random((240, 320))).astype(np.uint16)
    depth[:24] = 65535
    color = rng.integers(0, 255, (240, 320, 3), dtype=np.uint8)
    with pytest.warns(UnitWarning, match=r"depth 65535, .*at 10\.0% of the pixels"):
        frame = sp.Frame(color, depth, (300, 300, 159.5, 119.5), depth_scale=0.001)
    said = [f.sentence for f in diagnose(frame).warnings if "65535" in f.sentence]
    assert len(said) == 1 and "10.0% of the pixels" in said[0]
    write_png(tmp_path / "rgb.png", color)
    write_png(tmp_path / "depth.png", depth)
    doctor(str(tmp_path), camera="300,300,159.5,119.5", depth_scale=0.001)
    assert capsys.readouterr().out.count("65535") == 1


def test_registered_depth_has_no_sentinel() -> None:
    depth = scattered("u2", 800, 65535)
    with pytest.warns(UnitWarning, match="65535"):
        out = sp.register_depth(depth, CAMERA, CAMERA, np.eye(4), depth_scale=0.001)
    assert out.max() == pytest.approx(0.8)
