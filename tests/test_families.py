"""Rendered families: their objects, their truth, their figures beside real ones, and their layouts on disk."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import permutations, product
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial import ConvexHull

import spigolo as sp
from spigolo.doctor.local_planes import fit_local_planes
from spigolo.errors import ConfigError, FileError
from spigolo.lab.datasets import Sample, guess
from spigolo.lab.datasets.visibility import TOLERANCE_M, visible_labels
from spigolo.lab.synthetic import layouts
from spigolo.lab.synthetic.bins import VIEWS, shelf_stage
from spigolo.lab.synthetic.families import (
    FAMILIES,
    LEAST_IOU,
    drawn_iou,
    family_models,
    is_told_by_poses,
    record_family,
    render_family,
)
from spigolo.lab.synthetic.household import KINDS, Rest, household
from spigolo.lab.synthetic.placing import Plot, settled
from spigolo.lab.synthetic.realism import Realism, quartiles, realism
from spigolo.lab.synthetic.scene import SceneObject, View
from spigolo.lab.synthetic.staging import Recording, Stage
from spigolo.lab.synthetic.structured_light import StructuredLight, projector_shadow, simulate_structured_light
from spigolo.lab.synthetic.tables import INSTANCES, TABLES, multi_stage, table_stage
from test_synthetic import need_renderer

COUNTS = {"shelf": 3, "table": 3, "multi": 4}
Samples = Mapping[str, Sequence[Sample]]


@pytest.fixture(scope="module")
def recordings() -> Mapping[str, Sequence[Recording]]:
    """A frame of each scene of each family, rendered once, and its ideal depth."""
    need_renderer()
    return {family: [record_family(family, k) for k in range(count)] for family, count in COUNTS.items()}


@pytest.fixture(scope="module")
def samples(recordings: Mapping[str, Sequence[Recording]]) -> Samples:
    """The frames alone."""
    return {family: [recording.sample for recording in some] for family, some in recordings.items()}


def world_points(thing: SceneObject) -> npt.NDArray[np.float64]:
    points = np.concatenate([part.mesh.vertices_m for part in thing.parts])
    return points @ thing.rotation.T + np.array(thing.position_m)


@pytest.mark.parametrize("kind", KINDS)
def test_an_object_is_a_closed_mesh_that_stands_on_its_ground(kind: str) -> None:
    product = household(kind)
    model = product.model()
    a, b, c = np.moveaxis(model.vertices_m[model.triangles], 1, 0)
    litres = 1000 * float(np.sum(a * np.cross(b, c)) / 6)
    assert 0.1 < litres < 6
    size_m = np.ptp(model.vertices_m, axis=0)
    assert 0.02 < size_m.max() < 0.35
    assert model.vertices_m[:, 2].min() == pytest.approx(0, abs=1e-9)
    assert model.colors is not None
    assert model.colors.shape == model.vertices_m.shape
    for part in product.parts:
        np.testing.assert_allclose(np.linalg.norm(part.mesh.normals, axis=1), 1.0, atol=1e-6)


def test_a_name_is_one_object_and_a_number_another() -> None:
    first, other = household("soda_can_4"), household("soda_can_6")
    household.cache_clear()
    np.testing.assert_array_equal(household("soda_can_4").parts[0].texture, first.parts[0].texture)
    assert not np.array_equal(first.parts[0].texture, other.parts[0].texture)
    with pytest.raises(ConfigError, match="unknown object 'teapot_1': expected one of soda_can"):
        household("teapot_1")


@pytest.mark.parametrize("rest", [Rest(), Rest(90.0, 30.0), Rest(180.0), Rest(12.0, 90.0)])
def test_whatever_rests_touches_the_ground(rest: Rest) -> None:
    thing = settled(household("bowl_2"), rest, 40.0, 0.0, (0.1, -0.2))
    assert world_points(thing)[:, 2].min() == pytest.approx(0, abs=1e-9)


def test_a_plot_refuses_what_overlaps_or_sticks_out() -> None:
    square = np.array([(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)])
    plot, can = Plot(square), household("soda_can_4")
    assert plot.take(settled(can, Rest(), 0, 0, (0.0, 0.0)))
    assert not plot.take(settled(can, Rest(), 0, 0, (0.05, 0.0)))
    assert plot.take(settled(can, Rest(), 0, 0, (0.07, 0.0)))
    assert not plot.take(settled(can, Rest(), 0, 0, (0.28, 0.2)))


def test_what_is_pushed_touches_and_what_is_piled_up_lies_on_top() -> None:
    square = np.array([(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)])
    plot, can, box, rng = Plot(square), household("soda_can_4"), household("box_1"), np.random.default_rng(0)
    below = settled(box, Rest(90.0, 90.0), 20.0, 0.0, (0.0, 0.0))
    assert plot.take(below)
    apart = plot.place(can, (Rest(),), lambda: (0.2, 0.1), rng)
    pushed = plot.place(can, (Rest(),), lambda: (0.2, -0.1), rng, touching=True)
    assert apart is not None and pushed is not None
    assert apart.position_m[:2] == (0.2, 0.1)
    gaps_m = [
        np.min(np.linalg.norm(edge_points(below)[:, None] - edge_points(thing), axis=-1)) for thing in (apart, pushed)
    ]
    assert gaps_m[0] > 0.02
    assert gaps_m[1] < 0.002
    piled = plot.pile(can, Rest(), below, rng)
    assert piled is not None
    lowest, top = world_points(piled)[:, 2].min(), world_points(below)[:, 2].max()
    assert 0 < lowest - top < 0.001
    assert plot.pile(household("bowl_2"), Rest(180.0), below, rng) is None  # wider than the box


def edge_points(thing: SceneObject, count: int = 50) -> npt.NDArray[np.float64]:
    """Points (N, 2) along the outline of its footprint, so many an edge."""
    hull = cv2.convexHull(world_points(thing)[:, :2].astype(np.float32))[:, 0]
    steps = np.linspace(0, 1, count, endpoint=False)[:, None, None]
    return np.asarray(((1 - steps) * hull + steps * np.roll(hull, -1, axis=0)).reshape(-1, 2), np.float64)


@cache
def stages() -> Sequence[Stage]:
    made = []
    for seed in range(3):
        for make, scenes in ((shelf_stage, VIEWS), (table_stage, TABLES), (multi_stage, INSTANCES)):
            made += [make(scene, np.random.default_rng([seed, k])) for k, scene in enumerate(scenes)]
    return made


def test_nothing_goes_through_anything_and_some_things_are_piled_up() -> None:
    piles = 0
    for stage in stages():
        things = [world_points(thing) for thing in (*stage.objects, *stage.bystanders) if thing.name != "tool"]
        tops = [points[:, 2].max() for points in things]
        above = [points[:, 2].min() for points in things if points[:, 2].min() > 1e-6]
        assert len(above) <= 1
        assert all(min(abs(low - top) for top in tops) < 0.001 for low in above)
        piles += len(above)
        for points, others in permutations(things, 2):
            near = points[np.all((points > others.min(axis=0)) & (points < others.max(axis=0)), axis=1)]
            if near.size:
                faces = ConvexHull(others).equations
                assert not np.any(np.all(near @ faces[:, :3].T + faces[:, 3] < -1e-9, axis=1))
    assert piles >= 3


def test_clutter_stands_clear_of_instances_and_products_in_order_of_distance() -> None:
    near = 0
    for stage in stages():
        if any(thing.name == "tool" for thing in stage.bystanders):
            ways = [world_points(thing) - stage.view.position_m for thing in stage.objects]
            distances_m = [np.linalg.norm(way, axis=1).min() for way in ways]
            assert distances_m == sorted(distances_m)
            continue
        on_table = [thing for thing in stage.objects if world_points(thing)[:, 2].min() < 1e-6]
        for bystander, thing in product(stage.bystanders, on_table):
            outline = cv2.convexHull(world_points(thing)[:, :2].astype(np.float32))
            gap_m = min(-cv2.pointPolygonTest(outline, (x, y), True) for x, y in edge_points(bystander, 5))
            assert gap_m > TOLERANCE_M
            near += gap_m < 0.03
    assert near > 0


def test_products_stay_within_their_bin() -> None:
    for seed in range(4):
        stage = shelf_stage("view_1", np.random.default_rng(seed))
        points = np.concatenate([world_points(thing) for thing in stage.objects])
        assert np.abs(points[:, 0]).max() < 0.15
        assert points[:, 1].min() > 0
        assert points[:, 1].max() < 0.45
        assert points[:, 2].max() < 0.26


def test_each_scene_shows_what_it_is_said_to_show(samples: Samples) -> None:
    assert [s.frame.name for s in samples["table"]] == ["table_1_1", "desk_1_1", "kitchen_small_1_1"]
    for sample, scene in zip(samples["table"], TABLES, strict=True):
        assert {instance.model for instance in sample.instances} <= set(TABLES[scene])
        assert len(sample.instances) >= len(TABLES[scene]) - 2
    for sample, name in zip(samples["multi"], INSTANCES, strict=True):
        assert {instance.model for instance in sample.instances} == {name}
        assert 2 <= len(sample.instances) <= 3
    assert all(1 <= len(sample.instances) <= 3 for sample in samples["shelf"])
    for family, some in samples.items():
        names = {model.name for model in family_models(family)}
        assert all(instance.model in names for sample in some for instance in sample.instances)


@pytest.mark.parametrize(("ideal", "tolerance_m"), [(True, 0.002), (False, TOLERANCE_M)])
def test_masks_drawn_at_the_poses_are_the_exact_ones(
    recordings: Mapping[str, Sequence[Recording]], ideal: bool, tolerance_m: float
) -> None:
    """In ideal depth, which tests poses and models, and in measured depth by the rule of readers."""
    for family, some in recordings.items():
        for recording in some:
            sample = recording.sample
            assert list(np.unique(sample.labels)) == list(range(len(sample.instances) + 1))
            depth = recording.ideal_m if ideal else sample.frame.depth
            ious = drawn_iou(family, sample, depth, tolerance_m)
            assert len(ious) == len(sample.instances)
            assert ious.min() >= LEAST_IOU, sample.frame.name


def test_what_poses_do_not_tell_is_not_kept(samples: Samples) -> None:
    sample = samples["multi"][0]
    assert is_told_by_poses("multi", sample)
    assert not is_told_by_poses("multi", replace(sample, labels=np.zeros_like(sample.labels), instances=()))
    half_hidden = sample.labels.copy()
    half_hidden[:, : int(np.median(np.nonzero(sample.labels == 1)[1]))] = 0
    assert not is_told_by_poses("multi", replace(sample, labels=half_hidden))


def test_where_the_first_alone_is_labelled_others_hide_it_unless_measured(samples: Samples) -> None:
    """A set that labels one object knows no pose of what stands before it."""
    sample = samples["shelf"][0]
    first = sample.instances[0]
    nearer = first.pose.copy()
    nearer[:3, 3] = 0.9 * nearer[:3, 3] + [0.04, 0.0, 0.0]
    both = (first, replace(first, label=2, pose=nearer))
    unseen = np.zeros_like(sample.frame.depth)
    assert sample.frame.camera is not None
    labels = visible_labels(both, [household(first.model).model()] * 2, unseen, sample.frame.camera)
    hidden = replace(sample, labels=labels, instances=both)
    assert drawn_iou("multi", hidden, unseen) == pytest.approx(1)
    assert drawn_iou("shelf", hidden, unseen)[0] < 0.8


def test_poses_are_rotations_and_depth_is_that_of_the_objects(samples: Samples) -> None:
    for sample in (sample for some in samples.values() for sample in some):
        for instance in sample.instances:
            rotation = instance.pose[:3, :3]
            np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
            assert np.linalg.det(rotation) == pytest.approx(1)
            seen_m = sample.frame.depth[(sample.labels == instance.label) & (sample.frame.depth > 0)]
            if seen_m.size > 200:
                assert abs(np.median(seen_m) - instance.pose[2, 3]) < 0.2


def test_equal_numbers_and_seeds_give_equal_frames(samples: Samples) -> None:
    again = render_family("shelf", 0)
    np.testing.assert_array_equal(again.frame.color, samples["shelf"][0].frame.color)
    np.testing.assert_array_equal(again.frame.depth, samples["shelf"][0].frame.depth)
    np.testing.assert_array_equal(again.labels, samples["shelf"][0].labels)
    assert not np.array_equal(again.frame.color, samples["shelf"][1].frame.color)


@pytest.mark.parametrize(
    ("family", "missing", "edges", "brightness"),
    [
        ("shelf", (0.5, 0.85), (0.02, 0.11), (15, 95)),
        ("table", (0.05, 0.25), (0.02, 0.15), (70, 150)),
        ("multi", (0.05, 0.25), (0.02, 0.15), (80, 160)),
    ],
)
def test_figures_are_like_those_of_real_frames(
    samples: Samples,
    family: str,
    missing: tuple[float, float],
    edges: tuple[float, float],
    brightness: tuple[float, float],
) -> None:
    middle = {name: values[1] for name, values in quartiles([realism(s.frame) for s in samples[family]]).items()}
    assert missing[0] < middle["missing"] < missing[1]
    assert edges[0] < middle["edges"] < edges[1]
    assert brightness[0] < middle["brightness"] < brightness[1]
    assert middle["noise_06"] < middle["noise_08"] < 2.5 * middle["noise_06"] < 2.5


def test_noise_is_that_of_the_level_and_grows_with_the_slant() -> None:
    """Residuals to planes in pixels of disparity, as real frames have them: see docs/synthetic.md."""
    fx_px, across, grey = 525.0, np.arange(320)[None] - 159.5, np.full((240, 320, 3), 128, np.uint8)
    found = []
    for level, slant_px in ((0.5, 0.0), (1.0, 0.03), (1.0, 0.16), (2.0, 0.03)):
        disparity_px = fx_px * 0.075 / 0.9 + slant_px * across + np.zeros((240, 1))
        sensor = StructuredLight().at_noise_level(level)
        depth_m = simulate_structured_light(fx_px * 0.075 / disparity_px, grey, fx_px, np.random.default_rng(0), sensor)
        planes = fit_local_planes(depth_m)
        found.append(float(np.median(planes.residual[planes.whole])) * fx_px * 0.075)
    fine, usual, slanted, coarse = found
    assert fine < 0.03
    assert usual == pytest.approx(0.046, abs=0.006)
    assert 1.4 * usual < slanted < 1.8 * usual
    assert 1.3 * usual < coarse < 2 * usual


def test_realism_measures_noise_edges_and_gaps() -> None:
    noise_m = 0.002 * np.random.default_rng(0).standard_normal((120, 160))
    depth = (1.0 + noise_m).astype(np.float32)
    depth[:, :40] = 0
    figures = realism(sp.Frame(np.full((120, 160, 3), 90, np.uint8), depth, None))
    assert figures.missing == 0.25
    assert figures.edges == 0
    assert figures.brightness == 90
    assert figures.noise_08 == pytest.approx(2.0, rel=0.1)
    assert np.isnan(figures.noise_04)
    low, middle, high = quartiles([figures, Realism(0.5, 0, 0, 0, 0, 0, 0)])["missing"]
    assert low < middle < high


def test_a_wall_seen_at_a_flat_angle_casts_no_shadow_on_itself() -> None:
    across = (np.arange(640) - 319.5) / 525.0
    for angle_deg, distance_m in ((75.0, 0.5), (80.0, 0.5), (84.0, 0.8)):
        inverse = (1 + np.tan(np.radians(angle_deg)) * across) / distance_m
        seen = (inverse > 1 / 4) & (inverse < 1 / 0.4)
        disparity_px = np.where(seen, 525.0 * 0.075 * inverse, 0.0)[None].repeat(3, 0)
        assert seen.sum() > 90
        assert not projector_shadow(disparity_px).any()


def test_mirrors_margins_and_strays_of_the_depth_camera() -> None:
    depth_m = np.full((120, 160), 1.5)
    depth_m[30:90, 60:100] = 1.0
    grey = np.full((120, 160, 3), 128, np.uint8)
    gloss = np.zeros((120, 160))
    gloss[:, 120:] = 0.99

    def measured(sensor: StructuredLight, gloss: npt.NDArray[np.float64] | None = None) -> npt.NDArray[np.float32]:
        return simulate_structured_light(depth_m, grey, 525.0, np.random.default_rng(0), sensor, gloss)

    assert np.mean(measured(StructuredLight(), gloss)[:, 125:] == 0) > 0.9
    cut = measured(StructuredLight(margin_px=(0, 20, 10, 0)))
    assert np.all(cut[115:] == 0) and np.all(cut[:, 145:] == 0)
    assert np.all(cut[:20, :40] > 0)
    still, strayed = (measured(StructuredLight(rim_loss=0.0, edge_jitter_px=px)) for px in (0.0, 1.5))
    moved = (np.abs(still - strayed) > 0.3) & (still > 0) & (strayed > 0)
    assert moved.sum() > 30
    near_outline = cv2.dilate(
        cv2.morphologyEx((depth_m < 1.2).astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3))), np.ones((13, 13))
    )
    assert not moved[near_outline == 0].any()


def test_a_view_projects_as_its_camera_does() -> None:
    view = View((0.1, 0.2, 0.3), 0.9, 35.0, 20.0, 4.0, sp.Camera(570, 560, 325, 242, 640, 480))
    x, y, z = view.world_to_camera[:3] @ np.array([0.1, 0.2, 0.3, 1.0])
    np.testing.assert_allclose((x, y, z), (0, 0, 0.9), atol=1e-12)
    ahead = view.world_to_camera[:3, :3] @ np.array([0, 0, -1.0])
    assert ahead[1] > 0.7  # down is down


@pytest.mark.parametrize("layout", layouts.LAYOUTS)
@pytest.mark.parametrize("family", FAMILIES)
def test_what_is_written_is_read_back(
    samples: Samples, family: str, layout: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layouts, "render_family", lambda name, number, seed: samples[name][number])
    told: list[int] = []
    count = COUNTS[family]
    assert layouts.write_family(family, count, 0, tmp_path, layout, told.append) == count
    assert told == list(range(1, count + 1))
    by_color = {s.frame.color.tobytes(): s for s in samples[family]}
    entries = list(guess(tmp_path))
    assert len(entries) == count
    for entry in entries:
        frame, truth = entry.read_both()
        sample = by_color[frame.color.tobytes()]
        np.testing.assert_allclose(frame.depth, sample.frame.depth, atol=1e-6)
        assert frame.camera == sample.frame.camera
        assert truth is not None
        several = layout != "original" or family != "shelf"
        assert len(np.unique(truth.labels)) - 1 == (len(sample.instances) if several else 1)
        wanted = sample.labels if several else np.where(sample.labels == 1, 1, 0)
        for label in np.unique(wanted[wanted > 0]):
            mask = wanted == label
            here = truth.labels == np.bincount(truth.labels[mask]).argmax()
            assert np.sum(mask & here) / np.sum(mask | here) >= LEAST_IOU, (frame.name, label)


def test_the_command_renders_and_refuses(tmp_path: Path) -> None:
    need_renderer()

    def render(*words: object) -> subprocess.CompletedProcess[str]:
        code = "from spigolo.cli import main; main()"
        command = [sys.executable, "-c", code, "render", *map(str, words)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)

    done = render("shelf", "--count", 1, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert [entry.name for entry in guess(tmp_path / "out")] == ["view_1_1"]
    for words, said in (
        (["attic"], "expected one of shelf, table, multi"),
        (["table", "--layout", "coco"], "expected one of folders, bop, original"),
        (["table", "--count", 0], "expected at least one frame"),
    ):
        refused = render(*words, "--out", tmp_path / "none")
        assert refused.returncode == 2
        assert said in refused.stderr
    assert not (tmp_path / "none").exists()


def test_two_renderings_do_not_share_a_folder(tmp_path: Path) -> None:
    need_renderer()
    layouts.write_family("table", 1, 0, tmp_path)
    for family, seed, layout in (("table", 1, "folders"), ("multi", 0, "bop")):
        with pytest.raises(FileError, match=r"got .* with rendered stand-ins, family table, seed 0"):
            layouts.write_family(family, 1, seed, tmp_path, layout)
    with pytest.raises(ConfigError, match="expected a seed of 0 or more, got -1"):
        layouts.write_family("table", 1, -1, tmp_path / "other")
