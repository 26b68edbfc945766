"""Listing of the files of a folder in natural order, without hidden files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

RECORDINGS = (".bag", ".db3", ".mcap", ".mkv", ".oni", ".svo", ".svo2", ".klg", ".mp4", ".avi")
"""File suffixes of recordings, which contain streams instead of single images."""
COLOR_NAMES = ("rgb", "color", "colour", "image")
"""Common names of colour images and of their folders. A common name such as rgb cannot serve as the name of a frame."""
OPENED = (".bag", ".db3", ".mcap")
"""File suffixes of recordings that `sp.open_source` can read."""
NOT_OURS = ("__MACOSX", "@eaDir", "Thumbs.db", "$RECYCLE.BIN")
"""Names of files and folders that operating systems create. Files and folders with these names are skipped."""
EXACT_FIRST = (".npz", ".npy", ".exr", ".tif", ".tiff", ".png", ".pgm", ".ppm", ".pnm", ".bmp", ".webp")
"""File suffixes in order of preference. If several file names differ only in the suffix, the file with the most
preferred suffix is used. Suffixes that are not in the tuple come last.
"""


def natural_order(path: Path) -> tuple[list[tuple[int, str]], str]:
    """Return a sort key for file names that compares numbers by value, so that learn2 comes before learn10."""
    words = re.split(r"([0-9]+)", path.name)
    return [(int(word), "") if word.isdecimal() else (-1, word) for word in words], path.as_posix()


def is_ours(path: Path) -> bool:
    """Return True for a file of the user, and False for a hidden file or a file that the operating system created."""
    return not path.name.startswith(".") and path.name not in NOT_OURS


def listed(folder: Path, pattern: str = "*") -> list[Path]:
    """Return the files of a folder that match a glob pattern, in natural order and without hidden files."""
    found = (path for path in folder.glob(pattern) if all(is_ours(p) for p in _parts(path, folder)))
    return sorted(found, key=lambda path: [natural_order(part) for part in _parts(path, folder)])


def best_of_each(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield one file of each group of files whose names differ only in the suffix. A lossless image is preferred to a
    lossy image.
    """
    best: dict[str, Path] = {}
    for path in paths:
        known = best.setdefault(path.stem, path)
        if _rank(path) < _rank(known):
            best[path.stem] = path
    yield from best.values()


def _rank(path: Path) -> int:
    suffix = path.suffix.lower()
    return EXACT_FIRST.index(suffix) if suffix in EXACT_FIRST else len(EXACT_FIRST)


def _parts(path: Path, folder: Path) -> list[Path]:
    return [Path(part) for part in path.relative_to(folder).parts if part != ".."]
