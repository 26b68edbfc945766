"""Parts of one object are joined, objects beside each other are not: on solids drawn ray by ray."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import naive
import spigolo as sp
from spigolo.additions import joining
from spigolo.additions.joining import join_parts
from spigolo.additions.stance import measure_stance
from spigolo.additions.support import find_support
from spigolo.settings.joining import Cap, Smooth, Vessel
from spigolo.stages.regions import Regions

CAMERA = sp.Camera(fx=400.0, fy=400.0, cx=159.5, cy=119.5, width=320, height=240)
TILT = np.deg2rad(50)
UP = np.array([0.0, -np.cos(TILT), -np.sin(TILT)])
RIGHT = np.array([1.0, 0.0, 0.0])
FORWARD = np.cross(UP, RIGHT)
FORWARD *= np.sign(FORWARD[2])
DISTANCE_M = 0.6
CENTER = -DISTANCE_M * UP + 0.5 * FORWARD
"""A table 0.6 m below a camera that looks down by 50 degrees; solids are given in (right, forward, up) from here."""

Array = np.ndarray
Surface = Callable[[Array, Array], Array]


def rays() -> tuple[Array, Array]:
    """Origin and directions of all pixels in (right, forward, up); a direction's length is one metre of depth."""
    y, x = np.mgrid[: CAMERA.height, : CAMERA.width]
    pixels = np.stack([(x - CAMERA.cx) / CAMERA.fx, (y - CAMERA.cy) / CAMERA.fy, np.ones(x.shape)], -1)
    axes = np.stack([RIGHT, FORWARD, UP])
    return axes @ -CENTER, pixels @ axes.T


def everywhere(x: Array, y: Array) -> Array:
    return np.ones(x.shape, bool)


def plane(height: float, where: Callable[[Array, Array], Array] = everywhere) -> Surface:
    def hit(origin: Array, direction: Array) -> Array:
        t = (height - origin[2]) / direction[..., 2]
        x, y = (origin[i] + t * direction[..., i] for i in (0, 1))
        return np.where((t > 0) & where(x, y), t, np.inf)

    return hit


def wall(x: float, y: float, radius: float, low: float, high: float, inner: bool = False) -> Surface:
    """An upright cylinder's surface as seen from outside, or from inside."""

    def hit(origin: Array, direction: Array) -> Array:
        o = origin[:2] - (x, y)
        a = (direction[..., :2] ** 2).sum(-1)
        b, c = direction[..., :2] @ o, (o**2).sum() - radius**2
        root = b**2 - a * c
        t = (-b + (1 if inner else -1) * np.sqrt(np.maximum(root, 0))) / a
        up = origin[2] + t * direction[..., 2]
        return np.where((root > 0) & (t > 0) & (up >= low) & (up <= high), t, np.inf)

    return hit


def disc(x: float, y: float, radius: float, height: float) -> Surface:
    return plane(height, lambda u, v: (u - x) ** 2 + (v - y) ** 2 <= radius**2)


def front(x: float, y: float, width: float, high: float) -> Surface:
    """The upright face of a box towards the camera, at distance y."""

    def hit(origin: Array, direction: Array) -> Array:
        t = (y - origin[1]) / direction[..., 1]
        u, up = origin[0] + t * direction[..., 0], origin[2] + t * direction[..., 2]
        return np.where((t > 0) & (abs(u - x) <= width / 2) & (up >= 0) & (up <= high), t, np.inf)

    return hit


def rectangle(x: float, y: float, width: float, length: float, height: float) -> Surface:
    return plane(height, lambda u, v: (abs(u - x) <= width / 2) & (v >= y) & (v <= y + length))


def draw(*parts: Surface) -> tuple[sp.Frame, Array]:
    """The table with these surfaces on it, and which of them each pixel shows, 0 the table."""
    origin, direction = rays()
    hits = np.stack([plane(0.0)(origin, direction), *(part(origin, direction) for part in parts)])
    depth, part = hits.min(0), hits.argmin(0)
    noise = 0.0008 * np.random.default_rng(0).normal(size=depth.shape) * depth**2
    color = np.array([[120, 90, 60], [200, 200, 200], [190, 195, 200], [60, 90, 200], [200, 60, 60]], np.uint8)
    return sp.Frame(color[part % 5], (depth + noise).astype(np.float32), CAMERA), part


def join(regions: Regions, frame: sp.Frame, config: sp.Config) -> Regions:
    """What the joining of `trace` makes of these regions."""
    run, ours = sp.trace(frame, config), config.at_size(frame.shape).additions
    assert ours is not None
    return join_parts(regions, run.cues, run.plane, frame.camera, ours)


def joined(config: sp.Config, *parts: Surface) -> list[int]:
    """For each part, the smallest part that is in one region with it."""
    frame, part = draw(*parts)
    labels = naive.number_regions(part.reshape(-1).tolist()).reshape(part.shape)
    regions = Regions(labels, int(labels.max()) + 1)
    answer = join(regions, frame, config)
    for region in range(answer.count):  # whole regions alone are joined
        assert np.unique(answer.labels[labels == region]).size == 1
    assert answer.labels.max() + 1 == answer.count
    together = {k: answer.labels[part == k][0] for k in range(len(parts) + 1) if (part == k).any()}
    return [min(j for j, label in together.items() if label == together[k]) for k in together]


CUP = (wall(0, 0, 0.045, 0, 0.1), wall(0, 0, 0.045, 0, 0.1, inner=True))
BOWL_WITH_BOTTOM = (wall(0, 0, 0.09, 0, 0.1), wall(0, 0, 0.09, 0, 0.1, inner=True), disc(0, 0, 0.09, 0.002))
LIDDED = (wall(0, 0, 0.05, 0, 0.09), disc(0, 0, 0.05, 0.09))
HALVES = (front(-0.04, 0, 0.08, 0.15), front(0.04, 0.001, 0.08, 0.15))


def bulge(x: float, y: float, radius: float, width: float, high: float) -> Surface:
    """A strip of an upright cylinder that hardly bulges towards the camera: the inside of a cup without some depth."""
    cylinder = wall(x, y + radius, radius, 0, high)

    def hit(origin: Array, direction: Array) -> Array:
        t = cylinder(origin, direction)
        return np.where(abs(origin[0] + t * direction[..., 0] - x) <= width / 2, t, np.inf)

    return hit


FLAT_CUP = (wall(0, 0, 0.045, 0, 0.1), bulge(0, 0, 0.2, 0.08, 0.1))
MOVED_ASIDE = (wall(0, 0, 0.045, 0, 0.1), bulge(0.025, 0, 0.2, 0.08, 0.1))
MOVED_BACK = (wall(0, 0, 0.03, 0, 0.1), bulge(0, 0.06, 0.2, 0.056, 0.1))
CUT_BOWL = (wall(0, -0.26, 0.09, 0, 0.1, inner=True), disc(0, -0.26, 0.09, 0.002))
"""So near that the image ends within its bottom: its wall is out of sight."""


def and_a_board(part: Surface) -> Surface:
    """The surface and a board to the right of it, as one."""
    return lambda o, d: np.minimum(part(o, d), front(0.25, 0.1, 0.1, 0.1)(o, d))


CUT_ANGLE = (and_a_board(CUT_BOWL[0]), CUT_BOWL[1])
"""What surrounds the table there on three sides and leaves most of its hull free is no bowl."""


def both_cans(x: float, y: float) -> tuple[Surface, ...]:
    """Two solid cans of one height, the second one moved."""
    return tuple(
        lambda o, d, at=at: np.minimum(wall(*at, 0.035, 0, 0.1)(o, d), disc(*at, 0.035, 0.1)(o, d))
        for at in ((0, 0), (x, y))
    )


BOXES_BEHIND_EACH_OTHER = (front(0, 0, 0.1, 0.12), front(0.02, 0.08, 0.1, 0.12))


def cuboid(y: float) -> Surface:
    """A box of 8 x 8 x 10 cm, its front at distance y."""
    face, top = front(0, y, 0.08, 0.1), rectangle(0, y, 0.08, 0.08, 0.1)
    return lambda o, d: np.minimum(face(o, d), top(o, d))


@pytest.mark.parametrize(
    ("parts", "together"),
    [
        pytest.param(CUP, [0, 1, 1], id="cup"),
        pytest.param(BOWL_WITH_BOTTOM, [0, 1, 1, 1], id="bowl whose bottom lies on the table"),
        pytest.param(FLAT_CUP, [0, 1, 1], id="cup whose inside looks flat"),
        pytest.param(CUT_BOWL, [0, 1, 1], id="bowl that the image cuts"),
        pytest.param(CUT_ANGLE, [0, 1, 2], id="table in the bend of something that the image cuts"),
        pytest.param(MOVED_ASIDE, [0, 1, 2], id="something flat beside a can"),
        pytest.param(MOVED_BACK, [0, 1, 2], id="something flat farther behind a can than that is wide"),
        pytest.param(HALVES, [0, 1, 1], id="a face cut in two"),
        pytest.param(both_cans(0.075, 0), [0, 1, 2], id="two cans side by side"),
        pytest.param(both_cans(0.02, 0.08), [0, 1, 2], id="a can behind a can"),
        pytest.param(BOXES_BEHIND_EACH_OTHER, [0, 1, 2], id="a box behind a box"),
        pytest.param((cuboid(-0.05), cuboid(0.04)), [0, 1, 2], id="a box 1 cm behind one of its height"),
        pytest.param((cuboid(-0.05), cuboid(0.045)), [0, 1, 2], id="a box 1.5 cm behind one of its height"),
    ],
)
def test_parts_are_joined_and_objects_are_not(parts: tuple[Surface, ...], together: list[int]) -> None:
    assert joined(sp.PRESETS["OBJECTS_2"], *parts) == together


@pytest.mark.parametrize(
    ("rules", "parts", "together"),
    [
        ({"vessel": Vessel()}, CUP, [0, 1, 1]),
        ({"cap": Cap(), "smooth": Smooth(), "enclosed": 0.9}, CUP, [0, 1, 2]),
        ({"vessel": Vessel()}, BOWL_WITH_BOTTOM, [0, 1, 1, 3]),
        ({"vessel": Vessel(min_hollow_back=-0.01)}, FLAT_CUP, [0, 1, 2]),
        ({"vessel": Vessel(min_solidity=1.0)}, FLAT_CUP, [0, 1, 2]),
        ({"vessel": Vessel()}, CUT_BOWL, [0, 1, 2]),
        ({"smooth": Smooth()}, HALVES, [0, 1, 1]),
        ({"vessel": Vessel(), "cap": Cap()}, HALVES, [0, 1, 2]),
        ({}, CUP, [0, 1, 2]),
    ],
)
def test_each_rule_can_be_switched_off(rules: dict, parts: tuple[Surface, ...], together: list[int]) -> None:
    rest = dict.fromkeys(("vessel", "cap", "smooth", "enclosed")) | rules
    config = sp.PRESETS["OBJECTS_1"].replace(additions={"joining": sp.settings.Joining(**rest)})
    assert joined(config, *parts) == together


@pytest.mark.filterwarnings("ignore:no support plane")
def test_nothing_is_joined_without_a_camera_or_a_support() -> None:
    frame, part = draw(*CUP)
    regions = Regions(part.astype(np.int32), 3)
    blind = sp.Frame(frame.color, frame.depth, None)
    assert join(regions, blind, sp.PRESETS["OBJECTS_2"]) is regions
    high = sp.PRESETS["OBJECTS_2"].replace(additions={"support": {"min_share": 1.0}})
    assert sp.trace(frame, high).plane is None
    assert join(regions, frame, high) is regions
    assert join(regions, frame, sp.PRESETS["OBJECTS_1"]) is regions


def test_joining_without_a_support_is_refused() -> None:
    with pytest.raises(sp.errors.ConfigError, match=r"joining requires additions\.support"):
        sp.TABLE.replace(additions={"joining": sp.settings.Joining()})


def test_a_cup_is_one_object_from_frame_to_answer() -> None:
    frame, part = draw(*CUP)
    objects = list(sp.segment(frame))
    assert len(objects) == 1
    truth = part > 0
    assert np.count_nonzero(objects[0].mask & truth) / np.count_nonzero(objects[0].mask | truth) > 0.85
    assert len(sp.segment(frame, sp.PRESETS["OBJECTS_1"])) == 2


def test_a_grid_of_sampling_holes_leaves_a_cup_whole() -> None:
    """Three quarters of the depth are missing, as where it was registered to a larger colour image; that is filled."""
    frame, part = draw(*CUP)
    depth = np.zeros_like(frame.depth)
    depth[::2, ::2] = frame.depth[::2, ::2]
    objects = list(sp.segment(sp.Frame(frame.color, depth, frame.camera)))
    truth = part > 0
    assert len(objects) == 1
    assert np.count_nonzero(objects[0].mask & truth) / np.count_nonzero(objects[0].mask | truth) > 0.8


def table_and_floor(table_share: float) -> Array:
    """Depth of a floor with a table-top 0.4 m above it that fills a share of the image's columns."""
    origin, direction = rays()
    floor, table = plane(-0.4)(origin, direction), plane(0.0)(origin, direction)
    depth = floor.copy()
    width = int(table_share * CAMERA.width)
    depth[:, :width] = table[:, :width]
    return depth.astype(np.float32)


@pytest.mark.parametrize(("share", "stacked", "on_table"), [(0.4, 0.5, True), (0.4, None, False), (0.25, 0.5, False)])
def test_the_support_is_the_table_and_not_the_floor(share: float, stacked: float | None, on_table: bool) -> None:
    found = find_support(table_and_floor(share), CAMERA, sp.settings.Support(stacked_share=stacked))
    assert found is not None
    assert found.offset_m == pytest.approx(DISTANCE_M if on_table else DISTANCE_M + 0.4, abs=0.005)


@pytest.mark.parametrize(("width", "hides_something"), [(0.25, True), (9.0, False)])
def test_what_stands_tall_and_hides_nothing_is_a_wall(width: float, hides_something: bool) -> None:
    """A board on the floor hides floor; the same stretch of an endless step in the floor hides nothing."""
    origin, direction = rays()
    upright = front(0.0, 0.1, width, 0.15)(origin, direction)
    behind = plane(0.0 if hides_something else 0.15, lambda x, y: y >= 0.1)(origin, direction)
    before = plane(0.0, lambda x, y: y < 0.1)(origin, direction)
    depth = np.minimum.reduce([upright, behind, before])
    x = origin[0] + depth * direction[..., 0]
    stretch = (depth == upright) & (abs(x) < 0.125)
    regions = Regions(naive.number_regions(stretch.reshape(-1).tolist()).reshape(stretch.shape), 2)
    region = int(regions.labels[stretch][0])
    hides = measure_stance(regions, depth.astype(np.float32), CAMERA, None, stretch, sp.settings.Wall(), None).hides
    assert (hides[region] >= sp.settings.Wall().min_hides) == hides_something
    low = measure_stance(
        regions, depth.astype(np.float32), CAMERA, None, np.zeros_like(stretch), sp.settings.Wall(), None
    )
    assert np.isnan(low.hides[region])
    assert np.isnan(low.lean_deg[region])


@pytest.mark.parametrize(("turn_deg", "is_side"), [(20.0, False), (75.0, True)])
def test_a_face_that_turns_away_is_the_side_of_a_compartment(turn_deg: float, is_side: bool) -> None:
    """A plane in the middle of the picture, turned about its vertical axis."""
    camera = sp.Camera(fx=300.0, fy=300.0, cx=79.5, cy=59.5, width=160, height=120)
    across = (np.arange(160) - 79.5) / 300.0
    row = 1.0 / (1.0 + across * np.tan(np.radians(turn_deg)))
    depth = np.broadcast_to(row, (120, 160)).astype(np.float32)
    labels = np.zeros((120, 160), np.int32)
    labels[40:80, 60:100] = 1
    stance = measure_stance(Regions(labels, 2), depth, camera, None, labels == 1, sp.settings.Wall(), None)
    assert stance.lean_deg[1] == pytest.approx(turn_deg, abs=1.0)
    assert (stance.lean_deg[1] > sp.settings.Wall().slant_deg) == is_side
    assert np.isnan(stance.lean_deg[0])


def test_a_frame_of_edges_is_no_second_support() -> None:
    origin, direction = rays()
    floor, lip = plane(-0.4)(origin, direction), plane(0.0)(origin, direction)
    depth = floor.copy()
    edge = np.ones(depth.shape, bool)
    edge[45:-45, 55:-55] = False
    depth[edge] = lip[edge]
    found = find_support(depth.astype(np.float32), CAMERA, sp.settings.Support(stacked_share=0.3))
    assert found is not None
    shares = np.count_nonzero(edge) / edge.size
    assert shares > 0.5  # the frame is the larger plane here: the floor is not above it
    wide = floor.copy()
    edge[30:-30, 35:-35] = False
    wide[edge] = lip[edge]
    found = find_support(wide.astype(np.float32), CAMERA, sp.settings.Support(stacked_share=0.3))
    assert found is not None
    assert found.offset_m == pytest.approx(DISTANCE_M + 0.4, abs=0.005)


@pytest.mark.parametrize("opaque", [True, False])
def test_the_front_of_a_shelf_supports_nothing(opaque: bool) -> None:
    """Boards and posts that frame what lies 0.4 m behind them, the larger plane of both."""
    origin, direction = rays()
    back, boards = plane(-0.4)(origin, direction), plane(0.0)(origin, direction)
    front_of_shelf = np.ones(back.shape, bool)
    for y in (20, 90, 160):
        for x in (25, 125, 225):
            front_of_shelf[y : y + 45, x : x + 70] = False
    assert 0.5 < front_of_shelf.mean() < 0.8
    depth = np.where(front_of_shelf, boards, back).astype(np.float32)
    found = find_support(depth, CAMERA, sp.settings.Support(opaque=opaque))
    assert found is not None
    assert found.offset_m == pytest.approx(DISTANCE_M + (0.4 if opaque else 0.0), abs=0.005)


@pytest.mark.parametrize(("left", "below", "right", "supports"), [(130, 90, 0, True), (70, 60, 70, False)])
def test_a_plane_that_surrounds_what_lies_below_it_on_three_sides_is_no_support(
    left: int, below: int, right: int, supports: bool
) -> None:
    """A table-top along sides of the image, the larger part of it; what it leaves free shows the floor, 0.4 m below."""
    origin, direction = rays()
    there = np.zeros(direction.shape[:2], bool)
    there[:, :left] = there[-below:] = there[:, there.shape[1] - right :] = True
    assert there.mean() > 0.55
    depth = np.where(there, plane(0.0)(origin, direction), plane(-0.4)(origin, direction)).astype(np.float32)
    for opaque in (False, True):
        found = find_support(depth, CAMERA, sp.settings.Support(opaque=opaque))
        assert found is not None
        on_table = supports or not opaque
        assert found.offset_m == pytest.approx(DISTANCE_M + (0.0 if on_table else 0.4), abs=0.005)


@pytest.mark.parametrize(("measured", "supports"), [(0.7, True), (0.5, False)])
def test_where_depth_is_sparse_no_more_lies_below_the_support_than_on_it(measured: float, supports: bool) -> None:
    """Three planes side by side, each farther off: below the first and largest lies more than on it."""
    origin, direction = rays()
    boards = [plane(height)(origin, direction) for height in (0.0, -0.4, -0.8)]
    across = np.arange(CAMERA.width) / CAMERA.width
    depth = np.select([across < 0.4, across < 0.71], boards[:2], boards[2]).astype(np.float32)
    depth[round(measured * CAMERA.height) :] = 0
    found = find_support(depth, CAMERA, sp.settings.Support(opaque=True))
    assert found is not None
    assert found.offset_m == pytest.approx(DISTANCE_M + (0.0 if supports else 0.4), abs=0.005)


def test_the_largest_plane_stays_if_every_plane_shows_points_below() -> None:
    """A board of holes alone: nothing else is large enough to support."""
    origin, direction = rays()
    board, below = plane(0.0)(origin, direction), plane(-0.4)(origin, direction)
    y, x = np.mgrid[: CAMERA.height, : CAMERA.width]
    holes = (y % 60 > 20) & (x % 80 > 30)
    depth = np.where(holes, below + 0.3 * np.sin(x / 9.0) * np.cos(y / 7.0), board).astype(np.float32)
    found = find_support(depth, CAMERA, sp.settings.Support(opaque=True))
    assert found is not None
    assert found.offset_m == pytest.approx(DISTANCE_M, abs=0.005)


@pytest.mark.parametrize(("most", "regions"), [(1000, 2), (2, 2), (1, 3)])
def test_a_border_without_any_step_is_looked_at(most: int, regions: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its sides are at one depth to the last bit, so that none lies behind the other; of too many regions none is."""
    monkeypatch.setattr(joining, "MOST_PARTS", most)
    depth = np.full((240, 320), 1.0, np.float32)
    depth[80:160, 100:220] = 0.9
    frame = sp.Frame(np.zeros((240, 320, 3), np.uint8), depth, sp.Camera(300, 300, 160, 120, 320, 240))
    labels = np.zeros((240, 320), np.int32)
    labels[80:160, 100:160], labels[80:160, 160:220] = 1, 2
    answer = join(Regions(labels, 3), frame, sp.PRESETS["OBJECTS_2"])
    assert answer.count == regions
