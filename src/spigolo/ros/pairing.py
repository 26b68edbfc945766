"""Colour and depth images of one moment, and the queue in which their pairs wait."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from typing import Any

KEPT = 30
"""Images of one topic that wait for a partner: one second at 30 Hz."""
RESTART_NS = 1_000_000_000
"""A stamp so much older than the last pair means that time starts again, as when a recording is played in a loop."""


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """A colour and a depth message of one moment."""

    color: Any
    """The colour image. The answer has its header."""
    depth: Any
    """The depth image, registered to it."""
    arrived_s: float
    """Time at which the pair was complete, s, on the clock `time.perf_counter`."""


class StampMatcher:
    """Pairs messages of two topics by their stamps. Each message belongs to one pair at most.

    A message takes the partner with the nearest stamp within the tolerance. What is older than a pair can get no
    partner any more: it is dropped and counted in `unmatched`.
    """

    def __init__(self, tolerance_ns: int) -> None:
        self.tolerance_ns = tolerance_ns
        self.unmatched = 0
        self._waiting: dict[str, deque[tuple[int, Any]]] = {"color": deque(), "depth": deque()}
        self._last_ns: int | None = None

    def add(self, topic: str, stamp_ns: int, message: Any) -> tuple[Any, Any] | None:
        """Add a message of "color" or "depth". Return colour and depth if this completes a pair."""
        if self._last_ns is not None and stamp_ns < self._last_ns - RESTART_NS:
            self._drop_until(None)
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
        """Drop what is not newer than a stamp, or all."""
        self._last_ns = stamp_ns
        for topic, waiting in self._waiting.items():
            newer = deque(one for one in waiting if stamp_ns is not None and one[0] > stamp_ns)
            self.unmatched += len(waiting) - len(newer)
            self._waiting[topic] = newer


class Waiting:
    """Pairs between the thread that receives and the one that segments. A new pair pushes the oldest one out."""

    def __init__(self, length: int) -> None:
        self.dropped = 0
        self._pairs: deque[Pair] = deque(maxlen=length)
        self._changed = threading.Condition()

    def put(self, pair: Pair) -> None:
        """Add a pair. If the queue is full, the oldest one is dropped and counted."""
        with self._changed:
            self.dropped += len(self._pairs) == self._pairs.maxlen
            self._pairs.append(pair)
            self._changed.notify()

    def take(self, timeout_s: float) -> Pair | None:
        """Return the oldest pair. None if there is none within the time."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._pairs), timeout_s)
            return self._pairs.popleft() if self._pairs else None
