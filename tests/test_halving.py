"""Partition at half the width and height, outlines at full size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from spigolo.cli.inputs import configure
from spigolo.errors import ConfigError, FrameError
from spigolo.frames.halving import halve_frame, halve_roi, uncropped

HALF = sp.OBJECTS.replace(additions={"resolution": "half"})
SCENE = Path(sp.__file__).parent / "demo_scene"
TOP_M = 0.94


def scene(height: int = 361, width: int = 483, camera: bool = True) -> sp.Frame:
    """A table seen from above with a red box and a blue disc; odd sizes."""
    yy, xx = np.mgrid[:height, :width]
    box = (abs(yy - 120) < 40) & (abs(xx - 130) < 55)
    disc = (yy - 230) ** 2 + (xx - 330) ** 2 < 45**2
    color = np.full((height, width, 3), (120, 130, 110), np.uint8)
    color[box], color[disc] = (200, 40, 30), (30, 50, 190)
    depth = np.where(box | disc, TOP_M, 1.0).astype(np.float32)
    k = sp.Camera(480.0, 480.0, (width - 1) / 2, (height - 1) / 2, width, height) if camera else None
    return sp.Frame(color, depth, k)


def overlap(a: np.ndarray, b: np.ndarray) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.mark.parametrize("camera", [True, False])
def test_masks_are_those_of_the_full_frame_to_the_pixel(camera: bool) -> None:
    frame = scene(camera=camera)
    result = sp.segment(frame, HALF)
    tops = frame.depth == np.float32(TOP_M)
    assert result.labels.shape == frame.shape and len(result) == 2
    assert overlap(result.labels > 0, tops) > 0.99
    for o in result:
        assert o.area_px == np.count_nonzero(o.mask) and o.mask.shape == frame.shape
        if camera:
            assert o.centroid_m is not None and abs(o.centroid_m[2] - TOP_M) < 0.002
            assert len(o.points_m()) == o.area_px
    assert result.digest == HALF.digest != sp.OBJECTS.digest
    assert result.frame is frame


def test_real_objects_are_those_of_full_resolution() -> None:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    full, half = sp.segment(frame), sp.segment(frame, HALF)
    found = [max((overlap(o.mask, other.mask) for other in half), default=0.0) for o in full]
    assert sum(f > 0.9 for f in found) >= len(full) - 1


@pytest.mark.parametrize(
    "roi",
    [(60, 60, 200, 220), sp.MetricBox((-0.5, -0.5, 0.5), (0.0, 0.1, 0.97)), "mask"],
    ids=["box", "metres", "mask"],
)
def test_a_region_of_interest_is_given_in_the_full_frame(roi) -> None:
    frame = scene()
    if roi == "mask":
        roi = np.zeros(frame.shape, bool)
        roi[60:200, 60:220] = True
    result = sp.segment(frame, HALF, roi)
    assert len(result) == 1 and result.at((120, 130)) is result[0]


def test_a_region_of_interest_that_does_not_fit_is_refused() -> None:
    frame = scene()
    with pytest.raises(FrameError, match=r"inside 361 rows and 483 columns"):
        sp.segment(frame, HALF, (0, 0, 362, 10))
    assert halve_roi(None, frame) is None


def test_corrections_by_hand_work_on_the_full_frame() -> None:
    result = sp.segment(scene(), HALF)
    merged = result.merge(result[0], result[1])
    assert len(merged) == 1 and merged[0].area_px == result[0].area_px + result[1].area_px
    dropped = result.drop(result.object_at((120, 130)))
    assert len(dropped) == 1
    assert len(dropped.keep(dropped.at((120, 130)))) == 2


def test_a_trace_has_the_stages_of_the_halved_frame_and_the_answer_of_the_full_one() -> None:
    frame = scene()
    run = sp.trace(frame, HALF)
    assert run.frame is frame and run.segmentation.labels.shape == frame.shape
    assert run.cues.depth.shape == run.regions.labels.shape == (181, 242)


def test_the_halved_camera_sees_the_same_points() -> None:
    frame = scene()
    small = halve_frame(frame)
    assert small.camera is not None and frame.camera is not None
    assert small.shape == (181, 242)
    full, half = frame.camera.back_project(frame.depth), small.camera.back_project(small.depth)
    tops = [points[(points[:, 2] < 0.97) & (points[:, 0] < 0)].mean(axis=0) for points in (full, half)]
    np.testing.assert_allclose(tops[0], tops[1], atol=0.002)


def test_a_wide_frame_has_the_lengths_of_the_frame_that_it_was_cut_from() -> None:
    assert uncropped((360, 640)) == (480, 640)
    assert uncropped((480, 640)) == (480, 640)
    assert uncropped((640, 360)) == (640, 853)


def test_the_flag_has_a_short_name() -> None:
    assert configure("OBJECTS", {"resolution": "half"}).digest == HALF.digest
    with pytest.raises(ConfigError, match="'full' or 'half'"):
        configure("OBJECTS", {"resolution": "quarter"})


def test_additions_alone_give_the_papers_presets_half_resolution() -> None:
    config = configure("TABLE", {"resolution": "half"})
    assert config.additions is not None and config.additions.support is None
    assert sp.segment(scene(), config).labels.shape == (361, 483)
