"""Every kernel equals its slow twin in naive.py: whole numbers and partitions exactly, the rest within 1e-6."""

from __future__ import annotations

import ast
import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import naive
import spigolo as sp
from spigolo import Camera, Frame
from spigolo.additions.plane import Plane
from spigolo.frames.registration import projection
from spigolo.kernels import (
    bands,
    borders,
    choosing,
    color,
    contours,
    costs,
    edges,
    features,
    halving,
    inpainting,
    lzf,
    merging,
    moments,
    outlines,
    polar,
    potts,
    rasterising,
    registration,
    rows,
    rvl,
    saliency,
    seeding,
    smoothing,
    sorting,
)
from spigolo.kernels import planes as kernel_planes
from spigolo.kernels.workspace import Workspace
from spigolo.settings.parameters import VGA_PX
from spigolo.stages.edges import SIGN_RULES, scharr_canny
from spigolo.stages.graph import OFFSETS, Graph
from spigolo.stages.regions import SortedEdges, partition

KERNELS = Path(color.__file__).parent
K_DV, K_DS = 4.5, 0.1
TOLERANCE = {"rtol": 1e-6, "atol": 1e-6}

# --- scenes ---------------------------------------------------------------------------------------------------


def _frame(name: str, depth: naive.Array, rgb: naive.Array | None = None) -> Frame:
    height, width = depth.shape
    rng = np.random.default_rng(len(name))
    rgb = rng.integers(0, 256, (height, width, 3), dtype=np.uint8) if rgb is None else rgb
    camera = Camera(300.0, 310.0, width / 2 - 0.3, height / 2 + 0.2, width, height)
    return Frame(rgb, depth.astype(np.float32), camera, name=name)


def _synthetic() -> dict[str, Frame]:
    rng = np.random.default_rng(1)
    size = (17, 23)
    random = rng.uniform(0.5, 4, size)
    few = rng.choice([0.0, 0.8, 0.81, 1.3], size)
    colors = rng.choice(np.array([0, 20, 255], np.uint8), (*size, 3))
    ramp = np.linspace(0.7, 0.9, 23)[None] + np.linspace(0, 0.05, 17)[:, None]
    crease = 1.0 + 0.01 * np.abs(np.arange(23) - 11)[None] - np.linspace(0, 0.1, 17)[:, None]
    scenes = {
        "random": _frame("random", random),
        "tied": _frame("tied", few, colors),
        "constant": _frame("constant", np.full(size, 1.25), np.full((*size, 3), 90, np.uint8)),
        "all missing": _frame("all missing", np.zeros(size)),
        "partly missing": _frame("partly missing", np.where(rng.random(size) < 0.3, 0, ramp)),
        "ramp": _frame("ramp", ramp),
        "crease": _frame("crease", crease),
    }
    for height, width in ((1, 1), (1, 9), (9, 1), (2, 2)):
        depth = np.where(rng.random((height, width)) < 0.2, 0, rng.uniform(0.9, 1.1, (height, width)))
        scenes[f"{height}x{width}"] = _frame(f"{height}x{width}", depth)
    return scenes


SYNTHETIC = _synthetic()
CROPS = [pytest.param(k, id=f"crop {k}", marks=pytest.mark.frames) for k in range(3)]


@pytest.fixture(params=[*SYNTHETIC, *CROPS])
def scene(request: pytest.FixtureRequest) -> Frame:
    if isinstance(request.param, str):
        return SYNTHETIC[request.param]
    return request.getfixturevalue("crops")[request.param]


@pytest.fixture
def rng(scene: Frame) -> np.random.Generator:
    return np.random.default_rng(scene.depth.size)


def integral(image: naive.Array, kind: type = np.float64) -> naive.Array:
    out = np.zeros((image.shape[0] + 1, image.shape[1] + 1), kind)
    out[1:, 1:] = image.astype(kind).cumsum(0).cumsum(1)
    return out


def random_radii(rng: np.random.Generator, shape: tuple[int, int], largest: int = 6) -> naive.Array:
    y, x = np.mgrid[: shape[0], : shape[1]]
    room = np.minimum.reduce([y, x, shape[0] - 1 - y, shape[1] - 1 - x])
    return np.minimum(rng.integers(0, largest + 1, shape), room).astype(np.int32)


# --- colour and weights ---------------------------------------------------------------------------------------


def points_of(rgb: naive.Array, k_dv: float = K_DV, k_ds: float = K_DS) -> naive.Array:
    out = np.empty((3, *rgb.shape[:2]), np.float32)
    color.hsv_points(rgb.astype(np.float32), k_dv, k_ds, out)
    return out


@pytest.mark.parametrize(("k_dv", "k_ds"), [(K_DV, K_DS), (1.0, 1.0), (0.2, 3.0)])
def test_hsv_points(scene: Frame, k_dv: float, k_ds: float) -> None:
    np.testing.assert_allclose(
        points_of(scene.color, k_dv, k_ds), naive.hsv_points(scene.color, k_dv, k_ds), **TOLERANCE
    )


@pytest.mark.parametrize(("k_dv", "k_ds"), [(K_DV, K_DS), (1.0, 1.0), (0.2, 3.0)])
def test_color_difference_by_points_equals_the_printed_one_by_hue_angle(k_dv: float, k_ds: float) -> None:
    corners = np.stack(np.meshgrid(*[[0, 100, 255]] * 3), -1).reshape(1, -1, 3)
    points = points_of(corners, k_dv, k_ds)
    for i in range(corners.shape[1]):
        for j in range(corners.shape[1]):
            printed = naive.color_difference(corners[0, i], corners[0, j], k_dv, k_ds)
            assert color.color_difference(*points[:, 0, i], *points[:, 0, j]) == pytest.approx(printed, abs=1e-6)


def _scale(depth: naive.Array) -> float:
    valid = depth[depth > 0]
    return 1.0 / float(np.ptp(valid)) if valid.size and np.ptp(valid) > 0 else 0.0


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("ends", ["max", "i"])
def test_saliency_plane(scene: Frame, rng: np.random.Generator, offset: tuple[int, int], ends: str) -> None:
    cue, k = rng.random(scene.shape, np.float32), (1.05, 1.5, 0.5)
    out = np.empty(scene.shape, np.float32)
    code = costs.ENDS_I if ends == "i" else costs.ENDS_MAX
    scale = _scale(scene.depth)
    costs.saliency_plane(points_of(scene.color), scene.depth, cue, scale, 0.001, *k, code, *offset, out)
    twin = naive.saliency_plane(scene.color, scene.depth, cue, scale, 0.001, K_DV, K_DS, k, ends, offset)
    np.testing.assert_allclose(out, twin, **TOLERANCE)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("ends", ["max", "i"])
def test_boundary_plane(scene: Frame, rng: np.random.Generator, offset: tuple[int, int], ends: str) -> None:
    cue, k = (rng.random(scene.shape) < 0.3).astype(np.float32), (7.5, 0.66)
    out = np.empty(scene.shape, np.float32)
    code = costs.ENDS_I if ends == "i" else costs.ENDS_MAX
    costs.boundary_plane(points_of(scene.color), scene.depth, cue, 2.0, 0.0028, *k, code, *offset, out)
    twin = naive.boundary_plane(scene.color, scene.depth, cue, 2.0, 0.0028, K_DV, K_DS, k, ends, offset)
    np.testing.assert_allclose(out, twin, **TOLERANCE)


# --- depth ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("step_factor", [0.5, 3.0, 18.0])
def test_mark_steps(scene: Frame, step_factor: float) -> None:
    out = np.empty(scene.shape, np.uint8)
    smoothing.mark_steps(scene.depth, 0.0028, step_factor, out)
    np.testing.assert_array_equal(out, naive.mark_steps(scene.depth, 0.0028, step_factor))


@pytest.mark.parametrize("max_radius", [0, 3, 40])
def test_smoothing_radius(scene: Frame, rng: np.random.Generator, max_radius: int) -> None:
    distance = rng.uniform(0, 12, scene.shape).astype(np.float32)
    out = np.empty(scene.shape, np.int32)
    smoothing.smoothing_radius(scene.depth, distance, 0.0028, 1500.0, max_radius, out)
    np.testing.assert_array_equal(out, naive.smoothing_radius(scene.depth, distance, 0.0028, 1500.0, max_radius))


@pytest.mark.parametrize("left_out", ["missing", "nothing", "more"])
def test_mean_boxes(scene: Frame, rng: np.random.Generator, left_out: str) -> None:
    mask = {
        "missing": scene.depth == 0,
        "nothing": np.zeros(scene.shape, bool),
        "more": (scene.depth == 0) | (rng.random(scene.shape) < 0.6),
    }[left_out]
    radius, out = random_radii(rng, scene.shape), np.empty(scene.shape, np.float32)
    smoothing.mean_boxes(scene.depth, integral(np.where(mask, 0, scene.depth)), integral(mask, np.int32), radius, out)
    np.testing.assert_allclose(out, naive.mean_boxes(scene.depth, mask, radius), **TOLERANCE)


@pytest.mark.parametrize("cap", [1, 3, 16, 60])
def test_distance_to_zero(scene: Frame, rng: np.random.Generator, cap: int) -> None:
    for share in (0.03, 0.3, 1.0):
        mask = (rng.random(scene.shape) > share).astype(np.uint8)
        out = np.empty(scene.shape, np.float32)
        smoothing.distance_to_zero(mask, cap, np.empty(scene.shape, np.int16), out)
        np.testing.assert_allclose(out, naive.distance_to_zero(mask, cap), **TOLERANCE)


def test_close_holes(scene: Frame, rng: np.random.Generator) -> None:
    holes = (rng.random(scene.shape) < 0.7) & (scene.depth == 0)
    out, numbers = scene.depth.copy(), np.flatnonzero(holes)
    inpainting.close_holes(out, numbers, 0.03, 0.03, np.empty(numbers.size, np.float32))
    np.testing.assert_allclose(out, naive.close_holes(scene.depth, holes, 0.03, 0.03), **TOLERANCE)


def runs_of(depth: naive.Array) -> tuple[naive.Array, naive.Array, int]:
    """Runs, the gap of each, and how many gaps."""
    runs = np.full((depth.size, 3), -1, np.int32)
    runs = runs[: inpainting.find_runs(depth, runs)]
    gaps = np.empty(len(runs), np.int32)
    return runs, gaps, inpainting.join_runs(runs, np.empty(len(runs), np.int32), gaps)


@pytest.fixture(params=[0.0, 0.3, 0.6])
def holed(scene: Frame, rng: np.random.Generator, request: pytest.FixtureRequest) -> naive.Array:
    """A depth map of which some more is missing."""
    return np.where(rng.random(scene.shape) < request.param, np.float32(0), scene.depth)


def test_find_and_join_runs(holed: naive.Array) -> None:
    runs, gaps, count = runs_of(holed)
    assert inpainting.find_runs(holed, np.empty((holed.size, 3), np.int32)) == len(runs)
    assert runs.tolist() == naive.find_runs(holed)
    assert inpainting.join_runs(runs, np.empty(len(runs), np.int32), gaps) == count
    assert gaps.tolist() == naive.join_runs(holed)


def test_measure_gaps(holed: naive.Array, rng: np.random.Generator) -> None:
    runs, gaps, count = runs_of(holed)
    area, on_border, radius = np.zeros(count, np.int64), np.zeros(count, np.uint8), np.zeros(count, np.float32)
    near, far = np.full(count, np.inf, np.float32), np.zeros(count, np.float32)
    inpainting.measure_gaps(holed, runs, gaps, area, near, far, on_border)
    twin = naive.measure_gaps(holed)
    assert (area.tolist(), near.tolist(), far.tolist(), on_border.view(bool).tolist()) == twin
    distance = rng.uniform(0.5, 9, holed.shape).astype(np.float32)
    inpainting.widest(distance, runs, gaps, radius)
    assert radius.tolist() == naive.widest(holed, distance)


# --- saliency and edges ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("surrounds", [[12, 24, 48, 28, 56, 112], [1], [2, 3]])
def test_center_surround(scene: Frame, surrounds: list[int]) -> None:
    gray = scene.color[:, :, 1].copy()
    on, off = np.empty(gray.shape, np.int32), np.empty(gray.shape, np.int32)
    saliency.center_surround(gray, integral(gray, np.int32), np.array(surrounds, np.int64), on, off)
    twin_on, twin_off = naive.center_surround(gray, surrounds)
    np.testing.assert_array_equal(on, twin_on)
    np.testing.assert_array_equal(off, twin_off)


def test_join_levels(scene: Frame, rng: np.random.Generator) -> None:
    for largest in (1, 2, 255, 1530):
        on, off = rng.integers(0, largest, (2, *scene.shape)).astype(np.int32)
        out = np.empty(scene.shape, np.uint8)
        saliency.join_levels(on, off, out)
        np.testing.assert_array_equal(out, naive.join_levels(on, off))


def test_steepest(scene: Frame, rng: np.random.Generator) -> None:
    for largest in (1, 40, 4080):
        gx, gy = rng.integers(-largest, largest + 1, (2, *scene.shape)).astype(np.int16)
        assert edges.steepest(gx, gy) == naive.steepest(gx, gy)


def _classify(scene: Frame, canny: naive.Array, gx: naive.Array, gy: naive.Array, **changes: object) -> None:
    k = scene.camera
    camera = (k.fx, k.fy, k.cx, k.cy)
    values: dict[str, object] = {
        "step_px": 3,
        "step_m": 0.03,
        "signed": False,
        "missing_is_boundary": False,
        "contact_px": 2,
        "low_deg": 56.0,
        "high_deg": 154.0,
        "sign_rule": "tangent",
    }
    values |= changes
    rule = SIGN_RULES[str(values["sign_rule"])]
    depth_boundary, contact = np.zeros(canny.shape, np.uint8), np.zeros(canny.shape, np.uint8)
    rest = list((values | {"sign_rule": rule}).values())
    edges.classify_edges(canny.astype(np.uint8), gx, gy, scene.depth, camera, *rest, depth_boundary, contact)
    twin = naive.classify_edges(canny, gx, gy, scene.depth, camera, **values)  # type: ignore[arg-type]
    np.testing.assert_array_equal(depth_boundary, twin[0])
    np.testing.assert_array_equal(contact, twin[1])


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"signed": True},
        {"missing_is_boundary": True},
        {"step_px": 1, "contact_px": 3, "step_m": 0.002},
        {"low_deg": 0.0, "high_deg": 179.5},
    ],
    ids=str,
)
def test_classify_edges(scene: Frame, rng: np.random.Generator, changes: dict[str, object]) -> None:
    gx, gy = rng.integers(-9000, 9000, (2, *scene.shape)).astype(np.int16)
    _classify(scene, rng.random(scene.shape) < 0.5, gx, gy, **changes)
    canny, gx, gy = scharr_canny(scene.color, sp.settings.EdgesConfig())
    _classify(scene, canny, gx, gy, **changes)


@pytest.mark.parametrize("sign_rule", ["x", "none"])
def test_classify_edges_by_other_sign_rules(scene: Frame, rng: np.random.Generator, sign_rule: str) -> None:
    gx, gy = rng.integers(-9000, 9000, (2, *scene.shape)).astype(np.int16)
    _classify(scene, rng.random(scene.shape) < 0.5, gx, gy, sign_rule=sign_rule)


@pytest.mark.parametrize("max_run", [0, 1, 2, 40])
def test_fill_shadows(scene: Frame, max_run: int) -> None:
    out = np.full(scene.shape, -1, np.float32)
    contours.fill_shadows(scene.depth, max_run, out)
    np.testing.assert_array_equal(out, naive.fill_shadows(scene.depth, max_run))


@pytest.mark.parametrize("noise_per_m", [0.0, 0.004])
@pytest.mark.parametrize("reach", [(1, 2), (3, 2), (4, 4)])
def test_mark_contours(scene: Frame, reach: tuple[int, int], noise_per_m: float) -> None:
    k, filled = scene.camera, naive.fill_shadows(scene.depth, 3)
    camera, limits = (k.fx, k.fy, k.cx, k.cy), (0.012, 0.007)
    steps, creases = np.zeros(scene.shape, np.uint8), np.zeros(scene.shape, np.uint8)
    rest = (reach[0], *limits, reach[1], 40.0, 150.0, noise_per_m)
    contours.mark_contours(scene.depth, filled, camera, *rest, steps, creases)
    twin_steps, twin_creases = naive.mark_contours(scene.depth, filled, camera, *rest)
    np.testing.assert_array_equal(steps, twin_steps)
    np.testing.assert_array_equal(creases, twin_creases)


# --- sorting --------------------------------------------------------------------------------------------------

WEIGHTS = {
    "random": np.random.default_rng(2).random(700, np.float32),
    "tied": np.random.default_rng(3).choice(np.float32([0, 1e-42, 0.25, 0.25000003, 1, np.inf]), 500),
    "constant": np.full(90, 0.5, np.float32),
    "infinite": np.full(9, np.inf, np.float32),
    "zero": np.zeros(33, np.float32),
    "falling": np.linspace(3e38, 0, 400, dtype=np.float32),
    "one": np.float32([0.5]),
    "none": np.float32([]),
}


@pytest.fixture(params=WEIGHTS)
def weights(request: pytest.FixtureRequest) -> naive.Array:
    return WEIGHTS[request.param]


def packed_edges(weights: naive.Array) -> naive.Array:
    return naive.pack(weights.reshape(1, -1), list(range(weights.size)))


@pytest.mark.parametrize(("shift", "bits"), [(0, 10), (10, 10), (20, 11), (22, 9), (8, 1)])
def test_scatter(weights: naive.Array, shift: int, bits: int) -> None:
    packed = np.random.default_rng(4).permutation(packed_edges(weights))
    for base in {0, int(packed.min()) >> 32 if packed.size else 0}:
        out, starts, mask = np.empty_like(packed), np.full(1 << bits, 7, np.uint32), (1 << bits) - 1
        sorting.scatter(packed, np.uint64(base), np.uint64(shift), np.uint64(mask), starts, out)
        assert out.tolist() == naive.scatter(packed, base, shift, mask)


@pytest.mark.parametrize("low", [0.0, 0.2])
def test_edges_are_sorted_by_weight_then_number(weights: naive.Array, low: float) -> None:
    weights = weights[weights >= np.float32(low)]
    edges = SortedEdges(weights.reshape(1, 1, -1), np.array([1], np.int64), Workspace())
    sorted_ = edges._radix_sort(packed_edges(weights), int(np.float32(low).view(np.uint32))) if weights.size else []
    expected = naive.pack(weights.reshape(1, -1), naive.sort_edges(weights)) if weights.size else []
    np.testing.assert_array_equal(sorted_, expected)


# --- merging --------------------------------------------------------------------------------------------------


def planes(kind: str, shape: tuple[int, int], connectivity: int = 8) -> naive.Array:
    """Weights (P, H, W) of a kind, +inf where an edge leaves the image."""
    count = connectivity // 2
    rng = np.random.default_rng(shape[0] * 100 + shape[1])
    full = (count, *shape)
    weights = {
        "random": rng.random(full),
        "tied": rng.choice([0.0, 0.1, 0.2], full),
        "zero": np.zeros(full),
        "constant": np.full(full, 0.3),
        "ramp": np.broadcast_to(np.linspace(0, 1, shape[1]), full),
        "steps": np.broadcast_to(np.arange(shape[0])[:, None] % 3 / 2, full),
    }[kind].astype(np.float32)
    for plane, (dy, dx) in zip(weights, OFFSETS, strict=False):
        for y, x in naive.pixels(plane):
            if not naive.inside(plane, y + dy, x + dx):
                plane[y, x] = np.inf
    return weights


KINDS = ["random", "tied", "zero", "constant", "ramp", "steps"]
SIZES = [(1, 1), (1, 8), (8, 1), (2, 2), (5, 6), (14, 19)]
GAMMAS = [0.0, 0.0016, 0.3, 5.0, 1e9]


def offsets_of(weights: naive.Array) -> naive.Array:
    return np.array([dy * weights.shape[2] + dx for dy, dx in OFFSETS[: len(weights)]], np.int64)


def sorted_numbers(weights: naive.Array) -> list[int]:
    """Numbers of the edges inside the image, in order."""
    flat = weights.reshape(-1)
    return [k for k in naive.sort_edges(flat) if flat[k] < np.inf]


def sorted_pack(weights: naive.Array) -> naive.Array:
    """The packed edges inside the image, in order."""
    return naive.pack(weights, sorted_numbers(weights))


def planted(weights: naive.Array, gamma: float) -> tuple[naive.Array, naive.Array, naive.Array]:
    """Parent, records and flags before any merge but over straight edges of weight 0."""
    pixels, width = weights[0].size, weights.shape[2]
    parent, records = np.empty(pixels, np.uint32), np.empty(pixels, np.uint64)
    flat, flags = weights.reshape(len(weights), -1), np.empty(pixels, np.uint8)
    merging.plant(flat, np.uint64(width), gamma, parent, records, flags)
    return parent, records, flags


def _merged(weights: naive.Array, gamma: float) -> tuple[naive.Array, naive.Array]:
    """Parent and records after merging."""
    parent, records, _ = planted(weights, gamma)
    merging.merge(sorted_pack(weights), offsets_of(weights).view(np.uint64), gamma, False, parent, records)
    return parent, records


@pytest.mark.parametrize("gamma", [*GAMMAS, 1e-50, 1e300])
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", KINDS)
def test_plant(kind: str, size: tuple[int, int], gamma: float) -> None:
    weights = planes(kind, size)
    weights[weights == 0] *= np.random.default_rng(1).choice([-1, 1], np.sum(weights == 0))
    parent, records, flags = planted(weights, gamma)
    roots, kept = naive.plant(weights, gamma)
    assert (parent.tolist(), records[parent].tolist()) == (roots, kept)
    assert flags.all()


@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", KINDS)
def test_merge(kind: str, size: tuple[int, int], gamma: float) -> None:
    weights = planes(kind, size)
    parent, records = _merged(weights, gamma)
    forest, roots = naive.merge(weights, gamma), naive.roots_of(parent)
    np.testing.assert_array_equal(naive.number_regions(roots), forest.labels())
    for pixel, root in enumerate(roots):
        component = forest.component[pixel]
        area = len(forest.members[component])
        assert int(records[root]) == naive.record(area, forest.internal[component] + gamma / area)


@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize("kind", KINDS)
def test_merge_stops_at_the_first_refusal(kind: str, gamma: float) -> None:
    weights = planes(kind, (9, 12))
    edges, steps = sorted_pack(weights), offsets_of(weights).view(np.uint64)
    parent, records, _ = planted(weights, gamma)
    done = merging.merge(edges, steps, gamma, True, parent, records)
    joined = np.full(weights.shape, np.float32(np.inf))
    for number in sorted_numbers(weights)[:done]:
        joined.reshape(-1)[number] = weights.reshape(-1)[number]
    assert naive.number_regions(naive.roots_of(parent)).tolist() == naive.merge(joined, 1e30).labels().tolist()
    if done < edges.size:
        before = parent.tolist(), records.tolist()
        merging.merge(edges[done : done + 1], steps, gamma, False, parent, records)
        roots = naive.roots_of(np.array(before[0]))
        assert naive.roots_of(parent) == roots
        assert len(set(roots)) > 1


@pytest.mark.parametrize("min_size", [0.0, 2.0, 7.5, 1e6])
@pytest.mark.parametrize("kind", KINDS)
def test_absorb_small(kind: str, min_size: float) -> None:
    weights = planes(kind, (11, 13))
    parent, records = _merged(weights, 0.4)
    merging.absorb_small(sorted_pack(weights), offsets_of(weights).view(np.uint64), min_size, parent, records)
    forest = naive.merge(weights, 0.4)
    naive.absorb_small(forest, weights, min_size)
    roots = naive.roots_of(parent)
    np.testing.assert_array_equal(naive.number_regions(roots), forest.labels())
    assert (records[roots] >> 32).min() >= min(min_size, parent.size)


@pytest.mark.parametrize("gamma", [0.02, 0.1, 0.3])
@pytest.mark.parametrize("kind", KINDS)
def test_drop_final(kind: str, gamma: float) -> None:
    weights = planes(kind, (14, 19))
    flat, low = weights.reshape(-1), 0.2
    steps = offsets_of(weights).view(np.uint64)
    lightest = naive.pack(weights, [k for k in sorted_numbers(weights) if flat[k] < low])
    parent, records, flags = planted(weights, gamma)
    merging.merge(lightest, steps, gamma, False, parent, records)
    roots = naive.roots_of(parent)
    parent[:] = roots
    wanted = [(n, i, j) for n, i, j in naive.numbered_edges(weights) if flat[n] >= low and roots[i] != roots[j]]
    edges = naive.pack(weights, [n for n, _, _ in wanted])
    bounds = (records & np.uint64(0xFFFFFFFF)).astype(np.uint32).view(np.float32)
    some = [(float(flat[n]), i, j) for n, i, j in wanted]
    kept = edges[naive.drop_final(some, roots, bounds, choosing.SAMPLE_STEP)].tolist() if some else []
    count = choosing.drop_final(edges, steps, parent, records, flags)
    assert edges[:count].tolist() == kept


def collected(
    weights: naive.Array, low: float, high: float, parent: naive.Array, flags: naive.Array, least: int, detours: bool,
    room: int,
) -> naive.Array | None:  # fmt: skip
    """What `collect` packs into memory for so many edges and one, None where it says that they do not fit."""
    out, flat = np.full(room + 2, 99, np.uint64), weights.reshape(len(weights), -1)
    limits = np.float32(low), np.float32(high)
    offsets, width = offsets_of(weights), weights.shape[2]
    count = choosing.collect(flat, width, *limits, parent, flags, least, offsets, detours, out[:-1])
    assert out[-1] == 99
    return None if count < 0 else out[:count]


@pytest.mark.parametrize("detours", [True, False])
@pytest.mark.parametrize("least", [0, 1, 2])
@pytest.mark.parametrize("window", [(0.0, 0.1), (0.1, 0.3), (0.2, np.inf)])
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", KINDS)
def test_collect(kind: str, size: tuple[int, int], window: tuple[float, float], least: int, detours: bool) -> None:
    for connectivity in (4, 8):
        weights = planes(kind, size, connectivity)
        weights[weights == 0] = -0.0
        pixels = weights[0].size
        parent = np.array(naive.roots_of(_merged(weights, 0.3)[0]), np.uint32)
        flags = np.random.default_rng(pixels).integers(0, 2, pixels).astype(np.uint8)
        low, high = map(float, np.float32(window))
        kept = naive.collect(weights, low, high, parent.tolist(), flags, least, detours)
        found = collected(weights, *window, parent, flags, least, detours, len(kept))
        np.testing.assert_array_equal(found, naive.pack(weights, kept))
        if kept:
            assert collected(weights, *window, parent, flags, least, detours, len(kept) - 1) is None


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("size", [(2, 2 * choosing.BLOCK + 3), (3 * choosing.BLOCK // 100, 100), (choosing.BLOCK, 2)])
def test_collect_takes_block_after_block(size: tuple[int, int], connectivity: int) -> None:
    weights = planes("tied", size, connectivity)
    pixels = weights[0].size
    parent, flags = np.arange(pixels, dtype=np.uint32), np.ones(pixels, np.uint8)
    kept = naive.collect(weights, 0.0, np.inf, parent.tolist(), flags, 2, False)
    found = collected(weights, 0.0, np.inf, parent, flags, 2, False, len(kept))
    np.testing.assert_array_equal(found, naive.pack(weights, kept))


@pytest.mark.parametrize("kind", KINDS)
def test_flag_open_and_flag_small(kind: str) -> None:
    weights = planes(kind, (9, 12))
    parent, records = _merged(weights, 0.3)
    roots, flags = naive.roots_of(parent), np.empty(parent.size, np.uint8)
    bounds = (records & np.uint64(0xFFFFFFFF)).astype(np.uint32).view(np.float32)
    for low in np.float32([0, 0.1, 0.3, 1]):
        choosing.flag_open(np.uint64(int(low.view(np.uint32))), parent, records, flags)
        assert flags.view(bool).tolist() == naive.flag_open(float(low), roots, bounds)
        assert parent.tolist() == roots
    for min_size in (1.0, 4.5, 1e9):
        choosing.flag_small(min_size, parent, records, flags)
        assert flags.view(bool).tolist() == naive.flag_small(min_size, roots)


@pytest.mark.parametrize("pixels", [1, 2, 50])
def test_number_regions(pixels: int) -> None:
    parent = np.array([np.random.default_rng(pixels).integers(0, k + 1) for k in range(pixels)], np.uint32)
    expected = naive.number_regions(naive.roots_of(parent))
    labels = np.empty(pixels, np.int32)
    assert merging.number_regions(parent, np.full(pixels, 9, np.uint32), labels) == expected.max() + 1
    np.testing.assert_array_equal(labels, expected)


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", KINDS)
def test_partition_equals_the_textbook(kind: str, size: tuple[int, int], gamma: float, connectivity: int) -> None:
    weights = planes(kind, size, connectivity)
    for min_size_px in (0.0, 4.0):
        regions = partition(Graph(weights), gamma, min_size_px)
        expected = naive.partition(weights, gamma, min_size_px)
        np.testing.assert_array_equal(regions.labels, expected)
        assert regions.count == expected.max() + 1


@pytest.mark.parametrize("room", [1, 20, 200])
@pytest.mark.parametrize("kind", KINDS)
def test_partition_where_edges_do_not_fit(kind: str, room: int, monkeypatch: pytest.MonkeyPatch) -> None:
    begin = SortedEdges.__init__

    def begin_cramped(self: SortedEdges, *args: Any) -> None:
        begin(self, *args)
        self._room = room

    monkeypatch.setattr(SortedEdges, "__init__", begin_cramped)
    for gamma in GAMMAS:
        test_partition_equals_the_textbook(kind, (14, 19), gamma, 8)


@pytest.mark.frames
@pytest.mark.parametrize("gamma", [0.0016, 0.5])
def test_partition_of_real_frames_equals_the_textbook(crops: list[Frame], gamma: float) -> None:
    for frame in crops:
        weights = np.empty((4, *frame.shape), np.float32)
        for plane, offset in zip(weights, OFFSETS, strict=True):
            cue, scale = np.zeros(frame.shape, np.float32), _scale(frame.depth)
            costs.saliency_plane(points_of(frame.color), frame.depth, cue, scale, 0.0, 1.0, 1.5, 0.5, 0, *offset, plane)
        min_size_px = 500 * frame.depth.size / VGA_PX
        regions = partition(Graph(weights), gamma, min_size_px)
        expected = naive.partition(weights, gamma, min_size_px)
        np.testing.assert_array_equal(regions.labels, expected)


# --- sums over regions ----------------------------------------------------------------------------------------


@pytest.fixture
def labels(scene: Frame, rng: np.random.Generator) -> naive.Array:
    scattered = rng.integers(0, min(5, scene.depth.size), scene.shape)
    return naive.number_regions(scattered.reshape(-1).tolist()).reshape(scene.shape)


def test_sum_regions(labels: naive.Array) -> None:
    count = int(labels.max()) + 1
    sums, boxes = np.zeros((count, 6)), np.zeros((count, 4), np.int32)
    moments.sum_regions(labels, sums, boxes)
    twin_sums, twin_boxes = naive.sum_regions(labels, count)
    np.testing.assert_array_equal(sums, twin_sums)
    np.testing.assert_array_equal(boxes, twin_boxes)


def test_sum_depth(scene: Frame, labels: naive.Array) -> None:
    count, k = int(labels.max()) + 1, scene.camera
    sums, camera = np.zeros((count, 4)), (k.fx, k.fy, k.cx, k.cy)
    moments.sum_depth(labels, scene.depth, camera, sums)
    np.testing.assert_allclose(sums, naive.sum_depth(labels, scene.depth, camera, count), **TOLERANCE)


def test_spread(labels: naive.Array, rng: np.random.Generator) -> None:
    of_region, out = rng.integers(-9, 9, int(labels.max()) + 1, np.int32), np.empty_like(labels)
    moments.spread(of_region, labels, out)
    np.testing.assert_array_equal(out, naive.spread(of_region, labels))


def test_count_marked(labels: naive.Array, rng: np.random.Generator) -> None:
    count, mask = int(labels.max()) + 1, (rng.random(labels.shape) < 0.4).astype(np.uint8)
    counts = np.zeros(count, np.int64)
    moments.count_marked(labels, mask, counts)
    assert counts.tolist() == naive.count_marked(labels, mask, count)


@pytest.mark.parametrize("divisor", [1, 8])
def test_count_dark(scene: Frame, labels: naive.Array, divisor: int) -> None:
    count, dimmed = int(labels.max()) + 1, scene.color // np.uint8(divisor)
    counts = np.zeros(count, np.int64)
    moments.count_dark(labels, dimmed, counts)
    assert counts.tolist() == naive.count_dark(labels, dimmed, count)


def test_sum_contours(scene: Frame, labels: naive.Array, rng: np.random.Generator) -> None:
    boundary = rng.random(labels.shape, np.float32)
    sums = np.zeros((int(labels.max()) + 1, 2))
    moments.sum_contours(labels, boundary, sums)
    np.testing.assert_allclose(sums, naive.sum_contours(labels, boundary), **TOLERANCE)


# --- borders and planes ---------------------------------------------------------------------------------------


@pytest.fixture
def blocks(scene: Frame, rng: np.random.Generator) -> tuple[naive.Array, naive.Array]:
    """Labels in blocks, and the number of every region, -1 where it is left out."""
    y, x = np.mgrid[: scene.shape[0], : scene.shape[1]]
    labels = naive.number_regions(((y // 6) * 10 + x // 11).reshape(-1).tolist()).reshape(scene.shape)
    number = np.where(rng.random(labels.max() + 1) < 0.2, -1, 0)
    number[number == 0] = np.arange((number == 0).sum())
    return labels, number.astype(np.int32)


@pytest.mark.parametrize("reach", [1, 2, 4])
def test_sum_borders(
    scene: Frame, rng: np.random.Generator, blocks: tuple[naive.Array, naive.Array], reach: int
) -> None:
    (labels, number), boundary = blocks, rng.random(scene.shape, np.float32)
    count = int(number.max(initial=-1)) + 1
    sums = np.zeros((count, count, borders.SUMS))
    borders.sum_borders(labels, number, scene.depth, boundary, reach, 0.15, 0.02, sums)
    twin = naive.sum_borders(labels, number, scene.depth, boundary, reach, 0.15, 0.02)
    np.testing.assert_allclose(sums, twin, **TOLERANCE)


@pytest.mark.parametrize("margin", [0, 1])
def test_sum_hollows(scene: Frame, blocks: tuple[naive.Array, naive.Array], margin: int) -> None:
    labels, number = blocks
    sums = np.zeros((int(number.max(initial=-1)) + 1, 2))
    borders.sum_hollows(labels, number, scene.depth, 300.0, margin, sums)
    np.testing.assert_allclose(sums, naive.sum_hollows(labels, number, scene.depth, 300.0, margin), **TOLERANCE)


def test_a_row_that_ends_on_the_background_says_nothing_of_how_a_region_bulges() -> None:
    """The inside of a bowl, 20 mm deep and 0.1 m wide; the last pixel of its first row is of the wall behind."""
    across = np.linspace(-1, 1, 40)
    depth = np.tile((1.0 + 0.02 * (1 - across**2)).astype(np.float32), (6, 1))
    labels, number, sums = np.zeros(depth.shape, np.int32), np.zeros(1, np.int32), np.zeros((1, 2))
    borders.sum_hollows(labels, number, depth, 400.0, 0, sums)
    wanted = sums * 5 / 6
    depth[0, -1] = 1.8
    sums[:] = 0
    borders.sum_hollows(labels, number, depth, 400.0, 0, sums)
    np.testing.assert_allclose(sums, wanted, rtol=1e-5)
    assert 0.15 < sums[0, 0] / sums[0, 1] < 0.25


def test_collect_pairs(labels: naive.Array, rng: np.random.Generator) -> None:
    boundary = rng.random(labels.shape, np.float32)
    twin = naive.collect_pairs(labels, boundary)
    pairs, strength = np.zeros(len(twin) + 1, np.int64), np.zeros(len(twin) + 1, np.float32)
    assert borders.collect_pairs(labels, boundary, pairs, strength) == len(twin)
    ends = [(int(pair) >> 32, int(pair) & 0xFFFFFFFF) for pair in pairs[:-1]]
    assert sorted((*both, float(s)) for both, s in zip(ends, strength, strict=False)) == sorted(twin)
    few, weak = np.zeros(len(twin) // 2, np.int64), np.zeros(len(twin) // 2, np.float32)
    assert borders.collect_pairs(labels, boundary, few, weak) == len(twin)
    np.testing.assert_array_equal(few, pairs[: few.size])


@pytest.mark.parametrize("lengths_px", [(1, 2, 0), (2, 5, 3), (4, 10, 60)])
def test_sum_outlines(scene: Frame, blocks: tuple[naive.Array, naive.Array], lengths_px: tuple[int, int, int]) -> None:
    labels, shape = blocks[0], scene.depth.shape
    slope_x = np.linspace(-0.2, 0.3, shape[1]).astype(np.float32)
    slope_y, slope, offset = np.linspace(0.1, -0.4, shape[0]).astype(np.float32), np.float32(-0.7), np.float32(0.9)
    height = (slope_x + slope_y[:, None] + slope) * scene.depth + offset
    sums = np.zeros((int(labels.max()) + 1, outlines.SUMS))
    numbers = (0.0121, 0.0061, 0.0063, 0.0057)
    outlines.sum_outlines(labels, scene.depth, slope_x, slope_y, slope, offset, *lengths_px, *numbers, sums)
    twin = naive.sum_outlines(labels, scene.depth, height, lengths_px, numbers[:2], numbers[2:])
    np.testing.assert_array_equal(sums, twin)


@pytest.mark.parametrize("reach", [1, 3])
def test_sum_normals(
    scene: Frame, rng: np.random.Generator, blocks: tuple[naive.Array, naive.Array], reach: int
) -> None:
    labels, count = blocks[0], int(blocks[0].max()) + 1
    wanted = (rng.uniform(size=count) < 0.8).astype(np.uint8)
    sums, camera = np.zeros((count, 7)), (300.0, 310.0, 10.0, 12.0)
    kernel_planes.sum_normals(labels, scene.depth, wanted, camera, reach, sums)
    assert sums[:, 0].any() or min(scene.shape) < 20 or reach > 1
    np.testing.assert_allclose(sums, naive.sum_normals(labels, scene.depth, wanted, camera, reach), **TOLERANCE)


def _planes(rng: np.random.Generator, count: int) -> naive.Array:
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.column_stack([normals, rng.uniform(-1, 1, count)]).astype(np.float32)


def test_count_near(rng: np.random.Generator) -> None:
    points, planes = rng.uniform(-1, 1, (400, 3)).astype(np.float32), _planes(rng, 20)
    tolerance, counts = rng.uniform(0, 0.3, 400).astype(np.float32), np.zeros(20, np.int64)
    kernel_planes.count_near(points.T.copy(), planes, tolerance, counts)
    assert counts.tolist() == naive.count_near(points, planes, tolerance)


def test_measure_heights(scene: Frame, rng: np.random.Generator) -> None:
    for a, b, c, d in _planes(rng, 3).astype(np.float64):
        plane, out = Plane(np.array([a, b, c]), d), np.empty(scene.shape, np.float32)
        kernel_planes.measure_heights(scene.depth, *plane.slopes(scene.shape, scene.camera), np.float32(d), out)
        twin = naive.measure_heights(scene.depth, scene.camera.matrix, plane.normal, d)
        np.testing.assert_allclose(out, twin, atol=1e-5)


def test_tell_sides(scene: Frame, rng: np.random.Generator) -> None:
    for a, b, c, d in _planes(rng, 3).astype(np.float64):
        plane, out = Plane(np.array([a, b, c]), d), np.empty(scene.shape, np.uint8)
        slopes = plane.slopes(scene.shape, scene.camera)
        kernel_planes.tell_sides(
            scene.depth, *slopes, np.float32(d), np.float32(0.0081), np.float32(0.0056), out
        )  # fmt: skip
        twin = naive.tell_sides(scene.depth, scene.camera.matrix, plane.normal, d, 0.0081, 0.0056)
        assert np.count_nonzero(out != twin) <= 0.001 * out.size  # within rounding of a tolerance either may hold


# --- features and the Potts model ----------------------------------------------------------------------------------


@pytest.mark.parametrize("k_xy", [0.0, 1.0])
@pytest.mark.parametrize("offset", OFFSETS)
def test_feature_plane(scene: Frame, offset: tuple[int, int], k_xy: float) -> None:
    depth = np.where(scene.depth > 0, scene.depth * 100, np.nan)
    values = np.concatenate([scene.color.astype(np.float32).transpose(2, 0, 1), depth[None]]).astype(np.float32)
    out, apart = np.empty(scene.shape, np.float32), np.float32(k_xy**2 * (offset[0] ** 2 + offset[1] ** 2))
    features.feature_plane(values, apart, *offset, out)
    np.testing.assert_allclose(out, naive.feature_plane(values, k_xy, offset), **TOLERANCE)


@pytest.mark.parametrize("step", [(0.01, 0.05), (0.2, 0.0), (np.inf, 0.0)])
@pytest.mark.parametrize("offset", OFFSETS)
def test_interaction_plane(scene: Frame, offset: tuple[int, int], step: tuple[float, float]) -> None:
    distance, out = np.empty(scene.shape, np.float32), np.empty(scene.shape, np.float32)
    features.feature_plane(scene.color.astype(np.float32).transpose(2, 0, 1).copy(), np.float32(0), *offset, distance)
    potts.interaction_plane(distance, scene.depth, 70.0, 1.5, *step, 20.0, *offset, out)
    twin = naive.interaction_plane(distance, scene.depth, 70.0, 1.5, *step, 20.0, offset)
    np.testing.assert_allclose(out, twin, **TOLERANCE)


@pytest.mark.parametrize("temperature", [0.05, 1.0, 10.0])
@pytest.mark.parametrize("size", [(1, 1), (1, 6), (7, 1), (9, 12)])
def test_sweep(size: tuple[int, int], temperature: float) -> None:
    rng = np.random.default_rng(size[1])
    forces = (rng.integers(-16, 9, (4, *size)) / 8).astype(np.float32)  # sums of eighths are exact
    spins = rng.integers(0, 5, size).astype(np.int32)
    for number in range(3):
        twin, changed = naive.sweep(spins, forces, 6, temperature, 7, number)
        assert potts.sweep(spins, forces, 6, temperature, 7, number) == changed
        np.testing.assert_array_equal(spins, twin)


# --- registration ---------------------------------------------------------------------------------------------


def _turned(axis: tuple[float, float, float], translation: tuple[float, float, float]) -> naive.Array:
    """A transform by an axis times its angle in radians and a translation in metres."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = cv2.Rodrigues(np.array(axis, float))[0], translation
    return T


@pytest.mark.parametrize(
    ("T", "scale"),
    [
        pytest.param(np.eye(4), 1.0, id="identity"),
        pytest.param(_turned((0, 0, 0), (0.013, -0.004, 0.002)), 2.0, id="beside, upsampled"),
        pytest.param(_turned((0.1, -0.2, 0.3), (0.2, 0.1, 0.05)), 0.7, id="turned, downsampled"),
        pytest.param(_turned((0, 0, 0), (0.01, 0.02, -0.8)), 0.5, id="partly behind"),
    ],
)
def test_splat_depth(scene: Frame, T: naive.Array, scale: float) -> None:
    depth = np.ascontiguousarray(scene.depth[-32:, -40:])
    source = dataclasses.replace(scene.camera, width=depth.shape[1], height=depth.shape[0])
    target = source.scaled(max(int(source.width * scale), 1), max(int(source.height * scale), 1))
    out = np.zeros((target.height, target.width), np.float32)
    registration.splat_depth(depth, projection(source, target, T), 0.03, 0.03, out)
    twin = naive.splat_depth(depth, source.matrix, target.matrix, T, 0.03, 0.03, out.shape)
    np.testing.assert_allclose(out, twin, **TOLERANCE)


# --- boundaries from a point ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("radius", "least"), [(1, 0.5), (3, 2.0), (4, 12.0)])
def test_fit_sides(scene: Frame, rng: np.random.Generator, radius: int, least: float) -> None:
    depth = np.ascontiguousarray(scene.depth[:24, :24])
    disparity = np.divide(40, depth, out=np.zeros_like(depth), where=depth > 0)
    angle = np.arange(5) * (np.pi / 5)
    normals = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    edges_, direction = rng.integers(0, 2, (2, *depth.shape), dtype=np.uint8)
    direction *= rng.integers(0, 5, depth.shape, dtype=np.uint8)
    out = np.zeros((*depth.shape, 4), np.float32)
    polar.fit_sides(edges_, direction, normals, disparity, radius, 0.4 * radius, 0.01, least, out)
    twin = naive.fit_sides(edges_, direction, normals, disparity, radius, 0.4 * radius, 0.01, least)
    np.testing.assert_allclose(out, twin, rtol=1e-4, atol=1e-3)


@pytest.mark.parametrize("shape", [(1, 3), (2, 7), (9, 12), (24, 9)])
@pytest.mark.parametrize("kind", ["random", "few values", "constant", "edges and gaps"])
def test_closed_path(shape: tuple[int, int], kind: str) -> None:
    rng = np.random.default_rng(shape[0])
    for _ in range(10):
        costs = {
            "random": rng.uniform(0, 1, (2, *shape)),
            "few values": rng.choice([0.0, 1.0, 2.0], (2, *shape)),
            "constant": np.ones((2, *shape)),
            "edges and gaps": rng.choice([0.02, 0.4, 50.0], (2, *shape)),
        }[kind]
        radial, angular = costs.astype(np.float32)
        least, most = int(rng.integers(0, 2)), shape[1] - 1
        path = np.full(shape[0], -1, np.int32)
        cost = polar.closed_path(radial, angular, least, most, path)
        assert cost == pytest.approx(naive.closed_path(radial, angular, least, most), rel=1e-6)
        assert least <= path.min() and path.max() <= most
        ends = zip(path, np.roll(path, -1), strict=True)
        passed = sum(angular[t, min(a, b) : max(a, b)].sum(dtype=float) for t, (a, b) in enumerate(ends))
        assert radial[np.arange(shape[0]), path].sum(dtype=float) + passed == pytest.approx(cost, rel=1e-6)


# --- data sets ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(1, 1), (7, 11), (19, 16)])
def test_draw_mesh(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(shape[1])
    for _ in range(10):
        corners = rng.uniform(-4, max(shape) + 4, (12, 2))
        inverse = np.where(rng.random(12) < 0.1, 0, rng.uniform(0.3, 2, 12))
        points = np.column_stack([corners, inverse])
        triangles = rng.integers(0, 12, (9, 3), dtype=np.int32)
        out = np.zeros(shape, np.float32)
        rasterising.draw_mesh(points, triangles, out)
        np.testing.assert_allclose(out, naive.draw_mesh(points, triangles, shape), rtol=1e-5)


def test_draw_mesh_leaves_no_gap_between_triangles_that_meet_on_pixel_centres() -> None:
    points = np.array([[1, 1, 1], [5, 1, 1], [5, 5, 1], [1, 5, 1.0]])
    out = np.zeros((7, 7), np.float32)
    rasterising.draw_mesh(points, np.array([[0, 1, 2], [0, 2, 3]], np.int32), out)
    assert (out[1:6, 1:6] == 1).all() and out.sum() == 25


def lzf_stream(rng: np.random.Generator, parts: int) -> bytes:
    """Literals and copies drawn at random; every copy begins in what is there."""
    out, size = bytearray(), 0
    for _ in range(parts):
        if size == 0 or rng.random() < 0.4:
            length = int(rng.integers(1, 33))
            out += bytes([length - 1, *rng.integers(0, 256, length).tolist()])
        else:
            length, back = int(rng.integers(3, 60)), int(rng.integers(1, min(size, 8192) + 1)) - 1
            code = min(length - 2, 7)
            out += bytes([code << 5 | back >> 8, *([length - 9] if code == 7 else []), back & 255])
        size += length
    return bytes(out)


def test_unpack_lzf() -> None:
    rng = np.random.default_rng(8)
    for parts in (1, 2, 30, 300):
        packed = lzf_stream(rng, parts)
        wanted = naive.unpack_lzf(packed)
        out = np.zeros(len(wanted), np.uint8)
        assert lzf.unpack_lzf(np.frombuffer(packed, np.uint8).copy(), out)
        assert out.tobytes() == wanted
        assert not lzf.unpack_lzf(np.frombuffer(packed[:-1], np.uint8).copy(), out), "cut off"
        assert not lzf.unpack_lzf(np.frombuffer(packed, np.uint8).copy(), out[:-1]), "longer than was said"


@pytest.mark.parametrize("shape", [(6, 8), (7, 9), (1, 1), (5, 2)])
def test_halve_depth(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(3)
    for missing in (0.0, 0.3, 0.7, 1.0):
        depth = rng.uniform(0.5, 2, shape).astype(np.float32)
        depth[rng.random(shape) < missing] = 0
        out = np.empty(((shape[0] + 1) // 2, (shape[1] + 1) // 2), np.float32)
        halving.halve_depth(depth, out)
        np.testing.assert_array_equal(out, naive.halve_depth(depth))


def depth_runs(rng: np.random.Generator, size: int) -> np.ndarray:
    """Values near each other, in runs between zeros, and a few far apart."""
    values = np.clip(1000 + np.cumsum(rng.integers(-9, 10, size)), 1, 65535).astype(np.uint16)
    values[rng.random(size) < 0.02] = rng.integers(1, 65536)
    values[np.repeat(rng.random(size // 5 + 1) < 0.4, 5)[:size]] = 0
    return values


def test_unpack_rvl() -> None:
    rng = np.random.default_rng(9)
    extremes = np.array([65535, 1, 65535, 0, 0, 32768, 32767], np.uint16)
    for values in (extremes, np.zeros(40, np.uint16), *(depth_runs(rng, size) for size in (1, 7, 200, 3000))):
        packed = naive.pack_rvl(values)
        assert naive.unpack_rvl(packed, values.size) == values.tolist()
        words, out = np.frombuffer(packed, "<u4").astype(np.uint32), np.ones(values.size, np.uint16)
        assert rvl.unpack_rvl(words, out)
        np.testing.assert_array_equal(out, values)
        assert not rvl.unpack_rvl(words[:-1], out), "cut off"
        assert not rvl.unpack_rvl(words, np.ones(values.size + 99, np.uint16)), "shorter than was said"


def test_unpack_rvl_ends_on_any_words() -> None:
    rng, out = np.random.default_rng(10), np.zeros(500, np.uint16)
    endless = np.zeros(50, np.uint32), np.full(50, 0xFFFFFFFF, np.uint32), np.zeros(0, np.uint32)
    for words in (*endless, *(rng.integers(0, 2**32, 60, dtype=np.uint32) for _ in range(300))):
        fills = rvl.unpack_rvl(words, out)
        try:
            wanted = naive.unpack_rvl(words.astype("<u4").tobytes(), out.size)
        except StopIteration:
            wanted = []
        assert not fills or wanted == out.tolist()
        assert fills == (len(wanted) == out.size)


# --- seeded partition -----------------------------------------------------------------------------------------


def _seeded(rng: np.random.Generator, shape: tuple[int, int] = (14, 17)) -> tuple[naive.Array, ...]:
    """Labels, colour and depth of two objects that touch, with noise and holes in the depth."""
    labels = np.zeros(shape, np.int32)
    labels[3:10, 2:9], labels[5:13, 9:15] = 1, 2
    color = rng.integers(0, 90, (*shape, 3)).astype(np.uint8) + (40 * labels).astype(np.uint8)[..., None]
    depth = (1.0 - 0.1 * (labels > 0) + rng.normal(0, 0.004, shape)).astype(np.float32)
    depth[rng.random(shape) < 0.2] = 0
    return labels, color, depth


def _layers(labels: naive.Array, depth: naive.Array, width: int, hole_width: int) -> tuple[naive.Array, naive.Array]:
    layer, inner = np.empty(labels.shape, np.uint8), np.zeros(int(labels.max()) + 1, np.int32)
    bands.measure_layers(labels, (depth == 0).astype(np.uint8), width, hole_width, layer, inner)
    return layer, inner


@pytest.mark.parametrize("reach", [1, 3, 8])
def test_count_ramps(scene: Frame, blocks: tuple[naive.Array, naive.Array], reach: int) -> None:
    sums, numbers = np.zeros(2, np.int64), (np.float32(0.02), np.float32(0.03))
    bands.count_ramps(blocks[0], scene.depth, reach, *numbers, sums)
    assert sums.tolist() == naive.count_ramps(blocks[0], scene.depth, reach, 0.02, 0.03)


@pytest.mark.parametrize(("ramp", "smeared_px"), [([], 0), ([0.9], 1), ([0.95, 0.9, 0.85], 3)])
def test_a_ramp_is_as_wide_as_what_lies_between_both_depths(ramp: list[float], smeared_px: int) -> None:
    """A step of 0.2 m in every row, its middle pixels smeared."""
    row = [1.0] * (12 - len(ramp) // 2) + ramp + [0.8] * 12
    depth = np.tile(np.array(row, np.float32), (5, 1))
    labels = np.zeros(depth.shape, np.int32)
    labels[:, 12:] = 1
    sums = np.zeros(2, np.int64)
    bands.count_ramps(labels, depth, 8, np.float32(0.03), np.float32(0.02), sums)
    assert sums.tolist() == [5, 5 * smeared_px]


@pytest.mark.parametrize("widths", [(2, 4), (1, 1), (4, 2), (3, 20)])
@pytest.mark.parametrize("seed", range(4))
def test_measure_layers(seed: int, widths: tuple[int, int]) -> None:
    labels, _, depth = _seeded(np.random.default_rng(seed))
    layer, inner = _layers(labels, depth, *widths)
    twin_layer, twin_inner = naive.measure_layers(labels, depth == 0, *widths)
    np.testing.assert_array_equal(layer, twin_layer)
    assert inner.tolist() == twin_inner.tolist()


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (7, 13), (16, 16)])
@pytest.mark.parametrize("count", [1, 2, 40])
def test_border_pixels(shape: tuple[int, int], count: int, rng: np.random.Generator) -> None:
    labels = rng.integers(0, count, shape, np.int32)
    assert rows.border_pixels(labels).tolist() == naive.border_pixels(labels)
    checks = np.indices(shape).sum(0).astype(np.int32) % 2
    assert rows.border_pixels(checks).tolist() == (list(range(checks.size)) if checks.size > 1 else [])


@pytest.mark.parametrize("share", [0.0, 0.34, 0.6, 1.0])
def test_open_layers(scene: Frame, blocks: tuple[naive.Array, naive.Array], share: float) -> None:
    layer, inner = _layers(blocks[0], scene.depth, 2, 4)
    opened = np.full(layer.shape, 99, np.uint8)
    count = bands.open_layers(blocks[0], layer, inner, np.float32(share), opened)
    np.testing.assert_array_equal(opened, naive.open_layers(blocks[0], layer, inner, share))
    assert count == np.count_nonzero(opened)


def test_flag_columns(scene: Frame, rng: np.random.Generator) -> None:
    opened = (rng.random(scene.shape) < 0.5).astype(np.uint8)
    twin = naive.flag_columns(opened)
    bands.flag_columns(opened)
    np.testing.assert_array_equal(opened, twin)
    bands.flag_columns(opened)
    np.testing.assert_array_equal(opened, twin)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize(("memory", "carry"), [(0.5, 0.9), (0.0, 0.0)])
def test_grow_seeds(seed: int, memory: float, carry: float) -> None:
    labels, color, depth = _seeded(np.random.default_rng(seed))
    layer, inner = _layers(labels, depth, 2, 3)
    opened = np.empty(labels.shape, np.uint8)
    count = bands.open_layers(labels, layer, inner, np.float32(0.6), opened)
    out, left, source, step = labels.copy(), opened.copy(), np.empty(labels.size, np.int32), (0.018, 0.0083, 40.0)
    seeding.grow_seeds(color, depth, out, left, count, memory, carry, *map(np.float32, step), source)
    np.testing.assert_array_equal(out, naive.grow_seeds(color, depth, labels, opened, memory, carry, step))
    assert not left.any()
    where = np.flatnonzero(opened)
    assert not opened.reshape(-1)[source[where]].any()
    np.testing.assert_array_equal(out.reshape(-1)[where], labels.reshape(-1)[source[where]])


def test_follow_seeds(rng: np.random.Generator) -> None:
    before, after = (rng.integers(0, 3, (9, 11), np.int32) for _ in range(2))
    regions = rng.integers(0, 6, before.shape, np.int32)
    source = rng.integers(0, before.size, before.size, np.int32)
    out, areas = np.empty_like(regions), np.zeros(6, np.int64)
    seeding.follow_seeds(before, after, source, regions, out, areas)
    twin, twin_areas = naive.follow_seeds(before, after, source, regions)
    np.testing.assert_array_equal(out, twin)
    assert areas.tolist() == twin_areas


# --- all of them ----------------------------------------------------------------------------------------------


def kernel_names() -> dict[str, str]:
    """Module of every function that carries @kernel."""
    names = {}
    for path in sorted(KERNELS.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and any(ast.unparse(d) == "kernel" for d in node.decorator_list):
                assert node.name not in names, f"two kernels are named {node.name}"
                names[node.name] = path.stem
    return names


def test_every_kernel_has_a_twin_and_a_test_that_calls_both() -> None:
    tree = ast.parse(Path(__file__).read_text(encoding="utf-8"))
    called = {ast.unparse(node.func).removeprefix("kernel_") for node in ast.walk(tree) if isinstance(node, ast.Call)}
    names = kernel_names()
    assert len(names) >= 20
    assert [name for name in names if not hasattr(naive, name)] == []
    assert [name for name, module in names.items() if f"{module}.{name}" not in called] == []
    assert [name for name in names if f"naive.{name}" not in called] == []


OUTSIDE_THE_PIPELINE = {
    "splat_depth",
    "fit_sides",
    "closed_path",
    "draw_mesh",
    "unpack_lzf",
    "unpack_rvl",
}
"""The first is eq. 7 alone, which smoothing counts within eq. 8; the second makes frames; two are of methods, two of
data sets, and the last of recordings."""

COUNT_SIGNATURES = """
import importlib, json, sys
import numpy as np
import spigolo as sp

names, whole_numbers = json.loads(sys.argv[1]), json.loads(sys.argv[2])
rng = np.random.default_rng(5)
for height, width in ((60, 80), (97, 53)):
    depth = (1000 + 3 * np.add.outer(np.arange(height), np.arange(width))).astype(np.uint16)
    depth[20:30, 20:40] -= 150
    depth[40:43, 30:33] = 0
    color = rng.integers(0, 60, (height, width, 3), dtype=np.uint8)
    color[20:30, 20:40] += 150
    first = (height, width) == (60, 80)
    kind = int if whole_numbers and first else float
    camera = sp.Camera(kind(80), kind(80), kind(width // 2), kind(height // 2), width, height)
    frames = [sp.Frame(color, depth, camera, depth_scale=0.001), sp.Frame(color, depth / 1000.0, camera)]
    for preset in (sp.TABLE, sp.SHELF, sp.OBJECTS):
        sp.trace(frames[0 if first else 1], preset)
    sp.trace(frames[0 if first else 1], sp.OBJECTS.replace(additions={"resolution": "half"}))
    for method in sp.METHODS.values():
        method(frames[0 if first else 1])
found = {n: len(getattr(importlib.import_module(f"spigolo.kernels.{m}"), n).signatures) for n, m in names.items()}
print(json.dumps(found))
"""


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT", "0") != "0", reason="nothing is compiled")
@pytest.mark.parametrize("whole_numbers", [False, True], ids=["float intrinsics", "whole-number intrinsics"])
def test_every_kernel_is_compiled_for_one_signature(whole_numbers: bool) -> None:
    arguments = [json.dumps(kernel_names()), json.dumps(whole_numbers)]
    run = subprocess.run(
        [sys.executable, "-c", COUNT_SIGNATURES, *arguments], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    signatures = json.loads(run.stdout)
    assert {name: count for name, count in signatures.items() if count > 1} == {}
    assert {name for name, count in signatures.items() if count == 0} <= OUTSIDE_THE_PIPELINE
