"""Outlines drawn again by colour: what moves, what stays, and the facts that follow."""

from __future__ import annotations

import math

import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.refinement import open_hulls, place_outlines, refine_labels
from spigolo.kernels import bands
from spigolo.settings import Refinement


def small_frame(seed, shape=(14, 17)):
    rng = np.random.default_rng(seed)
    labels = np.zeros(shape, np.int32)
    labels[3:10, 2:9], labels[5:13, 9:15] = 1, 2
    color = rng.integers(0, 90, (*shape, 3)).astype(np.uint8) + (40 * labels).astype(np.uint8)[..., None]
    depth = (1.0 - 0.1 * (labels > 0) + rng.normal(0, 0.004, shape)).astype(np.float32)
    depth[rng.random(shape) < 0.2] = 0
    return labels, color, depth


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


@pytest.mark.parametrize("min_solidity", [0.5, None])
def test_the_bottom_of_a_bowl_has_the_depth_of_the_table_and_the_colour_of_the_bowl(min_solidity):
    y, x = np.mgrid[:120, :160]
    radius = np.hypot(y - 60, x - 80)
    bowl, bottom = radius < 45, radius < 25
    color = np.where(bowl[..., None], 40, 180).astype(np.uint8).repeat(3, axis=2)
    depth = np.where(bowl & ~bottom, 0.95, 1.0).astype(np.float32)
    labels = (bowl & ~bottom).astype(np.int32)
    done = refine_labels(labels, color, depth, Refinement(min_solidity=min_solidity, sigma_px=0.0))
    whole = np.count_nonzero((done.labels == 1) & bottom) / np.count_nonzero(bottom)
    assert whole < 0.5 if min_solidity is None else whole == 1.0
    np.testing.assert_array_equal(done.labels[~bowl], 0)


@pytest.mark.parametrize(("size", "is_opened"), [(10, False), (45, True)])
def test_only_objects_that_fill_most_of_their_hull_are_opened(size, is_opened):
    """The handle and body of a drill leave most of the hull free; a thick corner does not."""
    labels = np.zeros((120, 160), np.int32)
    labels[20:100, 30 : 30 + size] = labels[20 : 20 + size, 30:110] = 1
    opened = np.zeros(labels.shape, np.uint8)
    count = open_hulls(labels, opened, 0.5)
    assert (count > 0) == is_opened
    assert count == np.count_nonzero(opened)
    assert not opened[labels > 0].any()


def test_a_hull_opens_background_only_and_flags_the_image_border():
    labels = np.zeros((60, 80), np.int32)
    labels[10:50, :30] = 1
    labels[20:40, :12] = 0
    labels[25:35, 4:10] = 2
    opened = np.zeros(labels.shape, np.uint8)
    open_hulls(labels, opened, 0.5)
    notch = np.zeros(labels.shape, bool)
    notch[20:40, :12] = True
    np.testing.assert_array_equal(opened > 0, notch & (labels == 0))
    assert (opened[20:40, 0] == bands.OPEN | bands.FIRST_COLUMN).all()


def test_repeated_labels_follow_the_full_image():
    yy, xx = np.mgrid[:120, :160]
    disc = (yy - 57.3) ** 2 + (xx - 80.7) ** 2 < 35.2**2
    color = np.where(disc[..., None], 40, 180).astype(np.uint8).repeat(3, axis=2)
    repeated = disc[::2, ::2].astype(np.int32).repeat(2, axis=0).repeat(2, axis=1)
    out = place_outlines(repeated, color, np.zeros((120, 160), np.float32), Refinement(sigma_px=0.0))
    np.testing.assert_array_equal(out.labels > 0, disc)


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
