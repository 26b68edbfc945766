"""Progress bar on the error stream. Nothing is printed if the stream is a file."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn


@contextmanager
def progress(*columns: ProgressColumn, **options: Any) -> Iterator[Progress]:
    """Open a progress bar to which tasks are added. columns, options: as for rich's Progress."""
    from rich.console import Console
    from rich.progress import Progress

    with Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), **options) as bar:
        yield bar
