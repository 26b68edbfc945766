"""On what machine, and with what versions, something was measured."""

from __future__ import annotations

import os
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from spigolo.machine import processor

PACKAGES = {"numpy": "numpy", "numba": "numba", "opencv-python-headless": "OpenCV", "scipy": "scipy"}


@cache
def describe_machine() -> str:
    """Processor, system and versions in one line."""
    known = [f"{title} {found}" for package, title in PACKAGES.items() if (found := _version(package))]
    return (
        f"{processor()}, {os.cpu_count()} CPUs; {platform.system()} {platform.machine()};"
        f" Python {platform.python_version()}, {', '.join(known)}"
    )


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:  # OpenCV has several packages
        return None
