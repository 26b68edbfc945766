"""Base of all sources: iterables of frames that count unusable images."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TypeVar

from spigolo.clock import Pace
from spigolo.errors import SpigoloError, warn
from spigolo.frames.frame import Frame
from spigolo.sources.options import Options

Own = TypeVar("Own", bound="Source")
OnBroken = Callable[[str, SpigoloError], None]
"""Function that is called with the name of an unreadable frame or message, and the error."""


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, which ends in s for all numbers but 1."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


@dataclass(frozen=True, slots=True)
class Report:
    """Counts of a source since its iteration began."""

    frames: int
    """Number of frames that were returned."""
    unmatched: int = 0
    """Number of colour and depth images without a partner within the tolerance."""
    broken: int = 0
    """Number of unreadable frames or messages."""
    dropped: int = 0
    """Number of frames of a live source that were replaced by newer ones before use."""
    tolerance_ms: float | None = None
    """Maximum difference between the stamps of a pair, ms. None if images are not paired by stamp."""
    pace: Pace | None = None
    """Frame rate, and latency from arrival until the next frame is requested. None for a recording."""

    def __str__(self) -> str:
        within = "" if self.tolerance_ms is None else f" (no partner within {self.tolerance_ms:g} ms)"
        told = [counted(self.frames, "frame")]
        if self.unmatched or self.tolerance_ms is not None:
            told.append(f"{counted(self.unmatched, 'unmatched image')}{within}")
        if self.broken:
            told.append(f"{self.broken} broken")
        if self.pace is not None:
            told += [f"{self.dropped} dropped", str(self.pace)]
        return ", ".join(told)


class Source(ABC):
    """Frames of one folder, data set, recording or camera. Iterate over it, best inside `with`.

    Unreadable frames are skipped, counted and passed to `on_broken`, which warns by default.
    """

    live = False
    """True if frames come from a camera and have no end."""

    def __init__(self, name: str, options: Options) -> None:
        self.name = name
        """Name of the source, for messages."""
        self.options = options
        """Options of the source."""
        self.intrinsics = ""
        """Origin of the intrinsics. Empty if they were given or are not known."""
        self.on_broken: OnBroken = _warn
        self._frames_done = self._unmatched = self._broken = 0

    @property
    def count(self) -> int | None:
        """Return the number of frames. None if it is not known."""
        return None

    @abstractmethod
    def _frames(self) -> Iterator[Frame]:
        """Yield the frames from the first one on."""

    def __iter__(self) -> Iterator[Frame]:
        self._frames_done = self._unmatched = self._broken = 0
        for frame in self._frames():
            self._frames_done += 1
            yield frame

    def report(self) -> Report:
        """Return the counts since the last iteration began."""
        return Report(self._frames_done, self._unmatched, self._broken)

    def close(self) -> None:  # noqa: B027
        """Release files and devices."""

    def __enter__(self: Own) -> Own:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        size = "live" if self.live else "frames" if self.count is None else counted(self.count, "frame")
        return f"{type(self).__name__}({self.name!r}, {size})"

    def _skip(self, name: str, error: SpigoloError) -> None:
        self._broken += 1
        self.on_broken(name, error)


class SizedSource(Source):
    """Source with a known number of frames. Each frame can be read by its number."""

    def __init__(self, name: str, options: Options, count: int) -> None:
        super().__init__(name, options)
        self._count = count

    @property
    def count(self) -> int:
        """Return the number of frames, including broken ones."""
        return self._count

    def __len__(self) -> int:
        return self._count

    @abstractmethod
    def __getitem__(self, number: int) -> Frame:
        """Return one frame by its number, from 0. Raises SpigoloError if it cannot be read, IndexError without it."""

    @abstractmethod
    def name_of(self, number: int) -> str:
        """Return the name of a frame without reading it."""

    @abstractmethod
    def files_of(self, number: int) -> tuple[Path, ...]:
        """Return the files that hold a frame. All frames of a recording share its files."""


def _warn(name: str, error: SpigoloError) -> None:
    warn(f"{name}: {error}")
