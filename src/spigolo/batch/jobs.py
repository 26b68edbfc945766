"""Jobs, which describe frames so that another process can read the frames."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from spigolo.errors import FileError
from spigolo.frames.files import read_frame
from spigolo.frames.frame import MAX_PIXELS, Frame

BLOCK = 1 << 20


class Job(Protocol):
    """Description of a frame, which another process uses to read the frame. Any picklable object with the members
    `name`, `stamp`, `fingerprint` and `read` is a job.
    """

    @property
    def name(self) -> str:
        """Name of the frame, unique in a run. The character `/` in the name separates folders."""
        ...

    def stamp(self) -> str:
        """Return a short text that describes the state of the input files. If the text is the same as in an earlier
        run, the input files count as unchanged. The method `stamp` must be fast and must not read the content of files.
        """
        ...

    def fingerprint(self) -> str:
        """Return a hash of the content of all inputs of the frame."""
        ...

    def read(self) -> Frame:
        """Read the frame. Raises SpigoloError."""
        ...


@dataclass(frozen=True, slots=True)
class FrameFiles:
    """Job that reads a frame from image files."""

    name: str
    """Name of the frame, unique in a run."""
    color: str | Path
    """Path of the colour image, or of a .npz file with the whole frame."""
    depth: str | Path
    """Path of the depth image."""
    camera: str | Path | None = None
    """Camera file, camera name or field of view, in a form that `read_frame` accepts."""
    depth_scale: float | None = None
    """Metres per unit of the depth image. If None, the depth scale in the camera file is used."""
    max_pixels: int = MAX_PIXELS
    """Maximum number of pixels of an image."""

    def stamp(self) -> str:
        """Return a hash of the reading options, and of the size and modification time of each input file. Raises
        FileError.
        """
        return _hash(*self._options(), *(f"{s.st_size} {s.st_mtime_ns}" for s in map(_stat, self._files())))

    def fingerprint(self) -> str:
        """Return a hash of the reading options and of the content of each input file. Raises FileError."""
        return _hash(*self._options(), *map(_content, self._files()))

    def read(self) -> Frame:
        """Read the frame. Raises FileError, CameraError or FrameError."""
        return read_frame(self.color, self.depth, self.camera, self.depth_scale, max_pixels=self.max_pixels)

    def _files(self) -> list[Path]:
        files = [Path(self.color), Path(self.depth)]
        if self.camera is not None and os.path.isfile(self.camera):
            files.append(Path(self.camera))
        return files

    def _options(self) -> tuple[str, ...]:
        """Return the reading options as texts: camera name, depth scale and maximum number of pixels."""
        text = self.camera if isinstance(self.camera, str) and not os.path.isfile(self.camera) else None
        return repr(text), repr(self.depth_scale), repr(self.max_pixels)


def _hash(*parts: str) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]


def _stat(path: Path) -> os.stat_result:
    try:
        return path.stat()
    except OSError as error:
        raise _unreadable(path, error) from None


def _content(path: Path) -> str:
    digest = hashlib.sha256()
    try:
        with path.open("rb") as file:
            while block := file.read(BLOCK):
                digest.update(block)
    except OSError as error:
        raise _unreadable(path, error) from None
    return digest.hexdigest()


def _unreadable(path: Path, error: OSError) -> FileError:
    return FileError(f"expected an image in {path}, but the file cannot be read: {error.strerror or error}")
