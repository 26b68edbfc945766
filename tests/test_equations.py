"""One example per equation, worked by hand, and the options that a reading of the paper leaves open."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import naive
from spigolo import Camera
from spigolo.kernels import color, costs, edges, merging
from spigolo.kernels.smoothing import mean_boxes
from spigolo.methods.features import feature_graph
from spigolo.settings import BoundaryCost, Config, DepthConfig, EdgesConfig, SaliencyCost, Smoothing
from spigolo.stages.cues import Cues
from spigolo.stages.depth import missing_mask, prepare_depth, smooth
from spigolo.stages.edges import boundary_cue, classify, final_boundary, find_edges
from spigolo.stages.graph import Graph, weigh
from spigolo.stages.regions import partition
from spigolo.stages.saliency import power_law

Array = npt.NDArray[np.float32]


def approx(value: object) -> object:
    return pytest.approx(value, abs=1e-6)


def rows(*values: list[float]) -> Array:
    return np.array(values, np.float32)


# --- the plain weight ------------------------------------------------------------------------------------------


def plain_weights(k_xy: float) -> Array:
    """Of the edges right, down, down-right and up-right between four pixels, as (4, 2, 2)."""
    features = np.array([[[10, 13], [10, 10]], [[20, 24], [20, 20]], [[30, 30], [42, 30]]], np.float32)
    return feature_graph(features, connectivity=8, k_xy=k_xy).weights


def test_eq_01_plain_weight_of_colour() -> None:
    # pixels (10, 20, 30), (13, 24, 30); (10, 20, 42), (10, 20, 30)
    # right: sqrt(3^2 + 4^2 + 0) = 5, sqrt(12^2) = 12; down: sqrt(12^2) = 12, sqrt(3^2 + 4^2) = 5;
    # down-right: 0; up-right: sqrt(3^2 + 4^2 + 12^2) = 13
    right, down, falling, rising = plain_weights(k_xy=0.0)
    assert right.tolist() == [[5, np.inf], [12, np.inf]]
    assert down.tolist() == [[12, 5], [np.inf, np.inf]]
    assert falling[0, 0] == 0
    assert rising[1, 0] == 13


def test_eq_01_as_printed_with_coordinates() -> None:
    # the coordinates differ by 1 along rows and columns, by 1 and 1 along diagonals:
    # sqrt(5^2 + 1) = 5.0990195, sqrt(13^2 + 1 + 1) = 13.0766968, sqrt(0 + 1 + 1) = 1.4142136
    right, _, falling, rising = plain_weights(k_xy=1.0)
    assert (right[0, 0], falling[0, 0], rising[1, 0]) == (approx(5.0990195), approx(1.4142136), approx(13.0766968))


# --- partition ------------------------------------------------------------------------------------------------


def test_eq_02_internal_difference() -> None:
    # Four pixels in a row, edges 1/8, 1/2, 1/4; gamma = 8 lets all of them merge.
    # I(R) = max(1/8, 1/2, 1/4) = 1/2, and the bound that is kept is I + gamma / |R| = 1/2 + 8/4 = 2.5.
    row = np.float32([0.125, 0.5, 0.25, np.inf]).reshape(1, 1, 4)
    parent, records = np.arange(4, dtype=np.uint32), np.array([naive.record(1, 8.0)] * 4, np.uint64)
    merging.merge(naive.pack(row, [0, 2, 1]), np.array([1], np.uint64), 8.0, False, parent, records)
    record = int(records[naive.roots_of(parent)[0]])
    assert record == naive.record(4, 2.5)
    assert record == naive.record(4, 0.5 + 8.0 / 4)


def test_eq_03_merge_criterion() -> None:
    # I_a = 0.2, |a| = 10, I_b = 0.1, |b| = 50, gamma = 5: min(0.2 + 5/10, 0.1 + 5/50) = min(0.7, 0.2) = 0.2
    bounds = merging.merge_bound(0.2, 5.0, 10), merging.merge_bound(0.1, 5.0, 50)
    assert bounds == (approx(0.7), approx(0.2))
    assert merging.may_merge(0.2, *bounds)
    assert not merging.may_merge(0.21, *bounds)


@pytest.mark.parametrize(("second", "count"), [(1.0, 1), (1.25, 2)])
def test_eq_03_on_three_pixels(second: float, count: int) -> None:
    # gamma = 1. The first edge, 1/2, is at most 0 + 1/1 of both pixels: merge, I = 1/2.
    # The second one compares with min(1/2 + 1/2, 0 + 1/1) = 1: 1 merges, 1.25 does not.
    weights = np.full((2, 1, 3), np.inf, np.float32)
    weights[0, 0, :2] = 0.5, second
    assert partition(Graph(weights), gamma=1).count == count


# --- colour ---------------------------------------------------------------------------------------------------


def color_difference(first: tuple[float, ...], second: tuple[float, ...]) -> float:
    points = np.empty((3, 1, 2), np.float32)
    color.hsv_points(np.array([[first, second]], np.float32), 4.5, 0.1, points)
    return float(color.color_difference(*points[:, 0, 0], *points[:, 0, 1]))


def test_eq_04_color_difference() -> None:
    # k_dv = 4.5, k_ds = 0.1: the denominator is sqrt(20.25 + 0.01) = sqrt(20.26) = 4.501111
    # red and green: delta_v = 0, theta = 120, delta_s = 0.1 sqrt(1 + 1 + 1) = 0.173205; / 4.501111 = 0.038481
    assert color_difference((255, 0, 0), (0, 255, 0)) == approx(0.0384805)
    # black and white: delta_v = 4.5, delta_s = 0; 4.5 / 4.501111 = 0.999753
    assert color_difference((0, 0, 0), (255, 255, 255)) == approx(0.9997532)
    # hues 350 and 10: delta_h = 340, theta = 20, delta_s = 0.1 sqrt(2 - 2 cos 20) = 0.0347296; / 4.501111 = 0.0077158
    assert color_difference((255, 0, 42.5), (255, 42.5, 0)) == approx(0.0077158)
    # value 1 and 0.4 (102 / 255), saturation 1 and 0 (grey has no hue): delta_v = 4.5 * 0.6 = 2.7, delta_s = 0.1;
    # sqrt(7.29 + 0.01) / 4.501111 = 2.701851 / 4.501111 = 0.600263
    assert color_difference((255, 0, 0), (102, 102, 102)) == approx(0.6002632)


def test_eq_04_is_clipped_at_one() -> None:
    # black and red: sqrt(4.5^2 + 0.1^2) / sqrt(4.5^2 + 0.1^2) = 1; nothing is farther
    assert color_difference((0, 0, 0), (255, 0, 0)) == approx(1.0)
    assert color_difference((0, 0, 0), (255, 0, 0)) <= 1.0


# --- depth ----------------------------------------------------------------------------------------------------

WINDOW = rows(
    [2.0, 2.0, 2.0, 2.0, 2.0],
    [2.0, 0.0, 2.1, 2.0, 2.0],
    [2.0, 2.1, 2.0, 2.1, 2.0],
    [2.0, 2.0, 2.1, 2.0, 2.0],
    [2.0, 2.0, 2.0, 2.0, 2.0],
)
"""Around the centre: one missing pixel, four of 2.0 m and four of 2.1 m.

The missing pixel is sqrt 2 away: r = sqrt 2 / sqrt 2 = 1. Steps of 0.1 m are below 18 * 0.0028 * 2^2 = 0.2 m.
"""


def test_eq_05_plain_mean() -> None:
    # (4 * 2.0 + 4 * 2.1 + 0) / 3^2 = 16.4 / 9 = 1.822222
    assert smooth(WINDOW, Smoothing(mean="plain"))[2, 2] == approx(16.4 / 9)


def test_eq_06_binary_depth() -> None:
    assert missing_mask(rows([0.0, 1.5], [2.0, 0.0])).tolist() == [[True, False], [False, True]]


def test_eq_07_missing_pixels_in_a_window() -> None:
    # missing at (1, 1), (2, 3) and (0, 4): two of them within one pixel of the centre, three within two
    depth = np.full((5, 5), 2.0, np.float32)
    depth[[1, 2, 0], [1, 3, 4]] = 0
    for r, count in ((1, 2), (2, 3)):
        radius = np.zeros((5, 5), np.int32)
        radius[2, 2] = r
        plain, valid = (mean_of_centre(depth, left_out, radius) for left_out in (depth < 0, depth == 0))
        n = (2 * r + 1) ** 2  # sum / n in eq. 5, sum / (n - gamma_0) in eq. 8
        assert n * (1 - plain / valid) == pytest.approx(count, abs=1e-5)


def mean_of_centre(depth: Array, left_out: npt.NDArray[np.bool_], radius: npt.NDArray[np.int32]) -> float:
    out, total = np.empty_like(depth), cv2.integral(depth, sdepth=cv2.CV_64F)
    mean_boxes(depth, total, cv2.integral(left_out.view(np.uint8), sdepth=cv2.CV_32S), radius, out)
    return float(out[2, 2])


def test_eq_08_mean_of_valid_pixels() -> None:
    # gamma_0 = 1: 16.4 / (3^2 - 1) = 2.05
    smoothed = smooth(WINDOW, Smoothing(mean="valid"))
    assert smoothed[2, 2] == approx(2.05)
    assert smoothed[1, 1] == 0


def test_eq_08_without_depth_changes_nothing() -> None:
    assert (smooth(np.zeros((5, 5), np.float32), Smoothing()) == 0).all()


def test_eq_08_leaves_pixels_on_a_step_out_only_if_set() -> None:
    # Far from the camera the limit of a step is 18 * 0.0028 * 1^2 = 0.05 m: (3, 3) steps to its right neighbour, and
    # it lies sqrt 2 from the centre: r = 1. Window of the centre: eight of 1.0 and the stepping (3, 3) of 0.96.
    depth = np.ones((7, 7), np.float32)
    depth[3, 3], depth[3, 4] = 0.96, 1.03
    with_it = smooth(depth, Smoothing(skip_steps=False))[2, 2]
    without = smooth(depth, Smoothing(skip_steps=True))[2, 2]
    assert with_it == approx((8 * 1.0 + 0.96) / 9)
    assert without == approx(1.0)


def test_no_smoothing_changes_nothing() -> None:
    np.testing.assert_array_equal(prepare_depth(WINDOW, DepthConfig(smoothing=Smoothing(mean="none"))), WINDOW)


def test_eq_09_depth_difference() -> None:
    # |1.2 - 0.9| over a range of 2 m = 0.15; 3 m over 2 m is cut to 1; a missing end gives 0
    half, none = np.float32(0.5), np.float32(0)
    near, far, farther = np.float32([0.9, 1.2, 3.9])
    assert costs.depth_difference(far, near, half, none) == approx(0.15)
    assert costs.depth_difference(near, far, half, none) == approx(0.15)
    assert costs.depth_difference(near, farther, half, none) == 1.0
    assert costs.depth_difference(far, none, half, none) == 0.0
    assert costs.depth_difference(none, far, half, none) == 0.0
    # our addition: a difference within noise * nearer depth ^ 2 counts as none
    assert costs.depth_difference(far, near, half, np.float32(10)) == 0.0


# --- saliency -------------------------------------------------------------------------------------------------


def test_eq_10_power_law() -> None:
    # (0.2 / 0.4)^4 = 1/16, (0.4 / 0.4)^4 = 1, 0^4 = 0
    assert power_law(rows([0.2, 0.4, 0.0]), 4.0).tolist() == [[approx(0.0625), 1.0, 0.0]]
    # (0.2 / 0.4)^2 = 1/4; a map of zeros stays one
    assert power_law(rows([0.2, 0.4]), 2.0)[0, 0] == approx(0.25)
    assert power_law(rows([0.0, 0.0]), 4.0).tolist() == [[0.0, 0.0]]


def test_eq_11_saliency_of_a_vertex() -> None:
    # the power-law map at the vertex: 0.0625 at (0, 1)
    of_frame = Cues(rows([1.0, 1.0]), power_law(rows([0.4, 0.2]), 4.0), None)
    assert of_frame.delta_sal[0].tolist() == [1.0, approx(0.0625)]


# --- edges ----------------------------------------------------------------------------------------------------


def test_eq_12_depth_gradients() -> None:
    # rho+ = 1.50 - 1.42 = 0.08, rho- = 1.50 - 1.51 = -0.01; a missing end gives 0
    depth = rows([1.51, 1.50, 1.42, 0.0])
    assert edges.depth_gradient(depth, 0, 1, 0, 2, False) == approx(0.08)
    assert edges.depth_gradient(depth, 0, 1, 0, 0, False) == approx(-0.01)
    assert edges.depth_gradient(depth, 0, 1, 0, 3, False) == 0.0
    assert edges.depth_gradient(depth, 0, 3, 0, 2, False) == 0.0


def test_eq_13_depth_boundary() -> None:
    # t_rho = 0.03: one gradient of 0.08 is enough, 0.02 and -0.01 are texture, 0.03 itself is not below
    assert edges.is_depth_boundary(0.08, -0.01, 0.03, True)
    assert edges.is_depth_boundary(-0.01, 0.08, 0.03, True)
    assert not edges.is_depth_boundary(0.02, -0.01, 0.03, True)
    assert edges.is_depth_boundary(0.03, 0.0, 0.03, True)
    # seen from the near side both gradients are negative: only the unsigned reading finds the step
    assert not edges.is_depth_boundary(-0.08, -0.001, 0.03, True)
    assert edges.is_depth_boundary(-0.08, -0.001, 0.03, False)


def test_eq_14_back_projection() -> None:
    # K: f = 500, c = (320, 240). Pixel x = 420, y = 140 at 2 m: ((420 - 320) 2 / 500, (140 - 240) 2 / 500, 2)
    depth = np.zeros((480, 640), np.float32)
    depth[140, 420] = 2.0
    assert edges.back_project(depth, 140, 420, 500.0, 500.0, 320.0, 240.0) == (approx(0.4), approx(-0.4), 2.0)


def test_eq_15_direction_to_the_positive_side() -> None:
    # (1.3, 0.4, 2) - (1, 0, 2) = (0.3, 0.4, 0), of length 0.5
    assert edges.unit_vector((1.3, 0.4, 2.0), (1.0, 0.0, 2.0)) == (approx(0.6), approx(0.8), 0.0)


def test_eq_16_direction_to_the_negative_side() -> None:
    # (0, 0, 4) - (2, 1, 2) = (-2, -1, 2), of length 3; no direction where the points coincide
    assert edges.unit_vector((0.0, 0.0, 4.0), (2.0, 1.0, 2.0)) == (approx(-2 / 3), approx(-1 / 3), approx(2 / 3))
    assert edges.unit_vector((1.0, 1.0, 1.0), (1.0, 1.0, 1.0)) == (0.0, 0.0, 0.0)


UP, RIGHT = (-1, 0), (0, 1)
"""(n_y, n_x) of an edge that lies level and of one that stands upright."""


@pytest.mark.parametrize("rule", [edges.SIGN_X, edges.SIGN_TANGENT])
def test_eq_17_contact_angle(rule: int) -> None:
    # The foot of a box: its front rises, (0, -1, 0), the table comes nearer, (0, 0, -1).
    # cross = ((-1)(-1) - 0, 0, 0) = (1, 0, 0), dot = 0: atan2(1, 0) = 90
    assert edges.contact_angle_deg((0.0, -1.0, 0.0), (0.0, 0.0, -1.0), *UP, rule) == approx(90.0)
    # A leaning front: v- = (0, -1/2, -sqrt 3 / 2). |cross| = sqrt 3 / 2, dot = 1/2: atan2 = 60
    leaning = (0.0, -0.5, -np.sqrt(3) / 2)
    assert edges.contact_angle_deg((0.0, -1.0, 0.0), leaning, *UP, rule) == approx(60.0)


def test_eq_18_contact_boundary() -> None:
    # t_L = 56, t_H = 154, both included
    angles = (50.0, 56.0, 90.0, 154.0, 160.0, -90.0)
    assert [bool(edges.is_contact(a, 56.0, 154.0)) for a in angles] == [False, True, True, True, False, False]


@pytest.mark.parametrize("rule", [edges.SIGN_X, edges.SIGN_TANGENT])
def test_eq_19_internal_boundary(rule: int) -> None:
    # The upper front edge of a box: its top goes away, (0, 0, 1), its front goes down, (0, 1, 0).
    # cross = (0 * 0 - 1 * 1, 0, 0) = (-1, 0, 0), dot = 0: the angle is -90
    assert edges.contact_angle_deg((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), *UP, rule) == approx(-90.0)


def test_eq_19_by_the_printed_rule_tells_nothing_of_upright_edges() -> None:
    # n points right. Valley: v+ = (s, 0, -s), v- = (-s, 0, -s) with s = 1 / sqrt 2:
    # cross = (0, -s * -s - s * -s, 0) = (0, 1, 0), dot = -1/2 + 1/2 = 0. Ridge: cross = (0, -1, 0).
    s = np.sqrt(0.5)
    valley, ridge = ((s, 0.0, -s), (-s, 0.0, -s)), ((s, 0.0, s), (-s, 0.0, s))
    assert edges.contact_angle_deg(*valley, *RIGHT, edges.SIGN_TANGENT) == approx(90.0)
    assert edges.contact_angle_deg(*ridge, *RIGHT, edges.SIGN_TANGENT) == approx(-90.0)
    assert edges.contact_angle_deg(*valley, *RIGHT, edges.SIGN_X) == approx(90.0)
    assert edges.contact_angle_deg(*ridge, *RIGHT, edges.SIGN_X) == approx(90.0)


CAMERA = Camera(100.0, 100.0, 20.0, 20.0, 41, 41)


def upright_edges(depth: Array, config: EdgesConfig) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Both maps of a Canny edge along the middle column whose gradient points right."""
    canny = np.zeros(depth.shape, bool)
    canny[:, 20] = True
    gx, gy = np.full(depth.shape, 100, np.int16), np.zeros(depth.shape, np.int16)
    return classify(canny, gx, gy, depth, CAMERA, config)


def upright_crease(height_m: float) -> Array:
    """1 m in the middle column, `height_m` nearer (or farther, if negative) for each pixel beside it."""
    return np.float32(1.0) - np.abs(np.arange(-20, 21, dtype=np.float32)) * np.float32(height_m) * np.ones(
        (41, 1), np.float32
    )


def test_sign_rule_tangent_separates_an_upright_valley_from_a_ridge() -> None:
    rule = EdgesConfig(sign_rule="tangent", contact_low_deg=56, contact_high_deg=154)
    _, valley = upright_edges(upright_crease(0.01), rule)
    _, ridge = upright_edges(upright_crease(-0.01), rule)
    assert valley[8:-8, 20].all()
    assert not ridge.any()


def test_sign_rule_x_takes_every_upright_crease_for_a_contact() -> None:
    # the three points lie in one image row, so the x component of their cross product is 0, which is not below 0
    rule = EdgesConfig(sign_rule="x", contact_low_deg=56, contact_high_deg=154)
    skewed = upright_crease(-0.01) + np.linspace(0, 0.02, 41, dtype=np.float32)[None]
    _, ridge = upright_edges(skewed, rule)
    assert ridge[8:-8, 20].all()


def test_signed_step_misses_an_edge_seen_from_the_near_side() -> None:
    # The edge pixel is on the near side of a step of 10 cm: rho+ = 0, rho- = 1.0 - 1.1 = -0.1
    depth = np.ones((41, 41), np.float32)
    depth[:, :18] = 1.1
    unsigned, _ = upright_edges(depth, EdgesConfig(signed_step=False))
    signed, _ = upright_edges(depth, EdgesConfig(signed_step=True))
    assert unsigned[8:-8, 20].all()
    assert not signed.any()


@pytest.mark.parametrize("counts", [False, True])
def test_missing_depth_is_a_boundary_only_if_set(counts: bool) -> None:
    depth = np.ones((41, 41), np.float32)
    depth[:, :18] = 0
    found, contact = upright_edges(depth, EdgesConfig(missing_is_boundary=counts))
    assert found[8:-8, 20].all() == counts
    assert found.any() == counts
    assert not contact.any()


def test_an_edge_inside_a_hole_is_no_boundary_even_with_missing_depth_as_printed() -> None:
    # Eqs. 12, 13: rho is 0 - 0 on both sides
    found, contact = upright_edges(np.zeros((41, 41), np.float32), EdgesConfig(missing_is_boundary=True))
    assert not found.any() and not contact.any()


def test_missing_depth_as_printed_with_the_printed_sign() -> None:
    # The edge pixel has depth 1 m: rho is 1 - 0 on the missing side. An edge pixel without depth has rho = 0 - 1 < 0.
    config = EdgesConfig(missing_is_boundary=True, signed_step=True)
    beside, within = np.ones((41, 41), np.float32), np.ones((41, 41), np.float32)
    beside[:, :18], within[:, 16:23] = 0, 0
    assert upright_edges(beside, config)[0][8:-8, 20].all()
    assert not upright_edges(within, config)[0].any()


def test_eq_20_final_boundary() -> None:
    # 0 or 0, 0 or 1, 1 or 0, 1 or 1
    of_depth, of_contact = np.array([[False, False, True, True]]), np.array([[False, True, False, True]])
    assert final_boundary(of_depth, of_contact).tolist() == [[False, True, True, True]]


def test_eq_21_boundary_of_a_vertex() -> None:
    # the final map at the vertex: 1 on the boundary, 0 beside it
    lines = np.array([[False, True, False]])
    of_frame = Cues(rows([1.0, 1.0, 1.0]), None, boundary_cue(lines, EdgesConfig(boundary="thin")))
    assert of_frame.delta_bound.tolist() == [[0.0, 1.0, 0.0]]


def test_boundary_is_thin_or_soft() -> None:
    # a white half 20 cm in front of a black one
    image, depth = np.zeros((41, 41, 3), np.uint8), np.full((41, 41), 1.2, np.float32)
    image[:, 20:], depth[:, 20:] = 255, 1.0
    thin_config, soft_config = EdgesConfig(boundary="thin"), EdgesConfig(boundary="soft")
    thin, soft = (find_edges(image, depth, CAMERA, config) for config in (thin_config, soft_config))
    assert thin.final.any()
    np.testing.assert_array_equal(boundary_cue(thin.final, thin_config), thin.final.astype(np.float32))
    np.testing.assert_array_equal(soft.final, thin.final)
    boundary = boundary_cue(soft.final, soft_config)
    assert boundary.max() == 1.0
    assert (boundary[soft.final] > 0).all()
    assert np.count_nonzero(boundary) > 3 * np.count_nonzero(soft.final)


# --- weights --------------------------------------------------------------------------------------------------


def test_eq_22_first_cost() -> None:
    # d_hsv = 0.25, d_depth = 0.5, d_sal = 0.64; k_x = 1.05, k_y = 1.5, k_s = 0.5
    # k_y log2 1.25 = 1.5  * 0.321928 = 0.482892
    # k_x log2 1.5  = 1.05 * 0.584963 = 0.614211
    # k_s log2 1.64 = 0.5  * 0.713696 = 0.356848
    # 0.5 * 0.64^1.5 = 0.5 * 0.512 = 0.256; 0.5 * 0.25^1.5 = 0.5 * 0.125 = 0.0625
    # sum 1.772451 / (2 + 1.05 + 1.5 + 0.5) = 1.772451 / 5.05 = 0.350980
    assert costs.saliency_cost(0.25, 0.5, 0.64, 1.05, 1.5, 0.5) == approx(0.350980)


def test_eq_22_without_depth_keeps_color_and_saliency_alone() -> None:
    # d_depth = 0: (1.5 * log2 2 + 0.5 * log2 2) / 5.05 = 2 / 5.05
    assert costs.saliency_cost(1.0, 0.0, 1.0, 1.05, 1.5, 0.5) == approx(2 / 5.05)


def test_eq_23_second_cost() -> None:
    # d_hsv = 0.25, d_depth = 0.5, d_bound = 1; k_x = 7.5, k_b = 0.66
    # (7.5 * 0.5 * 0.321928 + 0.66) / 8.16 = (1.207230 + 0.66) / 8.16 = 1.867230 / 8.16 = 0.228827
    assert costs.boundary_cost(0.25, 0.5, 1.0, 7.5, 0.66) == approx(0.228827)


def first_weight(
    cost: SaliencyCost | BoundaryCost,
    depth: Array,
    cue: Array,
    depth_range: float | None = None,
    points: Array | None = None,
) -> float:
    """Of the edge from the first pixel to the right. cue: the one of single pixels that this cost reads."""
    of_frame = Cues(depth, cue, None) if isinstance(cost, SaliencyCost) else Cues(depth, None, cue)
    points = np.zeros((3, *depth.shape), np.float32) if points is None else points
    config = Config(depth=DepthConfig(depth_range=depth_range))
    return float(weigh(of_frame, points, cost, config).weights[0, 0, 0])


def test_eq_22_and_23_on_a_graph() -> None:
    # Two pixels at 1.0 and 1.5 m, points 0.25 apart; over a range of 1 m d_depth = 0.5: the numbers worked out above
    depth, points = rows([1.0, 1.5]), np.zeros((3, 1, 2), np.float32)
    points[1, 0, 1] = 0.25
    assert first_weight(SaliencyCost(), depth, rows([0.64, 0.0]), 1.0, points) == approx(0.350980)
    assert first_weight(BoundaryCost(), depth, rows([1.0, 0.0]), 1.0, points) == approx(0.228827)


def test_fixed_depth_range_does_not_ask_the_frame() -> None:
    # |1.0 - 1.5| over the frame's own 0.5 m is 1, over 2 m is 1/4. With k_y = k_s = 0, k_x = 1 and no colour
    # eq. 22 is log2(1 + d) / 3: 1/3 and 0.321928 / 3
    depth_alone = SaliencyCost(k_x=1, k_y=0, k_s=0)
    assert first_weight(depth_alone, rows([1.0, 1.5]), rows([0.0, 0.0])) == approx(1 / 3)
    assert first_weight(depth_alone, rows([1.0, 1.5]), rows([0.0, 0.0]), 2.0) == approx(0.321928 / 3)


def test_a_missing_end_gives_no_depth_difference() -> None:
    # both weights of this edge have depth in every term but the cue of single pixels, which is 0 here
    for depth in (rows([0.0, 1.5, 2.0]), rows([1.5, 0.0, 2.0])):
        assert first_weight(SaliencyCost(), depth, np.zeros_like(depth)) == 0.0
        assert first_weight(BoundaryCost(), depth, np.zeros_like(depth)) == 0.0


@pytest.mark.parametrize(("ends", "there", "back"), [("i", 0.0, 1.0), ("max", 1.0, 1.0)])
def test_cue_of_the_first_end_or_of_both(ends: str, there: float, back: float) -> None:
    # the cue stands at one end alone; without depth or colour eq. 23 is k_b d / (k_x + k_b), eq. 22 k_s d / (2 + ...)
    depth = rows([1.0, 1.0])
    for cue, share in ((rows([0.0, 1.0]), there), (rows([1.0, 0.0]), back)):
        assert first_weight(BoundaryCost(ends=ends), depth, cue) == approx(share * 0.66 / 8.16)
        assert first_weight(SaliencyCost(ends=ends), depth, cue) == approx(share * 0.5 / 5.05)
