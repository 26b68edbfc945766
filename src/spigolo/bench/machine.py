"""What the figures were measured on."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass

import cv2
import llvmlite
import numba
import numpy as np

from spigolo import __version__
from spigolo.machine import processor


@dataclass(frozen=True, slots=True)
class Machine:
    """cores: those this process may use. load: of the last minute, 0 = idle; None where the system does not say."""

    cpu: str
    cores: int
    system: str
    load: float | None
    versions: dict[str, str]


def this_machine() -> Machine:
    """The one this runs on, now."""
    versions = {
        "spigolo": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
        "llvmlite": llvmlite.__version__,
        "opencv": cv2.__version__,
    }
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return Machine(processor(), _cores(), f"{platform.system()} {platform.machine()}", load, versions)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
