"""Creation of segmentation methods from their names and parameters."""

from __future__ import annotations

from collections.abc import Sequence

from spigolo.errors import ConfigError
from spigolo.lab.evaluation.rows import Row
from spigolo.methods import METHODS, Method, Toscana2016
from spigolo.settings.config import Config


def make_methods(names: Sequence[str], configs: Sequence[Config]) -> list[Method]:
    """Create segmentation methods from their names. The method `toscana2016` is created once per element of `configs`.

    Duplicate methods are left out. Raises ConfigError for an unknown name.
    """
    methods: dict[tuple[str, str], Method] = {}
    for name in names:
        if name not in METHODS:
            raise ConfigError(f"unknown method {name!r}: expected one of {', '.join(METHODS)}")
        made: list[Method] = [Toscana2016(c) for c in configs] if name == Toscana2016.name else [METHODS[name]]
        for method in made:
            methods.setdefault((method.name, method.digest), method)
    return list(methods.values())


def remake(row: Row) -> Method | None:
    """Create the method that produced an evaluation result.

    Return None if this version of spigolo no longer has the method or its parameters.
    """
    if row.method not in METHODS:
        return None
    try:
        method = METHODS[row.method].replace(**row.parameters)
    except ConfigError:
        return None
    return method if method.digest == row.digest else None
