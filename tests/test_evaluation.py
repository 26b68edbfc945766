"""The measures: worked by hand, against the reference scorer, and by symmetry."""

from __future__ import annotations

import dataclasses
import importlib.util
import itertools
import math
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from spigolo.lab.evaluation import (
    boundary_map,
    default_radius_px,
    overlap_table,
    pair_by_f,
    score_frame,
    summarise,
    wilson_interval,
)
from spigolo.lab.evaluation.matching import Labels, Mask

ROOT = Path(__file__).resolve().parents[1]
DATA = Path(os.environ.get("SPIGOLO_DATA", ROOT / ".." / "shared" / "data"))
TOLERANCE = 1e-12

FRAME_NAMES = {
    "P": "overlap_precision",
    "R": "overlap_recall",
    "F": "overlap_f",
    "bP": "boundary_precision",
    "bR": "boundary_recall",
    "bF": "boundary_f",
    "F75": "f75",
    "true_ids": "object_ids",
    "n_true": "n_objects",
    "n_pred": "n_segments",
    "det70_recall": "found_70_recall",
    "det70_both": "found_70_both",
    "det_iou70": "found_iou_70",
    "best_iou": "best_iou",
    "matched_f": "paired_f",
}
"""Name in the reference scorer -> name here, for one frame."""

DATASET_NAMES = {name: FRAME_NAMES[name] for name in ("P", "R", "F", "bP", "bR", "bF", "F75")} | {
    "det70_recall": "found_70_recall",
    "det70_both": "found_70_both",
    "det_iou70": "found_iou_70",
    "mean_iou": "best_iou",
    "n_frames": "n_frames",
    "n_objects": "n_objects",
    "pred_per_true": "segments_per_object",
}
"""Name in the reference scorer -> name here, for a data set."""

SCALARS: tuple[str, ...] = ("overlap_precision", "overlap_recall", "overlap_f")
SCALARS += ("boundary_precision", "boundary_recall", "boundary_f", "f75", "n_segments", "n_objects")
PER_OBJECT = ("found_70_recall", "found_70_both", "found_iou_70", "best_iou", "paired_f")


def missing(what: Path) -> None:
    """Data that is not there fails the automatic checks and is skipped elsewhere."""
    message = f"{what} is absent; SPIGOLO_DATA names the data folder"
    if os.environ.get("CI"):
        pytest.fail(message)
    pytest.skip(message)


@pytest.fixture(scope="module")
def reference() -> Any:
    path = DATA.parent / "score.py"
    if not path.is_file():
        missing(path)
    spec = importlib.util.spec_from_file_location("reference_score", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def two_objects() -> Labels:
    """Two touching squares of 20 x 20 pixels."""
    labels = np.zeros((60, 80), np.int32)
    labels[10:30, 10:30] = 1
    labels[10:30, 30:50] = 2
    return labels


# --- worked by hand -----------------------------------------------------------------------------------------


def test_a_perfect_prediction_scores_one_everywhere(two_objects: Labels) -> None:
    total = summarise([score_frame(two_objects, two_objects)])
    figures = dataclasses.asdict(total)
    assert (figures.pop("n_frames"), figures.pop("n_objects")) == (1, 2)
    assert set(figures.values()) == {1.0}


def test_both_objects_in_one_segment(two_objects: Labels) -> None:
    score = score_frame(two_objects, np.where(two_objects > 0, 7, 0))
    assert (score.overlap_precision, score.overlap_recall, score.overlap_f) == (0.5, 0.5, 0.5)
    assert score.found_70_recall.all() and not score.found_70_both.any() and not score.found_iou_70.any()
    assert score.best_iou.tolist() == [0.5, 0.5]
    assert sorted(score.paired_f) == [0.0, pytest.approx(2 / 3)]
    assert score.f75 == 0 and score.n_segments == 1


@pytest.mark.parametrize(("radius_px", "n_unmet"), [(None, 17), (3, 13), (0, 19)])
def test_the_border_between_merged_objects_is_missed(
    two_objects: Labels, radius_px: float | None, n_unmet: int
) -> None:
    # The outline has 119 pixels; 19 more (y = 10 ... 28) lie between the objects. Those near the outline,
    # which runs at y = 9 and y = 29, are met. The default radius of so small an image is 1 px.
    score = score_frame(two_objects, np.where(two_objects > 0, 7, 0), radius_px=radius_px)
    assert score.boundary_precision == 1
    assert score.boundary_recall == pytest.approx((138 - n_unmet) / 138)


def test_the_default_radius_grows_with_the_image() -> None:
    assert [default_radius_px(shape) for shape in ((60, 80), (480, 640), (720, 1280))] == [1, 3, 5]


def test_a_shift_of_a_quarter(two_objects: Labels) -> None:
    score = score_frame(two_objects, np.roll(two_objects, 5, axis=1))
    assert score.overlap_precision == score.overlap_recall == 0.75
    assert score.paired_f.tolist() == [0.75, 0.75] and score.f75 == 0  # 0.75 itself is not enough
    assert score.best_iou.tolist() == [0.6, 0.6] and not score.found_iou_70.any()
    assert score.found_70_both.all()
    assert 0 < score.boundary_f < 1


def test_the_radius_decides_whether_a_shifted_boundary_is_met(two_objects: Labels) -> None:
    shifted = np.roll(two_objects, 3, axis=1)
    assert score_frame(two_objects, shifted, radius_px=3).boundary_f == 1
    assert score_frame(two_objects, shifted, radius_px=2.99).boundary_f < 1
    assert score_frame(two_objects, two_objects, radius_px=0).boundary_f == 1
    assert score_frame(two_objects, np.roll(two_objects, 25, axis=0), radius_px=math.inf).boundary_f == 1


def test_exactly_seventy_per_cent_is_not_found() -> None:
    truth = np.ones((1, 10), int)
    prediction = np.array([[1] * 7 + [0] * 3])
    assert not score_frame(truth, prediction).found_70_recall.any()
    prediction[0, 7] = 1
    assert score_frame(truth, prediction).found_70_both.all()


def test_nothing_true_and_nothing_predicted_is_right() -> None:
    empty = np.zeros((6, 8), int)
    score = score_frame(empty, empty)
    assert [getattr(score, name) for name in SCALARS] == [1.0] * 7 + [0, 0]
    total = summarise([score])
    assert total.overlap_f == 1 and math.isnan(total.found_70_recall) and math.isnan(total.best_iou)
    assert total.segments_per_object == 0


@pytest.mark.parametrize("swap", [False, True], ids=["nothing predicted", "nothing true"])
def test_one_side_empty_is_wrong(two_objects: Labels, swap: bool) -> None:
    pair = (np.zeros_like(two_objects), two_objects) if swap else (two_objects, np.zeros_like(two_objects))
    score = score_frame(*pair)
    assert [getattr(score, name) for name in SCALARS[:7]] == [0.0] * 7
    assert not score.found_70_recall.any() and not score.best_iou.any()
    assert len(score.paired_f) == score.n_objects == (0 if swap else 2)


def test_an_ignored_object_is_neither_right_nor_wrong(two_objects: Labels) -> None:
    before = two_objects.copy()
    score = score_frame(two_objects, np.where(two_objects == 2, 9, two_objects), ignore=two_objects == 2)
    assert score.overlap_f == score.boundary_f == 1 and score.object_ids.tolist() == [1]
    np.testing.assert_array_equal(two_objects, before)


def test_more_segments_than_objects(two_objects: Labels) -> None:
    prediction = two_objects.copy()
    prediction[10:30, 10:14] = 3  # 80 of 400 pixels of the first object
    score = score_frame(two_objects, prediction)
    assert score.overlap_precision == score.overlap_recall == pytest.approx(720 / 800)
    assert score.n_segments == 3 and score.found_70_both.all()
    assert summarise([score]).segments_per_object == 1.5


def test_frames_weigh_alike_in_the_means_and_objects_in_the_shares(two_objects: Labels) -> None:
    one = np.where(two_objects == 1, 1, 0)
    total = summarise([score_frame(two_objects, two_objects), score_frame(one, np.zeros_like(one))])
    assert total.overlap_f == 0.5 and total.found_70_both == pytest.approx(2 / 3)
    assert (total.n_frames, total.n_objects) == (2, 3)


def test_the_boundary_lies_left_of_and_above_the_change() -> None:
    labels = np.array([[0, 0, 0], [0, 5, 5], [0, 5, 5]])
    assert boundary_map(labels).astype(int).tolist() == [[0, 1, 1], [1, 0, 0], [1, 0, 0]]


def test_the_pairing_maximises_the_sum_and_not_the_best_pair() -> None:
    truth = np.array([[1] * 10 + [2] * 4])
    prediction = np.array([[1] * 5 + [2] * 9])
    table = overlap_table(truth, prediction)
    assert table.shared_px.tolist() == [[5, 5], [0, 4]]
    assert [part.tolist() for part in pair_by_f(table)] == [[0, 1], [0, 1]]


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int64, np.uint64])
def test_label_values_are_only_names(two_objects: Labels, dtype: type[np.integer[Any]]) -> None:
    names = np.array([0, 3, np.iinfo(dtype).max], dtype)
    score = score_frame(two_objects, names[two_objects])
    assert score.overlap_f == score.boundary_f == score.f75 == 1


# --- against the reference scorer ---------------------------------------------------------------------------


def assert_same_as_reference(ours: object, theirs: dict[str, Any], names: dict[str, str]) -> None:
    assert set(theirs) == set(names)
    for their_name, our_name in names.items():
        np.testing.assert_allclose(
            np.asarray(getattr(ours, our_name), float),
            np.asarray(theirs[their_name], float),
            rtol=0,
            atol=TOLERANCE,
            err_msg=f"{our_name} ({their_name})",
        )


@st.composite
def label_pairs(draw: st.DrawFn) -> tuple[Labels, Labels, Mask | None, float | None]:
    """Small truth, prediction, ignore mask and radius; often the prediction is the truth with changes."""
    shape = draw(array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=9))
    values = st.integers(0, draw(st.integers(0, 5)))
    truth, prediction = (
        draw(arrays(np.int32, shape, elements=values)),
        draw(arrays(np.int32, shape, elements=values)),
    )
    if draw(st.booleans()):
        prediction = np.where(draw(arrays(np.bool_, shape)), prediction, truth)
    ignore = draw(st.none() | arrays(np.bool_, shape))
    radius_px = draw(st.sampled_from([None, 0, 1, math.sqrt(2), 2, math.sqrt(5), 2.5, 4, 100]))
    return truth, prediction, ignore, radius_px


Case = tuple[Labels, Labels, "Mask | None", "float | None"]


@settings(deadline=None, max_examples=300)
@given(case=label_pairs())
def test_every_figure_of_a_frame_is_that_of_the_reference(reference: Any, case: Case) -> None:
    assert_same_as_reference(score_frame(*case), reference.score_frame(*case), FRAME_NAMES)


@settings(deadline=None, max_examples=60)
@given(cases=st.lists(label_pairs(), min_size=1, max_size=5))
def test_every_figure_of_a_data_set_is_that_of_the_reference(reference: Any, cases: list[Case]) -> None:
    ours = summarise([score_frame(*case) for case in cases])
    theirs = reference.summarise([reference.score_frame(*case) for case in cases])
    assert_same_as_reference(ours, theirs, DATASET_NAMES)


def perturbed(truth: Labels, seed: int) -> Labels:
    """A plausible bad prediction: one object lost, two merged, one cut, all shifted, some noise added."""
    rng = np.random.default_rng(seed)
    ids = rng.permutation(np.unique(truth[truth > 0]))
    out = np.roll(truth.astype(np.int32), rng.integers(-5, 6, 2), axis=(0, 1))
    lower_half = np.arange(out.shape[0])[:, np.newaxis] > np.mean(np.nonzero(out == ids[0])[0])
    out[(out == ids[0]) & lower_half] = 900
    if len(ids) > 1:
        out[out == ids[-1]] = 0
    if len(ids) > 3:
        out[out == ids[1]] = ids[2]
    y, x = rng.integers(0, out.shape[0] - 20), rng.integers(0, out.shape[1] - 30)
    out[y : y + 20, x : x + 30] = 901
    speckle = rng.random(out.shape) < 0.001
    out[speckle] = rng.integers(0, 5, int(speckle.sum()))
    return out


def test_real_labels_score_as_the_reference_scores_them(reference: Any) -> None:
    cv2 = pytest.importorskip("cv2")
    paths = sorted((DATA / "frames" / "osd-mosd").glob("*/label.png"))[:12]
    if not paths:
        missing(DATA / "frames" / "osd-mosd")
    ours, theirs = [], []
    for seed, path in enumerate(paths):
        label = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        ignore = label == 255
        truth = np.where(ignore, 0, label)
        ours.append(score_frame(truth, perturbed(truth, seed), ignore))
        theirs.append(reference.score_frame(truth, perturbed(truth, seed), ignore))
        assert_same_as_reference(ours[-1], theirs[-1], FRAME_NAMES)
    total = summarise(ours)
    assert 0.2 < total.overlap_f < 0.99 and 0.1 < total.boundary_f < 0.99  # neither trivial nor hopeless
    assert_same_as_reference(total, reference.summarise(theirs), DATASET_NAMES)


# --- symmetries ---------------------------------------------------------------------------------------------


def has_one_best_pairing(truth: Labels, prediction: Labels) -> bool:
    """Whether all pairings with the largest sum of F are the same one, by trying all of them."""
    f = overlap_table(truth, prediction).f()
    f = f if f.shape[0] <= f.shape[1] else f.T
    rows = range(f.shape[0])
    sums = sorted(
        sum(f[r, c] for r, c in zip(rows, p, strict=True))
        for p in itertools.permutations(range(f.shape[1]), f.shape[0])
    )
    return len(sums) < 2 or sums[-1] - sums[-2] > 1e-9


@st.composite
def untied_pairs(draw: st.DrawFn) -> tuple[Labels, Labels]:
    """Truth and prediction, at most four labels each, whose best pairing is unique."""
    shape = draw(array_shapes(min_dims=2, max_dims=2, min_side=2, max_side=8))
    truth = draw(arrays(np.int32, shape, elements=st.integers(0, 4)))
    changed = draw(arrays(np.int32, shape, elements=st.integers(0, 4)))
    prediction = np.where(draw(arrays(np.bool_, shape)), changed, truth)
    assume(has_one_best_pairing(truth, prediction))
    return truth, prediction


@settings(deadline=None)
@given(
    pair=untied_pairs(),
    true_names=st.permutations([3, 8, 20, 255]),
    pred_names=st.permutations([1, 2, 70, 71]),
)
def test_renaming_the_labels_changes_nothing(
    pair: tuple[Labels, Labels], true_names: list[int], pred_names: list[int]
) -> None:
    truth, prediction = pair
    before = score_frame(truth, prediction)
    rename_true, rename_pred = np.array([0, *true_names]), np.array([0, *pred_names])
    after = score_frame(rename_true[truth], rename_pred[prediction])
    for name in SCALARS:
        assert getattr(after, name) == pytest.approx(getattr(before, name), abs=TOLERANCE), name
    order = np.argsort(rename_true[before.object_ids])
    np.testing.assert_array_equal(after.object_ids, rename_true[before.object_ids][order])
    for name in PER_OBJECT:
        np.testing.assert_allclose(getattr(after, name), getattr(before, name)[order], atol=TOLERANCE)


@settings(deadline=None)
@given(pair=untied_pairs())
def test_swapping_truth_and_prediction_swaps_precision_and_recall(pair: tuple[Labels, Labels]) -> None:
    forth, back = score_frame(*pair), score_frame(pair[1], pair[0])
    for kind in ("overlap", "boundary"):
        for name, other in (("precision", "recall"), ("recall", "precision"), ("f", "f")):
            value = getattr(forth, f"{kind}_{name}")
            assert getattr(back, f"{kind}_{other}") == pytest.approx(value, abs=TOLERANCE)


# --- bad input ----------------------------------------------------------------------------------------------

GOOD = np.ones((4, 5), int)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((GOOD, GOOD[:3]), r"one shape, got truth \(4, 5\) and prediction \(3, 5\)"),
        ((GOOD[0], GOOD[0]), r"truth to be a 2-D label image, got shape \(5,\)"),
        ((GOOD, GOOD[..., np.newaxis]), r"prediction to be a 2-D label image, got shape \(4, 5, 1\)"),
        ((GOOD, GOOD.astype(float)), "prediction to hold whole-number labels, got float64"),
        ((GOOD == 1, GOOD), "truth to hold whole-number labels, got bool"),
        ((-GOOD, GOOD), "truth to hold labels from 0 up, got -1"),
        ((GOOD, GOOD, GOOD[:2] == 1), r"shape \(4, 5\), got bool of shape \(2, 5\)"),
        ((GOOD, GOOD, GOOD), r"boolean image of shape \(4, 5\), got int\d+"),
        ((GOOD, GOOD, None, -1.0), "0 or more, got -1.0"),
        ((GOOD, GOOD, None, math.nan), "0 or more, got nan"),
    ],
)
def test_bad_input_is_refused_with_a_sentence(arguments: tuple[Any, ...], says: str) -> None:
    with pytest.raises(ValueError, match=rf"^expected .*{says}.*: "):
        score_frame(*arguments)


def test_nothing_to_summarise_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one frame, got none: "):
        summarise([])


def test_a_missing_scipy_names_the_line_that_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "spigolo\[evaluation\]"'):
        score_frame(GOOD, GOOD)


def test_large_labels_and_small_ones_are_counted_alike() -> None:
    rng = np.random.default_rng(0)
    truth, prediction = rng.integers(0, 5, (2, 30, 40), dtype=np.uint64)
    small = overlap_table(truth, prediction)
    large = overlap_table(truth * np.uint64(70_000), prediction * np.uint64(90_001))
    assert large.object_ids.tolist() == [70_000, 140_000, 210_000, 280_000]
    for name in ("shared_px", "object_px", "segment_px"):
        np.testing.assert_array_equal(getattr(small, name), getattr(large, name))


# --- interval ------------------------------------------------------------------------------------------------


def test_wilson_interval_known_values() -> None:
    assert wilson_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)  # Newcombe 1998, table I
    assert wilson_interval(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert wilson_interval(1, 29) == pytest.approx((0.0061, 0.1718), abs=5e-5)
    assert wilson_interval(0, 0) == (0.0, 1.0)
    assert wilson_interval(3, 4, z=0) == (0.75, 0.75)


@given(n=st.integers(1, 500), share=st.floats(0, 1))
def test_wilson_interval_holds_the_share_and_mirrors(n: int, share: float) -> None:
    hits = round(share * n)
    low, high = wilson_interval(hits, n)
    assert 0 <= low <= hits / n + TOLERANCE and hits / n - TOLERANCE <= high <= 1
    assert wilson_interval(n - hits, n) == pytest.approx((1 - high, 1 - low), abs=TOLERANCE)


@pytest.mark.parametrize("arguments", [(-1, 5), (6, 5), (1, 5, -1.0), (1, 5, math.nan)])
def test_wilson_interval_refuses_impossible_counts(arguments: tuple[Any, ...]) -> None:
    with pytest.raises(ValueError, match=r"expected 0 <= hits <= n and z >= 0, got .*: "):
        wilson_interval(*arguments)
