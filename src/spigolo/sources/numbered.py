"""Frames of recordings and data sets as jobs of `spigolo.batch`. Each process reads the frame of a job by its
number.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from spigolo.errors import FileError
from spigolo.frames.frame import MAX_PIXELS, Frame
from spigolo.sources.base import SizedSource
from spigolo.sources.opening import open_source


@dataclass(frozen=True, slots=True)
class NumberedFrame:
    """Job that reads one frame of a recording or data set by its number."""

    name: str
    """Name of the frame, unique in its source."""
    source: str
    """Name of the source in the form that `open_source` accepts."""
    number: int
    """Number of the frame in the source, from 0."""
    camera: str | None = None
    """Intrinsics in any form that `read_frame` accepts. If None, the intrinsics of the source are used."""
    depth_scale: float | None = None
    """Metres per unit of integer depth. If None, the depth scale of the source is used."""
    max_pixels: int = MAX_PIXELS
    """Maximum number of pixels of an image."""

    def stamp(self) -> str:
        """Return a hash of the reading options, and of the size and modification time of each file of the frame. Raises
        FileError.
        """
        try:
            stats = [path.stat() for path in self._opened().files_of(self.number)]
        except OSError as error:
            raise FileError(f"could not read {self.source}: {error.strerror or error}") from None
        return _hash(repr(self).encode(), *(f"{s.st_size} {s.st_mtime_ns}".encode() for s in stats))

    def fingerprint(self) -> str:
        """Return a hash of the images and intrinsics of the frame. Raises SpigoloError for an unreadable frame."""
        frame = self.read()
        return _hash(frame.color.tobytes(), frame.depth.tobytes(), repr(frame.camera).encode())

    def read(self) -> Frame:
        """Return the frame. Raises SpigoloError."""
        return _read(self, self.stamp())

    def _opened(self) -> SizedSource:
        return open_numbered(self.source, self.camera, self.depth_scale, self.max_pixels)


def numbered_frames(
    source: str, camera: str | None = None, depth_scale: float | None = None, max_pixels: int = MAX_PIXELS
) -> list[NumberedFrame]:
    """Return all frames of a bag or data set as jobs. Raises FileError for a live camera or a RealSense recording."""
    opened = open_numbered(source, camera, depth_scale, max_pixels)
    return [NumberedFrame(opened.name_of(k), source, k, camera, depth_scale, max_pixels) for k in range(len(opened))]


def open_numbered(source: str, camera: str | None, depth_scale: float | None, max_pixels: int) -> SizedSource:
    """Open a source whose frames have numbers. Raises FileError for a live camera or a RealSense recording.

    Each process opens the source of its jobs only once, unless the file or folder of the source has changed.
    """
    path = Path(source.removeprefix("dataset:").partition("?")[0])
    state = path.stat() if path.exists() else None
    return _open(source, camera, depth_scale, max_pixels, state and (state.st_size, state.st_mtime_ns))


@lru_cache(maxsize=1)
def _open(
    source: str, camera: str | None, depth_scale: float | None, max_pixels: int, state: tuple[int, int] | None
) -> SizedSource:
    """Open a source, or return the source that was opened last if all arguments are the same. state: size and
    modification time of the file or folder, so that a changed source is opened again.
    """
    opened = open_source(source, camera, depth_scale, max_pixels=max_pixels)
    if not isinstance(opened, SizedSource):
        opened.close()
        raise FileError(
            f"expected a source with a known number of frames, got {source}: segment cameras and recordings of the"
            " RealSense SDK with `spigolo segment`"
        )
    return opened


@lru_cache(maxsize=1)
def _read(job: NumberedFrame, stamp: str) -> Frame:
    """Read the frame of a job. The last frame is cached, because the fingerprint and the segmentation of a job both
    read the frame. stamp: text of `NumberedFrame.stamp`. If the input files change, the frame is read again.
    """
    return job._opened()[job.number]


def _hash(*parts: bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:32]
