"""Detection of the colour file and the depth file of a frame by their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from spigolo.frames.listing import COLOR_NAMES

COLOR_WORDS = frozenset({*COLOR_NAMES, "img"})
DEPTH_WORDS = frozenset({"depth"})
FILLERS = frozenset({"aligned", "registered", "raw", "rect", "to"})
"""Words that say how an image was made, and are left out when names are compared."""
WORDS = re.compile(r"[-_. ]+")
NUMBERED = re.compile(rf"(?<![a-z])({'|'.join(sorted(COLOR_WORDS | DEPTH_WORDS))})(\d+)", re.IGNORECASE)
"""Word for colour or depth with a number directly after it, such as rgb0001."""


def role_of(path: Path) -> str | None:
    """Return "color" or "depth", depending on the words in the name of a file. If the file name has no such word, the
    name of its folder decides. Return None if both names have no such word.

    Names of depth images may also contain a word for colour, as in img_0001_depth.png. Words after "to" do not count,
    as in aligned_depth_to_color.png.
    """
    for name in (path.stem, path.parent.name):
        words = [word.lower() for word in _words(name)]
        own = set(words[: words.index("to")] if "to" in words else words)
        if own & (COLOR_WORDS | DEPTH_WORDS):
            return "depth" if own & DEPTH_WORDS else "color"
    return None


def rest_of(path: Path) -> str:
    """Return the name of a file without suffix and without words for colour and depth: `0001` for `0001-color.png`."""
    left_out = COLOR_WORDS | DEPTH_WORDS | FILLERS
    return "_".join(word for word in _words(path.stem) if word.lower() not in left_out)


def _words(name: str) -> list[str]:
    """Return the words of a name. A word such as rgb0001 counts as two words."""
    return WORDS.split(NUMBERED.sub(r"\1 \2", name))


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
