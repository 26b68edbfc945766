"""Minimum heights follow the noise of the support plane."""

from __future__ import annotations

import os

import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.heights import lower_heights, plane_noise_m
from spigolo.additions.support import find_support

CAMERA = sp.Camera(525.0, 525.0, 319.5, 239.5, 640, 480)
compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")


def table(noise_m: float, height_m: float = 0.006) -> sp.Frame:
    """A table 0.6 m below the camera with a flat box on it."""
    rng = np.random.default_rng(0)
    depth = np.full((480, 640), 0.6, np.float32)
    color = np.full((480, 640, 3), (150, 120, 90), np.uint8)
    depth[180:300, 240:400] -= height_m
    color[180:300, 240:400] = 40, 90, 160
    depth += rng.normal(0, noise_m, depth.shape).astype(np.float32)
    return sp.Frame(color, depth, CAMERA)


def lowered(frame: sp.Frame, config: sp.Config = sp.OBJECTS) -> sp.Config:
    assert config.additions is not None
    plane = find_support(frame.depth, frame.camera, config.additions.support)
    return lower_heights(config, plane, frame.depth, frame.camera)


def heights(config: sp.Config) -> tuple[float, float]:
    ours = config.additions
    assert ours is not None and ours.support is not None and ours.rules.ledge is not None
    return ours.support.min_height_m, ours.rules.ledge.step_m


@pytest.mark.parametrize("noise_m", [0.0005, 0.001, 0.0015])
def test_the_noise_of_the_plane_is_measured(noise_m: float) -> None:
    frame, support = table(noise_m, 0), sp.OBJECTS.additions.support  # type: ignore[union-attr]
    plane = find_support(frame.depth, frame.camera, support)
    assert plane is not None and support is not None
    assert plane_noise_m(plane, frame.depth, CAMERA, support) == pytest.approx(noise_m, rel=0.1)


@pytest.mark.parametrize(("noise_m", "height_m"), [(0.0002, 0.004), (0.0015, 3.5 * 0.0015), (0.003, 0.008)])
def test_heights_are_a_multiple_of_the_noise_between_two_limits(noise_m: float, height_m: float) -> None:
    found, step = heights(lowered(table(noise_m, 0)))
    assert found == pytest.approx(height_m, rel=0.1)
    assert step == pytest.approx(0.006 * found / 0.008)


def test_without_the_factor_a_plane_or_intrinsics_heights_stay() -> None:
    frame = table(0.0002)
    fixed = sp.OBJECTS.replace(**{"additions.support.noise_factor": None})
    assert lowered(frame, fixed) is fixed
    assert lower_heights(sp.OBJECTS, None, frame.depth, CAMERA) is sp.OBJECTS
    assert lower_heights(sp.TABLE, None, frame.depth, None) is sp.TABLE


@compiled
def test_a_box_of_six_millimetres_is_found_if_the_depth_shows_it() -> None:
    config = sp.OBJECTS.replace(additions={"flats": None})
    (found,) = sp.segment(table(0.0003), config)
    assert found.mask[180:300, 240:400].mean() > 0.95 and found.area_px < 1.1 * 120 * 160
    assert not len(sp.segment(table(0.0003), config.replace(**{"additions.support.noise_factor": None})))
    assert not len(sp.segment(table(0.003), config))
