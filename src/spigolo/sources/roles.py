"""Detection of the colour file and the depth file of a frame by their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from spigolo.frames.listing import COLOR_NAMES

COLOR_WORDS = frozenset({*COLOR_NAMES, "img"})
DEPTH_WORDS = frozenset({"depth"})
WORDS = re.compile(r"[-_. ]+")


def role_of(path: Path) -> str | None:
    """Return "color" or "depth", depending on the words in the name of a file. If the file name has no such word, the
    name of its folder decides. Return None if both names are unclear.
    """
    for name in (path.stem, path.parent.name):
        words = set(WORDS.split(name.lower()))
        is_color, is_depth = bool(words & COLOR_WORDS), bool(words & DEPTH_WORDS)
        if is_color != is_depth:
            return "color" if is_color else "depth"
    return None


def rest_of(path: Path) -> str:
    """Return the name of a file without suffix and without words for colour and depth: `0001` for `0001-color.png`."""
    words = WORDS.split(path.stem)
    return "_".join(word for word in words if word.lower() not in COLOR_WORDS | DEPTH_WORDS)


def match_by_name(files: Sequence[Path]) -> list[tuple[Path, Path]]:
    """Return pairs of colour and depth files whose names differ only in the word for colour or depth.

    Files without a partner are left out. Returns an empty list if the pairs are ambiguous.
    """
    found: dict[str, dict[str, Path]] = {"color": {}, "depth": {}}
    for path in files:
        role = role_of(path)
        if role is None:
            continue
        if rest_of(path) in found[role]:
            return []
        found[role][rest_of(path)] = path
    return [(path, found["depth"][rest]) for rest, path in found["color"].items() if rest in found["depth"]]
