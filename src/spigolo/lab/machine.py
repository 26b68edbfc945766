"""Description of the current machine: processor, load and versions of installed packages."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from pathlib import Path

import cv2
import llvmlite
import numba
import numpy as np

from spigolo.batch.engine import cores


@dataclass(frozen=True, slots=True)
class Machine:
    """Machine that runs this process."""

    cpu: str
    cores: int
    """Number of processor cores that the process may use."""
    system: str
    load: float | None
    """Average system load of the last minute, 0 = idle, None if unknown."""
    versions: dict[str, str]
    """Versions of installed packages, indexed by package name."""

    def __str__(self) -> str:
        """Format the processor, the number of cores, the system and the package versions as one line."""
        versions = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        return f"{self.cpu}, {self.cores} CPUs; {self.system}; {versions}"


def this_machine(**versions: str) -> Machine:
    """Describe the current machine. versions: additional package versions to include, as name=version."""
    versions |= {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
        "llvmlite": llvmlite.__version__,
        "opencv": cv2.__version__,
    }
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return Machine(processor(), cores(), f"{platform.system()} {platform.machine()}", load, versions)


def processor() -> str:
    """Return the name of the processor that the operating system reports."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, "") or platform.processor() or platform.machine()
