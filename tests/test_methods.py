"""The methods that ours is compared with: one way to call them, one type of answer, and what each can do."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import threading
import warnings
from collections.abc import Iterator
from dataclasses import FrozenInstanceError
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

import naive
import spigolo as sp
from conftest import load_frame
from spigolo.errors import ConfigError
from spigolo.kernels import features as kernel
from spigolo.kernels import potts
from spigolo.lab.evaluation import overlap_table
from spigolo.methods import (
    METHODS,
    Abramov2012,
    Felzenszwalb2004,
    FelzenszwalbConfig,
    Method,
    Rao2010,
    RaoConfig,
    SimpleConfig,
    Toscana2016,
)
from spigolo.methods.domains import connected_areas, find_borders, join_domains
from spigolo.methods.features import color_features, depth_feature, feature_graph, smooth
from spigolo.objects.verdicts import Reason
from spigolo.settings.parameters import Settings
from spigolo.stages.graph import OFFSETS
from spigolo.stages.regions import Regions, partition
from test_objects import scene

Array = naive.Array
PYTHON = Path(__file__).resolve().parents[1] / ".venv-oracle" / "bin" / "python"
BASELINES = sorted(set(METHODS) - {"toscana2016"})

compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")


@pytest.fixture(params=METHODS)
def method(request: pytest.FixtureRequest) -> Method:
    return METHODS[request.param]


@pytest.fixture(params=BASELINES)
def baseline(request: pytest.FixtureRequest) -> Method:
    return METHODS[request.param]


def without_camera(frame: sp.Frame) -> sp.Frame:
    return sp.Frame(frame.color, frame.depth, None)


# --- what all have in common ------------------------------------------------------------------------------------


def test_ours_is_one_of_them() -> None:
    assert set(METHODS) >= {"toscana2016", "felzenszwalb2004", "rao2010", "abramov2012"}
    assert all(name == method.name for name, method in METHODS.items())
    frame = scene()
    np.testing.assert_array_equal(METHODS["toscana2016"](frame).labels, sp.segment(frame).labels)


def test_every_region_is_an_object_or_rejected_with_a_reason(method: Method) -> None:
    frame = scene()
    result = method(frame)
    regions = result.regions
    assert isinstance(result, sp.Segmentation)
    assert result.labels.shape == frame.shape and result.labels.dtype == np.int32
    assert sorted(r.region for r in (*result.objects, *result.rejected)) == list(range(regions.count))
    assert sorted(set(result.labels.flat) - {0}) == [o.label for o in result.objects]
    assert all(np.array_equal(o.mask, result.labels == o.label) for o in result)
    assert all(r.why for r in result.rejected)
    first_pixels = [np.flatnonzero(regions.labels == k)[0] for k in range(regions.count)]
    assert first_pixels == sorted(first_pixels)
    scores = [o.score for o in result]
    assert scores == sorted(scores, reverse=True)
    assert all(0 <= r.contour <= 1 and r.area_px > 0 for r in (*result.objects, *result.rejected))


def two_boxes() -> tuple[sp.Frame, Array]:
    """Two boxes before a wall, 640x480, and their labels."""
    depth, color = np.full((480, 640), 1.0, np.float32), np.full((480, 640, 3), 90, np.uint8)
    truth = np.zeros(depth.shape, int)
    depth[120:260, 100:240], color[120:260, 100:240], truth[120:260, 100:240] = 0.8, (200, 30, 30), 1
    depth[180:330, 360:500], color[180:330, 360:500], truth[180:330, 360:500] = 0.85, (30, 60, 200), 2
    return sp.Frame(color, depth, sp.Camera(525, 525, 319.5, 239.5, 640, 480)), truth


@compiled
def test_a_method_finds_what_anyone_would_see(method: Method) -> None:
    frame, truth = two_boxes()
    result = method(frame)
    assert len(result) == 2
    assert overlap_table(truth, result.labels).iou().max(axis=1).min() > 0.9
    assert {r.reason for r in result.rejected if r.area_px > 10_000} == {Reason.SUPPORT}


def test_what_stands_on_nothing_is_rejected_by_the_rules_of_ours(baseline: Method) -> None:
    ours = sp.PRESETS["OBJECTS_2"]
    assert ours.additions is not None
    assert baseline.parameters["rejection"] == json.loads(ours.rejection.model_dump_json())
    rules = ours.additions.rules.replace(min_contour=None, min_contour_holes=None)
    shared = sp.settings.Additions(support=ours.additions.support, rules=rules)
    assert baseline.parameters["additions"] == json.loads(shared.model_dump_json())
    assert Reason.SUPPORT in {r.reason for r in baseline(scene()).rejected}


def test_the_answer_says_where_it_comes_from(baseline: Method) -> None:
    result = baseline(scene())
    assert (result.preset, result.digest) == (baseline.name, baseline.digest)
    assert result.left_out == ()


@compiled
def test_corrections_by_hand_work_on_every_answer(method: Method) -> None:
    result = method(two_boxes()[0])
    kept = result.keep(result.rejected[0])
    assert len(kept) == len(result) + 1
    assert len(kept.drop(kept[0])) == len(result)
    both = result.merge(result[0], result[1])
    assert both.regions.count == result.regions.count - 1
    assert len(both) == 1 and both[0].area_px == result[0].area_px + result[1].area_px


def test_without_a_camera_regions_are_the_same(baseline: Method) -> None:
    frame = scene()
    result = baseline(without_camera(frame))
    np.testing.assert_array_equal(result.regions.labels, baseline(frame).regions.labels)
    assert "support plane" in result.left_out and "contact boundary" not in result.left_out


def test_without_depth_nothing_is_an_object(method: Method) -> None:
    frame = scene()
    with pytest.warns(UserWarning, match="the frame has no measured depth"):
        result = method(sp.Frame(frame.color, np.zeros(frame.shape, np.float32), frame.camera))
    assert len(result) == 0
    assert {r.reason for r in result.rejected} == {Reason.NO_DEPTH}


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (5, 1), (3, 2)])
def test_the_smallest_frames_have_an_answer(baseline: Method, shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(0)
    frame = sp.Frame(rng.integers(0, 255, (*shape, 3), dtype=np.uint8), np.ones(shape, np.float32), None)
    assert baseline(frame).labels.shape == shape


def test_a_frame_of_one_colour_and_depth_is_one_region(baseline: Method) -> None:
    frame = sp.Frame(np.full((40, 60, 3), 90, np.uint8), np.ones((40, 60), np.float32), None)
    assert baseline(frame).regions.count == 1


def test_the_same_frame_gives_the_same_labels(method: Method) -> None:
    labels = [m(scene()).regions.labels for m in (method, method, pickle.loads(pickle.dumps(method)))]
    np.testing.assert_array_equal(labels[0], labels[1])
    np.testing.assert_array_equal(labels[0], labels[2])


def test_parameters_digest_and_copies(method: Method) -> None:
    again = method.replace(**method.parameters)
    assert (again.name, again.digest, again.parameters) == (method.name, method.digest, method.parameters)
    json.dumps(dict(method.parameters))
    changed = method.replace(**{"rejection.max_missing": 0.123})
    assert changed.digest != method.digest and changed.parameters["rejection"]["max_missing"] == 0.123
    assert method.replace(rejection={"max_missing": 0.123}).digest == changed.digest
    copy = pickle.loads(pickle.dumps(changed))
    assert (copy.digest, copy.parameters, type(copy)) == (changed.digest, changed.parameters, type(changed))
    assert changed.digest in repr(changed) or "0.123" in repr(changed)
    with pytest.raises(ConfigError, match="unknown parameter 'gamm'"):
        method.replace(gamm=1)


def test_methods_are_values_that_parameters_tell_apart(method: Method) -> None:
    changed = method.replace(**{"rejection.max_missing": 0.123})
    assert method.replace() == method != changed == pickle.loads(pickle.dumps(changed))
    with pytest.raises(FrozenInstanceError):
        method.config = changed.config  # type: ignore[attr-defined]


def test_other_parameters_of_ours_are_used_after_a_frame_was_segmented() -> None:
    ours, frame = Toscana2016(sp.TABLE), scene()
    assert ours(frame).preset == "TABLE"
    assert ours.replace(name="MINE")(frame).preset == "MINE"


def test_ours_runs_on_several_threads_at_once() -> None:
    ours, frame = METHODS["toscana2016"], scene()
    answers: list[sp.Segmentation] = []
    threads = [threading.Thread(target=lambda: answers.append(ours(frame))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 4
    assert Toscana2016(sp.TABLE).preset == "TABLE"


def stages(kind: type[Settings] = Settings) -> Iterator[type[Settings]]:
    """The models of all parameters, ours and the other methods'."""
    for stage in kind.__subclasses__():
        yield stage
        yield from stages(stage)


def test_every_parameter_says_what_it_is() -> None:
    assert {sp.Config, sp.settings.Rejection, RaoConfig, SimpleConfig} < set(stages())
    silent = [f"{s.__name__}.{name}" for s in stages() for name, f in s.model_fields.items() if not f.description]
    assert not silent


# --- felzenszwalb2004 and rao2010 -----------------------------------------------------------------------------------


def twin_weights(features: Array, k_xy: float) -> Array:
    """float32 as the kernel rounds; that both are equal within rounding is a test of the kernel's."""
    height, width = features.shape[1:]
    out = np.empty((len(OFFSETS), height, width), np.float32)
    for plane, offset in zip(out, OFFSETS, strict=True):
        kernel.feature_plane(features, np.float32(k_xy**2 * sum(d * d for d in offset)), *offset, plane)
        np.testing.assert_allclose(plane, naive.feature_plane(features, k_xy, offset), rtol=1e-6, atol=1e-6)
    return out


@pytest.mark.parametrize("parameters", [{}, {"k": 50, "k_xy": 1.0, "min_size_px2": 400}, {"k": 0, "min_size_px2": 0}])
@pytest.mark.parametrize("kind", [Felzenszwalb2004, Rao2010])
def test_regions_equal_the_textbooks(
    kind: type[Felzenszwalb2004] | type[Rao2010], parameters: dict[str, float]
) -> None:
    rng = np.random.default_rng(1)
    depth = np.where(rng.random((24, 31)) < 0.2, 0, rng.choice([0.8, 0.82, 1.1], (24, 31))).astype(np.float32)
    rough = rng.integers(0, 256, (4, 5, 3), dtype=np.uint8)
    color = cv2.resize(rough, (31, 24), interpolation=cv2.INTER_NEAREST) // 8 * 8
    method = kind().replace(**parameters)
    config = method.config
    features = color_features(color, config.sigma_px)
    if isinstance(config, RaoConfig):
        features = np.concatenate([features, depth_feature(depth, config.sigma_px, config.levels_per_m)[None]])
    regions = method.divide(sp.Frame(color, depth, None)).regions
    min_size = config.min_size_px2 * depth.size / (640 * 480)
    twin = naive.partition(twin_weights(features, config.k_xy), config.k, min_size)
    np.testing.assert_array_equal(regions.labels, twin)


def test_smoothing_reaches_four_sigma_and_repeats_the_border() -> None:
    image = np.zeros((21, 21), np.float32)
    image[10, 10] = 1
    profile = smooth(image, 0.8)[10] / smooth(image, 0.8)[10].max()
    assert np.flatnonzero(profile).tolist() == list(range(6, 15))
    np.testing.assert_allclose(profile[11:15], np.exp(-0.5 * (np.arange(1, 5) / 0.8) ** 2), rtol=1e-4)
    np.testing.assert_allclose(smooth(np.full((5, 6), 7, np.float32), 2.0), 7, rtol=1e-6)


def test_depth_is_smoothed_over_valid_pixels_and_stays_missing() -> None:
    depth = np.full((9, 9), 2.0, np.float32)
    depth[4, 4] = 0
    feature = depth_feature(depth, 0.8, 100.0)
    assert np.isnan(feature[4, 4])
    np.testing.assert_allclose(np.delete(feature.ravel(), 40), 200, rtol=1e-6)


def test_without_depth_rao_is_felzenszwalb() -> None:
    frame = scene()
    colour, both = Felzenszwalb2004(), Rao2010()
    np.testing.assert_array_equal(
        both.replace(levels_per_m=0).divide(frame).regions.labels, colour.divide(frame).regions.labels
    )
    np.testing.assert_array_equal(both.graph(frame).weights.shape, colour.graph(frame).weights.shape)


def test_depth_separates_objects_of_one_colour() -> None:
    depth = np.ones((60, 80), np.float32)
    depth[20:40, 20:50] = 0.9
    frame = sp.Frame(np.full((60, 80, 3), 120, np.uint8), depth, None)
    assert Felzenszwalb2004().divide(frame).regions.count == 1
    for method in (Rao2010(), Abramov2012()):
        labels = method.divide(frame).regions.labels
        assert np.all(labels[24:36, 24:46] == labels[30, 30])
        assert np.all(labels[:16] == labels[0, 0]) and labels[0, 0] != labels[30, 30]


@pytest.mark.parametrize("bar", [0, 5])
def test_missing_depth_makes_no_difference(bar: int) -> None:
    depth = np.ones((60, 80), np.float32)
    depth[:, 40 : 40 + bar] = 0
    frame = sp.Frame(np.full((60, 80, 3), 120, np.uint8), depth, None)
    assert Rao2010().divide(frame).regions.count == Abramov2012().divide(frame).regions.count == 1


# --- the oracle -----------------------------------------------------------------------------------------------------

ORACLE = """
import sys, numpy as np
from skimage.segmentation import felzenszwalb
given = np.load(sys.argv[1])
settings = dict(scale=float(given["k"]), min_size=int(given["min_size"]), channel_axis=-1)
np.savez(
    sys.argv[2],
    exact=felzenszwalb(given["smoothed"], sigma=0, **settings),
    plain=felzenszwalb(given["color"], sigma=0.8, **settings),
)
"""


def adjusted_rand(a: Array, b: Array) -> float:
    """Hubert & Arabie's: 1 for the same partition, about 0 for unrelated ones."""
    table = np.unique(a.ravel().astype(np.int64) * (b.max() + 1) + b.ravel(), return_counts=True)[1]
    pairs = [float((n * (n - 1.0) / 2).sum()) for n in (table, np.bincount(a.ravel()), np.bincount(b.ravel()))]
    expected = pairs[1] * pairs[2] / (a.size * (a.size - 1.0) / 2)
    return (pairs[0] - expected) / ((pairs[1] + pairs[2]) / 2 - expected)


@compiled
@pytest.mark.oracle
def test_regions_agree_with_scikit_images(tmp_path: Path) -> None:
    """Three things of theirs are matched.

    Scale: it works on colours in 0..1 and divides `scale` by 255 itself, so that k is its scale as it stands.
    Smoothing: its Gaussian is cut at 3.2 px and mirrors the border, so it is handed our smoothed image and sigma 0.
    Ties: it sorts equal weights in no fixed order and merges with < where eq. 3 has <=, so a noise far below a grey
    level leaves none. Its `min_size` is ours.
    """
    if not PYTHON.exists():
        message = "the oracle's environment is absent: make test builds it"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    folder = Path(sp.__file__).parent / "demo_scene"
    frame = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
    noise = np.random.default_rng(0).uniform(0, 0.01, (3, *frame.shape)).astype(np.float32)
    for k, min_size in ((300.0, 50), (800.0, 500)):
        config = FelzenszwalbConfig(k=k, min_size_px2=min_size)
        features = color_features(frame.color, 0.8) + noise
        ours = partition(feature_graph(features, 8), k, min_size)
        given = {"smoothed": features.transpose(1, 2, 0) / 255.0, "color": frame.color, "k": k, "min_size": min_size}
        np.savez(tmp_path / "given.npz", **given)
        subprocess.run([PYTHON, "-c", ORACLE, tmp_path / "given.npz", tmp_path / "theirs.npz"], check=True)
        theirs = dict(np.load(tmp_path / "theirs.npz"))
        assert adjusted_rand(ours.labels, theirs["exact"]) >= 0.99
        plain = Felzenszwalb2004(config).divide(frame).regions.labels
        assert adjusted_rand(plain, theirs["plain"]) >= 0.8  # their smoothing and ties, nothing matched


# --- abramov2012 ----------------------------------------------------------------------------------------------------


def test_labels_depend_on_the_seed_alone() -> None:
    color = np.random.default_rng(0).integers(0, 256, (40, 60, 3), dtype=np.uint8)
    frame = sp.Frame(color, np.ones((40, 60), np.float32), None)
    method = Abramov2012().replace(shrink=1, alpha=1.0, piece_px2=0, min_size_px2=0)
    one, again, other = (m.divide(frame).regions.labels for m in (method, method, method.replace(seed=8)))
    np.testing.assert_array_equal(one, again)
    assert not np.array_equal(one, other)


def test_interactions_attract_equal_colours_and_repel_across_a_depth_step() -> None:
    color = np.zeros((4, 6, 3), np.uint8)
    color[:, 3:] = 100
    depth = np.ones((4, 6), np.float32)
    depth[2:] = 1.2
    depth[3, 0] = 0
    right, down, _, _ = Abramov2012().interactions(color, depth)
    assert right[0].tolist() == [1, 1, -1, 1, 1, 0]
    assert down[1].tolist() == [-20] * 6
    assert down[2].tolist() == [1] * 6
    assert np.all(down[3] == 0)
    blind = Abramov2012().replace(step_m=None).interactions(color, depth)[1]
    assert blind[1].tolist() == [1] * 6


def test_sweeps_lower_the_energy() -> None:
    frame = scene()
    planes = Abramov2012().interactions(frame.color, frame.depth)
    spins = np.random.default_rng(0).integers(0, 256, frame.shape).astype(np.int32)
    energies = []
    for number in range(4):
        energies.append(
            -sum(f for p in naive.pixels(spins) for q, f in naive.neighbours(planes, *p) if spins[p] == spins[q])
        )
        potts.sweep(spins, planes, 256, 0.05, 7, number)
    assert energies == sorted(energies, reverse=True) and energies[0] > energies[-1] + 1000


def test_areas_are_connected_over_corners() -> None:
    spins = np.random.default_rng(3).integers(0, 3, (17, 23)).astype(np.int32)
    np.testing.assert_array_equal(connected_areas(spins).labels, naive.flood(spins, 8))


def naive_borders(labels: Array, planes: Array) -> dict[tuple[int, int], float]:
    """Mean interaction of every two domains that touch."""
    found: dict[tuple[int, int], list[float]] = {}
    for y, x in naive.pixels(labels):
        for at, force in naive.neighbours(planes, y, x):
            if labels[at] != labels[y, x]:
                found.setdefault((int(labels[y, x]), int(labels[at])), []).append(force)
    return {pair: float(np.mean(forces)) for pair, forces in found.items()}


def test_borders_are_those_of_every_pair_of_pixels() -> None:
    rng = np.random.default_rng(4)
    labels = naive.flood(rng.integers(0, 3, (12, 15)), 8).astype(np.int32)
    planes = rng.uniform(-2, 1, (4, 12, 15)).astype(np.float32)
    borders = find_borders(Regions(labels, int(labels.max()) + 1), planes)
    got = {(int(a), int(b)): float(m) for (a, b), m in zip(borders.domain.T, borders.mean, strict=True)}
    assert got == pytest.approx(naive_borders(labels, planes))
    assert [int((labels == a).sum()) for a in borders.domain[0]] == borders.area[0].tolist()


def test_joining_ends_where_no_border_attracts() -> None:
    rng = np.random.default_rng(5)
    labels = naive.flood(rng.integers(0, 4, (20, 25)), 8).astype(np.int32)
    planes = rng.uniform(-1.2, 1, (4, 20, 25)).astype(np.float32)
    before = Regions(labels, int(labels.max()) + 1)
    after = join_domains(before, planes, lambda b: b.mean > 0)
    assert 1 < after.count < before.count
    assert max(naive_borders(after.labels, planes).values()) <= 0
    assert np.unique(np.stack([labels, after.labels]).reshape(2, -1), axis=1).shape[1] == before.count
    np.testing.assert_array_equal(
        after.labels, naive.number_regions(after.labels.ravel().tolist()).reshape(after.labels.shape)
    )
    whole = join_domains(before, planes, lambda b: b.area[0] < 100)
    assert np.bincount(whole.labels.ravel()).min() >= 100


@compiled
@pytest.mark.parametrize("shrink", [1, 2, 3])
def test_every_scale_of_the_model_gives_labels_of_the_frame(shrink: int) -> None:
    frame, truth = two_boxes()
    regions = Abramov2012().replace(shrink=shrink).divide(frame).regions
    assert overlap_table(truth, regions.labels + 1).iou().max(axis=1).min() > 0.95


# --- on real frames -------------------------------------------------------------------------------------------------


@cache
def labelled(folder: Path) -> tuple[sp.Frame, Array]:
    """A frame and its labels, 255 = ignored."""
    return load_frame(folder), cv2.imread(str(folder / "label.png"), cv2.IMREAD_UNCHANGED)


def overlaps(method: Method, folder: Path) -> tuple[Array, Array]:
    """Pixels of each object (N,) and those that it shares with each region (N, R), ignored ones left out of both.

    Behind the objects' rows one more of what is background.
    """
    frame, label = labelled(folder)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        regions = method(frame).regions
    objects = [k for k in np.unique(label) if k not in (0, 255)]
    shared = [np.bincount(regions.labels[label == k], minlength=regions.count) for k in (*objects, 0)]
    return np.array(shared).sum(axis=1)[:-1], np.array(shared)


@cache
def raw_figures(name: str, folders: tuple[Path, ...], **changes: float | None) -> tuple[float, float, float]:
    """Means over objects: best IoU of a region, regions with 5 % of the object or more, under-segmentation error.

    Under-segmentation (Neubert & Protzel 2012): what the regions that meet an object add to it, or lack if that is
    less, as a share of it.
    """
    method = METHODS[name].replace(**changes)
    iou, pieces, under = [], [], []
    for folder in folders:
        object_px, shared = overlaps(method, folder)
        region_px = shared.sum(axis=0)
        for px, common in zip(object_px, shared[:-1], strict=True):
            iou.append((common / (px + region_px - common)).max())
            pieces.append(int((common >= 0.05 * px).sum()))
            under.append(np.minimum(common, region_px - common).sum() / px)
    return float(np.mean(iou)), float(np.mean(pieces)), float(np.mean(under))


@pytest.fixture(scope="module")
def mosd(data: Path) -> tuple[Path, ...]:
    """The 45 frames of the learn split."""
    return tuple(sorted((data / "frames" / "osd-mosd").iterdir()))


@compiled
@pytest.mark.frames
@pytest.mark.parametrize(("name", "floor"), [("felzenszwalb2004", 0.45), ("rao2010", 0.55), ("abramov2012", 0.55)])
def test_regions_hold_objects(mosd: tuple[Path, ...], name: str, floor: float) -> None:
    assert raw_figures(name, mosd)[0] >= floor


@compiled
@pytest.mark.frames
def test_abramov_has_fewer_pieces_and_no_more_leaks_than_felzenszwalb(mosd: tuple[Path, ...]) -> None:
    _, pieces, leaks = raw_figures("abramov2012", mosd)
    _, pieces_of_colour, leaks_of_colour = raw_figures("felzenszwalb2004", mosd)
    assert pieces < pieces_of_colour
    assert leaks <= leaks_of_colour


@compiled
@pytest.mark.frames
@pytest.mark.parametrize(("name", "off"), [("rao2010", {"levels_per_m": 0}), ("abramov2012", {"step_m": None})])
def test_depth_is_of_use(mosd: tuple[Path, ...], name: str, off: dict[str, float | None]) -> None:
    iou, _, leaks = raw_figures(name, mosd)
    blind_iou, _, blind_leaks = raw_figures(name, mosd, **off)
    assert iou > blind_iou + 0.02
    assert leaks < blind_leaks - 0.05


@pytest.mark.filterwarnings("ignore:no object was found:spigolo.errors.UnitWarning")
def test_abramov_takes_a_far_plane_with_holes() -> None:
    """All depth is one step; what is missing lies millions of steps before it."""
    depth = np.full((24, 32), 10.0)
    depth[8:12] = 0
    frame = sp.Frame(np.full((24, 32, 3), 90, np.uint8), depth, None)
    assert sp.METHODS["abramov2012"](frame).labels.shape == (24, 32)
