"""What can go wrong, one class per kind. Each message says what was expected, what came and how to mend it."""

from __future__ import annotations


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
