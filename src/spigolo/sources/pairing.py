"""Pairing of colour and depth images by their stamps, for a whole recording or for arriving messages."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

KEPT = 30
"""Maximum number of images of one topic that wait for a partner. 30 images are one second at 30 Hz."""
RESTART_NS = 200_000_000
"""If the stamps of one topic jump back by more than this time, in nanoseconds, the recording counts as restarted, for
example because it is played in a loop.
"""


def pair_stamps(colors_ns: Sequence[int], depths_ns: Sequence[int], tolerance_ns: float) -> list[tuple[int, int]]:
    """Return pairs (colour index, depth index) in the order of the colour stamps. Each index occurs at most once.

    The nearest stamps are paired first. The two stamps of a pair differ by at most the given tolerance. The input
    stamps need not be sorted.
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


class StampMatcher:
    """Pairing of messages of two topics by their stamps. Each message belongs to at most one pair.

    A message is paired with the message of the other topic that has the nearest stamp, if both stamps differ by at most
    the tolerance. When a new pair is found, older waiting messages are dropped and counted in `unmatched`.
    """

    def __init__(self, tolerance_ns: int) -> None:
        self.tolerance_ns = tolerance_ns
        self.unmatched = 0
        self._waiting: dict[str, deque[tuple[int, Any]]] = {"color": deque(), "depth": deque()}
        self._last_ns: int | None = None
        self._seen_ns: dict[str, int] = {}

    def add(self, topic: str, stamp_ns: int, message: Any) -> tuple[Any, Any] | None:
        """Add a message of the topic "color" or "depth". Return the colour and the depth message if the new message
        completes a pair.
        """
        if stamp_ns < self._seen_ns.get(topic, stamp_ns) - RESTART_NS:
            self._drop_until(None)
            self._seen_ns.clear()
        self._seen_ns[topic] = stamp_ns
        if self._last_ns is not None and stamp_ns <= self._last_ns - self.tolerance_ns:
            self.unmatched += 1
            return None
        partners = self._waiting["depth" if topic == "color" else "color"]
        nearest = min(partners, key=lambda other: abs(other[0] - stamp_ns), default=None)
        if nearest is None or abs(nearest[0] - stamp_ns) > self.tolerance_ns:
            self._keep(topic, stamp_ns, message)
            return None
        partners.remove(nearest)
        self._drop_until(max(stamp_ns, nearest[0]))
        return (message, nearest[1]) if topic == "color" else (nearest[1], message)

    def _keep(self, topic: str, stamp_ns: int, message: Any) -> None:
        waiting = self._waiting[topic]
        waiting.append((stamp_ns, message))
        if len(waiting) > KEPT:
            waiting.popleft()
            self.unmatched += 1

    def _drop_until(self, stamp_ns: int | None) -> None:
        """Drop the waiting messages whose stamp is at most the given stamp. If the stamp is None, drop all waiting
        messages.
        """
        self._last_ns = stamp_ns
        for topic, waiting in self._waiting.items():
            newer = deque(one for one in waiting if stamp_ns is not None and one[0] > stamp_ns)
            self.unmatched += len(waiting) - len(newer)
            self._waiting[topic] = newer
