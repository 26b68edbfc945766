"""Methods to evaluate, by name. Ours appears once for each preset."""

from __future__ import annotations

from collections.abc import Sequence

from spigolo.errors import ConfigError
from spigolo.lab.evaluation.rows import Row
from spigolo.methods import METHODS, Method, Toscana2016
from spigolo.settings.config import Config


def make_methods(names: Sequence[str], configs: Sequence[Config]) -> list[Method]:
    """Return the methods of some names: `toscana2016` once per configuration, any other once. Duplicates are dropped.

    Raises ConfigError for an unknown name.
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
    """Return the method of a row with the row's parameters. None if it no longer exists with these parameters."""
    if row.method not in METHODS:
        return None
    try:
        method = METHODS[row.method].replace(**row.parameters)
    except ConfigError:
        return None
    return method if method.digest == row.digest else None
