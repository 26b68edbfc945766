"""The kernels of the refinement against slow twins."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.refinement import enlarge_labels, refine_labels
from spigolo.kernels import seeding
from spigolo.settings import Refinement

MEMORY, CARRY, STEP_M, STEP_PER_M, STEP_WEIGHT = 0.5, 0.9, 0.018, 0.0083, 40.0


def naive_grow(color, depth, labels, opened, memory=MEMORY, carry=CARRY):
    """Prim's algorithm as a search of all edges for the lightest, the earliest found first among equals."""
    labels, opened, color = labels.copy(), opened > 0, color.astype(np.float32)
    tree = {(y, x): color[y, x] for y, x in zip(*np.nonzero(~opened), strict=True)}
    edges = []

    def weigh(here, other, before):
        d = tree[here] - color[other]
        weight = np.sqrt(np.float32(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]))
        a, b = depth[here], depth[other]
        if a > 0 and b > 0:
            weight += min(abs(a - b) / max(STEP_M, STEP_PER_M * a * a), 1.0) * STEP_WEIGHT
        return min(int(weight + before), seeding.LEVELS - 1)

    def near(p):
        for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            q = p[0] + dy, p[1] + dx
            if 0 <= q[0] < labels.shape[0] and 0 <= q[1] < labels.shape[1]:
                yield q

    for p in zip(*np.nonzero(opened), strict=True):
        edges += [(weigh(q, p, 0.0), q, p) for q in near(p) if not opened[q]]
    while edges:
        k = min(range(len(edges)), key=lambda k: (edges[k][0], k))
        weight, here, p = edges.pop(k)
        if not opened[p]:
            continue
        opened[p] = False
        labels[p] = labels[here]
        tree[p] = np.float32(memory) * tree[here] + np.float32(1 - memory) * color[p]
        edges += [(weigh(p, q, np.float32(carry) * np.float32(weight)), p, q) for q in near(p) if opened[q]]
    return labels


def naive_layers(labels, near_hole, width, hole_width):
    shape = labels.shape
    layer = np.full(shape, 255, np.uint8)
    for y, x in itertools.product(*map(range, shape)):
        around = [(y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)]
        if any(0 <= v < shape[0] and 0 <= u < shape[1] and labels[v, u] != labels[y, x] for v, u in around):
            layer[y, x] = 1
    for number in range(1, max(width, hole_width)):
        for y, x in zip(*np.nonzero(layer == number), strict=True):
            for dy, dx in itertools.product((-1, 0, 1), repeat=2):
                v, u = y + dy, x + dx
                if (number % 2 == 0 and dy and dx) or not (0 <= v < shape[0] and 0 <= u < shape[1]):
                    continue
                if layer[v, u] == 255 and number < (hole_width if near_hole[v, u] else width):
                    layer[v, u] = number + 1
    return layer


def small_frame(seed, shape=(14, 17)):
    rng = np.random.default_rng(seed)
    labels = np.zeros(shape, np.int32)
    labels[3:10, 2:9], labels[5:13, 9:15] = 1, 2
    color = rng.integers(0, 90, (*shape, 3)).astype(np.uint8) + (40 * labels).astype(np.uint8)[..., None]
    depth = (1.0 - 0.1 * (labels > 0) + rng.normal(0, 0.004, shape)).astype(np.float32)
    depth[rng.random(shape) < 0.2] = 0
    return labels, color, depth


def grow(color, depth, labels, opened, memory=MEMORY, carry=CARRY):
    out, flags = labels.copy(), opened.copy()
    source = np.empty(labels.size, np.int32)
    numbers = [np.float32(v) for v in (STEP_M, STEP_PER_M, STEP_WEIGHT)]
    seeding.grow_seeds(color, depth, out, flags, int((opened > 0).sum()), memory, carry, *numbers, source)
    return out, flags, source


def opened_of(labels, depth, width=2, hole_width=3):
    near_hole = (depth == 0).astype(np.uint8)
    layer, inner = np.empty(labels.shape, np.uint8), np.zeros(labels.max() + 1, np.int32)
    seeding.measure_layers(labels, near_hole, width, hole_width, layer, inner)
    opened = np.empty(labels.shape, np.uint8)
    seeding.open_layers(labels, layer, inner, np.float32(0.6), opened)
    return layer, inner, opened


@pytest.mark.parametrize("seed", range(6))
def test_layers_are_those_of_the_slow_twin(seed):
    labels, _, depth = small_frame(seed)
    layer, _, _ = opened_of(labels, depth, 2, 4)
    np.testing.assert_array_equal(layer, naive_layers(labels, depth == 0, 2, 4))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize(("memory", "carry"), [(MEMORY, CARRY), (0.0, 0.0)])
def test_forest_is_that_of_the_slow_twin(seed, memory, carry):
    labels, color, depth = small_frame(seed)
    _, _, opened = opened_of(labels, depth)
    out, left, source = grow(color, depth, labels, opened, memory, carry)
    np.testing.assert_array_equal(out, naive_grow(color, depth, labels, opened, memory, carry))
    assert not left.any()
    where = np.flatnonzero(opened.reshape(-1))
    assert not opened.reshape(-1)[source[where]].any()
    np.testing.assert_array_equal(out.reshape(-1)[where], labels.reshape(-1)[source[where]])


def test_every_object_keeps_pixels_and_the_closed_ones_stay():
    for seed in range(20):
        labels, color, depth = small_frame(seed)
        done = refine_labels(labels, color, depth, Refinement())
        assert set(np.unique(done.labels)) >= {1, 2}
        np.testing.assert_array_equal(done.labels[~done.opened], labels[~done.opened])


def test_an_outline_moves_to_the_colour_edge_where_depth_is_missing():
    color = np.full((60, 80, 3), 200, np.uint8)
    color[15:45, 20:60] = 30
    depth = np.full((60, 80), 1.0, np.float32)
    depth[15:45, 20:60] = 0.8
    depth[10:50, 50:70] = 0
    labels = np.zeros((60, 80), np.int32)
    labels[15:45, 20:52] = 1
    out = refine_labels(labels, color, depth, Refinement(sigma_px=0.0)).labels
    np.testing.assert_array_equal(out > 0, color[..., 0] == 30)


def test_enlarged_labels_follow_the_full_image():
    yy, xx = np.mgrid[:120, :160]
    disc = (yy - 57.3) ** 2 + (xx - 80.7) ** 2 < 35.2**2
    color = np.where(disc[..., None], 40, 180).astype(np.uint8).repeat(3, axis=2)
    out = enlarge_labels(
        disc[::2, ::2].astype(np.int32), color, np.zeros((120, 160), np.float32), Refinement(sigma_px=0.0)
    )
    np.testing.assert_array_equal(out > 0, disc)


def test_facts_describe_the_refined_mask():
    rng = np.random.default_rng(1)
    color = rng.integers(150, 160, (120, 160, 3)).astype(np.uint8)
    color[40:80, 50:100] //= 4
    depth = np.full((120, 160), 1.0, np.float32)
    depth[40:80, 50:100] = 0.9
    depth[40:80, 44:54] = 0
    frame = sp.Frame(
        color=color, depth=depth, camera=sp.Camera(fx=150.0, fy=150.0, cx=79.5, cy=59.5, width=160, height=120)
    )
    for config in (sp.OBJECTS.replace(additions={"refinement": on}) for on in (Refinement(), None)):
        result = sp.segment(frame, config)
        assert sum(o.area_px for o in (*result.objects, *result.rejected)) == color[..., 0].size
        for o in result:
            ys, xs = np.nonzero(result.labels == o.label)
            assert (o.area_px, o.box_px) == (ys.size, (ys.min(), xs.min(), ys.max() + 1, xs.max() + 1))
            assert math.isclose(o.missing, float((depth[ys, xs] == 0).mean()), abs_tol=1e-9)
