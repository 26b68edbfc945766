"""Reader of the TUM RGB-D benchmark (Sturm et al., 2012), and of other sequences with the same file layout.

    SEQUENCE/rgb.txt                  lines of `time file`, # begins a comment: seconds, paths from SEQUENCE
    SEQUENCE/depth.txt                the same: 16 bits, 5000 units to the metre, 0 = missing
    SEQUENCE/camera.json              optional: intrinsics and depth_scale, by default of a nominal Kinect v1. Other
                                      camera files that `read_frame` finds next to images are read, too

Timestamps may be in seconds, milliseconds, microseconds or nanoseconds. The unit of the timestamps is inferred from
their values. Each colour image is paired with the depth image nearest in time. Colour images without a depth image
within 20 ms are left out. The frames have no labels. The frames of a sequence form a group of near-identical frames.
The reader also accepts a folder that contains several sequences.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import numpy as np

from spigolo.errors import FileError, warn
from spigolo.frames.camera import Camera
from spigolo.frames.files import read_color, read_depth
from spigolo.frames.frame import Frame
from spigolo.frames.listing import listed
from spigolo.lab.datasets.entry import DataSet, Entry, ImageEntry

DEPTH_SCALE = 1 / 5000
MAX_APART_S = 0.02
UNITS_S = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))
"""Units of timestamps that count from 1970, as pairs (minimum median timestamp, unit in seconds).

The pairs of minimum and unit are tested in the given order. The unit of the timestamps is taken from the first pair
with a minimum that is at most the median of the timestamps.
"""
GAPS_S = ((3e6, 1e-9), (3e3, 1e-6), (8.0, 1e-3))
"""Units of timestamps that start at 0, as pairs (minimum median difference between successive timestamps, unit in
seconds). Successive frames of a camera are 8 ms to 3 s apart.

The pairs of minimum and unit are tested in the given order. The unit of the timestamps is taken from the first pair
with a minimum that is at most the median difference. If every minimum is above the median difference, the unit of the
timestamps is seconds.
"""
MANY_ALONE = 0.5
"""Maximum share of colour images without a depth image. If the share of colour images without a depth image is larger,
a warning is given.
"""

Stamped = list[tuple[float, Path]]


@dataclass(frozen=True, slots=True)
class StampedEntry(ImageEntry):
    """Frame with a time stamp."""

    stamp_ns: int
    """Time of the colour image in nanoseconds."""

    def read(self) -> Frame:
        """Read the colour image and the depth map.

        Raises FileError, FrameError or CameraError for missing or invalid files.
        """
        color, depth = read_color(self.color), read_depth(self.depth)
        return Frame(color, depth, self.camera, self.name, self.stamp_ns, self.depth_scale)


class Tum(DataSet):
    """Data set with one or several sequences of the TUM RGB-D benchmark."""

    layout = "rgb.txt and depth.txt with lines `time file` (TUM)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Return True if the folder, or one of its subfolders, has the files rgb.txt and depth.txt."""
        return bool(_sequences(folder))

    def _find(self) -> Iterator[Entry]:
        for sequence in _sequences(self.folder):
            camera, scale = self._camera(Camera.named("kinect-v1"), DEPTH_SCALE, sequence)
            data_set = self._named(sequence.name)
            for time_s, color, depth in _associated(sequence):
                stamp_ns = round(time_s * 1e6) * 1000  # a float64 of seconds since 1970 is exact to microseconds
                yield StampedEntry(data_set, color.stem, data_set, "none", color, depth, camera, scale, stamp_ns)


def _sequences(folder: Path) -> list[Path]:
    found = [path.parent for pattern in ("rgb.txt", "*/rgb.txt") for path in listed(folder, pattern)]
    return [path for path in found if (path / "depth.txt").is_file()]


def _listed(path: Path) -> Stamped:
    """Read a list of image files with timestamps, such as rgb.txt.

    Return the time in seconds and the image file of each line, sorted by time. Raises FileError if the file cannot be
    read.
    """
    found = []
    for number, line in enumerate(_text(path).splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:
                time, file = re.split(r"[,\s]+", line.strip(), maxsplit=1)
                if not np.isfinite(float(time)):
                    raise ValueError(time)
                file = file.strip().replace("\\", "/")
                if not _stays_inside(file):
                    raise FileError(f"expected a file in {path.parent} in line {number} of {path}, got {file[:60]!r}")
                found.append((float(time), path.parent / file))
            except ValueError:
                raise FileError(f"expected `time file` in line {number} of {path}, got {line[:60]!r}") from None
    found.sort()
    unit_s = _unit_s(np.array([time for time, _ in found]))
    return [(time * unit_s, file) for time, file in found]


def _stays_inside(file: str) -> bool:
    """Return True if a path is relative and stays inside its folder."""
    inside = posixpath.normpath(file)
    return not (inside == ".." or inside.startswith(("../", "/")) or PureWindowsPath(inside).drive)


def _text(path: Path) -> str:
    """Read a text file in UTF-8 or UTF-16 encoding. Raises FileError if the file cannot be read."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise FileError(f"expected a list in {path}, but the file cannot be read: {error.strerror or error}") from None
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    if b"\0" in data[:4]:
        return data.decode("utf-16-be" if data[:1] == b"\0" else "utf-16-le", errors="replace")
    return data.decode("utf-8-sig", errors="replace")


def _unit_s(times: np.ndarray) -> float:
    """Infer the unit of timestamps from their values or differences. Return the unit of the timestamps in seconds."""
    if not times.size:
        return 1.0
    absolute = next((unit for least, unit in UNITS_S if np.median(times) >= least), None)
    if absolute is not None or times.size < 2:
        return absolute or 1.0
    gap = float(np.median(np.diff(times)))
    return next((unit for least, unit in GAPS_S if gap >= least), 1.0)


def _associated(sequence: Path) -> Iterator[tuple[float, Path, Path]]:
    """Yield the time of each colour image in seconds, the colour image, and the depth image nearest in time. Both
    images are at most `MAX_APART_S` apart.

    Raises FileError if there are no pairs of images. Warns if most colour images have no depth image.
    """
    colors, depths = _listed(sequence / "rgb.txt"), _listed(sequence / "depth.txt")
    times = np.array([time for time, _ in depths])
    pairs, apart_s = [], []
    for time, color in colors:
        nearest = int(np.argmin(np.abs(times - time))) if times.size else -1
        apart_s.append(abs(times[nearest] - time) if times.size else np.inf)
        if apart_s[-1] <= MAX_APART_S:
            pairs.append((time, color, depths[nearest][1]))
    alone = len(colors) - len(pairs)
    if apart_s and times.size and not pairs:
        raise FileError(
            f"expected depth within {1000 * MAX_APART_S:.0f} ms of a colour image in {sequence}, got the nearest"
            f" {_duration(min(apart_s))} apart: all {alone} colour images have no partner. Check that both"
            " lists use one clock"
        )
    if alone > MANY_ALONE * len(colors):
        warn(f"{sequence}: {alone} of {len(colors)} colour images have no depth within {1000 * MAX_APART_S:.0f} ms")
    yield from pairs


def _duration(seconds: float) -> str:
    return f"{1000 * seconds:.0f} ms" if seconds < 10 else f"{seconds:.0f} s"
