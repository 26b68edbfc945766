"""Pairs of colour and depth by the stamps of their headers, one to one."""

from __future__ import annotations

from collections.abc import Sequence


def pair_stamps(colors_ns: Sequence[int], depths_ns: Sequence[int], tolerance_ns: float) -> list[tuple[int, int]]:
    """Return pairs (index of colour, index of depth) in the order of the colour stamps, each index at most once.

    Nearest stamps pair first. Stamps need not be ordered. Pairs differ by at most the tolerance.
    """
    later = sorted((stamp, k) for k, stamp in enumerate(depths_ns))
    candidates: list[tuple[int, int, int]] = []
    first = 0
    for stamp, color in sorted((stamp, k) for k, stamp in enumerate(colors_ns)):
        while first < len(later) and later[first][0] < stamp - tolerance_ns:
            first += 1
        near = first
        while near < len(later) and later[near][0] <= stamp + tolerance_ns:
            candidates.append((abs(later[near][0] - stamp), color, later[near][1]))
            near += 1
    taken_colors: set[int] = set()
    taken_depths: set[int] = set()
    pairs = []
    for _, color, depth in sorted(candidates):
        if color not in taken_colors and depth not in taken_depths:
            taken_colors.add(color)
            taken_depths.add(depth)
            pairs.append((color, depth))
    return sorted(pairs, key=lambda pair: colors_ns[pair[0]])
