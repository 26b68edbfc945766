"""Tables I to III of the paper (Toscana & Rosa 2016), with printed and measured values.

In the paper's tables, an object counts as found if one segment covers more than 70 % of the object's pixels. The values
of the method in parentheses (Mishra et al.) count objects that are covered by 50 %.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from spigolo.errors import FileError
from spigolo.frames.files import write_bytes
from spigolo.lab.evaluation.measures import FOUND_SHARE
from spigolo.lab.evaluation.rows import Row
from spigolo.lab.experiments.contenders import Contender
from spigolo.lab.experiments.printed import TABLES, Place, Printed
from spigolo.lab.page import Block, Cell, Heading, Items, Page, Paragraph, Table, to_html, to_markdown
from spigolo.settings.presets import PRESETS

RENDERED = "-rendered"
"""Suffix of the names of rendered data sets."""
NOT_DONE = "-"
"""Text of empty cells in the paper's tables."""
BESIDE_SHARE = 0.5
"""An object counts as found by the method in parentheses if its share of covered pixels is above `BESIDE_SHARE`."""


@dataclass(frozen=True, slots=True)
class Tally:
    """Numbers of objects for one table cell."""

    objects: int = 0
    found: int = 0
    """Number of objects with more than 70 % of their pixels in one predicted object."""
    in_regions: int = 0
    """Number of objects with more than 70 % of their pixels in one region. Rejected regions are included."""
    half: int = 0
    """Number of objects with more than 50 % of their pixels in one predicted object."""

    def __add__(self, other: Tally) -> Tally:
        return Tally(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))

    @property
    def share(self) -> str:
        """Return the percentage of objects found, as a string."""
        return _percent(self.found, self.objects)

    @property
    def share_half(self) -> str:
        """Return the percentage of objects with more than 50 % of their pixels in one predicted object, as a string."""
        return _percent(self.half, self.objects)

    @property
    def share_in_regions(self) -> str:
        """Return the share of objects with more than 70 % of their pixels in one region, as text in per cent."""
        return _percent(self.in_regions, self.objects)

    def among(self, other: Tally) -> str:
        """Return the text "of N" for N objects if `other` has a different number of objects, else an empty string."""
        return "" if self.objects == other.objects else f"of {self.objects}"


@dataclass(frozen=True, slots=True)
class Measured:
    """Measured values of one table of the paper, on one data set."""

    printed: Printed
    rendered: bool
    """True if the frames are rendered."""
    n_frames: int
    tallies: Mapping[str, Mapping[Place, Tally]]
    """Numbers of objects, indexed by method and table cell. The first method runs with the preset of the paper."""
    reference: str | None
    """Name of the method whose values are printed in parentheses, or None."""

    @property
    def title(self) -> str:
        """Return the title of the table. The title states if the frames are rendered."""
        on = f"rendered stand-in for {self.printed.about}" if self.rendered else self.printed.about
        return f"Table {self.printed.number}: {on}"


def write_paper_tables(contenders: Sequence[Contender], out: Path) -> list[tuple[str, Table]]:
    """Write a report with the paper's tables as index.html and report.md into the folder `out`.

    Return the title and the content of each table.

    Raises FileError if a file cannot be written. Also raises FileError if results for the paper's data sets or presets
    are missing.
    """
    measured = measure(contenders)
    tables = [(one.title, paper_table(one)) for one in measured]
    blocks: list[Block] = []
    for one, (title, table) in zip(measured, tables, strict=True):
        blocks += [Heading(title), Paragraph(_about(one)), table]
    page = Page("The paper's tables", [*blocks, Heading("How to read this"), Items(_explanations(measured))])
    write_bytes(out / "index.html", to_html(page).encode())
    write_bytes(out / "report.md", to_markdown(page).encode())
    return tables


def measure(contenders: Sequence[Contender]) -> list[Measured]:
    """Compute the values of the paper's tables from evaluation results.

    Raises FileError if results for the paper's data sets and presets are missing.
    """
    sets = [(printed, rendered) for printed in TABLES for rendered in (False, True)]
    measured = [one for pair in sets if (one := _measure(contenders, *pair)) is not None]
    if not measured:
        known = ", ".join(printed.data_set for printed in TABLES)
        names = {printed.data_set + suffix for printed in TABLES for suffix in ("", RENDERED)}
        if any(row.data_set in names for contender in contenders for row in contender.rows):
            raise FileError(
                f"expected labelled frames of {known}, got rows without scores: fetch the poses or masks of the data"
                " set, too"
            )
        raise FileError(
            f"expected rows of {known}, or of their stand-ins, got none: evaluate one of these data sets, or stand-ins"
            " of `spigolo render FAMILY --layout original`"
        )
    return measured


def paper_table(measured: Measured) -> Table:
    """Return a table with the values printed in the paper and the measured values."""
    return _wide(measured) if len(measured.printed.columns) > 1 else _narrow(measured)


def _measure(contenders: Sequence[Contender], printed: Printed, rendered: bool) -> Measured | None:
    name = printed.data_set + (RENDERED if rendered else "")
    held = {c.label: (c, [row for row in c.rows if row.data_set == name and row.score is not None]) for c in contenders}
    held = {label: pair for label, pair in held.items() if pair[1]}
    if not held:
        return None
    ours = ("toscana2016", PRESETS[printed.preset].digest)
    order = sorted(held, key=lambda label: held[label][0].which != ours)
    if held[order[0]][0].which != ours:
        raise FileError(
            f"expected rows of toscana2016 with preset {printed.preset} on {name} for Table {printed.number}, got rows"
            f" of {', '.join(order)}: run `spigolo evaluate FOLDER --presets {printed.preset}` with the same --out"
        )
    tallies = {label: _tally(held[label][1], printed) for label in order}
    reference = next((label for label in order if held[label][0].which[0] == printed.beside), None)
    return Measured(printed, rendered, len(held[order[0]][1]), tallies, reference)


def _tally(rows: Sequence[Row], printed: Printed) -> dict[Place, Tally]:
    tallies: dict[Place, Tally] = {}
    for row in rows:
        for place, tally in _judged(row, printed):
            tallies[place] = tallies.get(place, Tally()) + tally
    return tallies


def _judged(row: Row, printed: Printed) -> Iterator[tuple[Place, Tally]]:
    """Yield the table cell of each object in a frame, with the counts (`Tally`) of this single object.

    Objects that belong to no table cell are left out.
    """
    score = row.score
    assert score is not None
    if not len(score.names) == len(score.covered) == score.n_objects:
        raise FileError(
            f"expected the names of the objects in the row of {row.data_set}/{row.frame}, got a row of spigolo"
            f" {row.version} without names: evaluate the frames again into a new file"
        )
    for name, covered, by_region in zip(score.names, score.covered, score.covered_by_regions, strict=True):
        place = printed.place(row.frame, name)
        if place in printed.figures:
            yield place, Tally(1, covered > FOUND_SHARE, by_region > FOUND_SHARE, covered > BESIDE_SHARE)


def _narrow(measured: Measured) -> Table:
    printed, column = measured.printed, measured.printed.columns[0]
    head = ["", "objects, printed", "found, printed", "objects"]
    head += [part for label in measured.tallies for part in (label, "in its regions")]
    rows = []
    for line in printed.lines:
        figure = printed.figures[line, column]
        tallies = [cells.get((line, column), Tally()) for cells in measured.tallies.values()]
        cells = [Cell(line), Cell(str(figure.objects)), Cell(f"{figure.found} %"), Cell(str(tallies[0].objects))]
        for tally in tallies:
            note = tally.among(tallies[0])
            cells += [Cell(tally.share, note, tally is tallies[0]), Cell(tally.share_in_regions, note)]
        rows.append(cells)
    return Table(head, rows)


def _wide(measured: Measured) -> Table:
    """Return a table that has one column per class of objects, with the values printed in the paper and the measured
    values.

    Each line of the paper's table becomes several rows: printed values, measured values, and numbers of objects.
    """
    printed = measured.printed
    first, *others = [label for label in measured.tallies if label != measured.reference]
    name = f"{first} ({measured.reference})" if measured.reference else first
    rows = []
    for line in printed.lines:
        figures = [printed.figures.get((line, column)) for column in printed.columns]
        rows.append([Cell(line), Cell("printed"), *(Cell(f.found, f.beside) if f else Cell(NOT_DONE) for f in figures)])
        rows.append([Cell(line), Cell(name), *_paired_cells(measured, line, first)])
        tallies = _tallies(measured, line, first)
        in_regions = (Cell(t.share_in_regions if t else NOT_DONE) for t in tallies)
        rows.append([Cell(line), Cell(f"in the regions of {first}"), *in_regions])
        for label in others:
            pairs = zip(_tallies(measured, line, label), tallies, strict=True)
            rows.append(
                [Cell(line), Cell(label), *(Cell(t.share, t.among(r)) if t and r else Cell("-") for t, r in pairs)]
            )
        rows.append([Cell(line), Cell("objects"), *(Cell(str(t.objects) if t else NOT_DONE) for t in tallies)])
    return Table(["scene", "", *printed.columns], rows, names=2)


def _paired_cells(measured: Measured, line: str, label: str) -> Iterator[Cell]:
    """Yield the cells of one table line for the method `label`. The values in parentheses are the shares of objects of
    which the method `measured.reference` covers more than 50 %, as in the paper.
    """
    tallies = _tallies(measured, line, label)
    references = _tallies(measured, line, measured.reference) if measured.reference else [None] * len(tallies)
    for tally, other in zip(tallies, references, strict=True):
        yield Cell(tally.share, other.share_half if other else "", strong=True) if tally else Cell(NOT_DONE)


def _tallies(measured: Measured, line: str, label: str) -> list[Tally | None]:
    """Return the numbers of objects in each cell of a table line.

    The returned list has None for cells that are empty in the paper.
    """
    places = [(line, column) for column in measured.printed.columns]
    return [measured.tallies[label].get(p, Tally()) if p in measured.printed.figures else None for p in places]


def _about(measured: Measured) -> str:
    kind = "rendered frames" if measured.rendered else "frames"
    return f"{measured.n_frames} {kind}. {measured.printed.note}"


def _explanations(measured: Sequence[Measured]) -> list[str]:
    stand_in = "Values measured on rendered stand-ins cannot be compared with the printed values."
    return [
        "Found: one returned object covers more than 70 % of the object's pixels, or more than 50 % for the method in"
        " parentheses, as in the paper. It may also cover other pixels. In"
        " its regions: the same for any region, including rejected regions. The paper does not say which of the two it"
        " counts. A region with half of the scene covers every object inside.",
        "Printed: values of Toscana and Rosa 2016, with masks drawn by hand. Each object of each frame counts once.",
        "– : these frames have no such object.",
        *([stand_in] if any(one.rendered for one in measured) else []),
    ]


def _percent(hits: int, n: int) -> str:
    return f"{100 * hits / n:.1f} %" if n else "–"
