"""Pairs of colour and depth messages with nearly the same time stamp, and a queue of pairs."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Colour message and depth message with nearly the same time stamp."""

    color: Any
    """Colour image message, whose header is copied to the results."""
    depth: Any
    """Depth image message. The depth image is registered to the colour image."""
    arrived_s: float
    """Arrival time of the later message of the pair, in seconds, on the clock `time.perf_counter`."""


class Waiting:
    """Queue of pairs between the receiving thread and the segmentation thread."""

    def __init__(self, length: int) -> None:
        self.dropped = 0
        self._pairs: deque[Pair] = deque(maxlen=length)
        self._changed = threading.Condition()

    def put(self, pair: Pair) -> None:
        """Add a pair to the queue. If the queue is full, the oldest pair is dropped and counted."""
        with self._changed:
            self.dropped += len(self._pairs) == self._pairs.maxlen
            self._pairs.append(pair)
            self._changed.notify()

    def take(self, timeout_s: float) -> Pair | None:
        """Remove and return the oldest pair of the queue, or return None if no pair arrives within the timeout."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._pairs), timeout_s)
            return self._pairs.popleft() if self._pairs else None
