"""Count style faults in docstrings, comments and pages: `python scripts/count_prose.py [--list] [NAME ...]`.

Each NAME is a folder or file of this repository, or a package that is installed for this Python. The script prints
three counts per 1,000 words. The faults are semicolons, sentences of more than 25 words, and sentences that begin with
What, Where, Whether, Of, How or Whose. Code is not counted.
"""

from __future__ import annotations

import argparse
import ast
import importlib.util
import inspect
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OURS = ("src", "docs", "README.md")
OPENERS = frozenset({"what", "where", "whether", "of", "how", "whose"})
LONG = 25
"""Maximum number of words in a sentence that does not count as long."""

FENCED = re.compile(r"^ *(```|~~~).*?^ *\1[^\n]*$", re.DOTALL | re.MULTILINE)
DOCTEST = re.compile(r"^ *>>>.*?(?:\n\s*\n|\Z)", re.DOTALL | re.MULTILINE)
SECTION = re.compile(r"^ *[A-Z][\w ]*\n *-{3,} *$", re.MULTILINE)
"""Pattern of a section heading in a docstring in NumPy style."""
PARAMETER = re.compile(r"^( *)(?:[*\w][\w*, ]* : .*|[a-z_]+(?=\n\1 +\S))$", re.MULTILINE)
"""Pattern of the line with the name of a parameter in a docstring in NumPy style."""
LISTING = re.compile(r"(?:(?<=\n\n)|\A)(?: {2,}\S.*\n?)+(?=\n|\Z)")
"""Pattern of an indented block between empty lines."""
SPAN = re.compile(r"``[^`]+``|`[^`\n]+`|\*\*|!?\[([^\]]*)\]\([^)]*\)|:\w+:")
NEW_BLOCK = re.compile(r"\n\s*\n|\n(?= *(?:[-*#|>]|\d+\.) )|^ *#+ ", re.MULTILINE)
SENTENCE = re.compile(r"(?<=[.!?])[\"')]*\s+(?=[\"'(]*[A-Z`0-9])")
FIRST = re.compile(r"[^\w\d]*([^\W\d_]+)\b")
WORD = re.compile(r"[^\W\d_][\w'’-]*")


@dataclass(frozen=True)
class Place:
    """Sentence, with the file and the line of the text that contains it."""

    path: Path
    line: int
    sentence: str

    @property
    def words(self) -> list[str]:
        """Return the words of the sentence."""
        return WORD.findall(self.sentence)

    def faults(self) -> list[str]:
        """Return the style faults of the sentence."""
        words, first = self.words, FIRST.match(self.sentence)
        found = [f"opens with {first[1]}"] if first and first[1].lower() in OPENERS else []
        found += ["semicolon"] * self.sentence.count(";")
        return found + ([f"{len(words)} words"] if len(words) > LONG else [])


@dataclass
class Count:
    """Counts of words and style faults over many sentences."""

    words: int = 0
    openers: int = 0
    semicolons: int = 0
    long: int = 0
    heavy: list[Place] = field(default_factory=list)

    def add(self, place: Place) -> None:
        """Add the words and style faults of one sentence to the counts."""
        faults = place.faults()
        self.words += len(place.words)
        self.openers += any(fault.startswith("opens") for fault in faults)
        self.semicolons += faults.count("semicolon")
        self.long += any(fault.endswith("words") for fault in faults)
        if faults:
            self.heavy.append(place)

    def per_thousand(self) -> tuple[float, float, float]:
        """Return the numbers of bad openings, semicolons and long sentences per 1,000 words."""
        openers, semicolons, long = (1000 * n / max(self.words, 1) for n in (self.openers, self.semicolons, self.long))
        return openers, semicolons, long


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Count openers, semicolons and long sentences in docstrings, comments and pages."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"folder, file or package; default: {' '.join(OURS)}")
    parser.add_argument("--list", action="store_true", help="print each counted sentence with file, line and reason")
    arguments = parser.parse_args()
    print(f"{'':36}{'words':>8}{'openers':>9}{'semicolons':>12}{'long':>7}")
    for name in arguments.names or OURS:
        for kind, count in count_prose(find(name)).items():
            openers, semicolons, long = count.per_thousand()
            print(f"{f'{name}: {kind}':36}{count.words:8d}{openers:9.1f}{semicolons:12.1f}{long:7.1f}")
            for place in count.heavy if arguments.list else []:
                print(f"{place.path}:{place.line}: {', '.join(place.faults())}: {place.sentence}")


def find(name: str) -> Path:
    """Return the path of a folder, file or package. The name is searched in the current folder, in this repository and
    in the installed packages.
    """
    for path in (Path(name), ROOT / name):
        if path.exists():
            return path
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None:
        raise SystemExit(f"{name}: expected a folder, a file or an installed package, found none of them")
    origin = Path(spec.origin)
    return origin.parent if origin.name == "__init__.py" else origin


def count_prose(root: Path) -> dict[str, Count]:
    """Count the prose in a folder or file. Return the counts, indexed by kind of text."""
    counts: dict[str, Count] = {}
    files = [root] if root.is_file() else sorted(p for p in root.rglob("*") if "tests" not in p.relative_to(root).parts)
    for path in files:
        for kind, line, text in read_texts(path):
            for sentence in split_sentences(text):
                counts.setdefault(kind, Count()).add(Place(path, line, sentence))
    return counts


def read_texts(path: Path) -> Iterator[tuple[str, int, str]]:
    """Yield tuples (kind, line, text) of all docstrings, comments and paragraphs in a file."""
    if path.suffix == ".md":
        page = FENCED.sub(lambda code: "\n" * code[0].count("\n"), path.read_text(encoding="utf-8"))
        for line, text in split_page(page):
            yield "page", line, text
    elif path.suffix == ".py":
        source = path.read_text(encoding="utf-8")
        yield from (("docstrings", line, text) for line, text in find_docstrings(ast.parse(source)))
        yield from (("comments", line, text) for line, text in find_comments(path))


def split_page(page: str) -> Iterator[tuple[int, str]]:
    """Yield the paragraphs, list items and table cells of a Markdown page. Code blocks and references to code are left
    out.
    """
    block: list[str] = []
    for number, line in enumerate([*page.splitlines(), ""], start=1):
        item = re.match(r" *(?:[-*]|\d+\.|#+|>) ", line)
        closed = not line.strip() or item or line.lstrip().startswith("|")
        if closed and block:
            yield number - len(block), "\n".join(block)
            block = []
        if line.lstrip().startswith("|"):
            yield from ((number, cell) for cell in re.split(r"(?<!\\)\|", line) if cell.strip(" -:"))
        elif item:
            block = [line[item.end() :]]
        elif line.strip() and (block or not line.startswith(("    ", ":::"))):
            block.append(line)


def find_docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the docstrings of modules, classes, functions and variables."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield node.lineno, node.value.value


def find_comments(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the comments of a Python file. Comments on consecutive lines are joined. Comments for tools, such as noqa,
    are left out.
    """
    lines: list[str] = []
    last = 0
    with tokenize.open(path) as file:
        for token in tokenize.generate_tokens(file.readline):
            if token.type != tokenize.COMMENT or re.match(r"# *(type:|noqa|fmt:|!|pragma)", token.string):
                continue
            if lines and token.start[0] != last + 1:
                yield last - len(lines) + 1, "\n".join(lines)
                lines = []
            lines.append(token.string.lstrip("# "))
            last = token.start[0]
    if lines:
        yield last - len(lines) + 1, "\n".join(lines)


def split_sentences(text: str) -> Iterator[str]:
    """Yield the sentences of a text. Code in the text is left out."""
    text = inspect.cleandoc(text)
    for pattern in (FENCED, LISTING, DOCTEST, SECTION, PARAMETER):
        text = pattern.sub("\n", text)
    text = SPAN.sub(lambda span: span[1] or ("code" if span[0].startswith("`") else " "), text)
    for block in NEW_BLOCK.split(text):
        for sentence in SENTENCE.split(" ".join((block or "").split())):
            if WORD.search(sentence):
                yield sentence


if __name__ == "__main__":
    main()
