"""Licences of everything that spigolo and its extras install."""

from __future__ import annotations

import importlib.metadata
import re
from collections.abc import Iterator

NAME = re.compile(r"[A-Za-z0-9._-]+")


def required(name: str, seen: set[str]) -> Iterator[importlib.metadata.Distribution]:
    """The installed packages that a package needs, itself included. Extras count for spigolo alone."""
    known = re.sub(r"[-_.]+", "-", name).lower()
    if known in seen:
        return
    seen.add(known)
    try:
        found = importlib.metadata.distribution(known)
    except importlib.metadata.PackageNotFoundError:  # an extra, or a package of another system
        return
    yield found
    for requirement in found.requires or []:
        match = NAME.match(requirement)
        if match and ("extra ==" not in requirement or known == "spigolo"):
            yield from required(match.group(), seen)


def licence(package: importlib.metadata.Distribution) -> str:
    """What a package says of its licence: expression, classifiers, or the first line of the text."""
    told = package.metadata
    classifiers = [one for one in told.get_all("Classifier") or [] if one.startswith("License")]
    return " ".join([told.get("License-Expression") or "", *classifiers, (told.get("License") or "")[:80]]).strip()


def test_nothing_that_is_installed_has_a_gpl_licence() -> None:
    found = {package.metadata["Name"]: licence(package) for package in required("spigolo", set())}
    assert {"numpy", "numba", "pydantic"} <= {name.lower() for name in found}
    assert {name: told for name, told in found.items() if not told} == {}
    assert {name: told for name, told in found.items() if "GPL" in told or "GNU" in told} == {}
