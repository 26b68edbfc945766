"""The package on real frames: every preset on every one, and what OBJECTS must reach."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from conftest import load_frame
from spigolo.lab.evaluation import score_frame, summarise

pytestmark = [
    pytest.mark.frames,
    pytest.mark.filterwarnings("ignore:the largest plane is covered with image edges"),  # true of some of them
    pytest.mark.filterwarnings("ignore:no support plane"),  # true of some shelves
]
IGNORE = 255


def every_frame(data: Path) -> list[str]:
    listed = json.loads((data / "frames" / "splits.json").read_text())
    return [*listed["dev"], *listed["unlabelled"]]


@pytest.mark.parametrize("name", ["OBJECTS", "SHELF", "TABLE", "CLUTTER"])
def test_every_frame_runs_and_its_answer_holds_together(data: Path, name: str) -> None:
    names = every_frame(data)
    assert len(names) == 88

    def run(frame_name: str) -> None:
        frame = load_frame(data / "frames" / frame_name)
        config = sp.PRESETS[name]
        trace = sp.trace(frame, config)
        result = trace.segmentation
        assert result.labels.shape == frame.shape
        assert result.labels.dtype == np.int32
        assert np.array_equal(np.unique(result.labels[result.labels > 0]), np.arange(1, len(result) + 1))
        assert len(result) + len(result.rejected) == result.regions.count
        if config.additions is None or config.additions.flats is None:  # flat objects are new regions
            assert result.regions.count <= trace.regions.count  # outlines drawn again can take all of a small region
        for o in result:
            assert np.array_equal(o.mask, result.labels == o.label)
            assert o.area_px == np.count_nonzero(o.mask)
        assert all(np.isfinite(plane[plane != np.inf]).all() for plane in trace.graph.weights)
        finite = trace.graph.weights[trace.graph.weights != np.inf]
        assert 0 <= finite.min(initial=0) <= finite.max(initial=0) <= 1

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(run, names))


SETS = {
    "mOSD": ("osd-mosd",),
    "mOSD, test split": ("osd-mosd-b",),
    "table-tops": ("hand-uoc",),
    "other table-tops": ("osd-full-b", "hand-uoc-b", "hand-pcpt-b", "hand-posecnn-b"),
    "field": ("field",),
}
LITTLE_WORTH = {"kpick_dewbell_bin", "femtobolt_box", "pepper_greenhouse", "slambook_dining", "sbtc_battery_cables"}
"""Field frames that are left out: unregistered depth, labels that say little, and the packed tote."""


@pytest.mark.parametrize(
    ("sets", "n_objects", "least"),
    [
        ("mOSD", 120, {"overlap_f": 0.98, "found_iou_70": 0.97}),
        ("mOSD, test split", 156, {"overlap_f": 0.975}),
        ("table-tops", 27, {"overlap_f": 0.90}),
        ("other table-tops", 71, {"found_iou_70": 0.60, "boundary_f": 0.78}),
        ("field", 28, {"overlap_f": 0.70, "found_iou_70": 17 / 28}),
    ],
)
def test_objects_finds_the_objects(data: Path, sets: str, n_objects: int, least: dict[str, float]) -> None:
    """The bounds are slightly below what the preset reaches. It was made while looking at most of these frames."""
    folders = [folder for name in SETS[sets] for folder in sorted((data / "frames" / name).iterdir())]
    folders = [folder for folder in folders if (folder / "label.png").exists() and folder.name not in LITTLE_WORTH]

    def score(folder: Path):
        label = cv2.imread(str(folder / "label.png"), cv2.IMREAD_UNCHANGED)
        ignore = label == IGNORE
        return score_frame(np.where(ignore, 0, label), sp.segment(load_frame(folder)).labels, ignore=ignore)

    with ThreadPoolExecutor(2) as pool:
        total = summarise(list(pool.map(score, folders)))
    assert total.n_objects == n_objects
    reached = {name: getattr(total, name) for name in least}
    assert all(reached[name] >= bound for name, bound in least.items()), reached


def test_an_empty_tote_has_no_objects(data: Path) -> None:
    assert len(sp.segment(load_frame(data / "frames" / "unlabelled" / "arc_tote_empty"))) == 0


def test_two_runs_give_the_same_labels(frames: list[sp.Frame]) -> None:
    for frame in frames:
        for config in sp.PRESETS.values():
            assert np.array_equal(sp.segment(frame, config).labels, sp.segment(frame, config).labels)
