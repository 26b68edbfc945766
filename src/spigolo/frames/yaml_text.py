"""Reader of YAML camera files as written by ROS, kalibr and OpenCV."""

from __future__ import annotations

import math
import re
from typing import Any

MATRIX = "tag:yaml.org,2002:opencv-matrix"
FLOAT = "tag:yaml.org,2002:float"
MAX_ALIASED = 10_000
"""Maximum number of values that YAML aliases may repeat, because nested aliases can expand to billions of values."""
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)")
"""Pattern of numbers such as 1e-3, which YAML 1.1 treats as text."""


def parse_yaml(text: str) -> Any:
    """Return the content of the first document of a YAML text. Each OpenCV matrix becomes a dict of its fields.

    This function replaces OpenCV's YAML reader, which may crash the process on a damaged file. Raises ValueError for
    invalid YAML, and for aliases that repeat too many values or contain themselves.
    """
    import yaml  # slow to import, and few cameras need it

    try:
        return _load(yaml, text)
    except yaml.YAMLError as error:
        raise ValueError(str(error)) from None


def _load(yaml: Any, text: str) -> Any:
    """Return the first document of a YAML text. Raises YAMLError for invalid YAML.

    yaml: the module PyYAML.
    """

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        """YAML loader that also reads OpenCV matrices and all forms of numbers."""

        def get_node(self) -> Any:
            node = super().get_node()
            if _count_aliased(node) > MAX_ALIASED:
                raise yaml.YAMLError(f"the aliases repeat more than {MAX_ALIASED} values, or contain themselves")
            return node

    Loader.add_constructor(MATRIX, lambda loader, node: loader.construct_mapping(node, deep=True))
    Loader.add_implicit_resolver(FLOAT, NUMBER, list("-+0123456789."))
    loader = Loader(_without_directive(text))
    try:
        return loader.construct_document(loader.get_node()) if loader.check_node() else None
    finally:
        loader.dispose()


def _count_aliased(node: Any) -> float:
    """Return the number of values that the expansion of all YAML aliases adds, or infinity if an alias contains
    itself.
    """
    sizes: dict[int, float] = {}

    def size(one: Any) -> float:
        if id(one) not in sizes:
            sizes[id(one)] = math.inf  # placeholder: an alias that contains itself reaches this node again
            inner = one.value if isinstance(one.value, list) else []
            parts = (part for entry in inner for part in (entry if isinstance(entry, tuple) else (entry,)))
            sizes[id(one)] = 1.0 + sum(map(size, parts))
        return sizes[id(one)]

    return size(node) - len(sizes)


def _without_directive(text: str) -> str:
    """Return a YAML text without the directive in OpenCV's first line, which PyYAML rejects."""
    return re.sub(r"\A\s*%YAML:1\.0[^\n]*\n(?:---[^\n]*\n)?", "", text)
