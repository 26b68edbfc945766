"""Frames of recordings and data sets as jobs of `spigolo.batch`. Any process can read such a frame by its number."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache

from spigolo.errors import FileError
from spigolo.frames.frame import MAX_PIXELS, Frame
from spigolo.sources.base import SizedSource
from spigolo.sources.opening import open_source


@dataclass(frozen=True, slots=True)
class NumberedFrame:
    """One frame of a source whose number of frames is known."""

    name: str
    """Name of the frame, unique in its source."""
    source: str
    """Name of the source, as `open_source` takes it."""
    number: int
    """Number of the frame in the source, from 0."""
    camera: str | None = None
    """Intrinsics that replace those of the source, as `read_frame` takes them."""
    depth_scale: float | None = None
    """Metres per unit of integer depth. None: the unit of the source."""
    max_pixels: int = MAX_PIXELS
    """Maximum number of pixels of an image."""

    def stamp(self) -> str:
        """Return a hash of the options, and of the size and time of each file of the frame. Raises FileError."""
        try:
            stats = [path.stat() for path in self._opened().files_of(self.number)]
        except OSError as error:
            raise FileError(f"could not read {self.source}: {error.strerror or error}") from None
        return _hash(repr(self).encode(), *(f"{s.st_size} {s.st_mtime_ns}".encode() for s in stats))

    def fingerprint(self) -> str:
        """Return a hash of the images and intrinsics of the frame. Raises SpigoloError if it cannot be read."""
        frame = _read(self)
        return _hash(frame.color.tobytes(), frame.depth.tobytes(), repr(frame.camera).encode())

    def read(self) -> Frame:
        """Return the frame. Raises SpigoloError."""
        return _read(self)

    def _opened(self) -> SizedSource:
        return _open(self.source, self.camera, self.depth_scale, self.max_pixels)


def numbered_frames(
    source: str, camera: str | None = None, depth_scale: float | None = None, max_pixels: int = MAX_PIXELS
) -> list[NumberedFrame]:
    """Return all frames of a bag or data set as jobs. Raises FileError for a source without a number of frames."""
    opened = _open(source, camera, depth_scale, max_pixels)
    return [NumberedFrame(opened.name_of(k), source, k, camera, depth_scale, max_pixels) for k in range(len(opened))]


@lru_cache(maxsize=1)
def _open(source: str, camera: str | None, depth_scale: float | None, max_pixels: int) -> SizedSource:
    """Return the opened source. Each process opens the source of its jobs once."""
    opened = open_source(source, camera, depth_scale, max_pixels=max_pixels)
    if not isinstance(opened, SizedSource):
        opened.close()
        raise FileError(
            f"expected a source with a known number of frames, got {source}: segment cameras and recordings of the"
            " RealSense SDK with `spigolo segment`"
        )
    return opened


@lru_cache(maxsize=1)
def _read(job: NumberedFrame) -> Frame:
    """Return the frame of a job. The last frame is kept, as its hash and its segmentation need it one after another."""
    return job._opened()[job.number]


def _hash(*parts: bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:32]
