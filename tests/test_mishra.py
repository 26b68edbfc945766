"""The object around a point (2009) and the simple objects of a frame (2012)."""

from __future__ import annotations

import pickle
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from conftest import load_frame
from spigolo import Camera, Frame
from spigolo.errors import ConfigError
from spigolo.kernels import polar
from spigolo.methods import METHODS, FixationConfig, Mishra2012, SimpleConfig, segment_around
from spigolo.methods.mishra2009 import _Around, contour_around, edge_map, innermost, inside, paint
from spigolo.methods.mishra2012 import Judge, count_votes
from spigolo.methods.ownership import find_boundary

SIZE = (240, 320)
BOXES = ((60, 60, 130, 140), (100, 190, 170, 260))
"""(y0, x0, y1, x1) of what stands on the table of `table`."""


def table(boxes: bool = True, prints: bool = True) -> Frame:
    """A slanted table with a printed sheet on it, and two boxes with prints, 6 cm nearer than the table behind them."""
    rng = np.random.default_rng(3)
    y, _ = np.mgrid[: SIZE[0], : SIZE[1]]
    depth = 1.3 - 0.001 * y
    color = np.full((*SIZE, 3), 120, np.uint8)
    if prints:
        cv2.rectangle(color, (20, 180), (120, 225), (230, 230, 40), -1)
    for k, (y0, x0, y1, x1) in enumerate(BOXES if boxes else ()):
        depth[y0:y1, x0:x1] = depth[y1, x0] - 0.06
        color[y0:y1, x0:x1] = (190, 60, 60 + 90 * k)
        if prints:
            cv2.circle(color, ((x0 + x1) // 2, (y0 + y1) // 2), 15, (250, 250, 250), 2)
    color = np.clip(color + rng.normal(0, 2, color.shape), 0, 255).astype(np.uint8)
    return Frame(color, depth.astype(np.float32), Camera(330.0, 330.0, 159.5, 119.5, SIZE[1], SIZE[0]))


def box(k: int) -> npt.NDArray[np.bool_]:
    mask = np.zeros(SIZE, bool)
    y0, x0, y1, x1 = BOXES[k]
    mask[y0:y1, x0:x1] = True
    return mask


def iou(a: npt.NDArray[np.bool_], b: npt.NDArray[np.bool_]) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.fixture(scope="module")
def frame() -> Frame:
    return table()


# --- one object around a point --------------------------------------------------------------------------------


@pytest.mark.parametrize("k", [0, 1])
@pytest.mark.parametrize("where", [(0.5, 0.5), (0.3, 0.35), (0.75, 0.3)])
def test_the_box_around_a_point_in_it(frame: Frame, k: int, where: tuple[float, float]) -> None:
    y0, x0, y1, x1 = BOXES[k]
    found = segment_around(frame, (int(y0 + where[0] * (y1 - y0)), int(x0 + where[1] * (x1 - x0))))
    assert iou(found.mask, box(k)) > 0.9


def test_a_print_is_found_only_where_depth_is_left_out(frame: Frame) -> None:
    y0, x0, y1, x1 = BOXES[0]
    point = ((y0 + y1) // 2, (x0 + x1) // 2)
    by_contrast = segment_around(frame, point, FixationConfig(depth=False))
    assert by_contrast.area_px < 0.3 * box(0).sum()
    assert iou(segment_around(frame, point).mask, box(0)) > 0.9


def test_a_point_outside_is_refused(frame: Frame) -> None:
    for point in ((-1, 0), (0, SIZE[1]), (SIZE[0], 0)):
        with pytest.raises(IndexError, match="expected a pixel"):
            segment_around(frame, point)


@pytest.mark.parametrize("point", [(0, 0), (239, 319), (0, 319), (120, 0)])
def test_a_point_in_the_corner_has_a_region(frame: Frame, point: tuple[int, int]) -> None:
    assert segment_around(frame, point).mask[point]


def test_other_parameters_leave_the_point_where_it_was() -> None:
    changed = _Around(FixationConfig(), (3, 4)).replace(blur_px=2.0)
    assert (changed.point, changed.config.blur_px) == ((3, 4), 2.0)


def test_the_closed_path_is_the_minimum_cut_that_crosses_each_ray_once() -> None:
    """An arc without limit from every pixel to the one nearer to the point keeps the inside in one piece per ray."""
    rng = np.random.default_rng(5)
    for rays, radii in ((3, 5), (7, 6), (12, 9)):
        radial, angular = rng.integers(1, 40, (2, rays, radii)).astype(np.float32)
        node = np.arange(rays * radii).reshape(rays, radii)
        source, sink, without_limit = rays * radii, rays * radii + 1, 10**6
        arcs = np.zeros((sink + 1, sink + 1), np.int32)
        for t in range(rays):
            arcs[source, node[t, 0]] = arcs[node[t, -1], sink] = without_limit
            for k in range(radii):
                arcs[node[t, k], node[(t + 1) % rays, k]] += int(angular[t, k])
                arcs[node[(t + 1) % rays, k], node[t, k]] += int(angular[t, k])
                if k > 0:
                    arcs[node[t, k - 1], node[t, k]] = int(radial[t, k])
                    arcs[node[t, k], node[t, k - 1]] = without_limit
        flow = maximum_flow(csr_array(arcs), source, sink).flow_value
        assert polar.closed_path(radial, angular, 1, radii - 1, np.empty(rays, np.int32)) == flow


# --- objects of a whole frame ---------------------------------------------------------------------------------


def test_both_boxes_are_objects_and_the_print_is_none(frame: Frame) -> None:
    found = Mishra2012()(frame)
    assert len(found) == 2
    assert [max(iou(o.mask, box(k)) for o in found) > 0.9 for k in (0, 1)] == [True, True]
    assert found.regions.count == 3


def test_nothing_is_found_on_an_empty_table() -> None:
    assert len(Mishra2012()(table(boxes=False))) == 0


def test_depth_tells_objects_from_prints() -> None:
    """Alike in colour, the boxes are found by depth alone; without it there is nothing to see."""
    drawn = table(prints=False)
    same = Frame(np.full_like(drawn.color, 99), drawn.depth, drawn.camera)
    by_depth = Mishra2012()(same).regions
    assert [max(iou(by_depth.labels == r, box(k)) for r in range(by_depth.count)) > 0.85 for k in (0, 1)] == [True] * 2
    assert Mishra2012(SimpleConfig(depth=False)).divide(same).regions.count == 1


def test_the_nearer_side_owns_a_depth_border(frame: Frame) -> None:
    config = SimpleConfig()
    boundary = find_boundary(frame.color, frame.depth, frame.camera, config)
    y0, x0, y1, x1 = BOXES[0]
    for y, columns, inwards in (
        ((y0 + y1) // 2, slice(x0 - 3, x0 + 3), 1),
        ((y0 + y1) // 2, slice(x1 - 3, x1 + 3), -1),
    ):
        owned = boundary.side[y, columns] != 0
        assert owned.any()
        towards = boundary.normal[y, columns, 1] * boundary.side[y, columns]
        assert (towards[owned] * inwards > 0.9).all()
    votes = count_votes(boundary, config)
    y, x = np.unravel_index(int(votes.argmax()), votes.shape)
    assert (box(0) | box(1))[y, x]


def test_a_contour_with_the_border_on_the_wrong_side_is_no_object(frame: Frame) -> None:
    boundary = find_boundary(frame.color, frame.depth, frame.camera, SimpleConfig())
    angle = np.arange(360) * (np.pi / 180)
    y0, x0, y1, x1 = BOXES[0]
    middle, half = ((y0 + y1) / 2, (x0 + x1) / 2), ((y1 - y0) / 2, (x1 - x0) / 2)
    reach = np.minimum(half[0] / np.maximum(abs(np.sin(angle)), 1e-9), half[1] / np.maximum(abs(np.cos(angle)), 1e-9))
    contour = np.stack([middle[0] + reach * np.sin(angle), middle[1] + reach * np.cos(angle)], axis=1)
    judge = Judge(boundary, SimpleConfig())
    assert judge.share(contour, (95, 100)) > 0.9
    assert judge.share(contour, (95, 2000)) < 0.8  # as if the inside lay to the right


def test_a_print_is_not_looked_at_again(frame: Frame) -> None:
    config = SimpleConfig()
    boundary = find_boundary(frame.color, frame.depth, frame.camera, config)
    edges, middle = edge_map(boundary, config), (202, 70)
    assert Judge(boundary, config)(edges, middle) is None
    found = Judge(boundary, config.replace(min_strong=0))(edges, middle)
    assert found is not None and found.strong < 0.1 and 4000 < found.mask.sum() < 5000


def test_missing_depth_is_no_evidence(frame: Frame) -> None:
    depth = frame.depth.copy()
    depth[:, 170:] = 0
    found = Mishra2012()(Frame(frame.color, depth, frame.camera))
    assert max(iou(o.mask, box(0)) for o in found) > 0.9
    assert all(iou(o.mask, box(1)) < 0.5 for o in found)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (2, 2), (12, 7), (40, 30)])
@pytest.mark.parametrize("missing", [0.0, 0.4])
def test_images_of_any_size(shape: tuple[int, int], missing: float) -> None:
    rng = np.random.default_rng(2)
    depth = np.where(rng.random(shape) < missing, 0, rng.uniform(0.8, 1.2, shape)).astype(np.float32)
    small = Frame(rng.integers(0, 256, (*shape, 3), dtype=np.uint8), np.maximum(depth, 0), None)
    if small.depth.any():
        assert Mishra2012()(small).labels.shape == shape
        assert segment_around(small, (0, 0)).mask[0, 0]


@pytest.mark.filterwarnings("ignore:the frame has no measured depth")
def test_without_depth_and_without_a_camera(frame: Frame) -> None:
    blind = Frame(frame.color, np.zeros(SIZE, np.float32), frame.camera)
    assert len(Mishra2012()(blind)) == 0
    assert segment_around(blind, (95, 100)).mask[95, 100]
    unknown = Mishra2012()(Frame(frame.color, frame.depth, None))
    assert [max(iou(o.mask, box(k)) for o in unknown) > 0.9 for k in (0, 1)] == [True, True]


def test_it_is_one_of_the_methods(frame: Frame) -> None:
    method = METHODS["mishra2012"]
    again = pickle.loads(pickle.dumps(method))
    assert (again.name, again.digest, again.parameters) == (method.name, method.digest, method.parameters)
    assert np.array_equal(np.asarray(again(frame)), np.asarray(method(frame)))
    fewer = method.replace(max_fixations=0)
    assert fewer.digest != method.digest and len(fewer(frame)) == 0
    with pytest.raises(ConfigError):
        method.replace(fixations=3)
    assert "mishra2009" not in METHODS


# --- parts ----------------------------------------------------------------------------------------------------


def test_regions_are_numbered_by_their_first_pixel_and_hidden_ones_are_left_out() -> None:
    masks = np.zeros((3, 4, 5), bool)
    masks[0, 1:3, 1:3], masks[1, :, 3:], masks[2, 1:4, 1:4] = True, True, True
    regions = paint(list(masks), (4, 5))
    assert regions.count == 3
    assert regions.labels.tolist() == [[0, 0, 0, 1, 1], *[[0, 2, 2, 2, 1]] * 3]


def test_innermost_and_inside() -> None:
    angle = np.arange(360) * (np.pi / 180)
    disc = inside(np.stack([40 + 20 * np.sin(angle), 50 + 20 * np.cos(angle)], axis=1), (90, 100))
    assert abs(int(disc.sum()) - np.pi * 20**2) < 100
    assert np.abs(np.subtract(innermost(disc), (40, 50))).max() <= 1


def test_an_edge_at_the_point_is_no_contour_around_it() -> None:
    edges = np.zeros((90, 100), np.float32)
    cv2.circle(edges, (50, 40), 3, 1.0, -1)
    cv2.circle(edges, (50, 40), 20, 0.9, 2)
    contour = contour_around(edges, (40, 50), FixationConfig())
    np.testing.assert_allclose(np.hypot(*(contour - (40, 50)).T), 20, atol=2)


@pytest.mark.frames
def test_most_objects_of_a_real_frame_are_found_from_their_innermost_point(data: Path) -> None:
    folder = data / "frames" / "hand-uoc" / "000001"
    real, labels = load_frame(folder), cv2.imread(str(folder / "label.png"), cv2.IMREAD_UNCHANGED)
    truth = [labels == k for k in np.unique(labels) if k not in (0, 255)]
    around = [iou(segment_around(real, innermost(mask)).mask, mask) for mask in truth]
    assert np.mean(np.array(around) > 0.7) >= 0.6
    regions = Mishra2012().divide(real).regions
    best = [max(iou(regions.labels == r, mask) for r in np.unique(regions.labels[mask])) for mask in truth]
    assert np.mean(best) > 0.6
