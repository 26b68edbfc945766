"""Every equation of the paper has a home: a function whose docstring begins with its number."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import spigolo

SOURCES = Path(spigolo.__file__).parent
EQUATIONS = range(1, 24)
"""Eq. 1, the plain weight of the graph that the method starts from, has its home with `felzenszwalb2004`."""
LIST = re.compile(r"Eqs?\. ((?:\d+(?:, | and )?)+)\.")
RANGE = re.compile(r"[Ee]qs?\. ((?:\d+(?:-\d+)?(?:, | and | or )?)+)")


def docstrings() -> Iterator[tuple[str, str]]:
    """(place, first line of its docstring) of every function, property and class of the package."""
    for path in sorted(SOURCES.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Module):
                name = getattr(node, "name", "module")
                yield f"{path.relative_to(SOURCES)}:{name}", (ast.get_docstring(node) or "").split("\n")[0]


def homes() -> dict[int, list[str]]:
    found: dict[int, list[str]] = {number: [] for number in EQUATIONS}
    for place, line in docstrings():
        begins = LIST.match(line)
        for number in map(int, re.findall(r"\d+", begins[1])) if begins and not place.endswith(":module") else ():
            found.setdefault(number, []).append(place)
    return found


def mentioned() -> set[int]:
    """Numbers that any docstring's first line names, alone or inside a range."""
    numbers: set[int] = set()
    for _, line in docstrings():
        for group in RANGE.findall(line):
            for first, last in re.findall(r"(\d+)(?:-(\d+))?", group):
                numbers |= set(range(int(first), int(last or first) + 1))
    return numbers


@pytest.mark.parametrize("number", EQUATIONS)
def test_equation_has_a_home(number: int) -> None:
    assert homes()[number], f"no docstring begins with 'Eq. {number}.'"


@pytest.mark.parametrize("number", EQUATIONS)
def test_the_home_of_an_equation_is_used(number: int) -> None:
    """At least one home is named somewhere else in the package, so that a reader does not study unused code."""
    words = re.findall(r"\w+", " ".join(p.read_text(encoding="utf-8") for p in SOURCES.rglob("*.py")))
    assert any(words.count(place.partition(":")[2]) > 1 for place in homes()[number])


def test_no_docstring_names_an_equation_that_the_paper_does_not_have() -> None:
    assert mentioned() <= set(EQUATIONS)
    assert set(homes()) <= set(EQUATIONS)


def test_every_equation_has_a_worked_example() -> None:
    tree = ast.parse((Path(__file__).parent / "test_equations.py").read_text(encoding="utf-8"))
    names = [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]
    examples = {number for number in EQUATIONS if any(name.startswith(f"test_eq_{number:02}_") for name in names)}
    assert examples == set(EQUATIONS)
