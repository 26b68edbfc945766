"""Facts about regions, rules of rejection, oriented boxes, the answer."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from spigolo.lab.studies import boxes
from spigolo.objects.boxes import fit_box
from spigolo.objects.facts import RegionFacts, measure_regions
from spigolo.objects.scores import contour_strength
from spigolo.objects.verdicts import Verdict
from spigolo.objects.verdicts import judge as judge_by
from spigolo.settings import Ledge, Rejection, Rules, Wall
from spigolo.settings.presets import preset
from spigolo.stages.depth import prepare_depth
from spigolo.stages.regions import Regions

DEMO = Path(sp.__file__).parent / "demo_scene"
CAMERA = sp.Camera(fx=500.0, fy=500.0, cx=79.5, cy=59.5, width=160, height=120)


def frame_of(depth: np.ndarray, color: int = 128) -> sp.Frame:
    return sp.Frame(np.full((*depth.shape, 3), color, np.uint8), depth, CAMERA)


def measure(regions: Regions, frame: sp.Frame) -> list[RegionFacts]:
    """The facts of regions of a frame as it came: SHELF does not in-paint."""
    config = sp.SHELF.replace(depth={"smoothing": {"mean": "none"}})
    return measure_regions(regions, prepare_depth(frame.depth, config.depth), frame, np.zeros(frame.shape, np.float32))


def facts_of(labels: np.ndarray, depth: np.ndarray | None = None, color: int = 128) -> list:
    depth = np.ones(labels.shape, np.float32) if depth is None else depth
    frame = frame_of(depth, color)
    return measure(Regions(labels.astype(np.int32), int(labels.max()) + 1), frame)


def test_facts_of_a_rectangle() -> None:
    labels = np.zeros((120, 160), np.int32)
    labels[20:40, 30:90] = 1  # 20 x 60 pixels
    facts = facts_of(labels)[1]
    assert facts.area_px == 1200
    assert facts.box_px == (20, 30, 40, 90)
    assert facts.centroid_px == (29.5, 59.5)
    # variance of n consecutive integers is (n^2 - 1) / 12
    assert facts.spread_px2 == pytest.approx(((60**2 - 1) / 12, (20**2 - 1) / 12))
    assert facts.eccentricity == pytest.approx(np.sqrt(1 - 399 / 3599))
    # at 1 m: X = (59.5 - 79.5) / 500, Y = (29.5 - 59.5) / 500
    assert facts.centroid_m == pytest.approx((-0.04, -0.06, 1.0), abs=1e-6)
    assert facts.points_m().shape == (1200, 3)
    assert facts.missing == 0


def test_missing_depth_is_counted_in_what_was_measured() -> None:
    labels = np.zeros((120, 160), np.int32)
    labels[20:40, 30:90] = 1
    depth = np.ones(labels.shape, np.float32)
    depth[20:40, 30:60] = 0
    facts = facts_of(labels, depth)[1]
    assert facts.missing == 0.5
    assert len(facts.points_m()) == 600


def test_a_region_without_depth_has_no_place_in_space() -> None:
    facts = facts_of(np.zeros((120, 160), np.int32), np.zeros((120, 160), np.float32))[0]
    assert facts.centroid_m is None
    assert facts.distance_m is None
    assert facts.oriented_box() is None
    assert facts.points_m().shape == (0, 3)


def judge(facts: RegionFacts, rules: Rejection | Rules) -> Verdict | None:
    """Judged by rules of the paper alone, or by rules of ours alone, without a support."""
    if isinstance(rules, Rules):
        return judge_by(facts, Rejection(), rules, None)
    return judge_by(facts, rules, Rules(), None)


def region(width: int = 60, height: int = 50, **scene):
    """Facts of a rectangle in an image of its own."""
    labels = np.zeros((120, 160), np.int32)
    labels[10 : 10 + height, 10 : 10 + width] = 1
    return facts_of(labels, **scene)[1]


@pytest.mark.parametrize(
    ("rule", "limit", "broken", "kept", "reason"),
    [
        ("max_distance_m", 1.5, {"depth": np.full((120, 160), 1.6, np.float32)}, {}, "out of reach"),
        ("max_lambda1_px2", 310.0, {"width": 62}, {"width": 60}, "too long"),  # (n^2 - 1) / 12: 320, 300
        ("max_lambda2_px2", 200.0, {"height": 50}, {"height": 48}, "too wide"),  # 208, 192
        ("min_length_m", 0.121, {"width": 60}, {"width": 62}, "too small"),
        ("max_length_m", 0.123, {"width": 62}, {"width": 60}, "too long"),  # 0.124 m and 0.120 m at 1 m, f = 500
        ("max_width_m", 0.098, {"height": 50}, {"height": 48}, "too wide"),
        ("max_eccentricity", 0.9, {"height": 25}, {"height": 30}, "too thin"),
        ("max_dark", 0.3, {"color": 23}, {"color": 24}, "dark"),
    ],
)
def test_each_rule_rejects_beyond_its_limit_alone(rule, limit, broken, kept, reason) -> None:
    rules = (Rules if rule in Rules.model_fields else Rejection)(**{rule: limit})
    verdict = judge(region(**broken), rules)
    assert verdict is not None
    assert verdict[0].value == reason
    assert reason in verdict[1]
    assert judge(region(**kept), rules) is None
    assert judge(region(**broken), Rejection()) is None


@pytest.mark.parametrize(
    ("stance", "words"),
    [
        ((0.16, 35.0, 0.0, 60), None),
        ((0.14, 35.0, 0.0, 60), "depth increases by a step along 14% of the region's outline (minimum 15%)"),
        ((0.16, 35.0, 0.1, 60), "depth increases by a step along 16% of the region's outline (minimum 22%)"),
        ((0.146, 35.0, 0.0, 60), "depth increases by a step along 14.6% of the region's outline (minimum 15.0%)"),
        ((0.31, 42.0, 0.0, 60), None),
        (
            (0.29, 42.0, 0.0, 60),
            "depth increases by a step along 29% of the region's outline (minimum 30% for a surface tilted by 42 deg)",
        ),
        (
            (0.9, 70.0, 0.0, 60),
            "depth increases by a step along 90% of the region's outline (minimum 100% for a surface tilted by 70 deg)",
        ),
        ((0.9, 20.0, 0.1, 60), None),
        (
            (0.9, 20.0, 0.1, 100),
            "the image border cuts off the region, and the region is 4.0 times as long as wide (maximum 3.5)",
        ),
        ((0.9, 20.0, 0.0, 100), None),
        ((None, None, None, 100), None),
    ],
)
def test_a_wall_hides_little_turns_away_or_is_a_rail_that_the_image_cuts(stance, words) -> None:
    hides, lean_deg, cut, width = stance
    facts = replace(region(width=width, height=25), hides=hides, lean_deg=lean_deg, cut=cut)
    verdict = judge(facts, Rules(wall=Wall()))
    assert verdict == (None if words is None else (sp.Reason.WALL, f"wall: {words}"))


def test_a_line_of_pixels_that_the_image_cuts_is_a_rail() -> None:
    facts = replace(region(height=1), hides=0.9, lean_deg=None, cut=0.1)
    verdict = judge(facts, Rules(wall=Wall()))
    assert verdict is not None
    assert verdict[0] is sp.Reason.WALL
    assert verdict[1].startswith("wall: the image border cuts off the region")


def test_missing_depth_is_rejected_above_thirty_percent_not_at_it() -> None:
    rules = Rejection(max_missing=0.3)
    depth = np.ones((120, 160), np.float32)
    depth[10:60, 10:28] = 0  # 18 of 60 columns: 30 %
    assert judge(region(depth=depth), rules) is None
    depth[10, 28] = 0
    verdict = judge(region(depth=depth), rules)
    assert verdict is not None
    assert verdict[0] is sp.Reason.MISSING_DEPTH


def test_dark_is_rejected_at_thirty_percent() -> None:
    labels = np.zeros((120, 160), np.int32)
    labels[10:60, 10:70] = 1
    color = np.full((120, 160, 3), 200, np.uint8)
    color[10:60, 10:28] = 23  # 30 % of it
    frame = sp.Frame(color, np.ones((120, 160), np.float32), CAMERA)
    facts = measure(Regions(labels, 2), frame)[1]
    verdict = judge(facts, Rejection(max_dark=0.3))
    assert verdict is not None
    assert verdict[0] is sp.Reason.DARK
    color[10, 10] = 24
    frame = sp.Frame(color, np.ones((120, 160), np.float32), CAMERA)
    assert judge(measure(Regions(labels, 2), frame)[1], Rejection(max_dark=0.3)) is None


def test_a_region_without_a_boundary_around_it_is_no_object() -> None:
    labels = np.zeros((10, 12), np.int32)
    labels[2:6, 3:8] = 1
    boundary = np.zeros(labels.shape, np.float32)
    boundary[2:6, 3] = 0.5  # its left column: 4 of 18 pairs to the left, and the ends of both rows
    strength = contour_strength(Regions(labels, 2), boundary)
    assert strength == pytest.approx([6 * 0.5 / 18] * 2)
    config = sp.TABLE.replace(
        rejection={"max_lambda1_px2": None, "max_lambda2_px2": None}, additions={"rules": {"min_contour": 0.99}}
    )
    result = sp.segment(scene(), config)
    assert len(result) == 0
    assert sp.Reason.WEAK_CONTOUR in {r.reason for r in result.rejected}


@pytest.mark.parametrize(("ledge", "is_kept"), [(0.6, True), (0.4, False), (None, False)])
def test_a_flat_object_is_kept_though_its_contour_is_weak(ledge: float | None, is_kept: bool) -> None:
    facts = replace(region(), contour=0.3, ledge=ledge)
    assert (judge(facts, Rules(wall=Wall(), ledge=Ledge(), min_contour=0.6)) is None) == is_kept
    verdict = judge(facts, Rules(wall=Wall(), min_contour=0.6))
    assert verdict == (
        sp.Reason.WEAK_CONTOUR,
        "weak contour: the mean boundary value along the region's border is 0.30 (minimum 0.60)",
    )


def test_pixel_limits_grow_with_the_image() -> None:
    rules = Rejection(max_lambda1_px2=310.0)
    assert judge(region(width=62), rules.at_size((480, 640))) is not None
    assert judge(region(width=62), rules.at_size((960, 1280))) is None


def test_limits_in_metres_take_the_place_of_those_in_pixels_where_intrinsics_are_known() -> None:
    paper, ours = Rejection(max_lambda1_px2=310.0), Rules(metric=True, max_length_m=0.2)
    assert judge(region(width=62), paper) is not None
    assert region(width=62).size_m == pytest.approx((62 * 0.002, 50 * 0.002), rel=1e-3)
    assert judge_by(region(width=62), paper, ours, None) is None
    far = region(width=62, depth=np.full((120, 160), 2.0, np.float32))
    assert judge_by(far, paper, ours, None) == (
        sp.Reason.TOO_LONG,
        "too long: the region's length is 0.25 m (maximum 0.20 m)",
    )
    labels = np.zeros((120, 160), np.int32)
    labels[10:60, 10:72] = 1
    blind = sp.Frame(np.full((120, 160, 3), 128, np.uint8), np.ones((120, 160), np.float32), None)
    facts = measure(Regions(labels, 2), blind)[1]
    assert facts.size_m is None
    verdict = judge_by(facts, paper, ours, None)
    assert verdict is not None
    assert "lambda1" in verdict[1]


def cuboid_depth() -> tuple[np.ndarray, np.ndarray]:
    """Depth of a 12 x 8 cm board at 0.8 m before a wall at 1.5 m, slanted about the vertical, and its mask."""
    y, x = np.mgrid[0:120, 0:160]
    ray = (x - CAMERA.cx) / CAMERA.fx
    slope = np.tan(np.deg2rad(30))
    z = 0.8 / (1 - slope * ray)  # the plane Z = 0.8 + slope X
    along = ray * z / np.cos(np.deg2rad(30))
    mask = (np.abs(along) <= 0.06) & (np.abs((y - CAMERA.cy) / CAMERA.fy * z) <= 0.04)
    return np.where(mask, z, 1.5).astype(np.float32), mask


def test_an_oriented_box_has_the_size_and_direction_of_a_slanted_board() -> None:
    depth, mask = cuboid_depth()
    box = fit_box(mask, depth, CAMERA)
    assert box is not None
    assert box.size_m == pytest.approx((0.12, 0.08, 0.0), abs=0.006)
    assert box.center_m == pytest.approx((0, 0, 0.8), abs=0.004)
    assert abs(box.R_camera_box[:, 0] @ [np.cos(np.pi / 6), 0, np.sin(np.pi / 6)]) > 0.999
    assert np.linalg.det(box.R_camera_box) == pytest.approx(1)
    corners = box.corners_m()
    assert corners.shape == (8, 3)
    assert np.ptp((corners - box.center_m) @ box.R_camera_box, axis=0) == pytest.approx(box.size_m)


def test_a_box_follows_the_direction_it_is_given() -> None:
    depth, mask = cuboid_depth()
    up = np.array([0.0, np.cos(0.3), np.sin(0.3)])
    box = fit_box(mask, depth, CAMERA, up)
    assert box is not None
    assert np.abs(up @ box.R_camera_box).max() == pytest.approx(1)
    np.testing.assert_allclose(box.R_camera_box.T @ box.R_camera_box, np.eye(3), atol=1e-9)
    assert np.linalg.det(box.R_camera_box) == pytest.approx(1)


def test_boxes_stand_upright_on_the_support() -> None:
    answer = sp.segment(sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json"))
    assert len(answer) > 5
    for o in answer:
        box = o.oriented_box()
        assert o.plane is not None and box is not None
        assert np.abs(o.plane.normal @ box.R_camera_box).max() == pytest.approx(1)


def test_flying_pixels_at_the_contour_do_not_blow_up_a_box() -> None:
    depth, mask = cuboid_depth()
    import cv2

    rim = mask & (cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) == 0)
    flying = depth.copy()
    flying[rim] = np.random.default_rng(0).uniform(0.8, 1.5, np.count_nonzero(rim)).astype(np.float32)
    clean, spoilt = fit_box(mask, depth, CAMERA), fit_box(mask, flying, CAMERA)
    assert clean is not None
    assert spoilt is not None
    assert clean.size_m == pytest.approx((0.12, 0.08, 0.0), abs=0.003)
    assert spoilt.size_m == pytest.approx(clean.size_m, abs=0.008)


@pytest.mark.parametrize(
    ("kind", "side_mm", "center_mm"), [("exact", 2, 2), ("structured light", 4, 5), ("stereo", 9, 9)]
)
def test_boxes_of_known_size_are_measured(kind: str, side_mm: float, center_mm: float) -> None:
    errors = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        known = boxes.draw_scene(rng)
        box = fit_box(*reversed(boxes.spoil(known, kind, rng)), boxes.CAMERA, known.axes[:, 2])
        assert box is not None
        errors.append(boxes.errors_mm(box, known))
    _, largest, center = np.median(errors, axis=0)
    assert largest <= side_mm and center <= center_mm


def test_a_few_flying_pixels_within_an_object_do_not_blow_up_its_box() -> None:
    depth, mask = cuboid_depth()
    depth[60, 70:80] = 1.4  # 10 of 3000
    box = fit_box(mask, depth, CAMERA, np.array([0.0, 1.0, 0.0]))
    assert box is not None
    assert box.size_m == pytest.approx((0.12, 0.08, 0.0), abs=0.006)


def scene() -> sp.Frame:
    """Two boxes that stand before a wall, at 0.7 and 0.8 m."""
    depth = np.full((120, 160), 1.0, np.float32)
    color = np.full((120, 160, 3), 90, np.uint8)
    depth[30:80, 20:60], color[30:80, 20:60] = 0.7, (200, 30, 30)
    depth[40:90, 90:140], color[40:90, 90:140] = 0.8, (30, 60, 200)
    return sp.Frame(color, depth, CAMERA)


def test_two_boxes_before_a_wall_are_two_objects_with_their_facts() -> None:
    config = preset("TABLE").replace(rejection={"max_lambda1_px2": 20000.0, "max_lambda2_px2": 15000.0})
    result = sp.segment(scene(), config)
    assert len(result) == 2
    near, far = sorted(result, key=lambda o: o.centroid_m[2])
    assert near.centroid_m[2] == pytest.approx(0.7, abs=0.005)
    assert far.centroid_m[2] == pytest.approx(0.8, abs=0.005)
    assert near.area_px == pytest.approx(2000, rel=0.06)
    assert far.area_px == pytest.approx(2500, rel=0.06)
    wall, *slivers = sorted(result.rejected, key=lambda r: -r.area_px)
    assert wall.reason is sp.Reason.TOO_LONG
    assert all(r.reason is sp.Reason.TOO_THIN for r in slivers)
    assert result.preset == "TABLE"
    assert result.digest == config.digest != preset("TABLE").digest


def test_the_answer_is_an_array_and_a_sequence() -> None:
    config = preset("TABLE").replace(rejection={"max_lambda1_px2": 20000.0, "max_lambda2_px2": 15000.0})
    result = sp.segment(scene(), config)
    assert np.array_equal(np.asarray(result), result.labels)
    assert np.asarray(result, dtype=np.uint8).dtype == np.uint8
    assert [o.label for o in result] == [1, 2]
    assert result[0].label == 1
    copy = np.array(result)
    copy[:] = 0
    assert result.labels.any()


def test_results_do_not_change_when_the_next_frame_is_segmented() -> None:
    first = sp.segment(scene(), sp.TABLE)
    before = first.labels.copy()
    sp.segment(sp.Frame(np.zeros((120, 160, 3), np.uint8), np.ones((120, 160), np.float32), CAMERA), sp.TABLE)
    assert np.array_equal(first.labels, before)


def test_auto_cost_follows_the_missing_depth() -> None:
    cost = sp.settings.AutoCost()
    config = sp.TABLE.replace(cost=cost, partition={"gamma_shadows": 5.0})
    full = sp.trace(scene(), config)
    assert isinstance(full.weighing.cost, sp.settings.BoundaryCost)
    assert full.cues.saliency is None
    holed = scene().depth.copy()
    holed[35:75, 62:88] = 0  # a shadow between the boxes
    shadows = sp.trace(sp.Frame(scene().color, holed, CAMERA), config)
    assert shadows.weighing.missing == pytest.approx(40 * 26 / (120 * 160))
    assert isinstance(shadows.weighing.cost, sp.settings.SaliencyCost)
    assert (full.weighing.gamma, shadows.weighing.gamma) == (config.partition.gamma, 5.0)
    assert shadows.edges is None


def test_every_field_of_the_json_says_what_its_fact_says() -> None:
    scene = Path(sp.__file__).parent / "demo_scene"
    frame = sp.read_frame(*(scene / name for name in ("rgb.png", "depth.png", "camera.json")))
    result = sp.segment(frame, roi=(0, 0, 300, 640))
    values = json.loads(json.dumps(result.to_dict()))
    assert values["image_size_px"] == [480, 640] and (values["preset"], values["digest"]) == (
        "OBJECTS_2",
        result.digest,
    )
    assert len(values["objects"]) == len(result) > 3 and len(values["rejected"]) == len(result.rejected) > 3
    for told, region in zip(values["objects"] + values["rejected"], [*result, *result.rejected], strict=True):
        box = told.pop("oriented_box", None)
        if box is not None:
            assert box == {
                k: getattr(region.oriented_box(), k).tolist() for k in ("center_m", "size_m", "R_camera_box")
            }
        for name, value in told.items():
            fact = getattr(region, name)
            assert value == (list(fact) if isinstance(fact, tuple) else getattr(fact, "value", fact)), name
    for fact in ("missing", "unfilled", "dark", "above", "inside", "contour", "cut", "hides"):
        others = [o[fact] for o in values["objects"] + values["rejected"]]
        assert len(set(others)) > 1, fact  # a fact that is the same everywhere would tell nothing here
