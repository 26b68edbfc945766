"""Opening of sources of frames that are named on the command line."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING

from spigolo.errors import FileError, UnitWarning
from spigolo.frames.frame import MAX_PIXELS
from spigolo.sources.base import SizedSource, counted

if TYPE_CHECKING:
    from spigolo.frames.frame import Frame
    from spigolo.sources.base import Source


def opened(
    words: Sequence[str],
    camera: str | None = None,
    depth_scale: float | None = None,
    max_pixels: int = MAX_PIXELS,
    quiet: bool = False,
) -> Source:
    """Return the source of frames that is named on the command line.

    quiet: suppress warnings about the depth unit. Commands that print the diagnosis of `spigolo doctor` set `quiet`,
    because the diagnosis also checks the depth unit.
    """
    from spigolo.sources.opening import open_source

    if quiet:
        warnings.simplefilter("ignore", UnitWarning)
    return open_source(words, camera, depth_scale, max_pixels=max_pixels)


def first_frame(source: Source, index: int | None = None) -> Frame:
    """Return one frame of a source.

    index: number of the frame, counted from 0. If None, the first frame is returned. Unreadable frames of a camera are
    skipped. Raises SpigoloError if the frame does not exist or cannot be read.
    """
    if index is None and source.count is not None and source.count > 1:
        print(f"using the first of {counted(source.count, 'frame')} in {source.name}. For another frame, give --index")
    if isinstance(source, SizedSource) and len(source):
        if (index or 0) >= len(source):
            raise FileError(f"there is no frame {index} in {source.name}, which has {counted(len(source), 'frame')}")
        return source[index or 0]
    frame = next(islice(source, index or 0, None), None)
    if frame is None:
        raise FileError(f"there is no frame {index or 0} in {source.name} ({source.report()})")
    return frame
