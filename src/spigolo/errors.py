"""Exceptions, one class per kind. Each message says what was expected, what was given and how to fix it."""

from __future__ import annotations

import os
import sys
import warnings

PACKAGE = os.path.dirname(__file__) + os.sep
"""Prefix of the paths of this package's files."""


class SpigoloError(Exception):
    """Base of all exceptions that spigolo raises on purpose."""


class FrameError(SpigoloError, ValueError):
    """Colour, depth and camera do not form a valid frame."""


class CameraError(SpigoloError, ValueError):
    """The intrinsics cannot be those of a pinhole camera."""


class ConfigError(SpigoloError, ValueError):
    """A parameter, preset or TOML file is invalid."""


class FileError(SpigoloError, OSError):
    """A file could not be read or written."""


class UnitWarning(UserWarning):
    """Depth is probably not in metres."""


def warn(message: str, kind: type[Warning] = UserWarning) -> None:
    """Issue a warning that points to the line that called into this package."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, kind, stacklevel=level)
