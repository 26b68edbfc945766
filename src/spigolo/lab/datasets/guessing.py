"""Detection of the file layout of a data set."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from spigolo.errors import FileError
from spigolo.frames.listing import listed
from spigolo.lab.datasets.bop import Bop
from spigolo.lab.datasets.entry import DataSet, Entry, existing_folder
from spigolo.lab.datasets.folders import Folders
from spigolo.lab.datasets.labelled_images import Ocid, Osd
from spigolo.lab.datasets.mosd import Mosd
from spigolo.lab.datasets.rutgers import Rutgers
from spigolo.lab.datasets.tejani import Tejani
from spigolo.lab.datasets.tum import Tum
from spigolo.lab.datasets.uw_scenes import UwScenes
from spigolo.lab.datasets.uw_scenes_v2 import UwScenesV2
from spigolo.lab.labelled import FULL_SETS

READERS: tuple[type[DataSet], ...] = (
    Folders, Bop, UwScenes, UwScenesV2, Tejani, Rutgers, Osd, Mosd, Tum, Ocid,
)  # fmt: skip
"""Reader classes. A folder is read by the first class in this tuple that supports the file layout of the folder."""


def guess(path: Path | str, full: Sequence[str] = FULL_SETS) -> DataSet:
    """Detect the file layout of a folder, and return its data set.

    If the folder itself has no known file layout, its subfolders are searched.

    Raises FileError if no subfolder or more than one subfolder has a known layout, or if files are missing.

    Parameters
    ----------
    path
        Folder of the data set.
    full
        Name patterns, such as "osd-*", of data sets in which every object is labelled.

    """
    folder = existing_folder(path)
    reader = _reader(folder)
    if reader is not None:
        return reader(folder, full)
    inner = {below: found for below in listed(folder) if below.is_dir() and (found := _reader(below))}
    if len(inner) > 1:
        raise FileError(f"expected one data set in {path}, got {len(inner)}: give {' or '.join(map(str, inner))}")
    if not inner:
        raise FileError(
            f"expected frames in {path}, got none: give a root of sets, a set or a single frame ({Folders.layout}), or"
            " a data set as it was published (BOP, UW RGB-D Scenes, Rutgers APC, Tejani, OSD, mOSD, OCID, TUM)"
        )
    ((below, reader),) = inner.items()
    return reader(below, full)


def find_labelled_frames(folders: Sequence[Path], full: Sequence[str] = FULL_SETS) -> list[Entry]:
    """Return the frames of several data sets, sorted by the names of data set and frame.

    `guess` detects the file layout of each folder.

    Raises FileError if a folder has no frames, or if two frames of the same data set have the same name.

    Parameters
    ----------
    folders
        Folders of the data sets.
    full
        Name patterns of data sets in which every object is labelled.

    """
    found: dict[tuple[str, str], Entry] = {}
    for folder in folders:
        for entry in guess(folder, full):
            other = found.setdefault((entry.data_set, entry.name), entry)
            if other != entry:
                raise FileError(
                    f"expected only one frame {entry.data_set}/{entry.name}, got {other.files[0]} and"
                    f" {entry.files[0]}: rename one of the data sets"
                )
    return [found[key] for key in sorted(found)]


def _reader(folder: Path) -> type[DataSet] | None:
    return next((reader for reader in READERS if reader.matches(folder)), None)
