"""What holds for every input, drawn by Hypothesis."""

from __future__ import annotations

import colorsys
import itertools
import math
import types
import typing
from collections.abc import Callable
from typing import Any, Literal

import cv2
import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from pydantic import BaseModel
from pydantic.fields import FieldInfo

import naive
from spigolo import Camera, Config, Frame
from spigolo.errors import ConfigError, UnitWarning
from spigolo.kernels import color, costs
from spigolo.settings import (
    Additions,
    AutoCost,
    BoundaryCost,
    ColorConfig,
    EdgesConfig,
    Facing,
    Inpainting,
    SaliencyConfig,
    SaliencyCost,
    Smoothing,
)
from spigolo.settings.presets import OBJECTS, from_toml
from spigolo.stages.color import color_points
from spigolo.stages.cues import Cues
from spigolo.stages.depth import find_gaps, inpaint_small_gaps, smooth
from spigolo.stages.edges import boundary_cue, find_edges
from spigolo.stages.graph import OFFSETS, Graph, weigh
from spigolo.stages.regions import partition
from spigolo.stages.saliency import saliency_cue

Array = naive.Array

shares = st.floats(0, 1)
weights_k = st.floats(0, 1e6)
seeds = st.integers(0, 2**32 - 1)


@st.composite
def depths(draw: st.DrawFn, least: int = 1, most: int = 28) -> Array:
    """A slanted plane or a constant, with noise or a step, and rectangles and specks of missing pixels."""
    height, width = draw(st.integers(least, most)), draw(st.integers(least, most))
    rng = np.random.default_rng(draw(seeds))
    y, x = np.mgrid[:height, :width]
    depth = draw(st.floats(0.3, 4)) + draw(st.floats(0, 0.02)) * x + draw(st.floats(0, 0.02)) * y
    depth += draw(st.sampled_from([0, 0.001, 0.5])) * rng.random((height, width))
    depth[:, draw(st.integers(0, width)) :] += draw(st.sampled_from([0.0, 0.02, 0.7]))
    for _ in range(draw(st.integers(0, 4))):
        top, left = draw(st.integers(0, height - 1)), draw(st.integers(0, width - 1))
        depth[top : top + draw(st.integers(1, 9)), left : left + draw(st.integers(1, 9))] = 0
    depth[rng.random((height, width)) < draw(st.sampled_from([0, 0.05, 0.4, 1]))] = 0
    return depth.astype(np.float32)


@st.composite
def images(draw: st.DrawFn, most: int = 24) -> Array:
    """Colours at random, few colours in blocks, or one alone."""
    shape = draw(array_shapes(min_dims=2, max_dims=2, max_side=most))
    rng = np.random.default_rng(draw(seeds))
    image = rng.integers(0, 256, (*shape, 3), dtype=np.uint8)
    block = draw(st.sampled_from([1, 5, most]))
    return np.ascontiguousarray(image.repeat(block, 0).repeat(block, 1)[: shape[0], : shape[1]])


def in_unit_range(cue: Array) -> bool:
    return bool(np.isfinite(cue).all() and (cue >= 0).all() and (cue <= 1).all())


# --- cues -----------------------------------------------------------------------------------------------------


@given(images(), st.floats(0.1, 8))
def test_saliency_is_a_share(image: Array, power: float) -> None:
    assert in_unit_range(saliency_cue(image, SaliencyConfig(power=power)))


@given(images(40), depths(40, 40), st.sampled_from(["soft", "thin"]))
def test_boundary_is_a_share_and_lies_on_canny_edges(image: Array, depth: Array, boundary: str) -> None:
    image = np.ascontiguousarray(np.resize(image, (40, 40, 3)))
    config = EdgesConfig(boundary=boundary)
    maps = find_edges(image, depth, Camera(80.0, 80.0, 20.0, 20.0, 40, 40), config)
    assert in_unit_range(boundary_cue(maps.final, config))
    assert not ((maps.depth_boundary | maps.contact_boundary) & ~maps.canny).any()


@given(depths(), st.floats(1e-3, 1e3))
def test_depth_difference_is_a_share_and_symmetric(depth: Array, scale: float) -> None:
    few = depth.reshape(-1)[:6]
    for a, b in itertools.product(few, repeat=2):
        there, back = (costs.depth_difference(i, j, np.float32(scale), np.float32(0)) for i, j in ((a, b), (b, a)))
        assert 0 <= there <= 1
        assert there == back


rgb_colors = st.tuples(*[st.integers(0, 255)] * 3)
hues = st.floats(0, 360)


def points_of(*rgb: tuple[float, ...], k_dv: float = 4.5, k_ds: float = 0.1) -> Array:
    out = np.empty((3, 1, len(rgb)), np.float32)
    color.hsv_points(np.array([rgb], np.float32), k_dv, k_ds, out)
    return out


def difference(a: tuple[float, ...], b: tuple[float, ...], **weights: float) -> float:
    points = points_of(a, b, **weights)
    return float(color.color_difference(*points[:, 0, 0], *points[:, 0, 1]))


def from_hsv(hue_deg: float, saturation: float, value: float) -> tuple[float, ...]:
    return tuple(255 * channel for channel in colorsys.hsv_to_rgb(hue_deg / 360 % 1, saturation, value))


@given(rgb_colors, rgb_colors)
def test_color_difference_is_a_symmetric_share(a: tuple[int, ...], b: tuple[int, ...]) -> None:
    assert 0 <= difference(a, b) <= 1
    assert difference(a, b) == difference(b, a)
    assert difference(a, a) == 0


@given(rgb_colors, rgb_colors)
def test_color_difference_knows_no_first_hue(a: tuple[int, ...], b: tuple[int, ...]) -> None:
    # one turn of the channels turns all hues by 120 degrees, swapping two of them mirrors hue at 0
    turned = difference((a[2], a[0], a[1]), (b[2], b[0], b[1]), k_dv=1.0, k_ds=1.0)
    mirrored = difference((a[0], a[2], a[1]), (b[0], b[2], b[1]), k_dv=1.0, k_ds=1.0)
    assert turned == pytest.approx(difference(a, b, k_dv=1.0, k_ds=1.0), abs=1e-6)
    assert mirrored == pytest.approx(difference(a, b, k_dv=1.0, k_ds=1.0), abs=1e-6)


@given(hues, shares, shares, st.sampled_from([-360, 360, 720]))
def test_a_full_turn_of_hue_is_nothing(hue: float, saturation: float, value: float, turn: int) -> None:
    assert difference(from_hsv(hue, saturation, value), from_hsv(hue + turn, saturation, value)) < 1e-6


@given(st.floats(0, 60), st.floats(0, 60), shares)
def test_hue_differences_across_zero_are_those_elsewhere(a: float, b: float, saturation: float) -> None:
    across = difference(from_hsv(-a, saturation, 1), from_hsv(b, saturation, 1), k_dv=1.0, k_ds=1.0)
    elsewhere = difference(from_hsv(150 - a, saturation, 1), from_hsv(150 + b, saturation, 1), k_dv=1.0, k_ds=1.0)
    assert across == pytest.approx(elsewhere, abs=1e-5)


@given(images(), st.floats(0, 3))
def test_color_points_are_finite_and_smoothing_keeps_a_plain_image(image: Array, sigma_px: float) -> None:
    assume(sigma_px == 0 or sigma_px > 0.05)
    assert np.isfinite(color_points(image, ColorConfig(sigma_px=sigma_px))).all()
    plain = np.broadcast_to(image[:1, :1], image.shape).copy()
    points = color_points(plain, ColorConfig(sigma_px=sigma_px))
    np.testing.assert_allclose(points, np.broadcast_to(points[:, :1, :1], points.shape), atol=1e-5)


# --- depth ----------------------------------------------------------------------------------------------------

smoothings = st.builds(
    Smoothing,
    mean=st.just("valid"),
    radius_per_error_px_m=st.floats(10, 1e5),
    step_factor=st.floats(0.1, 100),
    max_radius_px=st.integers(0, 12),
    skip_steps=st.booleans(),
)


@given(depths(), st.floats(0.25, 10, width=32), smoothings)
def test_constant_depth_is_a_fixed_point_of_smoothing(depth: Array, distance: float, config: Smoothing) -> None:
    constant = np.where(depth > 0, np.float32(distance), np.float32(0))
    np.testing.assert_array_equal(smooth(constant, config), constant)


@given(depths(), smoothings)
def test_missing_pixels_never_enter_a_mean(depth: Array, config: Smoothing) -> None:
    smoothed, valid = smooth(depth, config), depth > 0
    np.testing.assert_array_equal(smoothed == 0, ~valid)
    if valid.any():
        assert smoothed[valid].min() >= depth[valid].min() * (1 - 1e-6)
        assert smoothed[valid].max() <= depth[valid].max() * (1 + 1e-6)


@given(depths(), st.sampled_from(["plain", "none"]))
def test_no_way_of_smoothing_fills_a_missing_pixel(depth: Array, mean: str) -> None:
    assert (smooth(depth, Smoothing(mean=mean))[depth == 0] == 0).all()


@given(depths(), smoothings)
def test_smoothing_does_not_write_to_its_input(depth: Array, config: Smoothing) -> None:
    before = depth.copy()
    smooth(depth, config)
    inpaint_small_gaps(depth, Inpainting())
    np.testing.assert_array_equal(depth, before)


def beside_a_shadow() -> Array:
    """A wall at 1 m with a large shadow, and a small gap one pixel beside it."""
    depth = np.ones((28, 28), np.float32)
    depth[4:24, 4:18] = 0
    depth[12:15, 19:22] = 0
    return depth


@given(depths(3), st.integers(1, 60), st.floats(1, 8), st.booleans())
@example(beside_a_shadow(), 20, 8.0, False)
def test_inpainting_keeps_valid_pixels_and_stays_within_their_range(
    depth: Array, area_px: int, radius_px: float, sampling_holes: bool
) -> None:
    limits = Inpainting(max_area_px2=area_px, max_radius_px=radius_px, sampling_holes=sampling_holes)
    filled, valid = inpaint_small_gaps(depth, limits), depth > 0
    np.testing.assert_array_equal(filled[valid], depth[valid])
    new = filled[(filled != 0) & ~valid]
    if new.size:
        assert new.min() >= depth[valid].min() * (1 - 1e-5)
        assert new.max() <= depth[valid].max() * (1 + 1e-5)


@given(depths(3), st.integers(1, 60), st.floats(1, 8))
def test_inpainting_leaves_large_gaps_and_those_at_the_border(depth: Array, area_px: int, radius_px: float) -> None:
    limits = Inpainting(max_area_px2=area_px, max_radius_px=radius_px, sampling_holes=False)
    filled = inpaint_small_gaps(depth, limits)
    for gap in range(1, naive.flood(depth == 0, 8).max() + 2):
        there = naive.flood(depth == 0, 8) == gap - 1
        if depth[there].any():
            continue
        y, x = np.nonzero(there)
        at_border = {0} & {*y, *x} or depth.shape[0] - 1 in y or depth.shape[1] - 1 in x
        if at_border or y.size > area_px:
            assert not filled[there].any()


@given(depths(12))
def test_closing_holes_leaves_the_inside_of_a_shadow(depth: Array) -> None:
    filled = inpaint_small_gaps(depth, Inpainting(max_area_px2=0, max_radius_px=1, sampling_holes=True))
    side = 3
    for y in range(depth.shape[0] - side + 1):
        for x in range(depth.shape[1] - side + 1):
            if not depth[y : y + side, x : x + side].any():
                assert not filled[y : y + side, x : x + side].any()


@given(depths())
def test_gaps_are_the_connected_missing_pixels(depth: Array) -> None:
    gaps = find_gaps(depth)
    assert gaps.area_px.sum() == np.count_nonzero(depth == 0)
    for gap in range(len(gaps)):
        there = np.zeros(depth.shape, bool)
        there.reshape(-1)[gaps.pixels(gaps.gap_of_run == gap)] = True
        assert gaps.area_px[gap] == np.count_nonzero(there)
        assert not depth[there].any()
        assert np.unique(naive.flood(there, 8)[there]).size == 1
        rim = (cv2.dilate(there.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0) & (depth > 0)
        assert (gaps.near_m[gap], gaps.far_m[gap]) == ((depth[rim].min(), depth[rim].max()) if rim.any() else (0, 0))


# --- weights --------------------------------------------------------------------------------------------------


@given(weights_k, weights_k, weights_k)
def test_weights_are_one_where_all_cues_are(k_x: float, k_y: float, k_other: float) -> None:
    assert costs.saliency_cost(1.0, 1.0, 1.0, k_x, k_y, k_other) == pytest.approx(1, abs=1e-12)
    assume(k_x + k_other > 1e-300)
    assert costs.boundary_cost(1.0, 1.0, 1.0, k_x, k_other) == pytest.approx(1, abs=1e-12)


@given(shares, shares, shares, weights_k, weights_k, weights_k)
def test_costs_are_shares(d_hsv: float, d_depth: float, d_other: float, k_x: float, k_y: float, k_other: float) -> None:
    assert 0 <= costs.saliency_cost(d_hsv, d_depth, d_other, k_x, k_y, k_other) <= 1 + 1e-12
    assume(k_x + k_other > 1e-300)
    assert 0 <= costs.boundary_cost(d_hsv, d_depth, d_other, k_x, k_other) <= 1 + 1e-12


@given(depths(), st.one_of(st.none(), st.floats(0.01, 10)), st.sampled_from([4, 8]), seeds, st.data())
def test_graph_weights_are_shares_inside_the_image_and_infinite_outside(
    depth: Array, depth_range: float | None, connectivity: int, seed: int, data: st.DataObject
) -> None:
    rng = np.random.default_rng(seed)
    ends, k = data.draw(st.sampled_from(["i", "max"])), data.draw(st.floats(1e-3, 100))
    cost = data.draw(st.sampled_from([SaliencyCost(k_x=k, ends=ends), BoundaryCost(k_b=k, ends=ends)]))
    points = color_points(rng.integers(0, 256, (*depth.shape, 3), dtype=np.uint8), ColorConfig())
    cue = rng.random(depth.shape, np.float32)
    config = Config(depth={"depth_range": depth_range}, partition={"connectivity": connectivity})
    graph = weigh(Cues(depth, cue, cue), points, cost, config)
    assert graph.weights.shape == (connectivity // 2, *depth.shape)
    for plane, (dy, dx) in zip(graph.weights, OFFSETS, strict=False):
        is_inside = np.array(
            [[naive.inside(depth, y + dy, x + dx) for x in range(depth.shape[1])] for y in range(len(depth))]
        )
        assert in_unit_range(plane[is_inside])
        assert np.isposinf(plane[~is_inside]).all()


# --- regions --------------------------------------------------------------------------------------------------

sizes = st.tuples(st.integers(1, 12), st.integers(1, 12))
gammas = st.one_of(st.just(0.0), st.floats(1e-4, 10), st.floats(1e3, 1e9))
Pair = tuple[tuple[int, int], tuple[int, int]]


def planes_of(weight_of: dict[Pair, float], size: tuple[int, int], connectivity: int) -> Array:
    """The planes of a graph from the weight of every pair of neighbours, in either order."""
    planes = np.full((connectivity // 2, *size), np.inf, np.float32)
    for plane, (dy, dx) in zip(planes, OFFSETS, strict=False):
        for y, x in naive.pixels(plane):
            there = (y + dy, x + dx)
            weight = weight_of.get(((y, x), there), weight_of.get((there, (y, x))))
            plane[y, x] = np.inf if weight is None else weight
    return planes


def neighbours(size: tuple[int, int], connectivity: int) -> list[Pair]:
    image = np.empty(size)
    offsets = OFFSETS[: connectivity // 2]
    return [
        ((y, x), (y + dy, x + dx))
        for y, x in naive.pixels(image)
        for dy, dx in offsets
        if naive.inside(image, y + dy, x + dx)
    ]


@st.composite
def graphs(draw: st.DrawFn) -> tuple[Array, int]:
    """Planes with few or many different weights, and their connectivity."""
    size, connectivity = draw(sizes), draw(st.sampled_from([4, 8]))
    pairs = neighbours(size, connectivity)
    rng = np.random.default_rng(draw(seeds))
    levels = draw(st.sampled_from([1, 2, 5, 10**6]))
    values = rng.integers(0, levels, len(pairs)) / levels
    return planes_of(dict(zip(pairs, values.tolist(), strict=True)), size, connectivity), connectivity


@given(graphs(), gammas, st.floats(0, 30))
def test_regions_are_connected_and_numbered_without_gaps(
    graph: tuple[Array, int], gamma: float, min_size: float
) -> None:
    weights, connectivity = graph
    regions = partition(Graph(weights), gamma, min_size)
    assert regions.labels.shape == weights.shape[1:]
    assert np.unique(regions.labels).tolist() == list(range(regions.count))
    # areas of equal label are numbered in raster order, as regions are: each region is one of them
    np.testing.assert_array_equal(naive.flood(regions.labels, connectivity), regions.labels)
    areas = np.bincount(regions.labels.reshape(-1))
    assert regions.count == 1 or areas.min() >= min_size * (1 - 1e-9)


@given(graphs(), gammas, st.floats(0, 30))
def test_partition_is_the_textbook_one(graph: tuple[Array, int], gamma: float, min_size: float) -> None:
    weights, _ = graph
    expected = naive.partition(weights, gamma, min_size)
    np.testing.assert_array_equal(partition(Graph(weights), gamma, min_size).labels, expected)


FLIPS: dict[str, Callable[[tuple[int, int], tuple[int, int]], tuple[int, int]]] = {
    "left-right": lambda size, at: (at[0], size[1] - 1 - at[1]),
    "up-down": lambda size, at: (size[0] - 1 - at[0], at[1]),
}


@pytest.mark.parametrize("flip", FLIPS)
@given(sizes, st.sampled_from([4, 8]), gammas, st.floats(0, 30), seeds)
def test_merging_follows_a_flip(
    flip: str, size: tuple[int, int], connectivity: int, gamma: float, min_size: float, seed: int
) -> None:
    pairs, move = neighbours(size, connectivity), FLIPS[flip]
    distinct = (np.random.default_rng(seed).permutation(len(pairs)) / max(len(pairs), 1)).tolist()
    here = dict(zip(pairs, distinct, strict=True))
    there = {(move(size, a), move(size, b)): weight for (a, b), weight in here.items()}
    labels, flipped = (
        partition(Graph(planes_of(weight_of, size, connectivity)), gamma, min_size).labels
        for weight_of in (here, there)
    )
    back = np.array([flipped[move(size, at)] for at in naive.pixels(labels)])
    np.testing.assert_array_equal(naive.number_regions(back.tolist()), labels.reshape(-1))


# --- configuration --------------------------------------------------------------------------------------------


def values_of(annotation: Any, limits: dict[str, Any]) -> st.SearchStrategy[Any]:
    """Values of a field's type within its limits, read from the models themselves."""
    origin, parts = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        inner = parts[1].metadata if isinstance(parts[1], FieldInfo) else parts[1:]
        return values_of(parts[0], limits | limits_of(inner))
    if origin in (typing.Union, types.UnionType):
        return st.one_of([values_of(part, limits) for part in parts])
    low, high = limits.get("gt", limits.get("ge", 0)), limits.get("le", limits.get("lt"))
    if origin is tuple and Ellipsis not in parts:
        return st.tuples(*(values_of(part, limits) for part in parts))
    plain: dict[Any, Callable[[], st.SearchStrategy[Any]]] = {
        Literal: lambda: st.sampled_from(parts),
        tuple: lambda: st.lists(st.integers(1, 200), min_size=1, max_size=6).map(tuple),
        type(None): st.none,
        bool: st.booleans,
        int: lambda: st.integers(low, 1000 if high is None else high),
        float: lambda: st.floats(low, high, exclude_min="gt" in limits, allow_nan=False, allow_infinity=False),
        str: lambda: st.text(max_size=12),
    }
    return plain.get(origin or annotation, lambda: models(annotation))()


def limits_of(metadata: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for limit in metadata:
        found |= {name: getattr(limit, name) for name in ("ge", "gt", "le", "lt") if hasattr(limit, name)}
    return found


@st.composite
def models(draw: st.DrawFn, model: type[BaseModel]) -> BaseModel:
    """A valid instance; values that depend on each other are put in order."""
    values = {
        name: draw(values_of(field.annotation, limits_of(field.metadata))) for name, field in model.model_fields.items()
    }
    for low in [name for name in values if "_low" in name]:
        high = low.replace("_low", "_high")
        values[low], values[high] = sorted((values[low], values[high]))
    if "blur_px" in values:
        values["blur_px"] |= 1
    if model is Facing and values["up"] is not None:
        assume(1e-6 < math.hypot(*values["up"]) < math.inf)
    if model is BoundaryCost:
        assume(values["k_x"] + values["k_b"] > 0)
    if model is Config:
        gamma = draw(st.floats(0, 1e9)) if isinstance(values["cost"], AutoCost) else None
        values["partition"] = values["partition"].model_copy(update={"gamma_shadows": gamma})
    if model is Additions and values["support"] is None:
        values |= {"joining": None, "flats": None}
        values["rules"] = values["rules"].model_copy(update={"wall": None, "rim": None, "ledge": None})
    return model(**values)


@settings(max_examples=settings.default.max_examples // 4)  # a whole configuration is long to draw
@given(models(Config))
def test_toml_brings_every_configuration_back(config: Config) -> None:
    read = from_toml(config.to_toml())
    assert read == config
    assert read.digest == config.digest
    assert read.to_toml() == config.to_toml()


def test_an_upward_direction_of_no_length_is_refused() -> None:
    with pytest.raises(ConfigError, match="such as"):
        OBJECTS.replace(additions={"support": {"facing": {"up": (0.0, 0.0, 0.0)}}})


def test_what_is_switched_off_against_its_default_comes_back_switched_off() -> None:
    off = {"refinement": {"min_solidity": None}, "rules": {"wall": {"max_cut_ratio": None}}}
    config = OBJECTS.replace(additions=off)
    assert 'max_cut_ratio = "none"' in config.to_toml()
    assert from_toml(config.to_toml()) == config


@given(models(Config), st.text(max_size=5))
def test_digest_depends_on_values_but_not_on_names(config: Config, name: str) -> None:
    assert config.replace(name=name).digest == config.digest
    other = config.replace(**{"partition.connectivity": 12 - config.partition.connectivity})
    assert other.digest != config.digest


@pytest.mark.parametrize("surrounds", [(-5,), (12, -1)])
def test_negative_surrounds_are_refused(surrounds: tuple[int, ...]) -> None:
    with pytest.raises(ConfigError):
        SaliencyConfig(surrounds_px=surrounds)


# --- frames ---------------------------------------------------------------------------------------------------


def frame_of(depth: Array, image: Array | None = None, **more: Any) -> Frame:
    height, width = depth.shape
    image = np.zeros((height, width, 3), np.uint8) if image is None else image
    return Frame(image, depth, Camera(100.0, 100.0, width / 2, height / 2, width, height), **more)


depth_values = st.one_of(
    st.floats(0.125, 16, width=32),
    st.sampled_from([0.0, -0.0, np.nan, np.inf, -np.inf]),
    st.floats(-4, -0.125, width=32),
)


@given(arrays(np.float32, array_shapes(min_dims=2, max_dims=2), elements=depth_values), st.sampled_from(["f4", "f8"]))
def test_no_depth_becomes_zero(depth: Array, kind: str) -> None:
    negative = int(np.count_nonzero(depth < 0))
    if negative:
        with pytest.warns(UserWarning, match="negative depth"):
            frame = frame_of(depth.astype(kind))
    else:
        frame = frame_of(depth.astype(kind))
    valid = np.isfinite(depth) & (depth > 0)
    np.testing.assert_array_equal(frame.depth, np.where(valid, depth, np.float32(0)))
    assert frame.negative_depth == negative
    assert frame.depth.dtype == np.float32


LAYOUTS: dict[str, Callable[[Array], Array]] = {
    "plain": lambda a: a,
    "strided": lambda a: np.repeat(np.repeat(a, 2, 0), 3, 1)[::2, ::3],
    "reversed": lambda a: a[::-1, ::-1].copy()[::-1, ::-1],
    "Fortran": np.asfortranarray,
    "list": lambda a: a.tolist() if a.ndim == 2 else a,
}


@given(images(8), st.sampled_from(list(LAYOUTS)), st.sampled_from(["f2", "f4", "f8"]), st.booleans())
def test_any_layout_of_arrays_is_taken_and_owned(image: Array, layout: str, kind: str, read_only: bool) -> None:
    depth = (1 + image[:, :, 0] / np.float32(128)).astype(kind)
    given_image, given_depth = LAYOUTS[layout](image), LAYOUTS[layout](depth)
    for array in (given_image, given_depth):
        if read_only and isinstance(array, np.ndarray):
            array.flags.writeable = False
    frame = frame_of(depth, given_image) if layout == "list" else frame_of(given_depth, given_image)
    np.testing.assert_array_equal(frame.color, image)
    np.testing.assert_array_equal(frame.depth, depth.astype(np.float32))
    for own, theirs in ((frame.color, given_image), (frame.depth, given_depth)):
        assert own.flags.c_contiguous
        assert own.flags.writeable
        assert not np.shares_memory(own, theirs)


@pytest.mark.filterwarnings("ignore::spigolo.errors.UnitWarning")
@given(
    arrays(np.uint16, array_shapes(min_dims=2, max_dims=2)), st.sampled_from(["u2", "f4"]), st.integers(0, 2**16 - 1)
)
def test_what_a_mask_hides_is_missing(depth: Array, kind: str, hidden: int) -> None:
    masked = np.ma.masked_array(depth.astype(kind), np.arange(depth.size).reshape(depth.shape) % 3 == 0)
    masked.data[masked.mask] = hidden
    frame = frame_of(masked, depth_scale=0.001)
    np.testing.assert_array_equal(frame.depth, frame_of(masked.filled(0), depth_scale=0.001).depth)


within_reach = st.integers(0, 49_000)


@given(
    arrays(np.uint16, array_shapes(min_dims=2, max_dims=2), elements=within_reach),
    st.sampled_from([0.001, 0.0001, 0.00025]),
)
def test_integer_depth_is_scaled(depth: Array, scale: float) -> None:
    frame = frame_of(depth, depth_scale=scale)
    np.testing.assert_allclose(frame.depth, depth * scale, rtol=1e-6)
    np.testing.assert_array_equal(frame.depth == 0, depth == 0)


def test_a_depth_beyond_float32_counts_as_missing() -> None:
    with pytest.warns(UnitWarning, match=r"farther than 50 m, counts as missing \(at 50\.0% of the pixels\)"):
        assert frame_of(np.array([[1.0, np.finfo(np.float64).max]])).depth.tolist() == [[1.0, 0.0]]


def test_what_no_camera_measures_is_missing() -> None:
    depth = np.array([[1e-7, 2e-6, 1.0, 49.0, 51.0]], np.float32)
    with pytest.warns(UnitWarning, match=r"depth 51, farther than 50 m, counts as missing \(at 20\.0% of the pixels\)"):
        np.testing.assert_array_equal(frame_of(depth).depth > 0, [[False, True, True, True, False]])
    far = np.array([[0.9e8, 1.1e8]], np.float32)  # nothing within reach: the unit is wrong
    np.testing.assert_array_equal(frame_of(far).depth > 0, [[True, False]])
