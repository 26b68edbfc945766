"""The paper's figures from any frame."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.stages.depth import smooth
from spigolo.view import figures
from test_cli import SCENE, spigolo
from test_joining import BOWL_WITH_BOTTOM, draw


@pytest.fixture(scope="module")
def frame() -> sp.Frame:
    return draw(*BOWL_WITH_BOTTOM)[0]


def test_the_cloud_of_eq_5_strays_where_depth_is_missing(frame: sp.Frame) -> None:
    depth = frame.depth.copy()
    depth[100:120, 140:180] = 0
    assert frame.camera is not None
    window = (60, 80, 180, 240)
    clean = figures.side_view(depth, frame.color, frame.camera, window)
    assert (clean != 255).any()
    assert (figures.side_view(np.zeros_like(depth), frame.color, frame.camera, window) == 255).all()


def test_figure_2_needs_a_camera_and_the_others_do_not(frame: sp.Frame) -> None:
    blind = sp.Frame(frame.color, frame.depth, None)
    with pytest.raises(sp.errors.CameraError, match="Figure 2"):
        figures.figure2(blind)
    for draw_figure in (figures.figure3, figures.figure4):
        assert draw_figure(blind).any()


@pytest.mark.filterwarnings("ignore:no support plane")
@pytest.mark.parametrize("shape", [(40, 3), (3, 2), (1, 1)])
def test_figures_of_narrow_images(frame: sp.Frame, shape: tuple[int, int]) -> None:
    height, width = shape
    narrow = sp.Frame(frame.color[:height, :width], np.ones(shape), "60deg")
    for figure in (figures.figure2, figures.figure3, figures.figure4):
        assert figure(narrow).size > 0


def test_internal_boundaries_are_more_edges(frame: sp.Frame) -> None:
    picture = figures.figure4(frame)
    height, width = frame.shape
    strip = max(24, height // 18)
    with_internal, final = (picture[2 + strip : strip + height, x : x + width] > 200 for x in (2, 6 + width))
    assert np.count_nonzero(with_internal) >= np.count_nonzero(final) > 0


def test_all_figures_are_written(tmp_path: Path) -> None:
    done = spigolo("figures", SCENE, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    for number in (2, 3, 4, 5):
        picture = cv2.imread(str(tmp_path / f"figure{number}.png"))
        assert picture.std() > 20
    assert len(done.stdout.split()) == 4


def test_figures_show_the_objects_of_the_named_preset(tmp_path: Path, frame: sp.Frame) -> None:
    ours, paper = (figures.figure5({"x": (frame, sp.segment(frame, p))}) for p in (sp.OBJECTS, sp.TABLE))
    assert (ours != paper).any()
    for preset in ("OBJECTS", "TABLE"):
        done = spigolo("figures", SCENE, "--preset", preset, "--out", tmp_path / preset)
        assert done.returncode == 0, done.stderr
    five, of_table = (cv2.imread(str(tmp_path / preset / "figure5.png")) for preset in ("OBJECTS", "TABLE"))
    assert (five != of_table).any()
    done = spigolo("figures", SCENE, "--preset", "SHELFS", "--out", tmp_path / "x")
    assert done.returncode == 2 and "unknown preset 'SHELFS'" in done.stderr


def test_figure_2_differs_only_by_equation_8(frame: sp.Frame, monkeypatch: pytest.MonkeyPatch) -> None:
    used = []

    def recorded(depth: np.ndarray, config: sp.settings.Smoothing) -> np.ndarray:
        used.append(config)
        return smooth(depth, config)

    monkeypatch.setattr(figures, "smooth", recorded)
    figures.figure2(frame)
    plain, valid = used
    assert (plain.mean, valid.mean) == ("plain", "valid") and plain.replace(mean="valid") == valid
    assert not valid.skip_steps
