"""Regions of interest, scores, corrections by hand, frames without intrinsics or depth."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.doctor import diagnose
from spigolo.frames.roi import pixel_of
from spigolo.methods import METHODS, segment_around
from spigolo.settings.parameters import VGA_PX
from spigolo.stages.regions import Regions
from test_objects import CAMERA, scene

CONFIG = sp.TABLE.replace(rejection={"max_lambda1_px2": 20000.0, "max_lambda2_px2": 15000.0})
SCENE = Path(sp.__file__).parent / "demo_scene"
LEFT, RIGHT = (50, 40), (60, 115)
"""A pixel on each of the two boxes."""


def result() -> sp.Segmentation:
    return sp.segment(scene(), CONFIG)


def consistent(answer: sp.Segmentation) -> None:
    assert [o.label for o in answer] == list(range(1, len(answer) + 1))
    assert np.array_equal(np.unique(answer.labels[answer.labels > 0]), np.arange(1, len(answer) + 1))
    for o in answer:
        assert np.array_equal(o.mask, answer.labels == o.label)
    for r in answer.rejected:
        assert not answer.labels[r.mask].any()
    assert [o.score for o in answer] == sorted((o.score for o in answer), reverse=True)
    assert sum(o.area_px for o in answer) + sum(r.area_px for r in answer.rejected) == answer.labels.size


@pytest.mark.parametrize("form", ["box", "mask", "metric", "robot"])
def test_regions_outside_are_rejected_with_that_reason(form: str) -> None:
    mask = np.zeros((120, 160), bool)
    mask[:, :75] = True
    turned = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.5], [0, 0, 0, 1]], float)  # x forward, y left, z up
    roi = {
        "box": (0, 0, 120, 75),
        "mask": mask,
        "metric": sp.MetricBox((-1, -1, 0.5), (0, 1, 2)),
        "robot": sp.MetricBox((0.5, 0, -1), (2, 1, 2), turned),
    }[form]
    answer = sp.segment(scene(), CONFIG, roi)
    consistent(answer)
    assert len(answer) == 1
    assert answer.labels[LEFT] == 1
    right = answer.at(RIGHT)
    assert isinstance(right, sp.RejectedRegion)
    assert right.reason is sp.Reason.OUTSIDE
    assert right.inside == 0


@pytest.mark.parametrize(
    ("roi", "words"),
    [
        ((0, 0, 121, 10), "inside 120 rows and 160 columns"),
        ((5, 0, 5, 10), "inside 120 rows"),
        ((0.0, 0.0, 20.0, 10.0), "whole numbers"),
        ((0, 0, 20), "pixel box"),
        (np.ones((3, 3), bool), "image's shape"),
    ],
)
def test_a_region_of_interest_that_does_not_fit_is_refused(roi, words: str) -> None:
    with pytest.raises(sp.errors.FrameError, match=words):
        sp.segment(scene(), CONFIG, roi)


def test_a_metric_box_must_have_an_inside() -> None:
    with pytest.raises(sp.errors.FrameError, match="low < high"):
        sp.MetricBox((0, 0, 1), (1, 1, 1))


@pytest.mark.parametrize(
    ("turned", "words"),
    [
        (np.eye(3), r"\(4, 4\)"),
        (np.full((4, 4), np.nan), "NaN"),
        (np.diag([1000.0, 1000, 1000, 1]), "scales"),
        (np.array([[1, 0, 0, 450.0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), "in metres"),
    ],
)
def test_a_metric_box_is_turned_by_a_rigid_transform_alone(turned, words: str) -> None:
    with pytest.raises(sp.errors.CameraError, match=words):
        sp.MetricBox((0, 0, 0), (1, 1, 1), turned)


@pytest.mark.parametrize("form", [list, np.array])
def test_a_pixel_box_comes_in_any_sequence(form) -> None:
    box = (0, 0, 120, 75)
    assert np.array_equal(sp.segment(scene(), CONFIG, form(box)).labels, sp.segment(scene(), CONFIG, box).labels)


def test_a_click_gives_the_object_there_whatever_its_rule() -> None:
    assert sp.segment_at(scene(), LEFT, CONFIG).centroid_m[2] == pytest.approx(0.7, abs=0.005)
    wall = sp.segment_at(scene(), (5, 80), CONFIG)  # rejected as too long
    assert wall.area_px > 10000
    assert [result().object_at(point).region for point in (LEFT, (5, 80))] == [result().at(LEFT).region, wall.region]
    with pytest.raises(IndexError, match="inside 120 rows"):
        sp.segment_at(scene(), (120, 0), CONFIG)


CLICKS: dict[str, Callable[[object], object]] = {
    "at": lambda point: result().at(point),
    "object_at": lambda point: result().object_at(point),
    "segment_at": lambda point: sp.segment_at(scene(), point, CONFIG),
    "segment_around": lambda point: segment_around(scene(), point),
}


@pytest.mark.parametrize("click", CLICKS)
def test_a_click_may_come_in_any_numbers(click: str) -> None:
    forms = (LEFT, [50.0, 40.0], np.array(LEFT, np.uint8), np.array([50.0, 40]), (49.6, 40.4))
    masks = [CLICKS[click](form).mask for form in forms]
    assert all(np.array_equal(mask, masks[0]) for mask in masks)


def test_a_point_lies_in_the_nearest_pixel() -> None:
    points = [(-0.5, 0.49), (0.5, 1.49), (119.49, 159.4)]
    assert [pixel_of(point, (120, 160)) for point in points] == [(0, 0), (1, 1), (119, 159)]


@pytest.mark.parametrize("click", CLICKS)
@pytest.mark.parametrize(
    "point",
    [
        (True, False),
        None,
        (1, 2, 3),
        (1,),
        "ab",
        (119.5, 2),
        (1, np.nan),
        (np.inf, 0),
        ([1], [2]),
        7,
        (0, -1),
        (-0.6, 0),
    ],
)
def test_what_is_no_pixel_is_refused_in_one_sentence(click: str, point: object) -> None:
    with pytest.raises(IndexError) as caught:
        CLICKS[click](point)
    assert str(caught.value) == f"expected a pixel (y, x) inside 120 rows and 160 columns, got {point!r}"


def test_a_click_on_what_is_no_frame_is_refused() -> None:
    for click in (sp.segment_at, segment_around):
        with pytest.raises(sp.errors.FrameError, match="expected a Frame"):
            click(scene().color, LEFT)


def test_keep_and_drop_give_new_answers() -> None:
    first = result()
    left = first.at(LEFT)
    second = first.drop(left)
    consistent(second)
    assert (len(first), len(second)) == (2, 1)
    dropped = second.at(LEFT)
    assert dropped.reason is sp.Reason.BY_HAND
    third = second.keep(dropped)
    consistent(third)
    assert np.array_equal(third.labels, first.labels)
    assert first.labels[LEFT] > 0


def test_a_region_of_another_answer_is_refused() -> None:
    answer = result()
    left, right = answer.at(LEFT), answer.at(RIGHT)
    merged = answer.merge(left, right)
    for change in (merged.drop, merged.keep, lambda r: merged.merge(r, left)):
        with pytest.raises(sp.SpigoloError, match="take the region from the method `at` of this result"):
            change(right)
    consistent(answer.drop(left).keep(left))


def test_a_region_of_the_same_regions_is_taken_wherever_it_comes_from() -> None:
    answer = result()
    left, right = pickle.loads(pickle.dumps((answer.at(LEFT), answer.at(RIGHT))))
    assert np.array_equal(answer.drop(left).labels, answer.drop(answer.at(LEFT)).labels)
    assert len(answer.merge(left, result().at(RIGHT))) == 1
    consistent(answer.drop(left).keep(left).merge(left, right))


@pytest.mark.parametrize("thing", [1, None, LEFT, "cup"])
def test_what_is_no_region_is_refused(thing: object) -> None:
    answer = result()
    for change in (answer.keep, answer.drop, lambda r: answer.merge(answer[0], r)):
        with pytest.raises(
            sp.SpigoloError, match=r"expected an object or region from the method `at` of this result, got .*"
        ):
            change(thing)


def test_merging_measures_anew() -> None:
    first = result()
    a, b = first.at(LEFT), first.at(RIGHT)
    joined = first.merge(a, b)
    consistent(joined)
    assert len(joined) == 1
    whole = joined[0]
    assert whole.area_px == a.area_px + b.area_px
    assert np.array_equal(whole.mask, a.mask | b.mask)
    mean = (np.array(a.centroid_m) * a.area_px + np.array(b.centroid_m) * b.area_px) / whole.area_px
    assert whole.centroid_m == pytest.approx(mean, abs=1e-6)
    # a rejected region may be joined too, and what was dropped stays so
    wall = joined.at((5, 80))
    assert len(joined.merge(joined[0], wall)) == 1
    assert len(first.merge(a, a)) == 2


def test_joined_regions_are_numbered_by_their_first_pixel() -> None:
    regions = Regions(np.array([[0, 1, 1], [2, 3, 3], [2, 4, 4]], np.int32), 5)
    joined = regions.joined(np.array([0, 1, 0, 3, 1]))
    assert joined.count == 3
    assert joined.labels.tolist() == [[0, 1, 1], [0, 2, 2], [0, 1, 1]]


def test_scores_lie_in_0_to_1_and_fall_with_the_evidence() -> None:
    from spigolo.objects.scores import region_score

    contour, measured = np.array([1.0, 0.5, 1.0]), np.array([3000.0, 3000.0, 300.0]) / VGA_PX
    # 1 - exp(-1) = 0.632; 1 - exp(-0.1) = 0.0952
    assert region_score(contour, measured, None) == pytest.approx([0.632, 0.316, 0.0952], abs=1e-3)
    assert region_score(contour, measured, np.array([0.5, 1, 0])) == pytest.approx([0.316, 0.316, 0], abs=1e-3)
    for config in sp.PRESETS.values():
        answer = sp.segment(scene(), config)
        assert all(0 <= r.score <= 1 for r in (*answer, *answer.rejected))


def bare(camera: sp.Camera | None) -> sp.Frame:
    return sp.Frame(scene().color, scene().depth, camera)


@pytest.mark.parametrize("name", sorted(sp.PRESETS))
def test_without_intrinsics_what_needs_no_space_still_works_and_the_rest_is_named(name: str) -> None:
    answer = sp.segment(bare(None), sp.PRESETS[name])
    consistent(answer)
    assert "points, centroids and boxes in metres" in answer.left_out
    assert ("contact boundary" in answer.left_out) == (name != "SHELF")
    assert ("support plane" in answer.left_out) == name.startswith("OBJECTS")
    for r in (*answer, *answer.rejected):
        assert r.centroid_m is None
        assert r.oriented_box() is None
        with pytest.raises(sp.errors.CameraError, match="intrinsics"):
            r.points_m()
    assert sp.segment(bare(CAMERA), sp.PRESETS[name]).left_out == ()


def test_without_intrinsics_the_boxes_are_found_all_the_same() -> None:
    answer = sp.segment(bare(None), CONFIG)
    assert isinstance(answer.at(LEFT), sp.ObjectMask)
    assert isinstance(answer.at(RIGHT), sp.ObjectMask)
    with pytest.raises(sp.errors.FrameError, match="intrinsics"):
        sp.segment(bare(None), CONFIG, sp.MetricBox((0, 0, 0), (1, 1, 1)))


def test_depth_in_millimetres_is_reported() -> None:
    frame = scene()
    far = sp.Frame(frame.color, frame.depth * 1000, frame.camera)
    with pytest.warns(UserWarning, match="the median depth is .* m: .* depth_scale=0.001"):
        sp.segment(far, CONFIG)


def test_a_scale_applied_twice_is_reported() -> None:
    frame = scene()
    sp.segment(sp.Frame(frame.color, frame.depth * 0.07, frame.camera), CONFIG)  # 5 cm: some cameras see so near
    near = sp.Frame(frame.color, frame.depth, frame.camera, depth_scale=0.001)
    with pytest.warns(sp.errors.UnitWarning, match=r"the median depth is [\d.]+ mm: do not apply depth_scale twice"):
        sp.segment(near, CONFIG)


@pytest.mark.parametrize("name", sorted(sp.PRESETS))
def test_a_frame_without_any_depth_has_no_objects_and_one_warning(name: str) -> None:
    with pytest.warns(UserWarning, match="the frame has no measured depth") as caught:
        answer = sp.segment(sp.Frame(scene().color, np.zeros((120, 160)), CAMERA), sp.PRESETS[name])
    assert len(caught) == 1
    assert len(answer) == 0
    assert {r.reason for r in answer.rejected} == {sp.Reason.NO_DEPTH}


DOORS: dict[str, Callable[[sp.Frame], object]] = {
    "segment": lambda frame: sp.segment(frame, CONFIG),
    "segment_at": lambda frame: sp.segment_at(frame, LEFT, CONFIG),
    "trace": lambda frame: sp.trace(frame, CONFIG),
    "Segmenter": sp.Segmenter(CONFIG),
    "segment_around": lambda frame: segment_around(frame, LEFT),
    **METHODS,
}


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("depth", [0.0, 700.0], ids=["none", "in millimetres"])
def test_a_warning_names_the_line_of_who_called_whatever_the_door(door: str, depth: float) -> None:
    with pytest.warns(UserWarning, match=r"depth") as caught:
        DOORS[door](sp.Frame(scene().color, np.full((120, 160), depth), CAMERA))
    assert [warning.filename for warning in caught] == [__file__]


def test_a_warning_of_negative_depth_names_the_line_of_who_called(tmp_path: Path) -> None:
    np.save(tmp_path / "depth.npy", -scene().depth)
    (tmp_path / "rgb.png").write_bytes(cv2.imencode(".png", scene().color)[1].tobytes())
    with pytest.warns(UserWarning, match="negative depth") as made:
        sp.Frame(scene().color, -scene().depth, CAMERA)
    with pytest.warns(UserWarning, match="negative depth") as read:
        sp.read_frame(tmp_path / "rgb.png", tmp_path / "depth.npy", CAMERA)
    assert [warning.filename for warning in (*made, *read)] == [__file__] * 2


@pytest.mark.filterwarnings("ignore:no support plane")
@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (9, 1), (2, 2), (5, 40)])
@pytest.mark.parametrize("name", sorted(sp.PRESETS))
def test_tiny_images_work(name: str, shape: tuple[int, int]) -> None:
    height, width = shape
    camera = sp.Camera(100, 100, width / 2, height / 2, width, height)
    color = np.random.default_rng(0).integers(0, 255, (*shape, 3), dtype=np.uint8)
    depth = np.random.default_rng(1).uniform(0.5, 2, shape)
    consistent(sp.segment(sp.Frame(color, depth, camera), sp.PRESETS[name]))


@pytest.mark.parametrize("corner", ["abc", None, [[1], [1, 2]], (0, 0), (2, 2, 2)])
def test_a_metric_box_of_other_things_is_refused(corner: object) -> None:
    with pytest.raises(sp.errors.FrameError, match="expected a metric box with low < high"):
        sp.MetricBox(corner, (1, 1, 1))  # type: ignore[arg-type]


@pytest.mark.parametrize("work", [sp.segment, sp.trace, sp.Segmenter(), diagnose, *sp.METHODS.values()])
def test_what_is_no_frame_is_refused(work: Callable[[object], object]) -> None:
    with pytest.raises(sp.errors.FrameError, match=r"expected a Frame such as .*, got ndarray"):
        work(np.zeros((4, 4, 3), np.uint8))


def test_a_missing_support_plane_is_told_and_only_where_a_preset_needs_one() -> None:
    depth = np.random.default_rng(0).uniform(0.5, 2, (120, 160))
    frame = sp.Frame(scene().color, depth, CAMERA)
    with pytest.warns(UserWarning, match=r"no support plane was found, .*additions\.support\.facing\.up"):
        sp.segment(frame)
    sp.segment(frame, sp.TABLE)
    sp.segment(sp.Frame(scene().color, depth, None))


def test_merging_leaves_the_other_objects_and_all_ids_as_they_were() -> None:
    first = sp.Segmenter(ids=True)(sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json"))
    a, b = first[3], first[5]
    merged = first.merge(a, b)
    consistent(merged)
    assert sorted(o.id for o in merged if o.id is not None) == sorted({o.id for o in first} - {b.id})
    before = {o.id: o for o in first}
    for o in merged:
        if o.id != a.id:
            assert o.to_dict() | {"region": 0} == before[o.id].to_dict() | {"region": 0}
    assert merged.object_at((round(a.centroid_px[0]), round(a.centroid_px[1]))).area_px == a.area_px + b.area_px


def test_numbers_of_numpy_as_stamp_are_written_as_json() -> None:
    frame = scene()
    stamped = sp.Frame(frame.color, frame.depth, frame.camera, "one", np.int64(5))
    assert json.loads(json.dumps(sp.segment(stamped, CONFIG).to_dict()))["stamp_ns"] == 5
    with pytest.raises(sp.errors.FrameError, match="whole nanoseconds"):
        sp.Frame(frame.color, frame.depth, frame.camera, "one", 0.5)


def test_intrinsics_of_a_larger_image_are_told() -> None:
    frame = scene()
    half = frame.color[::2, ::2], frame.depth[::2, ::2]
    with pytest.warns(UserWarning, match="outside the image of 80x60: the intrinsics probably belong to another image"):
        sp.Frame(*half, [[CAMERA.fx, 0, CAMERA.cx + 1], [0, CAMERA.fy, CAMERA.cy], [0, 0, 1]])


def test_a_negative_trim_is_refused() -> None:
    for trim_m in (-1.0, float("nan")):
        with pytest.raises(sp.SpigoloError, match="at least 0 m"):
            result()[0].points_m(trim_m)


def test_a_ragged_region_of_interest_is_refused() -> None:
    with pytest.raises(sp.errors.FrameError, match="expected a mask or a pixel box"):
        sp.segment(scene(), CONFIG, [[1, 2], [3]])  # type: ignore[list-item]


@pytest.mark.parametrize("up", [[0, -1e-300, 0], [0, float("-inf"), 0], [float("nan")] * 3])
def test_an_upward_direction_without_a_direction_is_refused(up: list[float]) -> None:
    with pytest.raises(sp.errors.ConfigError):
        sp.OBJECTS.replace(additions={"support": {"facing": {"up": up}}})


def test_a_huge_weight_of_depth_steps_is_as_good_as_a_large_one() -> None:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    large, huge = (
        sp.segment(frame, sp.OBJECTS.replace(additions={"refinement": {"step_weight": w}})) for w in (1e15, 1e30)
    )
    assert np.array_equal(large.labels, huge.labels)


def test_a_dropped_object_that_is_kept_again_has_its_id() -> None:
    result = sp.Segmenter(sp.OBJECTS, ids=True)(scene())
    first = result[0]
    assert first.id is not None
    y, x = map(int, first.centroid_px)
    dropped = result.drop(first)
    assert dropped.at((y, x)).id == first.id and dropped.object_at((y, x)).id == first.id


@pytest.mark.parametrize("resolution", ["full", "half"])
def test_a_region_of_interest_changes_no_mask_inside(resolution: str) -> None:
    demo = Path(sp.__file__).parent / "demo_scene"
    frame = sp.read_frame(demo / "rgb.png", demo / "depth.png", demo / "camera.json")
    config = sp.OBJECTS.replace(**{"additions.resolution": resolution, "additions.support.near_roi": None})
    whole, part = sp.segment(frame, config), sp.segment(frame, config, (0, 0, 480, 320))
    inside = [o for o in whole if o.box_px[3] <= 320]
    assert 0 < len(inside) <= len(part) < len(whole)
    for o in inside:
        found = part.at((int(o.centroid_px[0]), int(o.centroid_px[1])))
        assert np.array_equal(found.mask, o.mask) and found.score == o.score
    assert {r.reason for r in part.rejected} >= {sp.Reason.OUTSIDE}
