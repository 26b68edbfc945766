"""Report pages of headings, text, tables and images, written as HTML or Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal


@dataclass(frozen=True, slots=True)
class Cell:
    """Table cell."""

    text: str
    note: str = ""
    """Additional text of a table cell, in smaller print."""
    strong: bool = False
    """True to print the text of the cell in bold."""


@dataclass(frozen=True, slots=True)
class Heading:
    """Section heading."""

    text: str


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Paragraph of plain text."""

    text: str


@dataclass(frozen=True, slots=True)
class Items:
    """Bulleted list, with one sentence per item."""

    sentences: Sequence[str]


@dataclass(frozen=True, slots=True)
class Table:
    """Table of text and values.

    The first `names` columns are left-aligned text, and the other columns are right-aligned values.
    """

    head: Sequence[str]
    """Column headings."""
    rows: Sequence[Sequence[Cell]]
    """Table cells, as one sequence per row."""
    names: int = 1
    """Number of text columns at the left of the table."""
    title: str = ""
    """Title of the table. Only Markdown output prints the title."""
    note: str = ""
    """Text below the table. Only Markdown output prints the note."""

    @property
    def sides(self) -> list[Literal["left", "right"]]:
        """Return the alignment of each column."""
        return ["left" if k < self.names else "right" for k in range(len(self.head))]


def cells(rows: Sequence[Sequence[str]]) -> list[list[Cell]]:
    """Convert rows of strings to rows of table cells."""
    return [[Cell(text) for text in row] for row in rows]


@dataclass(frozen=True, slots=True)
class Picture:
    """Image with a caption."""

    path: str
    """Path of the image file, relative to the page."""
    caption: str


@dataclass(frozen=True, slots=True)
class Gallery:
    """Section of images. In HTML output, a section of images can be opened and closed."""

    title: str
    pictures: Sequence[Picture]
    unfolded: bool = False
    """True if the section of images is open when the page is loaded."""


Block = Heading | Paragraph | Items | Table | Gallery


@dataclass(frozen=True, slots=True)
class Page:
    """Page with a title and a sequence of content blocks."""

    title: str
    blocks: Sequence[Block]


STYLE = """
:root { color-scheme: light dark; --line: #d8dce2; --dim: #667080; --head: #f3f5f8; --ink: #1c2330; --page: #fff; }
@media (prefers-color-scheme: dark) {
  :root { --line: #363c48; --dim: #98a2b3; --head: #232936; --ink: #e4e8ef; --page: #171b23; }
}
body { margin: 2.5rem auto; max-width: 92rem; padding: 0 1.5rem; background: var(--page); color: var(--ink);
  font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; margin: 0 0 .4rem; }
h2 { font-size: 1.2rem; margin: 2.4rem 0 .6rem; }
p, li { max-width: 60rem; }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .35rem .5rem; text-align: right; vertical-align: top; white-space: nowrap; }
th { background: var(--head); font-weight: 600; vertical-align: bottom; white-space: normal; }
th.name, td.name { text-align: left; white-space: normal; }
tr.first td { border-top: 1px solid var(--line); }
table tr:last-child td { border-bottom: 1px solid var(--line); }
td small { display: block; color: var(--dim); font-size: .8em; }
details { margin: .8rem 0; }
summary { cursor: pointer; font-weight: 600; }
.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(34rem, 1fr)); gap: 1.2rem;
  margin-top: .8rem; }
figure { margin: 0; }
figure img { width: 100%; display: block; border-radius: 4px; }
figcaption { color: var(--dim); font-size: .9em; margin-top: .3rem; }
@media (max-width: 40rem) { .gallery { grid-template-columns: 1fr; } }
"""


def to_html(page: Page) -> str:
    """Format a page as HTML. Image files are not embedded but referenced by their paths."""
    title = escape(page.title)
    body = "\n".join(_html(block) for block in page.blocks)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{body}\n</body>\n</html>\n"
    )


def to_markdown(page: Page) -> str:
    """Format a page as Markdown. Image files are not embedded but referenced by their paths."""
    return "\n\n".join([f"# {page.title}", *(_markdown(block) for block in page.blocks)]) + "\n"


def to_text(table: Table) -> str:
    """Format a table as plain text with aligned columns. The note of a table cell is written in parentheses."""
    cells = [list(table.head), *([_text_cell(cell) for cell in row] for row in table.rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(table.head))]
    pads = [str.ljust if k < table.names else str.rjust for k in range(len(widths))]
    lines = ([pad(text, width) for pad, text, width in zip(pads, row, widths, strict=True)] for row in cells)
    return "\n".join("  ".join(line).rstrip() for line in lines)


def _text_cell(cell: Cell) -> str:
    return f"{cell.text} ({cell.note})" if cell.note else cell.text


def _html(block: Block) -> str:
    match block:
        case Heading(text):
            return f"<h2>{escape(text)}</h2>"
        case Paragraph(text):
            return f"<p>{escape(text)}</p>"
        case Items(sentences):
            return "<ul>\n" + "\n".join(f"<li>{escape(s)}</li>" for s in sentences) + "\n</ul>"
        case Table():
            return _html_table(block)
        case Gallery(title, pictures, unfolded):
            shown = " open" if unfolded else ""
            figures = "\n".join(_html_figure(picture) for picture in pictures)
            return (
                f"<details{shown}>\n<summary>{escape(title)}</summary>\n"
                f'<div class="gallery">\n{figures}\n</div>\n</details>'
            )


def _html_figure(picture: Picture) -> str:
    caption, path = escape(picture.caption), escape(picture.path)
    return (
        f'<figure><a href="{path}"><img src="{path}" alt="{caption}" loading="lazy"></a>'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _html_table(table: Table) -> str:
    kinds = ['class="name"' if k < table.names else "" for k in range(len(table.head))]
    head = "".join(f"<th {kind}>{escape(text)}</th>" for kind, text in zip(kinds, table.head, strict=True))
    lines = [f"<tr>{head}</tr>"]
    for number, row in enumerate(table.rows):
        first = _first_of_name(table, number)
        cells = "".join(
            f"<td {kind}>{_html_cell(cell) if k or first else ''}</td>"
            for k, (kind, cell) in enumerate(zip(kinds, row, strict=True))
        )
        lines.append(f'<tr class="{"first" if first else ""}">{cells}</tr>')
    return '<div class="table"><table>\n' + "\n".join(lines) + "\n</table></div>"


def _first_of_name(table: Table, number: int) -> bool:
    return table.names < 2 or number == 0 or table.rows[number - 1][0] != table.rows[number][0]


def _html_cell(cell: Cell) -> str:
    text = f"<b>{escape(cell.text)}</b>" if cell.strong else escape(cell.text)
    return f"{text}<small>{escape(cell.note)}</small>" if cell.note else text


def _markdown(block: Block) -> str:
    match block:
        case Heading(text):
            return f"## {_plain(text)}"
        case Paragraph(text):
            return _plain(text)
        case Items(sentences):
            return "\n".join(f"- {_plain(s)}" for s in sentences)
        case Table():
            title = f"## {_plain(block.title)}\n\n" if block.title else ""
            return title + _markdown_table(block) + (f"\n\n{_plain(block.note)}" if block.note else "")
        case Gallery(title, pictures):
            return "\n\n".join(
                [
                    f"### {_plain(title)}",
                    *(f"![{_plain(p.caption)}]({p.path})\n\n{_plain(p.caption)}" for p in pictures),
                ]
            )


def _markdown_table(table: Table) -> str:
    rule = ["---"] * table.names + ["---:"] * (len(table.head) - table.names)
    lines = [list(map(_plain, table.head)), rule, *([_markdown_cell(cell) for cell in row] for row in table.rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _markdown_cell(cell: Cell) -> str:
    text = f"**{_plain(cell.text)}**" if cell.strong else _plain(cell.text)
    return f"{text} ({_plain(cell.note)})" if cell.note else text


def _plain(text: str) -> str:
    """Escape the special characters of Markdown in a text."""
    for mark in ("\\", "|", "*", "_", "`", "<", "[", "]"):
        text = text.replace(mark, f"\\{mark}")
    return " ".join(text.split())
