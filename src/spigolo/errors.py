"""Exceptions and warnings of spigolo. An error message says what was expected, what was given and how to correct the
input.
"""

from __future__ import annotations

import os
import sys
import warnings

PACKAGE = os.path.dirname(__file__) + os.sep
"""Folder of this package, with a path separator at the end. The path of each source file of the package starts with
this folder.
"""


class SpigoloError(Exception):
    """Base class of all exceptions that spigolo raises on purpose."""


class FrameError(SpigoloError, ValueError):
    """Exception for a colour image, depth map and camera that do not form a valid frame."""


class CameraError(SpigoloError, ValueError):
    """Exception for intrinsics that are not valid for a pinhole camera."""


class ConfigError(SpigoloError, ValueError):
    """Exception for an invalid parameter, preset or TOML file."""


class FileError(SpigoloError, OSError):
    """Exception for a file that cannot be read or written."""


class UnitWarning(UserWarning):
    """Warning for depth that is probably not in metres."""


def warn(message: str, kind: type[Warning] = UserWarning) -> None:
    """Issue a warning that points to the line of the user's code that called this package."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, kind, stacklevel=level)
