"""Contenders of a comparison of segmentation methods. A contender is a method with one set of parameters, its scores
and a unique name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from spigolo.errors import ConfigError, FileError
from spigolo.lab.evaluation.rows import Row, read_rows
from spigolo.settings.presets import PRESETS

Part = tuple[str, str, str]
"""Method, digest (hash) of its parameters, and name of the file with the scores.

The file name is empty, unless several files hold scores of the same method on the same frames.
"""

Place = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Contender:
    """Scores of one method with one set of parameters."""

    label: str
    """Label of this method with its parameters in the report. No two methods of a comparison have the same label."""
    file: str
    """Name of the file with the scores. The file name is empty, unless several files hold scores of this method on the
    same frames.
    """
    rows: tuple[Row, ...]
    """Scores of the method, one result per frame."""

    @property
    def which(self) -> tuple[str, str]:
        """Return the name of the method and the digest of its parameters."""
        return self.rows[0].method, self.rows[0].digest


def read_contenders(paths: Sequence[Path]) -> list[Contender]:
    """Read files of evaluation results. Return one `Contender` per method and set of parameters."""
    files = {path: read_rows(path) for path in paths}
    rows = gather({str(path): held for path, held in files.items()})
    if not rows:
        raise FileError(f"expected rows in {', '.join(map(str, paths))}, got none: run `spigolo evaluate` first")
    return rows


def gather(files: Mapping[str, Sequence[Row]]) -> list[Contender]:
    """Group evaluation results by method and parameters. files: evaluation results, indexed by file name.

    If files hold results of one method on different frames, the results are combined. If two files hold results of one
    method on the same frames, each file gives its own `Contender`.
    """
    held = {file: _by_method(rows) for file, rows in files.items()}
    parts: dict[Part, dict[Place, Row]] = {}
    for file, methods in held.items():
        others = [other for name, other in held.items() if name != file]
        for which, rows in methods.items():
            clash = any(rows.keys() & other.get(which, {}).keys() for other in others)
            parts.setdefault((*which, file if clash else ""), {}).update(rows)
    firsts = {part: next(iter(rows.values())) for part, rows in parts.items()}
    return [Contender(label, part[2], tuple(parts[part].values())) for part, label in _labels(firsts).items()]


def find_references(contenders: Sequence[Contender], name: str | None = None) -> list[Contender]:
    """Return the reference methods, with which all other methods are compared.

    name: label, digest, preset or method of the reference. If `name` is the name of a file, all methods in this file
    are references.

    If no name is given, the first element of `contenders` is the reference. If no name is given and several files hold
    results for the same frames, all methods in the first file are references. Raises ConfigError if `name` matches no
    method, or if it matches several methods or files.
    """
    if name is None:
        return _of_file(contenders, contenders[0].file) or [contenders[0]]
    alias = (
        PRESETS[name.upper()].digest if name.upper() in PRESETS else name
    )  # a preset name stands for its current parameters
    exact = [c for c in contenders if name == c.label]
    files = {c.file for c in contenders if c.file and name in (c.file, Path(c.file).name, Path(c.file).stem)}
    found = exact or [c for file in files for c in _of_file(contenders, file)]
    if found and len(files) < 2:
        return found
    found = [c for c in contenders if name.lower() in _names(c)] or [c for c in contenders if alias == c.which[1]]
    if len(found) == 1:
        return found
    known = "; ".join(f"{c.label} ({c.which[1]})" for c in contenders)
    raise ConfigError(
        f"expected a file, or the label or digest of one method, got {name!r}, which matches"
        f" {len(found) or 'none'} of the methods: {known}"
    )


def pair_up(contenders: Sequence[Contender], references: Sequence[Contender]) -> list[tuple[Contender, Contender]]:
    """Pair each evaluated method with its reference.

    The reference is the element of `references` with the same method and parameters. If no element has the same method
    and parameters, the reference is the first element of `references`. A reference method is not paired with itself.
    """
    of = {c.which: c for c in references}
    return [(of.get(c.which, references[0]), c) for c in contenders if c not in references]


def _of_file(contenders: Sequence[Contender], file: str) -> list[Contender]:
    return [c for c in contenders if c.file == file] if file else []


def _names(contender: Contender) -> set[str]:
    return {name.lower() for name in (contender.label, *contender.which, contender.rows[0].preset)}


def _by_method(rows: Sequence[Row]) -> dict[tuple[str, str], dict[Place, Row]]:
    methods: dict[tuple[str, str], dict[Place, Row]] = {}
    for row in rows:
        methods.setdefault((row.method, row.digest), {})[row.data_set, row.frame] = row
    return methods


def _labels(firsts: Mapping[Part, Row]) -> dict[Part, str]:
    """Return a short unique label for each method and set of parameters.

    A label consists of the name of the preset or method. If labels are not unique, the digest of the parameters and the
    name of the file are appended.
    """
    one_method = len({method for method, _, _ in firsts}) == 1
    labels = {part: _short(row, one_method) for part, row in firsts.items()}
    labels = _refine(labels, lambda part: part[1] if _digests(labels, labels[part]) > 1 else "")
    labels = _refine(labels, lambda part: Path(part[2]).stem)
    return _refine(labels, lambda part: part[2])


def _short(row: Row, one_method: bool) -> str:
    if not row.preset:
        return row.method
    return row.preset if one_method else f"{row.method} {row.preset}"


def _digests(labels: Mapping[Part, str], label: str) -> int:
    return len({digest for (_, digest, _), other in labels.items() if other == label})


def _refine(labels: Mapping[Part, str], more: Callable[[Part], str]) -> dict[Part, str]:
    """Append more text to labels that are not unique. more: function that returns the additional text."""
    count = Counter(labels.values())
    return {part: f"{label} {more(part)}".rstrip() if count[label] > 1 else label for part, label in labels.items()}
