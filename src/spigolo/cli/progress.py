"""Progress bar on the error stream. If the error stream is redirected to a file, lines of text replace the bar."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn

LINE_S = 60.0
"""Time between two lines of text, in seconds."""


@contextmanager
def progress(*columns: ProgressColumn, **options: Any) -> Iterator[Progress]:
    """Open a progress bar on the error stream. columns, options: arguments of `rich.progress.Progress`."""
    from rich.console import Console
    from rich.progress import Progress

    shown = sys.stderr.isatty()
    with Progress(*columns, console=Console(stderr=True), disable=not shown, **options) as bar:
        if shown or options.get("auto_refresh") is False:  # text from a background thread would disturb measurements
            yield bar
            return
        with _lines(bar):
            yield bar


@contextmanager
def _lines(bar: Progress) -> Iterator[None]:
    """Print the text columns of each task as a line of text every `LINE_S` seconds."""
    from rich.text import Text

    def run() -> None:
        while not ended.wait(LINE_S):
            for task in bar.tasks:
                texts = [column(task) for column in bar.columns if not isinstance(column, str)]
                words = (text.plain.strip() for text in texts if isinstance(text, Text))
                print("  ".join(word for word in words if word), file=sys.stderr, flush=True)

    ended = threading.Event()
    thread = threading.Thread(target=run, name="spigolo progress", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
