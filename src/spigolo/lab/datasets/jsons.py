"""Reader of JSON files whose top-level value is an object (a dict in Python)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spigolo.errors import FileError


def read_mapping(path: Path) -> Mapping[str, Any]:
    """Read a JSON file that contains an object, and return its fields. Raises FileError if the file cannot be read."""
    try:
        values = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        raise FileError(f"expected JSON in {path}, but the file cannot be read: {error}") from None
    if not isinstance(values, Mapping):
        raise FileError(f"expected an object with fields in {path}, got {type(values).__name__}")
    return values
