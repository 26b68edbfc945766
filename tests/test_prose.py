"""The script that counts prose, on sentences made for it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[1] / "scripts" / "count_prose.py"
LONG = " ".join(["word"] * 26)
MODULE = f'''"""What a mask is. Return it; `a; b` is code."""
# Whether it holds
# is asked here.
LIMIT = 3
"""How far. {LONG.capitalize()}."""
x = 1  # noqa: E501
def f():
    """Sum of a row.

    >>> What(1); 2
    3

    Parameters
    ----------
    row : what it is; a list
        Values of the row.
    """
'''
PAGE = """# Where to begin

Start here.
Of course; or not.

```python
What(); x
```

    How; indented code

- One item
- Whose item

| Where | `a;b` |
|---|---|
"""


def count(tmp_path: Path, file: str, text: str) -> tuple[dict[str, list[str]], list[str]]:
    """Return the counts of each kind of text, and the heavy sentences with their places."""
    path = tmp_path / file
    path.write_text(text, encoding="utf-8")
    words = [sys.executable, str(SCRIPT), "--list", file]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=60)
    lines = done.stdout.splitlines()[1:]
    rows = [line.split() for line in lines if line.startswith(f"{file}: ")]
    return {kind: counts for _, kind, *counts in rows}, [line for line in lines if not line.startswith(f"{file}: ")]


def test_docstrings_and_comments_are_counted_without_their_code(tmp_path: Path) -> None:
    counts, heavy = count(tmp_path, "module.py", MODULE)
    assert counts == {"docstrings": ["45", "44.4", "22.2", "22.2"], "comments": ["6", "166.7", "0.0", "0.0"]}
    assert heavy == [
        "module.py:1: opens with What: What a mask is.",
        "module.py:1: semicolon: Return it; code is code.",
        "module.py:5: opens with How: How far.",
        f"module.py:5: 26 words: {LONG.capitalize()}.",
        "module.py:2: opens with Whether: Whether it holds is asked here.",
    ]


def test_pages_are_counted_by_paragraph_item_and_cell(tmp_path: Path) -> None:
    counts, heavy = count(tmp_path, "page.md", PAGE)
    assert counts["page"][0] == "15"
    assert heavy == [
        "page.md:1: opens with Where: Where to begin",
        "page.md:3: opens with Of, semicolon: Of course; or not.",
        "page.md:13: opens with Whose: Whose item",
        "page.md:15: opens with Where: Where",
    ]


def test_something_that_is_not_there_is_refused() -> None:
    words = [sys.executable, str(SCRIPT), "no_such_package"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert done.stderr.startswith("no_such_package: expected a folder, a file or an installed package")
