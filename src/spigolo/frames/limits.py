"""Maximum number of pixels of images."""

from __future__ import annotations

from spigolo.errors import FrameError

MAX_PIXELS = 16_000_000
"""Default maximum number of pixels of an image, to limit memory."""


def check_count(width: int, height: int, max_pixels: int) -> None:
    """Raise FrameError if an image of width x height has more than max_pixels pixels."""
    if width * height > max_pixels:
        raise FrameError(
            f"expected at most {max_pixels} pixels, got {width}x{height}: shrink the images, or give"
            f" max_pixels={width * height} if the memory suffices"
        )
