"""Sources for live cameras. A separate thread receives frames, and old frames are dropped if the program reads frames
too slowly.
"""

from __future__ import annotations

import threading
import time
from abc import abstractmethod
from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from typing import Generic, TypeVar

from spigolo.clock import Pace
from spigolo.errors import SpigoloError
from spigolo.frames.frame import Frame
from spigolo.sources.base import Report, Source
from spigolo.sources.options import Options

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Storage for a few items that one thread puts in and another thread takes out. If the mailbox is full, the next
    item replaces the oldest item.

    size: maximum number of items.
    """

    def __init__(self, size: int = 1) -> None:
        self._ready = threading.Condition()
        self._items: deque[T] = deque(maxlen=size)
        self._ended: BaseException | bool = False
        self.dropped = 0
        """Number of items that were replaced before they were taken."""

    def put(self, item: T) -> None:
        """Put a new item into the mailbox."""
        with self._ready:
            self.dropped += len(self._items) == self._items.maxlen
            self._items.append(item)
            self._ready.notify()

    def end(self, error: BaseException | None = None) -> None:
        """Signal to the reading thread that no more items follow. If an error is given, it is raised on the reading
        thread.
        """
        with self._ready:
            self._ended = error or True
            self._ready.notify()

    def take(self) -> T | None:
        """Wait for an item and return the oldest item. Return None if there are no more items. Raises the error that
        was passed to `end`.
        """
        with self._ready:
            self._ready.wait_for(lambda: self._items or self._ended)
            if not self._items and isinstance(self._ended, BaseException):
                raise self._ended
            return self._items.popleft() if self._items else None


class LiveSource(Source):
    """Source for a live camera. While the caller processes a frame, only the newest frames are kept. The option `queue`
    is the maximum number of frames that are kept.

    `report()` includes the latency from the arrival of a frame until the caller requests the next frame.
    """

    live = True

    def __init__(self, name: str, options: Options) -> None:
        super().__init__(name, options)
        self._pace = Pace()
        self._dropped = 0
        self._stopping = threading.Event()

    @abstractmethod
    def _receive(self) -> Iterator[Frame]:
        """Yield the arriving frames until the source is closed. `_receive` runs on a separate thread."""

    def close(self) -> None:
        """Stop the camera."""
        self._stopping.set()

    def report(self) -> Report:
        """Return the numbers of frames since the start of the last iteration, the frame rate and the latency."""
        return replace(super().report(), dropped=self._dropped, pace=self._pace)

    def _frames(self) -> Iterator[Frame]:
        self._pace, self._dropped = Pace(), 0
        self._stopping.clear()
        box: Mailbox[tuple[float, Frame]] = Mailbox(self.options.queue)
        thread = threading.Thread(target=self._fill, args=(box,), name=f"spigolo {self.name}", daemon=True)
        thread.start()
        try:
            while (item := box.take()) is not None:
                arrived, frame = item
                self._dropped = box.dropped
                yield frame
                self._pace.add(time.perf_counter() - arrived)
            self._dropped = box.dropped
        finally:
            self._stopping.set()
            thread.join()

    def _fill(self, box: Mailbox[tuple[float, Frame]]) -> None:
        try:
            for frame in self._receive():
                if self._stopping.is_set():
                    break
                box.put((time.perf_counter(), frame))
        except SpigoloError as error:
            box.end(error)
        except Exception as error:  # the error is raised again on the reader's thread
            box.end(SpigoloError(f"{self.name}: {' '.join(str(error).split())}"))
        else:
            box.end()
