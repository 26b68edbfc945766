"""Progress bar on the error stream. No bar is shown if the error stream is redirected to a file."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn


@contextmanager
def progress(*columns: ProgressColumn, **options: Any) -> Iterator[Progress]:
    """Open a progress bar on the error stream. columns, options: arguments of `rich.progress.Progress`."""
    from rich.console import Console
    from rich.progress import Progress

    with Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), **options) as bar:
        yield bar
