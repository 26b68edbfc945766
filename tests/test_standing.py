"""Planes that things stand on, outlines that are a region's own, flat objects and packed layers."""

from __future__ import annotations

import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.plane import Plane
from spigolo.additions.rims import surrounded_support
from spigolo.additions.stance import measure_stance
from spigolo.additions.support import faces_up, find_support
from spigolo.objects.facts import measure_regions
from spigolo.objects.verdicts import judge
from spigolo.stages.regions import Regions

CAMERA = sp.Camera(fx=150.0, fy=150.0, cx=79.5, cy=59.5, width=160, height=120)
SHAPE = (120, 160)


def rays() -> np.ndarray:
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    return np.stack([(x - CAMERA.cx) / CAMERA.fx, (y - CAMERA.cy) / CAMERA.fy, np.ones(SHAPE)], axis=-1)


def seen(normal: tuple[float, float, float], offset_m: float) -> np.ndarray:
    """Depth (H, W) of a plane; infinite where it is not in front of the camera."""
    facing = rays() @ np.asarray(normal)
    return np.where(facing < 0, -offset_m / np.where(facing < 0, facing, -1), np.inf)


@pytest.mark.parametrize(
    ("normal", "share", "expected"),
    [
        ((0.0, -1.0, 0.0), 0.2, True),
        ((0.0, 0.0, -1.0), 0.2, True),
        ((0.0, 0.9, -0.44), 0.9, False),
        ((0.98, 0.0, -0.2), 0.2, False),
        ((0.98, 0.0, -0.2), 0.6, True),
    ],
)
def test_ceilings_and_side_walls_are_not_supports(
    normal: tuple[float, float, float], share: float, expected: bool
) -> None:
    assert faces_up(Plane(np.array(normal), 1.0), share, sp.settings.Facing()) == expected


def test_an_upward_direction_overrides_how_the_camera_is_held() -> None:
    rule = sp.settings.Facing(up=(5.0, 0.0, 0.0))
    assert faces_up(Plane(np.array([1.0, 0.0, 0.0]), 1.0), 0.1, rule)
    assert not faces_up(Plane(np.array([0.0, -1.0, 0.0]), 1.0), 0.9, rule)


def test_the_support_lies_within_reach() -> None:
    """A wall at 6 m fills most of the frame, a table at 1 m its lower third."""
    depth = np.full(SHAPE, 6.0, np.float32)
    depth[80:] = seen((0.0, -1.0, 0.0), 0.3)[80:]
    near = find_support(depth, CAMERA, sp.settings.Support(within_reach=True), 2.5)
    far = find_support(depth, CAMERA, sp.settings.Support(), 2.5)
    assert near is not None and far is not None
    assert near.offset_m == pytest.approx(0.3, abs=0.01)
    assert far.offset_m == pytest.approx(6.0, abs=0.01)


def test_the_support_lies_in_and_around_the_region_of_interest() -> None:
    depth = np.full(SHAPE, 2.0, np.float32)
    depth[70:, 90:] = 1.0
    roi = np.zeros(SHAPE, bool)
    roi[85:105, 110:140] = True
    found = find_support(depth, CAMERA, sp.settings.Support(near_roi=0.5), None, roi)
    assert found is not None
    assert found.offset_m == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("min_things", [None, 0.02])
def test_the_floor_of_a_bin_comes_before_its_larger_wall(min_things: float | None) -> None:
    """A wall in the lower part of the picture, a smaller floor with a block on it in the upper one."""
    floor, wall = seen((0.0, -0.2, -0.98), 1.0), seen((0.0, -0.8, -0.6), 0.75)
    depth = np.where(np.mgrid[: SHAPE[0], : SHAPE[1]][0] < 55, floor, wall)
    depth[18:34, 60:90] -= 0.08
    found = find_support(depth.astype(np.float32), CAMERA, sp.settings.Support(min_things=min_things))
    assert found is not None
    assert found.offset_m == pytest.approx(0.75 if min_things is None else 1.0, abs=0.02)


@pytest.mark.parametrize(("max_below", "offset_m"), [(None, 0.975), (0.1, 1.0)])
def test_the_floor_under_a_heap_is_found_between_its_objects(max_below: float | None, offset_m: float) -> None:
    """Blocks of 25 mm cover three fifths of a floor at 1 m, so that most points lie on their upper sides."""
    depth = np.full(SHAPE, 0.975, np.float32)
    depth[:, np.arange(SHAPE[1]) % 10 < 4] = 1.0
    plane = find_support(depth, CAMERA, sp.settings.Support(max_below=max_below))
    assert plane is not None
    assert plane.offset_m == pytest.approx(offset_m, abs=0.002)
    assert plane.normal == pytest.approx([0, 0, -1], abs=0.01)


def test_a_plane_is_not_lowered_to_what_lies_in_a_hole_of_the_table() -> None:
    """A fifth of what the table surrounds is a hole, through which one sees the floor, half a metre below."""
    depth = np.full(SHAPE, 1.0, np.float32)
    depth[40:80, 50:110] = 1.5
    plane = find_support(depth, CAMERA, sp.settings.Support(max_below=0.1))
    assert plane is not None and plane.offset_m == pytest.approx(1.0, abs=0.002)


def bin_seen_from_above(rim_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Depth and labels of a floor at 1 m with a rim around it, 8 px wide and 5 cm high: 1 = rim, 2 = a box inside."""
    depth, labels = np.full(SHAPE, 1.0, np.float32), np.zeros(SHAPE, np.int32)
    height, width = round(rim_m * CAMERA.fy / 0.95 / 2), round(rim_m * CAMERA.fx / 0.95 * 0.75)
    y, x = 60 - height // 2, 80 - width // 2
    labels[y : y + height, x : x + width] = 1
    labels[y + 8 : y + height - 8, x + 8 : x + width - 8] = 0
    labels[56:64, 76:88] = 2
    depth[labels > 0] = 0.95
    return depth, labels


@pytest.mark.parametrize("rim_m", [0.2, 0.6])
def test_a_rim_is_no_object_as_it_surrounds_the_floor(rim_m: float) -> None:
    depth, labels = bin_seen_from_above(rim_m)
    support, plane = sp.settings.Support(), Plane(np.array([0.0, 0.0, -1.0]), 1.0)
    rim, box = labels == 1, labels == 2
    y, x = np.nonzero(rim)
    inner = np.zeros(SHAPE, bool)
    inner[y.min() : y.max() + 1, x.min() : x.max() + 1] = True
    expected = np.count_nonzero(inner & ~rim & ~box) / np.count_nonzero(rim)
    assert surrounded_support(rim, plane, depth, CAMERA, support) == pytest.approx(expected)
    assert surrounded_support(box, plane, depth, CAMERA, support) == 0
    frame = sp.Frame(np.zeros((*SHAPE, 3), np.uint8), depth, CAMERA)
    facts = measure_regions(Regions(labels, 3), depth, frame, np.ones(SHAPE, np.float32), plane=plane)
    rules = sp.settings.Rules(rim=sp.settings.Rim(max_support=0.3, min_length_m=0.35))
    verdicts = [judge(one, sp.settings.Rejection(max_dark=None), rules, support) for one in facts[1:]]
    assert verdicts[1] is None
    if rim_m == 0.2:  # a ring of this size is a thing to grasp
        assert verdicts[0] is None
    else:
        assert verdicts[0] is not None and verdicts[0][0] is sp.Reason.WALL
        why = f"the support plane inside the region's convex hull has {expected:.0%} of the region's area (maximum 30%)"
        assert verdicts[0][1] == f"wall: {why}"
    assert judge(facts[1], sp.settings.Rejection(max_dark=None), sp.settings.Rules(), support) is None


@pytest.mark.parametrize(("before_m", "hides"), [(0.4, 1.0), (1.0, 0.0)])
def test_a_border_with_something_nearer_is_the_other_ones(before_m: float, hides: float) -> None:
    """A face with an object at its left; depth steps back, or does not, along the rest of the outline."""
    depth = np.full(SHAPE, 1.5 if hides else 1.0, np.float32)
    labels = np.zeros(SHAPE, np.int32)
    labels[40:80, 60:100] = 1
    depth[40:80, 60:100] = 1.0
    depth[30:90, 30:60] = 0.4 if hides else before_m
    stance = measure_stance(Regions(labels, 2), depth, CAMERA, None, labels == 1, sp.settings.Wall(), None)
    assert stance.hides[1] == pytest.approx(hides)
    assert np.isnan(stance.ledge[1])


@pytest.mark.parametrize(("thick_m", "ledge"), [(0.012, 1.0), (0.003, 0.0)])
def test_a_flat_object_has_a_step_of_height_along_its_outline(thick_m: float, ledge: float) -> None:
    depth, labels = np.full(SHAPE, 0.6, np.float32), np.zeros(SHAPE, np.int32)
    labels[40:80, 60:100] = 1
    depth[labels == 1] -= thick_m
    plane = Plane(np.array([0.0, 0.0, -1.0]), 0.6)
    stance = measure_stance(
        Regions(labels, 2), depth, CAMERA, plane, labels == 1, sp.settings.Wall(), sp.settings.Ledge()
    )
    assert stance.ledge[1] == ledge


def test_a_packed_layer_is_warned_of_once_and_a_plain_table_is_not() -> None:
    depth = np.full((240, 320), 0.6, np.float32)
    camera = sp.Camera(fx=300.0, fy=300.0, cx=159.5, cy=119.5, width=320, height=240)
    tiles = (np.indices((240, 320)) // 12).sum(axis=0) % 2 * 200
    packed = np.repeat(tiles.astype(np.uint8)[..., None], 3, axis=2)
    with pytest.warns(UserWarning, match="packed objects") as told:
        assert len(sp.segment(sp.Frame(packed, depth, camera))) == 0
    assert len(told) == 1
    sp.segment(sp.Frame(np.zeros_like(packed), depth, camera))


@pytest.mark.parametrize(("metric", "is_rejected"), [(True, False), (False, True)])
def test_no_limit_in_metres_does_not_bring_back_the_limit_in_pixels(metric: bool, is_rejected: bool) -> None:
    depth, labels = np.full(SHAPE, 1.2, np.float32), np.zeros(SHAPE, np.int32)
    labels[20:90, 30:130] = 1
    frame = sp.Frame(np.zeros((*SHAPE, 3), np.uint8), depth, CAMERA)
    facts = measure_regions(Regions(labels, 2), depth, frame, np.ones(SHAPE, np.float32))[1]
    paper = sp.settings.Rejection(max_lambda1_px2=100.0, max_lambda2_px2=100.0)
    verdict = judge(facts, paper, sp.settings.Rules(metric=metric), None)
    assert (verdict is not None) == is_rejected
