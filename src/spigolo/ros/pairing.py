"""Pairs of colour and depth images of the same time, and their queue."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Colour and depth message of the same time."""

    color: Any
    """Colour image. Results get its header."""
    depth: Any
    """Depth image, registered to colour."""
    arrived_s: float
    """Time at which the pair was complete, s, on the clock `time.perf_counter`."""


class Waiting:
    """Queue of pairs between the receiving and the segmenting thread. A new pair replaces the oldest one if it is
    full.
    """

    def __init__(self, length: int) -> None:
        self.dropped = 0
        self._pairs: deque[Pair] = deque(maxlen=length)
        self._changed = threading.Condition()

    def put(self, pair: Pair) -> None:
        """Add a pair. If the queue is full, the oldest pair is dropped and counted."""
        with self._changed:
            self.dropped += len(self._pairs) == self._pairs.maxlen
            self._pairs.append(pair)
            self._changed.notify()

    def take(self, timeout_s: float) -> Pair | None:
        """Return the oldest pair, or None if no pair arrives within the timeout."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._pairs), timeout_s)
            return self._pairs.popleft() if self._pairs else None
