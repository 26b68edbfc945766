"""Regions merge over their whole common border, the weakest first. What stands stays apart from what it stands on."""

from __future__ import annotations

import numpy as np
import pytest

import naive
from spigolo.additions.merging import find_borders, merge_regions
from spigolo.settings import Merging
from spigolo.stages.regions import Regions

Array = np.ndarray


def naive_merge(labels: Array, boundary: Array, depth: Array, above: Array | None, config: Merging) -> Array:
    """Search all borders for the weakest that may go, relabel the image, and search again."""
    labels = labels.copy()

    def stands(k: int) -> bool | None:
        measured = (labels == k) & (depth > 0)
        if not measured.any():
            return None
        return bool(above is None or 2 * np.count_nonzero(above & (labels == k)) > np.count_nonzero(measured))

    def open_px(k: int) -> int:
        return np.count_nonzero((labels == k) & (boundary < config.line))

    def is_weak(mean: float, a: int, b: int) -> bool:
        alike = None in (stands(a), stands(b)) or stands(a) == stands(b)
        return mean < config.max_mean and alike

    def is_small(mean: float, a: int, b: int) -> bool:
        return min(open_px(a), open_px(b)) < config.min_open_px2

    for may_merge in (is_weak, is_small):
        while True:
            borders: dict[tuple[int, int], list[float]] = {}
            for a, b, strength in naive.collect_pairs(labels, boundary):
                borders.setdefault((a, b), []).append(strength)
            means = {pair: sum(all_of) / len(all_of) for pair, all_of in borders.items()}
            fit = [pair for pair, mean in means.items() if may_merge(mean, *pair)]
            if not fit:
                break
            a, b = min(fit, key=lambda pair: means[pair])
            labels[labels == b] = a
    return naive.number_regions(labels.reshape(-1).tolist()).reshape(labels.shape)


def blocks(shape: tuple[int, int], size: int) -> Array:
    y, x = np.indices(shape) // size
    return naive.number_regions((100 * y + x).reshape(-1).tolist()).reshape(shape)


def merged(labels: Array, boundary: Array, depth: Array, above: Array | None, config: Merging) -> Array:
    answer = merge_regions(Regions(labels, int(labels.max()) + 1), boundary, depth, above, config)
    assert answer.count == answer.labels.max() + 1
    return naive.number_regions(answer.labels.reshape(-1).tolist()).reshape(labels.shape)


@pytest.mark.parametrize("least", [0.0, 7.0, 25.0])
@pytest.mark.parametrize("with_support", [True, False])
@pytest.mark.parametrize("seed", range(8))
def test_merging_is_that_of_the_slow_twin(seed: int, with_support: bool, least: float) -> None:
    rng = np.random.default_rng(seed)
    labels = blocks((18, 24), 4)
    boundary = np.clip(rng.random((18, 24)) * rng.random((3, 4)).repeat(6, 0).repeat(6, 1), 0, 1).astype(np.float32)
    depth = np.where(rng.random((18, 24)) < 0.2, 0, 1.0).astype(np.float32)
    depth[:4, :4] = 0
    above = (labels % 3 == 0) & (depth > 0) if with_support else None
    config = Merging(max_mean=0.35, line=0.3, min_open_px2=least)
    twin = naive_merge(labels, boundary, depth, above, config)
    assert twin.max() < labels.max()
    assert twin.max() > 0 or least > 0
    np.testing.assert_array_equal(merged(labels, boundary, depth, above, config), twin)


@pytest.mark.parametrize("gap", [1.0, 0.2])
def test_the_whole_border_counts_and_not_its_weakest_piece(gap: float) -> None:
    """A line with a gap in it parts two regions; one that is hardly there does not."""
    labels = np.zeros((40, 40), np.int32)
    labels[:, 20:] = 1
    boundary, depth = np.zeros((40, 40), np.float32), np.ones((40, 40), np.float32)
    boundary[:, 19:21] = gap
    boundary[:4, 19:21] = 0
    assert merged(labels, boundary, depth, None, Merging()).max() + 1 == (2 if gap == 1.0 else 1)


@pytest.mark.parametrize(
    ("of_left", "of_right", "count"),
    [(True, False, 2), (True, True, 1), (False, False, 1), (True, None, 1)],
)
def test_what_stands_does_not_merge_with_what_it_stands_on(of_left: bool, of_right: bool | None, count: int) -> None:
    """Two halves without any boundary, each above the support or not, or without depth."""
    labels, depth = np.zeros((40, 40), np.int32), np.ones((40, 40), np.float32)
    labels[:, 20:] = 1
    above = np.where(labels == 1, bool(of_right), of_left)
    if of_right is None:
        depth[labels == 1] = 0
    assert merged(labels, np.zeros_like(depth), depth, above, Merging()).max() + 1 == count


def test_a_region_within_lines_joins_the_neighbour_with_the_weaker_border() -> None:
    """Nine columns on a line, stronger at its left than at its right."""
    labels, boundary = np.zeros((40, 49), np.int32), np.zeros((40, 49), np.float32)
    labels[:, 20:29], labels[:, 29:] = 1, 2
    boundary[:, 18:24], boundary[:, 24:31] = 0.9, 0.6
    answer = merged(labels, boundary, np.ones((40, 49), np.float32), None, Merging())
    np.testing.assert_array_equal(answer[0], [0] * 20 + [1] * 29)


def test_borders_are_found_in_an_image_with_more_of_them_than_pixels() -> None:
    """Every pixel is a region: there are almost twice as many pairs as pixels."""
    labels = np.arange(30, dtype=np.int32).reshape(5, 6)
    boundary = np.linspace(0, 1, 30, dtype=np.float32).reshape(5, 6)
    first, second, length, total = find_borders(labels, boundary)
    twin = sorted(naive.collect_pairs(labels, boundary))
    assert list(zip(first.tolist(), second.tolist(), total.tolist(), strict=True)) == twin
    assert (length == 1).all()
