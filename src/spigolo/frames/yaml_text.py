"""YAML as ROS, kalibr and OpenCV write it."""

from __future__ import annotations

import importlib
import os
import re
from typing import Any

from spigolo.errors import FileError

MATRIX = "tag:yaml.org,2002:opencv-matrix"
FLOAT = "tag:yaml.org,2002:float"
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)")
"""Numbers such as 1e-3, which YAML 1.1 takes for text."""


def import_yaml(path: str | os.PathLike[str], extra: str = "yaml") -> Any:
    """Return the module that reads a YAML file. Raises FileError where the extra that brings it is not installed."""
    try:
        return importlib.import_module("yaml")
    except ImportError:
        raise FileError(f'expected PyYAML to read {path}, but it is missing: pip install "spigolo[{extra}]"') from None


def parse_yaml(yaml: Any, text: str) -> Any:
    """Return what the first document of a YAML text holds. OpenCV's matrices come as their fields.

    OpenCV's own reader ends the process over a damaged file. Raises what the module raises.
    """

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        """Knows OpenCV's matrices and all numbers."""

    Loader.add_constructor(MATRIX, lambda loader, node: loader.construct_mapping(node, deep=True))
    Loader.add_implicit_resolver(FLOAT, NUMBER, list("-+0123456789."))
    loader = Loader(_without_directive(text))
    try:
        return loader.get_data() if loader.check_data() else None
    finally:
        loader.dispose()


def _without_directive(text: str) -> str:
    """Return the text without OpenCV's first line, which no other reader knows."""
    return re.sub(r"\A\s*%YAML:1\.0[^\n]*\n(?:---[^\n]*\n)?", "", text)
