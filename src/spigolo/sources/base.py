"""Base classes of all sources. A source is an iterable of frames that counts unusable images."""

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
"""Function that is called with the name of an unreadable frame or message, and with the error."""


def counted(number: int, noun: str) -> str:
    """Format a number with its noun, such as "1 frame" or "2 frames"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


@dataclass(frozen=True, slots=True)
class Report:
    """Numbers of frames and images of a source since the start of the last iteration."""

    frames: int
    """Number of frames that the source has yielded."""
    unmatched: int = 0
    """Number of colour and depth images that belong to no pair, for example because their time stamps differ by more
    than `tolerance_ms`.
    """
    broken: int = 0
    """Number of unreadable frames or messages."""
    dropped: int = 0
    """Number of frames of a live source that were replaced by newer frames before use."""
    tolerance_ms: float | None = None
    """Maximum difference between the stamps of a pair, in milliseconds. The value is None if images are not paired by
    their stamps.
    """
    pace: Pace | None = None
    """Frame rate, and latency from the arrival of a frame until the next frame is requested. The value is None for a
    recording.
    """

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
    """Iterable of the frames of a folder, data set, recording or camera. Use a source in a `with` statement, which
    closes the source at the end.

    Unreadable frames are skipped and counted. The function `on_broken` is called for each unreadable frame. By default,
    the function issues a warning.
    """

    live = False
    """True if the frames come from a camera, so that iteration does not end."""

    def __init__(self, name: str, options: Options) -> None:
        self.name = name
        """Name of the source, for messages."""
        self.options = options
        """Options of the source."""
        self.intrinsics = ""
        """Origin of the intrinsics, such as the device. The text is empty if the caller gave the intrinsics, or if they
        are unknown.
        """
        self.on_broken: OnBroken = _warn
        self._frames_done = self._unmatched = self._broken = 0

    @property
    def count(self) -> int | None:
        """Return the number of frames, or None if the number is unknown."""
        return None

    @abstractmethod
    def _frames(self) -> Iterator[Frame]:
        """Yield all frames, starting with the first frame."""

    def __iter__(self) -> Iterator[Frame]:
        self._frames_done = self._unmatched = self._broken = 0
        for frame in self._frames():
            self._frames_done += 1
            yield frame

    def report(self) -> Report:
        """Return the numbers of frames and images since the start of the last iteration."""
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
    """Source with a known number of frames, in which each frame can be read by its number."""

    def __init__(self, name: str, options: Options, count: int) -> None:
        super().__init__(name, options)
        self._count = count

    @property
    def count(self) -> int:
        """Return the number of frames, including unreadable frames."""
        return self._count

    def __len__(self) -> int:
        return self._count

    @abstractmethod
    def __getitem__(self, number: int) -> Frame:
        """Return a frame by its number, from 0. Raises SpigoloError for an unreadable frame, and IndexError for a
        number out of range.
        """

    @abstractmethod
    def name_of(self, number: int) -> str:
        """Return the name of a frame without reading the frame."""

    @abstractmethod
    def files_of(self, number: int) -> tuple[Path, ...]:
        """Return the files that contain a frame. For a recording, the files are the same for all frames."""


def _warn(name: str, error: SpigoloError) -> None:
    warn(f"{name}: {error}")
