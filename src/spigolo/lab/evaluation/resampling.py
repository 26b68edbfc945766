"""Confidence intervals by resampling, and splits of frames for cross-validation.

Letters in array shapes: G = number of groups of near-identical frames, K = number of frames.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Indices = NDArray[np.intp]

DRAWS = 4000
SEED = 0
LEVEL = 0.95


class Estimate(NamedTuple):
    """Value with the lower and upper limit of its 95 % confidence interval. Unknown values are NaN."""

    value: float
    low: float
    high: float


UNKNOWN = Estimate(math.nan, math.nan, math.nan)


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """Split of frames for cross-validation."""

    name: str
    inside: Indices
    """Indices of the frames used to choose parameters."""
    outside: Indices
    """Indices of the held-out frames. No frame of `inside` is near-identical to a held-out frame."""


def bootstrap(
    values: ArrayLike, weights: ArrayLike | None = None, *, draws: int = DRAWS, seed: int = SEED, level: float = LEVEL
) -> Estimate:
    """Return the weighted mean of the values, with its bootstrap confidence interval.

    The limits of the confidence interval are NaN for fewer than two values.

    Parameters
    ----------
    values
        Values (G,), one per group of near-identical frames. To compare two methods on the same frames, pass the
        differences between the values of the methods.
    weights
        Weight of each value (G,), by default 1.
    draws
        Number of bootstrap samples.
    seed
        Random seed. The same seed always gives the same confidence interval.
    level
        Confidence level of the interval, 0..1.

    """
    x = np.asarray(values, np.float64)
    w = np.ones_like(x) if weights is None else np.asarray(weights, np.float64)
    if x.ndim != 1 or x.shape != w.shape or (w < 0).any():
        raise ValueError(
            f"expected one value and one weight of 0 or more per group, got shapes {x.shape} and {w.shape}:"
            " take the mean within each group first"
        )
    x, w = x[w > 0], w[w > 0]
    if not x.size:
        return UNKNOWN
    value = float(np.average(x, weights=w))
    if x.size == 1:
        return Estimate(value, math.nan, math.nan)
    drawn = np.random.default_rng(seed).integers(0, x.size, (draws, x.size))
    means = (x * w)[drawn].sum(axis=1) / w[drawn].sum(axis=1)
    low, high = np.quantile(means, [(1 - level) / 2, (1 + level) / 2])
    return Estimate(value, float(low), float(high))


def folds(groups: Sequence[Hashable], k: int = 5, seed: int = SEED) -> list[Split]:
    """Split K frames into `k` folds of about equal size for cross-validation.

    Near-identical frames are always in the same fold.

    groups: name of the group of near-identical frames that contains each frame (K,). Raises ValueError if there are
    fewer groups of near-identical frames than folds.
    """
    frames_of = _frames_of(groups)
    if not 2 <= k <= len(frames_of):
        raise ValueError(f"expected 2 to {len(frames_of)} folds of {len(frames_of)} groups, got {k}: choose another k")
    order = np.random.default_rng(seed).permutation(len(frames_of))
    lists = list(frames_of.values())
    # distribute large groups first, so that the folds get similar sizes
    shuffled = sorted((lists[i] for i in order), key=len, reverse=True)
    held: list[list[int]] = [[] for _ in range(k)]
    for members in shuffled:
        min(held, key=len).extend(members)
    return [_split(f"fold {n}", len(groups), members, groups) for n, members in enumerate(held, start=1)]


def leave_one_set_out(sets: Sequence[str], groups: Sequence[Hashable] | None = None) -> list[Split]:
    """Return one split per data set, in which all frames of this data set are held out. Splits are sorted by data set
    name.

    Frames of other data sets are left out of a split if they are near-identical to one of its held-out frames.

    Raises ValueError if there are fewer than two data sets.

    Parameters
    ----------
    sets
        Data set of each frame (K,).
    groups
        Group (K,) of each frame. Near-identical frames are in one group.

    """
    names = sorted(set(sets))
    if len(names) < 2:
        raise ValueError(f"expected at least two data sets to leave one out, got {len(names)}: add frames")
    alike = list(range(len(sets))) if groups is None else groups
    if len(alike) != len(sets):
        raise ValueError(
            f"expected one group per frame, got {len(alike)} groups for {len(sets)} frames: give both in the same order"
        )
    return [_split(name, len(sets), [i for i, s in enumerate(sets) if s == name], alike) for name in names]


def _frames_of(groups: Sequence[Hashable]) -> dict[Hashable, list[int]]:
    frames: dict[Hashable, list[int]] = {}
    for index, group in enumerate(groups):
        frames.setdefault(group, []).append(index)
    return frames


def _split(name: str, count: int, outside: Sequence[int], groups: Sequence[Hashable]) -> Split:
    held = {groups[i] for i in outside}
    inside = [i for i in range(count) if groups[i] not in held]
    return Split(name, np.array(inside, np.intp), np.array(sorted(outside), np.intp))


def wilson_interval(hits: float, n: float, z: float = 1.96) -> tuple[float, float]:
    """Return the Wilson score interval of the share hits / n.

    z: half the width of the interval, in standard deviations. With z = 1.96, the confidence level is 95 %.

    The interval is (0, 1) for n = 0. The numbers `hits` and `n` may be fractions, for example if near-identical frames
    have lower weights. The formula assumes independent trials, but objects in the same frame are only approximately
    independent.
    """
    if not 0 <= hits <= n or not z >= 0:
        raise ValueError(f"expected 0 <= hits <= n and z >= 0, got hits={hits}, n={n}, z={z}: check the counts")
    if n == 0:
        return 0.0, 1.0
    share, spread = hits / n, z * z / n
    centre = (share + spread / 2) / (1 + spread)
    half = math.sqrt(share * (1 - share) * spread + spread * spread / 4) / (1 + spread)
    return max(0.0, centre - half), min(1.0, centre + half)
