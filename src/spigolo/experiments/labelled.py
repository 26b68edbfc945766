"""Labelled frames on disk: SET/FRAME/ with rgb.png, depth.png, camera.json, label.png and, if there, info.json.

`label.png`: 0 = background, 1..N = objects, 255 = ignore; absent where nothing is labelled. Beside the sets
`splits.json` may list groups of near-identical frames: {"near_duplicate_groups": [["SET/FRAME", ...], ...]}.
`info.json` may say which label is ignored ("ignore_label") and whether every object is labelled ("fully_labelled").
Letters used in shapes: H, W = image.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError, FrameError
from spigolo.evaluation.rows import Labelling
from spigolo.frame import Frame, Mask
from spigolo.io import read_frame, read_labels

FULL_SETS = ("osd-*", "hand-uoc")
"""Sets on which every object is labelled, where info.json does not say."""

IGNORE_LABEL = 255


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """labels (H, W): 0 = background, other values = objects. ignore (H, W) bool: neither right nor wrong."""

    labels: npt.NDArray[np.integer[Any]]
    ignore: Mask


@dataclass(frozen=True, slots=True)
class FrameFolder:
    """Where a frame lies and what is known of it before it is read. group: shared by near-identical frames."""

    data_set: str
    name: str
    group: str
    labelling: Labelling
    folder: Path
    ignore_label: int = IGNORE_LABEL

    def read(self) -> Frame:
        """The frame; raises FileError, FrameError or CameraError."""
        return read_frame(self.folder / "rgb.png", self.folder / "depth.png", self.folder / "camera.json")

    def read_truth(self) -> Truth | None:
        """Its labels, None where it has none; raises FileError or FrameError."""
        if self.labelling == "none":
            return None
        labels = read_labels(self.folder / "label.png")
        ignore = labels == self.ignore_label
        return Truth(np.where(ignore, 0, labels), ignore)

    def read_both(self) -> tuple[Frame, Truth | None]:
        """Frame and labels; raises FrameError also where they differ in size."""
        frame, truth = self.read(), self.read_truth()
        if truth is not None and truth.labels.shape != frame.shape:
            raise FrameError(
                f"expected labels of {frame.shape[1]} x {frame.shape[0]} pixels as the colour image has, got"
                f" {truth.labels.shape[1]} x {truth.labels.shape[0]} in {self.folder / 'label.png'}"
            )
        return frame, truth


def find_labelled_frames(folders: Sequence[Path], full: Sequence[str] = FULL_SETS) -> list[FrameFolder]:
    """The frames in these folders, by set and name: each a root of sets, a set or a single frame.

    full: sets on which every object is labelled, as patterns such as "osd-*". Raises FileError where a folder holds
    none, or where two frames share set and name.
    """
    found: dict[tuple[str, str], FrameFolder] = {}
    for folder in folders:
        for place in _places(folder):
            frame = _describe(place, full)
            other = found.setdefault((frame.data_set, frame.name), frame)
            if other.folder != place:
                raise FileError(
                    f"expected one frame {frame.data_set}/{frame.name}, got {other.folder} and {place}: rename one set"
                )
    return [found[key] for key in sorted(found)]


def _places(folder: Path) -> list[Path]:
    if not folder.is_dir():
        raise FileError(f"expected a folder of frames, but there is no folder {folder}")
    root = folder.resolve()
    places = [p.parent for pattern in ("", "*/", "*/*/") for p in sorted(root.glob(f"{pattern}rgb.png"))]
    if not places:
        raise FileError(
            f"expected frames (folders with rgb.png, depth.png, camera.json) in {folder} or up to two folders below,"
            " got none: give a root of sets, a set or a single frame"
        )
    return places


def _describe(place: Path, full: Sequence[str]) -> FrameFolder:
    data_set, name = place.parent.name, place.name
    info = _mapping(place / "info.json")
    labelling: Labelling = "none"
    if (place / "label.png").is_file():
        whole = info.get("fully_labelled", any(fnmatch(data_set, pattern) for pattern in full))
        labelling = "full" if whole else "part"
    group = _groups(place.parents[1]).get(f"{data_set}/{name}", f"{data_set}/{name}")
    return FrameFolder(data_set, name, group, labelling, place, int(info.get("ignore_label") or IGNORE_LABEL))


def _groups(root: Path) -> dict[str, str]:
    """Group of each frame that is like others: the name of the first of them."""
    groups = _mapping(root / "splits.json").get("near_duplicate_groups", [])
    return {name: members[0] for members in groups for name in members}


def _mapping(path: Path) -> Mapping[str, Any]:
    """What a JSON file holds, nothing where there is none."""
    if not path.is_file():
        return {}
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise FileError(f"expected JSON in {path}, but it cannot be read: {error}") from None
    if not isinstance(values, Mapping):
        raise FileError(f"expected an object with fields in {path}, got {type(values).__name__}")
    return values
