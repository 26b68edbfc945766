"""Images of other sizes than 640x480: lengths in pixels grow with the image where a configuration says so."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.contours import add_contours, depth_contours, find_holes, hole_contours, measure_noise, widen
from spigolo.additions.heights import lower_heights
from spigolo.additions.support import find_support
from spigolo.frames.files import read_labels
from spigolo.settings import Inpainting, Settings
from spigolo.settings.parameters import Grows, GrowsAsArea
from spigolo.stages.color import color_points
from spigolo.stages.cues import choose_weighing, gather_cues
from spigolo.stages.depth import prepare_depth
from spigolo.stages.edges import boundary_cue, find_edges
from spigolo.stages.graph import weigh
from spigolo.stages.regions import partition
from spigolo.view.figure1 import stages

DEMO = Path(sp.__file__).parent / "demo_scene"


def test_lengths_of_objects_grow_and_those_of_the_papers_presets_do_not() -> None:
    large, small = sp.OBJECTS.at_size((960, 1280)), sp.OBJECTS.at_size((240, 320))
    ours, ours_small = large.additions, small.additions
    assert ours is not None and ours_small is not None
    assert (large.edges.step_offset_px, large.edges.blur_px, ours.line_px) == (10, 17, 2)
    assert (small.edges.step_offset_px, small.edges.blur_px, ours_small.line_px) == (2, 5, 1)
    assert large.depth.smoothing.radius_per_error_px_m == 2 * sp.OBJECTS.depth.smoothing.radius_per_error_px_m
    assert ours.joining is not None
    assert (ours.joining.reach_px, ours.joining.margin_px, ours.joining.min_border_px) == (8, 6, 24)
    assert ours.contours is not None
    assert ours.contours.crease_offset_px == 8
    assert large.edges.step_m == sp.OBJECTS.edges.step_m
    assert sp.OBJECTS.at_size((480, 640)) == sp.OBJECTS
    for config in (sp.TABLE, sp.SHELF, sp.CLUTTER, sp.PRESETS["OBJECTS_1"]):
        before, after = dict(values(config)), dict(values(config.at_size((960, 1280))))
        changed = {name for name in before if before[name] != after[name]}
        assert {name for name in changed if not name.endswith("_px2")} <= GROW_ALWAYS


GROW_ALWAYS = {"Inpainting.max_radius_px", "Wall.reach_px", "Wall.shadow_px"}
"""Lengths that grow with the image whatever the configuration says."""


@pytest.mark.parametrize("name", sorted(sp.PRESETS))
def test_areas_of_every_preset_grow_with_the_pixels_of_the_image(name: str) -> None:
    before, after = dict(values(sp.PRESETS[name])), dict(values(sp.PRESETS[name].at_size((960, 1280))))
    areas = {field for field in before if field.endswith("_px2") and before[field] is not None}
    assert "Partition.min_size_px2" in areas
    assert all(after[field] == 4 * before[field] for field in areas)
    always = GROW_ALWAYS & before.keys()
    assert all(after[field] == 2 * before[field] for field in always)


def test_a_method_grows_its_areas_and_keeps_its_lengths() -> None:
    config = sp.METHODS["abramov2012"].config
    large = config.at_size((960, 1280))
    assert (large.piece_px2, large.min_size_px2) == (4 * config.piece_px2, 4 * config.min_size_px2)
    assert large.sigma_px == config.sigma_px


@pytest.mark.parametrize("height", [60, 123, 240, 479, 600, 1080, 2000])
def test_grown_lengths_stay_valid(height: int) -> None:
    grown = sp.OBJECTS.at_size((height, height * 4 // 3))
    assert sp.Config(**grown.model_dump()) == grown
    assert grown.edges.blur_px % 2 == 1


@pytest.mark.parametrize("factor", [0.3, 0.5, 1.0, 1.7, 4.0])
def test_grown_lengths_keep_their_type_and_nothing_stays_nothing(factor: float) -> None:
    nothing = {
        "depth.smoothing.max_radius_px": 0, "additions.joining.margin_px": 0, "additions.contours.max_shadow_px": 0
    }  # fmt: skip
    shape = round(480 * factor), round(640 * factor)
    for config in (sp.OBJECTS, sp.SHELF, sp.OBJECTS.replace(**nothing)):
        for (name, before), (_, after) in zip(values(config), values(config.at_size(shape, lengths=True)), strict=True):
            assert type(before) is type(after), name
            assert (before == 0) == (after == 0), name
    frame = resized(sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json"), 0.5)
    assert len(sp.segment(frame, sp.OBJECTS.replace(**nothing))) > 0


def values(stage: Settings) -> Iterator[tuple[str, Any]]:
    for name in type(stage).model_fields:
        value = getattr(stage, name)
        if isinstance(value, Settings):
            yield from values(value)
        else:
            yield f"{type(stage).__name__}.{name}", value


def test_the_answer_carries_the_digest_of_the_configuration_that_was_given() -> None:
    frame = sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json")
    assert sp.segment(resized(frame, 0.5), sp.OBJECTS).digest == sp.OBJECTS.digest
    assert sp.trace(resized(frame, 0.5), sp.OBJECTS).config is sp.OBJECTS


def resized(frame: sp.Frame, factor: float) -> sp.Frame:
    assert frame.camera is not None
    height, width = (round(n * factor) for n in frame.shape)
    color = cv2.resize(frame.color, (width, height), interpolation=cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR)
    depth = cv2.resize(frame.depth, (width, height), interpolation=cv2.INTER_NEAREST)
    return sp.Frame(np.asarray(color), np.asarray(depth), frame.camera.scaled(width, height))


@pytest.mark.parametrize("factor", [0.5, 1.5, 2.0, 2.5])
def test_a_frame_of_another_size_has_the_same_objects(factor: float) -> None:
    frame = sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json")
    wanted = [o.mask for o in sp.segment(frame)]
    other = resized(frame, factor)
    found = [
        cv2.resize(o.mask.view(np.uint8), frame.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
        for o in sp.segment(other)
    ]
    assert len(wanted) == len(found) == 9
    for mask in wanted:
        assert max(np.sum(mask & f) / np.sum(mask | f) for f in found) > 0.8


def test_every_stage_reads_the_lengths_of_this_size() -> None:
    frame = resized(sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json"), 2.0)
    run, sized = sp.trace(frame, sp.OBJECTS), sp.OBJECTS.at_size(frame.shape)
    ours = sized.additions
    assert ours is not None
    depth = prepare_depth(frame.depth, sized.depth)
    weighing = choose_weighing(depth, sized)
    edges = find_edges(frame.color, depth, frame.camera, sized.edges)
    plane = find_support(frame.depth, frame.camera, ours.support, sized.rejection.max_distance_m)
    lowered = lower_heights(sized, plane, frame.depth, frame.camera).additions
    assert lowered is not None
    contours = add_contours(edges, depth, frame.camera, plane, lowered)
    cues = gather_cues(frame.color, depth, contours.lines, weighing, sized)
    assert run.edges is not None and run.contours is not None
    assert np.array_equal(run.edges.final, edges.final)
    assert np.array_equal(run.contours.contours, contours.contours)
    assert np.array_equal(run.cues.depth, cues.depth)
    assert np.array_equal(run.cues.boundary, cues.boundary)
    points = color_points(frame.color, sized.color)
    graph = weigh(cues, points, weighing.cost, sized, ours.noise_per_m)
    assert np.array_equal(run.graph.weights, graph.weights)
    assert partition(graph, weighing.gamma, sized.partition.min_size_px2).count >= run.regions.count
    assert np.array_equal(stages(run)["color_points"], points)


def test_wide_lines_hold_where_thin_ones_are_blurred_away() -> None:
    color, depth = np.full((120, 160, 3), 90, np.uint8), np.ones((120, 160), np.float32)
    depth[:, 80:] = 1.2
    camera = sp.Camera(150, 150, 80, 60, 160, 120)
    edges = find_edges(color, depth, camera, sp.OBJECTS.edges)
    assert sp.OBJECTS.additions is not None
    thin, wide = (
        boundary_cue(
            add_contours(edges, depth, camera, None, sp.OBJECTS.additions.replace(line_px=n)).lines, sp.OBJECTS.edges
        )
        for n in (1, 3)
    )
    assert np.count_nonzero(wide[60] > 0.9) > np.count_nonzero(thin[60] > 0.9) > 0


def test_lines_are_widened_by_hand() -> None:
    final = np.zeros((5, 9), bool)
    final[:, 4] = True
    assert widen(final, 1) is final
    assert widen(final, 3)[2].tolist() == [False] * 3 + [True] * 3 + [False] * 3
    assert np.count_nonzero(widen(final, 2)[2]) == 2


def test_holes_count_from_a_minimum_share_of_missing_depth() -> None:
    depth = np.ones((6, 10), np.float32)
    depth[2:4, 3:7] = 0  # 8 of 60
    assert find_holes(depth, sp.settings.DepthContours()) is None
    assert find_holes(depth, sp.settings.DepthContours(holes_from=0.2)) is None
    holes = find_holes(depth, sp.settings.DepthContours(holes_from=0.1))
    assert holes is not None
    assert np.array_equal(holes, depth == 0)


@pytest.mark.parametrize("per_m", [0.0, 0.001, 0.004])
def test_noise_is_the_scatter_about_the_chord_of_slanted_planes(per_m: float) -> None:
    """Of normal noise the median is 0.67 of its deviation, that of a pixel from the mean of two sqrt(1.5) of one's."""
    rng = np.random.default_rng(3)
    depth = 1 / np.linspace(0.5, 1.5, 320)[None].repeat(240, 0)
    depth += per_m * depth**2 * rng.normal(size=depth.shape)
    noise = measure_noise(depth.astype(np.float32), 4)
    assert noise == pytest.approx(0.6745 * np.sqrt(1.5) * per_m, rel=0.05, abs=1e-6)
    assert measure_noise(np.zeros((240, 320), np.float32), 4) == 0.0


def test_a_crease_is_deeper_than_the_noise() -> None:
    """A groove of 3 cm across a plane, with noise of 4 mm."""
    rng, camera = np.random.default_rng(4), sp.Camera(300, 300, 160, 120, 320, 240)
    groove = 0.03 * np.maximum(1 - np.abs(np.arange(320) - 160) / 8, 0)
    depth = (1.0 + groove + 0.004 * rng.normal(size=(240, 320))).astype(np.float32)
    numbers = sp.settings.DepthContours(step_m=1.0, crease_offset_px=8)
    every, deep = (depth_contours(depth, camera, numbers.replace(crease_noise=n)) for n in (None, 4.0))
    assert every[20:-20, 160].mean() >= deep[20:-20, 160].mean() > 0.95
    assert every[20:-20, 30:120].mean() > 0.04
    assert deep[20:-20, 30:120].mean() < 0.01


def test_contours_of_a_hole_are_both_sides_of_its_border_and_wide_color_edges_in_it() -> None:
    holes, canny = np.zeros((13, 13), bool), np.zeros((13, 13), bool)
    holes[2:11, 2:11] = True
    canny[6, 6] = canny[0, 0] = True
    contours = hole_contours(holes, canny, line_px=1)
    wanted = np.zeros((13, 13), bool)
    wanted[1:12, 1:12] = True
    wanted[3:10, 3:10] = False
    wanted[5:8, 5:8] = True
    assert np.array_equal(contours, wanted)


def test_more_contour_is_required_if_outlines_of_holes_are_contours() -> None:
    """Nothing has a mean boundary of 1: asked for that, all regions of a frame with holes are weak."""
    frame = sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json")
    depth = frame.depth.copy()
    depth[::60], depth[:100] = 0, 0
    depth[:, :250] = 0
    some = sp.Frame(frame.color, depth, frame.camera)
    for taken, objects in ((frame, True), (some, False)):
        plain, strict = (
            sp.segment(taken, sp.OBJECTS.replace(additions={"rules": {"min_contour_holes": least, "ledge": None}}))
            for least in (None, 1.0)
        )
        assert len(plain) > 0
        assert len(strict) == (len(plain) if objects else 0)
        assert (
            any(r.reason is sp.Reason.WEAK_CONTOUR and "minimum 1.00" in r.why for r in strict.rejected) is not objects
        )


@pytest.mark.frames
@pytest.mark.parametrize(("factor", "most_not_grown"), [(2.0, 27), (0.5, 20)])
def test_objects_of_real_frames_of_another_size_are_found_as_before(
    data: Path, factor: float, most_not_grown: int
) -> None:
    """Of 27; a third is lost in small images where lengths do not shrink. Large ones take either."""
    found = dict.fromkeys(("as it is", "grown", "not grown"), 0)
    for folder in sorted((data / "frames" / "hand-uoc").iterdir()):
        frame = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
        truth, other = read_labels(folder / "label.png"), resized(frame, factor)
        other_truth = cv2.resize(truth.astype(np.uint8), other.shape[::-1], interpolation=cv2.INTER_NEAREST)
        found["as it is"] += count_found(frame, truth, sp.OBJECTS)
        found["grown"] += count_found(other, other_truth, sp.OBJECTS)
        found["not grown"] += count_found(other, other_truth, sp.OBJECTS.replace(additions={"lengths_grow": False}))
    assert found["as it is"] >= 24
    assert found["grown"] >= found["as it is"] - 3
    assert found["not grown"] <= most_not_grown


def count_found(frame: sp.Frame, truth: np.ndarray, config: sp.Config) -> int:
    """Labelled objects with a segment of IoU above 0.7."""
    masks, seen = [o.mask for o in sp.segment(frame, config)], truth != 255
    return sum(
        max((np.sum(m & (truth == k)) / np.sum((m & seen) | (truth == k)) for m in masks), default=0.0) > 0.7
        for k in np.unique(truth[seen])
        if k > 0
    )


@pytest.mark.parametrize("holes_from", [0.1, 0.9, None])
def test_holes_are_contours_of_a_frame_that_has_enough_of_them(holes_from: float | None) -> None:
    """A wall without any edge of colour or depth, a quarter of which has no depth, but a print there."""
    color, depth = np.full((240, 320, 3), 90, np.uint8), np.ones((240, 320), np.float32)
    depth[60:180, 80:240] = 0
    color[100:140, 140:180] = 200
    config, camera = (
        sp.OBJECTS.replace(additions={"contours": {"holes_from": holes_from}}),
        sp.Camera(300, 300, 160, 120, 320, 240),
    )
    assert config.additions is not None
    edges = find_edges(color, depth, camera, config.edges)
    found = add_contours(edges, depth, camera, None, config.additions)
    assert found.lines[100:140, 130:150].any() == (holes_from == 0.1)
    assert found.lines[120, 79:81].all() == (holes_from == 0.1)
    assert not found.lines[:50].any()
    assert found.in_holes == (holes_from == 0.1)


def test_every_length_in_pixels_grows() -> None:
    """Three of them whatever the configuration says."""
    config = sp.OBJECTS.replace(depth={"inpainting": Inpainting()})
    lengths = {name: marks for c in (config, sp.SHELF) for name, marks in list_marks(c, ("_px", "_px_m"))}
    assert len(lengths) > 12
    grows = {name: [mark for mark in marks if isinstance(mark, Grows)] for name, marks in lengths.items()}
    assert all(len(marks) == 1 for marks in grows.values())
    assert {name for name, (mark,) in grows.items() if mark.always} == GROW_ALWAYS


@pytest.mark.parametrize("name", ["ours", *sorted(sp.METHODS)])
def test_every_area_in_pixels_grows(name: str) -> None:
    config = sp.OBJECTS if name == "ours" else sp.METHODS[name].config
    areas = dict(list_marks(config, ("_px2",)))
    assert len(areas) >= 2
    assert all(any(isinstance(mark, GrowsAsArea) for mark in marks) for marks in areas.values())


def list_marks(stage: Settings, endings: tuple[str, ...]) -> Iterator[tuple[str, list[object]]]:
    for name, field in type(stage).model_fields.items():
        if isinstance(value := getattr(stage, name), Settings):
            yield from list_marks(value, endings)
        elif name.endswith(endings):
            yield f"{type(stage).__name__}.{name}", field.metadata
