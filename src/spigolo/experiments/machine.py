"""On what machine, and with what versions, something was measured."""

from __future__ import annotations

import os
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = {"numpy": "numpy", "numba": "numba", "opencv-python-headless": "OpenCV", "scipy": "scipy"}


@cache
def describe_machine() -> str:
    """Processor, system and versions in one line."""
    known = [f"{title} {found}" for package, title in PACKAGES.items() if (found := _version(package))]
    return (
        f"{_processor()}, {os.cpu_count()} CPUs; {platform.system()} {platform.machine()};"
        f" Python {platform.python_version()}, {', '.join(known)}"
    )


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:  # OpenCV has several packages
        return None


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())
