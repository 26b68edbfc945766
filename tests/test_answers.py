"""Whole answers for any frame: what every preset and method promises, whatever the frame holds."""

from __future__ import annotations

import json
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import event, given
from hypothesis import strategies as st

import spigolo as sp
from test_properties import depths, seeds

PRESETS = sorted(sp.PRESETS)
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of negative depth, wrong units


@st.composite
def scenes(draw: st.DrawFn) -> sp.Frame:
    """Blocks on a slanted plane, seen by a camera or by nobody knows whom; noise, holes and depth that cannot be."""
    depth = draw(depths(1, 90))
    shape = depth.shape
    rng = np.random.default_rng(draw(seeds))
    color = np.full((*shape, 3), draw(st.sampled_from([0, 120, 255])), np.uint8)
    for _ in range(draw(st.integers(0, 5))):
        top, left, size = (draw(st.integers(0, most)) for most in (shape[0] - 1, shape[1] - 1, 40))
        block = np.s_[top : top + size + 1, left : left + size + 1]
        nearer = draw(st.sampled_from([0.0, 0.01, 0.1, 0.29]))
        depth[block] = np.where(depth[block] > 0, depth[block] - np.float32(nearer), 0)
        color[block] = rng.integers(0, 256, 3)
    color = np.clip(color + rng.normal(0, draw(st.sampled_from([0, 4, 60])), color.shape), 0, 255).astype(np.uint8)
    depth = depth * np.float32(draw(st.sampled_from([1.0, 0.1, 20.0])))
    if draw(st.booleans()):
        flawed = rng.random(shape) < 0.1
        depth[flawed] = draw(st.sampled_from([np.nan, np.inf, -1.0, 1e9, 1e-30]))
    focal = draw(st.sampled_from([None, 0.8, 5.0]))
    camera = None
    if focal is not None:
        camera = sp.Camera(focal * shape[1], focal * shape[1], shape[1] / 2 - 0.5, shape[0] / 2, shape[1], shape[0])
    return sp.Frame(color, depth, camera)


def check(answer: sp.Segmentation, frame: sp.Frame) -> None:
    """What any answer promises."""
    labels = answer.labels
    assert labels.shape == frame.shape and labels.dtype == np.int32
    assert np.array_equal(np.unique(np.append(labels, 0)), np.arange(len(answer) + 1))
    regions = answer.regions
    assert sorted(r.region for r in (*answer.objects, *answer.rejected)) == list(range(regions.count))
    scores = [o.score for o in answer.objects]
    assert scores == sorted(scores, reverse=True) and all(0 <= score <= 1 for score in scores)
    for o in answer.objects:
        mask = labels == o.label
        assert np.array_equal(mask, regions.labels == o.region) and o.area_px == np.count_nonzero(mask)
        rows, columns = np.nonzero(mask)
        assert o.box_px == (rows.min(), columns.min(), rows.max() + 1, columns.max() + 1)
        assert np.allclose(o.centroid_px, (rows.mean(), columns.mean()))
        if frame.camera is not None:
            assert np.isfinite(o.points_m()).all() and len(o.points_m()) == np.count_nonzero(mask & (frame.depth > 0))
    if answer.support is not None:
        assert not (answer.support & (labels > 0)).any()
    json.dumps(answer.to_dict(), allow_nan=False)


@pytest.mark.parametrize("name", PRESETS)
@given(frame=scenes())
def test_a_preset_keeps_its_promises(name: str, frame: sp.Frame) -> None:
    before = frame.color.copy(), frame.depth.copy()
    answer = sp.segment(frame, sp.PRESETS[name])
    check(answer, frame)
    assert np.array_equal(before[0], frame.color) and np.array_equal(before[1], frame.depth)
    again = sp.Segmenter(sp.PRESETS[name])(frame)
    assert np.array_equal(again.labels, answer.labels)


@pytest.mark.parametrize("name", sorted(sp.METHODS))
@given(frame=scenes())
def test_a_method_keeps_its_promises(name: str, frame: sp.Frame) -> None:
    check(sp.METHODS[name](frame), frame)


lengths = st.one_of(st.floats(0.01, 1e8), st.sampled_from([0.01, 1.0, 60.0, 1e8]))
offsets = st.one_of(st.floats(-1e8, 1e8), st.sampled_from([-1e8, 0.0, 10.0, 1e8]))
sizes = st.integers(1, 20)
cameras = st.builds(sp.Camera, lengths, lengths, offsets, offsets, sizes, sizes)


@given(cameras, cameras, st.sampled_from([1e-6, 0.5, 1.0, 3e3, 9e7]), seeds)
def test_depth_moves_from_any_camera_to_any_other(
    source: sp.Camera, target: sp.Camera, far_m: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    depth = (far_m * rng.uniform(1, 1.1, (source.height, source.width))).astype(np.float32)
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(rng.normal(0, rng.choice([0, 0.1, 3]), 3))[0]
    T[:3, 3] = rng.choice([0, 0.02, 1]) * rng.uniform(-5, 5, 3)
    moved = sp.register_depth(depth, source, target, T)
    assert moved.shape == (target.height, target.width) and np.isfinite(moved).all() and (moved >= 0).all()


near, far = st.floats(-3, 0.5), st.floats(0.6, 9)
rois = st.one_of(
    st.tuples(st.integers(-9, 40), st.integers(-9, 40), st.integers(1, 90), st.integers(1, 90)),
    st.builds(sp.MetricBox, st.tuples(near, near, near), st.tuples(far, far, far)),
)


@given(frame=scenes(), name=st.sampled_from(PRESETS), roi=rois)
def test_a_region_of_interest_is_taken_or_refused(frame: sp.Frame, name: str, roi: Any) -> None:
    try:
        answer = sp.segment(frame, sp.PRESETS[name], roi)
    except sp.SpigoloError as error:
        event(type(error).__name__)
        return
    check(answer, frame)
    assert all(o.inside is not None and 0.5 <= o.inside <= 1 for o in answer)


@given(frame=scenes(), name=st.sampled_from(PRESETS), draws=st.lists(seeds, min_size=1, max_size=4))
def test_corrections_keep_them_too(frame: sp.Frame, name: str, draws: list[int]) -> None:
    answer = sp.segment(frame, sp.PRESETS[name])
    for seed in draws:
        rng = np.random.default_rng(seed)
        a, b = (answer.at((int(rng.integers(frame.shape[0])), int(rng.integers(frame.shape[1])))) for _ in range(2))
        answer = (answer.keep(a), answer.drop(a), answer.merge(a, b))[int(rng.integers(3))]
        check(answer, frame)
