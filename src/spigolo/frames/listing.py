"""Listing of a folder's files in natural order, without hidden files, and with one file per name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

RECORDINGS = (".bag", ".db3", ".mcap", ".mkv", ".oni", ".svo", ".svo2", ".klg", ".mp4", ".avi")
"""Suffixes of recordings, which hold streams instead of single images."""
OPENED = (".bag", ".db3", ".mcap")
"""Suffixes of the recordings that `sp.open_source` reads."""
NOT_OURS = ("__MACOSX", "@eaDir", "Thumbs.db", "$RECYCLE.BIN")
"""Names that operating systems create. Names that begin with a dot are left out too."""
EXACT_FIRST = (".npz", ".npy", ".exr", ".tif", ".tiff", ".png", ".pgm", ".ppm", ".pnm", ".bmp", ".webp")
"""Suffixes in order of preference for files of the same name. Lossy formats such as JPEG come last."""


def natural_order(path: Path) -> tuple[list[tuple[int, str]], str]:
    """Return a sort key that puts learn2 before learn10, the same on every file system."""
    words = re.split(r"([0-9]+)", path.name)
    return [(int(word), "") if word.isdecimal() else (-1, word) for word in words], path.as_posix()


def is_ours(path: Path) -> bool:
    """Return True if a file belongs to the user: no leading dot and not created by the operating system."""
    return not path.name.startswith(".") and path.name not in NOT_OURS


def listed(folder: Path, pattern: str = "*") -> list[Path]:
    """Return the matching files of a folder in natural order of each part of the path, without hidden ones."""
    found = (path for path in folder.glob(pattern) if all(is_ours(p) for p in _parts(path, folder)))
    return sorted(found, key=lambda path: [natural_order(part) for part in _parts(path, folder)])


def best_of_each(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield one file of each name. A lossless file is preferred to a preview of the same name."""
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
