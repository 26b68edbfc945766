"""TUM RGB-D benchmark (Sturm et al. 2012), and whoever keeps its lists.

    SEQUENCE/rgb.txt                  lines of `time file`, # begins a comment; seconds, paths from SEQUENCE
    SEQUENCE/depth.txt                the same; 16 bits, 5000 units to the metre, 0 = missing
    SEQUENCE/camera.json              optional, another camera than a nominal Kinect v1, as the benchmark advises

Each colour image goes with the depth image nearest in time, within 20 ms, and without one it is left out. There are no
labels. The frames of a sequence are near-identical. A folder of sequences serves as well.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from spigolo.errors import FileError
from spigolo.frames.camera import Camera
from spigolo.frames.files import read_camera
from spigolo.lab.datasets.entry import DataSet, Entry, ImageEntry

DEPTH_SCALE = 1 / 5000
MAX_APART_S = 0.02


class Tum(DataSet):
    """Sequences of the TUM RGB-D benchmark."""

    layout = "rgb.txt and depth.txt with lines `time file` (TUM)"

    @classmethod
    def matches(cls, folder: Path) -> bool:
        """Whether it or a folder in it has both lists."""
        return bool(_sequences(folder))

    def _find(self) -> Iterator[Entry]:
        usual = self._camera(Camera.named("kinect-v1"))
        for sequence in _sequences(self.folder):
            own = sequence / "camera.json"
            camera = read_camera(own, usual.width, usual.height)[0] if own.is_file() else usual
            data_set = self._named(sequence.name)
            for color, depth in _associated(_listed(sequence / "rgb.txt"), _listed(sequence / "depth.txt")):
                yield ImageEntry(data_set, color.stem, data_set, "none", color, depth, camera, DEPTH_SCALE)


def _sequences(folder: Path) -> list[Path]:
    found = [path.parent for pattern in ("rgb.txt", "*/rgb.txt") for path in sorted(folder.glob(pattern))]
    return [path for path in found if (path / "depth.txt").is_file()]


def _listed(path: Path) -> list[tuple[float, Path]]:
    """Time and file of each line, by time; raises FileError."""
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        if line.strip() and not line.startswith("#"):
            try:
                time, file = line.split(maxsplit=1)
                found.append((float(time), path.parent / file.strip()))
            except ValueError:
                raise FileError(f"expected `time file` in line {number} of {path}, got {line[:60]!r}") from None
    return sorted(found)


def _associated(colors: list[tuple[float, Path]], depths: list[tuple[float, Path]]) -> Iterator[tuple[Path, Path]]:
    times = np.array([time for time, _ in depths])
    for time, color in colors:
        nearest = int(np.argmin(np.abs(times - time))) if times.size else -1
        if nearest >= 0 and abs(times[nearest] - time) <= MAX_APART_S:
            yield color, depths[nearest][1]
