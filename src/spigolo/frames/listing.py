"""Files of a folder that count: in natural order, without hidden ones, the lossless one of several of one name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

RECORDINGS = (".bag", ".db3", ".mcap", ".mkv", ".oni", ".svo", ".svo2", ".klg", ".mp4", ".avi")
"""Suffixes of recordings, which hold streams and no images."""
OPENED = (".bag", ".db3", ".mcap")
"""Suffixes of those that `sp.open_source` reads."""
NOT_OURS = ("__MACOSX", "@eaDir", "Thumbs.db", "$RECYCLE.BIN")
"""Names that systems leave behind, next to those that begin with a dot."""
EXACT_FIRST = (".npz", ".npy", ".exr", ".tif", ".tiff", ".png", ".pgm", ".ppm", ".pnm", ".bmp", ".webp")
"""Suffixes in the order in which files of one name are taken. Others, such as JPEG, lose something and come last."""


def natural_order(path: Path) -> tuple[list[tuple[int, str]], str]:
    """Return a key that puts learn2 before learn10, the same on every file system."""
    words = re.split(r"([0-9]+)", path.name)
    return [(int(word), "") if word.isdecimal() else (-1, word) for word in words], path.as_posix()


def is_ours(path: Path) -> bool:
    """Return whether a name is a user's: no dot at its beginning, nothing that a system left."""
    return not path.name.startswith(".") and path.name not in NOT_OURS


def listed(folder: Path, pattern: str = "*") -> list[Path]:
    """Return what matches in a folder, without hidden files and folders, in natural order of each part of the path."""
    found = (path for path in folder.glob(pattern) if all(is_ours(p) for p in _parts(path, folder)))
    return sorted(found, key=lambda path: [natural_order(part) for part in _parts(path, folder)])


def best_of_each(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield one file of each name: the one that is exact, where a preview has the same name."""
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
