"""Search for domains, and joining of neighbouring domains by their interactions. A domain is a connected area of pixels
with equal spin.

Spins have the shape (H, W). Interactions have the shape (4, H, W), one plane for each offset of `graph.OFFSETS`. B =
twice the number of borders between domains, because every border is listed twice.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Mask
from spigolo.stages.graph import OFFSETS, Graph
from spigolo.stages.regions import Regions, partition

Planes = npt.NDArray[np.float32]
Spins = npt.NDArray[np.int32]
Counts = npt.NDArray[np.int64]
Ends = tuple[tuple[slice, slice], tuple[slice, slice]]


def connected_areas(spins: Spins) -> Regions:
    """Return the connected areas of equal spin (H, W) as regions."""
    weights = np.full((len(OFFSETS), *spins.shape), np.inf, np.float32)
    for plane, offset in zip(weights, OFFSETS, strict=True):
        here, there = pair_ends(spins.shape, offset)
        plane[here][spins[here] == spins[there]] = 0
    return partition(Graph(weights), gamma=0)


class Borders(NamedTuple):
    """Borders between neighbouring domains. Every border is listed twice, once from each side.

    - domain: (2, B), labels of the two domains at the border: the domain on this side, and the domain on the other
      side.
    - area: (2, B), number of pixels of the two domains at the border, in the order of `domain`.
    - mean: (B,), mean interaction of the pixel pairs across the border.
    """

    domain: Counts
    area: Counts
    mean: npt.NDArray[np.float64]


def join_domains(domains: Regions, planes: Planes, may_join: Callable[[Borders], Mask]) -> Regions:
    """Join neighbouring domains until `may_join` does not allow any of the remaining borders to be removed.

    The domains are joined in rounds. In each round, each domain joins the neighbour with the largest mean interaction,
    among the neighbours that `may_join` allows. After each round, the mean interactions are computed again.

    planes: interactions (4, H, W). may_join: function that returns a mask (B,) of the borders that may be removed.
    """
    while True:
        borders = find_borders(domains, planes)
        wanted = may_join(borders)
        if not wanted.any():
            return domains
        domains = domains.joined(_join_best(domains.count, borders.domain[:, wanted], borders.mean[wanted]))


def find_borders(domains: Regions, planes: Planes) -> Borders:
    """Return the borders between domains, with the mean interaction across each border. planes: interactions (4, H,
    W).
    """
    keys, forces = [], []
    for pairs, offset in zip(planes, OFFSETS, strict=True):
        here, there = pair_ends(domains.labels.shape, offset)
        a, b = domains.labels[here], domains.labels[there]
        differ = a != b
        a, b = a[differ].astype(np.int64), b[differ].astype(np.int64)
        keys.append(np.minimum(a, b) * domains.count + np.maximum(a, b))
        forces.append(pairs[here][differ])
    found, of = np.unique(np.concatenate(keys), return_inverse=True)
    mean = np.bincount(of, np.concatenate(forces), found.size) / np.bincount(of, minlength=found.size)
    low, high = np.divmod(found, domains.count)
    domain = np.stack([np.concatenate([low, high]), np.concatenate([high, low])])
    area = np.bincount(domains.labels.reshape(-1), minlength=domains.count)
    return Borders(domain, area[domain], np.concatenate([mean, mean]))


def _join_best(count: int, domain: Counts, mean: npt.NDArray[np.float64]) -> Counts:
    """Return the new number (count,) of each domain after every domain joined the neighbour with the largest mean
    interaction.

    domain: (2, B), pairs of domains that may join. mean: (B,), mean interaction of each pair. A joined domain gets the
    smallest number of the domains that it contains.
    """
    one, other = domain
    order = np.lexsort((domain.max(0), domain.min(0), mean))  # the border with the largest mean is assigned last
    best = np.arange(count)
    best[one[order]] = other[order]
    # the order is strict, so that a cycle has exactly two domains
    mutual = (best[best] == np.arange(count)) & (np.arange(count) < best)
    best[mutual] = np.flatnonzero(mutual)
    while not np.array_equal(best, best[best]):
        best = best[best]
    first = np.full(count, count)
    np.minimum.at(first, best, np.arange(count))
    return first[best]


def pair_ends(shape: tuple[int, ...], offset: tuple[int, int]) -> Ends:
    """Return slices of an image for all pairs of pixels that are an offset (dy, dx) apart. The first tuple of slices
    (rows, columns) selects the first pixel of each pair, and the second tuple selects the second pixel.
    """
    (height, width), (dy, dx) = shape, offset
    rows = slice(max(0, -dy), max(height - max(0, dy), 0)), slice(max(0, dy), max(height + min(0, dy), 0))
    return (rows[0], slice(0, max(width - dx, 0))), (rows[1], slice(dx, width))
