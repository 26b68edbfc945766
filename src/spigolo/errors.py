"""Errors, one class per kind. Each message says what was expected, what came and how to mend it."""

from __future__ import annotations

import os
import sys
import warnings

PACKAGE = os.path.dirname(__file__) + os.sep
"""Path that the files of this package begin with."""


class SpigoloError(Exception):
    """Base of every error that spigolo raises on purpose."""


class FrameError(SpigoloError, ValueError):
    """Colour, depth and camera do not make a frame."""


class CameraError(SpigoloError, ValueError):
    """The intrinsics cannot be those of a pinhole camera."""


class ConfigError(SpigoloError, ValueError):
    """A parameter, preset or TOML file is not what spigolo knows."""


class FileError(SpigoloError, OSError):
    """A file could not be read or written."""


class UnitWarning(UserWarning):
    """Depth can hardly be in metres."""


def warn(message: str, kind: type[Warning] = UserWarning) -> None:
    """Warn at the line that called into this package, whichever way led here."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, kind, stacklevel=level)
