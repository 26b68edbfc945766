"""Domains of equal spin, and the joining of neighbouring ones by the interactions across their borders.

A lattice is (H, W). Interactions are its planes (4, H, W), one for each of `graph.OFFSETS`. B = borders.
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
    """Connected areas of equal spin: edges of weight 0 merge, all others are none."""
    weights = np.full((len(OFFSETS), *spins.shape), np.inf, np.float32)
    for plane, offset in zip(weights, OFFSETS, strict=True):
        here, there = pair_ends(spins.shape, offset)
        plane[here][spins[here] == spins[there]] = 0
    return partition(Graph(weights), gamma=0)


class Borders(NamedTuple):
    """Borders between two domains. Every border is listed twice, once from either side.

    domain (2, B): numbers of this domain and of the other one. area (2, B): their pixels. mean (B,): the interaction of
    the pairs across the border.
    """

    domain: Counts
    area: Counts
    mean: npt.NDArray[np.float64]


def join_domains(domains: Regions, planes: Planes, may_join: Callable[[Borders], Mask]) -> Regions:
    """Join neighbouring domains by their interactions (4, H, W) until none may join another one.

    Works in rounds. Every domain joins the neighbour with the largest mean interaction among those that it may join,
    from its side. Then means are computed anew.
    """
    while True:
        borders = find_borders(domains, planes)
        wanted = may_join(borders)
        if not wanted.any():
            return domains
        domains = domains.joined(_join_best(domains.count, borders.domain[:, wanted], borders.mean[wanted]))


def find_borders(domains: Regions, planes: Planes) -> Borders:
    """The borders between the domains of a lattice and what acts across them."""
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
    """The first domain that each of `count` ends up with when every one joins its neighbour with the largest mean.

    domain (2, B): who may join whom.
    """
    one, other = domain
    order = np.lexsort((domain.max(0), domain.min(0), mean))  # the best comes last and stays
    best = np.arange(count)
    best[one[order]] = other[order]
    # no two borders are equal in that order, so that circles have two members
    mutual = (best[best] == np.arange(count)) & (np.arange(count) < best)
    best[mutual] = np.flatnonzero(mutual)
    while not np.array_equal(best, best[best]):
        best = best[best]
    first = np.full(count, count)
    np.minimum.at(first, best, np.arange(count))
    return first[best]


def pair_ends(shape: tuple[int, ...], offset: tuple[int, int]) -> Ends:
    """Return the places of the first and the second pixels of all pairs of an offset."""
    (height, width), (dy, dx) = shape, offset
    rows = slice(max(0, -dy), max(height - max(0, dy), 0)), slice(max(0, dy), max(height + min(0, dy), 0))
    return (rows[0], slice(0, max(width - dx, 0))), (rows[1], slice(dx, width))
