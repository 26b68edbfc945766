"""Paths of frames: colour, depth and camera files that belong together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from spigolo.errors import FileError, warn
from spigolo.frames.camera_files import camera_for, camera_of
from spigolo.frames.listing import COLOR_NAMES, RECORDINGS, best_of_each, listed
from spigolo.sources.roles import match_by_name, rest_of

IMAGES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".pnm", ".webp")
DEPTHS = (*IMAGES, ".npy", ".npz", ".exr")


@dataclass(frozen=True, slots=True)
class FramePaths:
    """Paths of the files of a frame. camera: path of a camera file next to the images, or None."""

    name: str
    color: Path
    depth: Path
    camera: Path | None


def find_frames(inputs: Sequence[str]) -> list[FramePaths]:
    """Return the frames in files and folders.

    If two files are given, the first is the colour image and the second is the depth image of one frame. More than two
    files are paired by their names (0001-color.png and 0001-depth.png). If no names match, files are paired in the
    given order. A .npz file with colour and depth is a frame. A folder with rgb.png and depth.png is one frame. Any
    other folder contains subfolders with one frame each, or files that are paired by their names. A folder can also
    contain the folders rgb/ and depth/, in which the two images of a frame have the same file name. Every frame gets a
    unique name.
    """
    paths = [Path(word) for word in inputs]
    if not all(inputs):
        raise FileError("expected a file or folder, got an empty name: give . for the current folder")
    if not paths:
        raise FileError("expected a colour and a depth image, or a folder of frames, got nothing")
    absent = [path for path in paths if not path.exists()]
    if absent:
        raise FileError(f"expected an image or folder, but there is no {absent[0]}")
    files = [path for path in paths if not path.is_dir()]
    whole = [path for path in files if _is_frame(path)]
    if len(files) == 2 and len(whole) == 1:  # the other file is the depth or the colour image
        whole = []
    frames = [_whole(path) for path in dict.fromkeys(whole)] + _pairs([path for path in files if path not in whole])
    for folder in (path for path in paths if path.is_dir()):
        frames += _frames_in(folder)
    return _named_apart(frames)


def _is_frame(path: Path) -> bool:
    """Return True if a file is a .npz file with colour and depth."""
    if path.suffix.lower() != ".npz":
        return False
    from spigolo.frames.arrays import names_in
    from spigolo.frames.images import COLOR_KEYS, DEPTH_KEYS

    names = set(names_in(path))
    return bool(names & set(COLOR_KEYS)) and bool(names & set(DEPTH_KEYS))


def _whole(path: Path) -> FramePaths:
    """Return the paths of a frame that is stored in one .npz file."""
    return FramePaths(path.stem, path, path, camera_of(path))


def _pairs(files: Sequence[Path]) -> list[FramePaths]:
    """Pair colour and depth files by their names, or in the given order if no names match. Files whose names have no
    partner are left out with a warning. Raises FileError for an odd number of files if no names match.
    """
    recording = next((path for path in files if path.suffix.lower() in RECORDINGS), None)
    if recording is not None:
        from spigolo.frames.images import how_to_extract

        raise FileError(f"expected images, got the recording {recording}: {how_to_extract(recording.suffix.lower())}")
    matched = match_by_name(files) if len(files) > 2 else []
    if matched:
        taken = {path for pair in matched for path in pair}
        _warn_of_single([path for path in files if path not in taken], "images have no partner")
        return [FramePaths(rest_of(color) or color.stem, color, depth, camera_of(color)) for color, depth in matched]
    if len(files) % 2:
        alone = f"expected files in pairs, colour then depth, got {len(files)}: {files[-1]} has no depth image"
        if files[-1].suffix.lower() == ".npz":
            raise FileError(
                f"{alone}. A single .npz file is a frame if it holds the arrays rgb and depth, and preferably K"
            )
        raise FileError(alone)
    pairs = zip(files[::2], files[1::2], strict=True)
    return [FramePaths(color.stem, color, depth, camera_of(color)) for color, depth in pairs]


def only_frame(frames: Sequence[FramePaths]) -> FramePaths:
    """Return the only frame in a list. Raises FileError for no frame or several frames."""
    if len(frames) != 1:
        raise FileError(f"expected one frame, got {len(frames)}: give a colour and a depth image")
    return frames[0]


def _named_apart(frames: Sequence[FramePaths]) -> list[FramePaths]:
    names = distinct([frame.name for frame in frames], [_around(frame) for frame in frames])
    return [replace(frame, name=name) for frame, name in zip(frames, names, strict=True)]


def distinct(names: Sequence[str], groups: Sequence[str]) -> list[str]:
    """Return unique frame names. A name that occurs twice gets the name of its group, such as its folder, as prefix. If
    the result is still not unique, it gets a number as suffix.
    """
    count = Counter(names)
    taken, apart = {name for name in count if count[name] == 1}, []
    for name, group in zip(names, groups, strict=True):
        new = name
        if count[name] > 1:
            base = f"{group}_{name}"
            new = next(n for n in chain([base], (f"{base}_{k}" for k in range(2, len(names) + 2))) if n not in taken)
            taken.add(new)
        apart.append(new)
    return apart


def _around(frame: FramePaths) -> str:
    """Return the name of the folder that contains a frame, or of the parent folder for folders such as rgb/."""
    folder = frame.color.resolve().parent
    return folder.parent.name if folder.name in (frame.name, *COLOR_NAMES) else folder.name


def _frames_in(folder: Path) -> list[FramePaths]:
    frames = _frame_of(folder, folder) or _paired(folder)
    if not frames:
        inner = [path for path in listed(folder) if path.is_dir()]
        frames = [frame for path in inner for frame in _frame_of(path, folder)]
    if not frames:
        frames = [_whole(path) for path in listed(folder) if _is_frame(path)]
    if not frames:
        frames = _matched(listed(folder), folder)
    if not frames:
        raise FileError(
            f"expected rgb.png and depth.png in {folder} or in its subfolders, folders rgb/ and depth/ with equally"
            f" named files, or pairs of files such as 0001-color.png and 0001-depth.png{_what_lies_there(folder)}"
        )
    return frames


def _what_lies_there(folder: Path) -> str:
    """Return a hint for the error message about a folder without frames. The hint is empty if the folder contains no
    recording.
    """
    found = next((path for path in listed(folder) if path.suffix.lower() in RECORDINGS), None)
    if found is None:
        return ""
    from spigolo.frames.images import how_to_extract

    return f". {found.name} is a recording: {how_to_extract(found.suffix.lower())}"


def _frame_of(folder: Path, top: Path) -> list[FramePaths]:
    """Return a list with the frame that a folder contains, or an empty list. top: folder that the user gave."""
    files = listed(folder)
    colors = [f for name in COLOR_NAMES for f in files if f.stem == name and f.suffix.lower() in IMAGES]
    depths = [f for f in files if f.stem == "depth" and f.suffix.lower() in DEPTHS]
    color, depth = (next(best_of_each(found), None) for found in (colors, depths))
    if color and not depth:
        _warn_of_single([color], "colour images have no depth image")
    return [FramePaths(folder.name, color, depth, camera_for(folder, top))] if color and depth else []


def _paired(folder: Path) -> list[FramePaths]:
    colors = next((folder / name for name in COLOR_NAMES if (folder / name).is_dir()), None)
    if colors is None or not (folder / "depth").is_dir():
        return []
    stored = list(best_of_each(f for f in listed(folder / "depth") if f.suffix.lower() in DEPTHS))
    depths = {f.stem: f for f in stored}
    images = list(best_of_each(f for f in listed(colors) if f.suffix.lower() in IMAGES))
    if not any(f.stem in depths for f in images) and (matched := _matched([*images, *stored], folder)):
        return matched
    _warn_of_single([f for f in images if f.stem not in depths], "colour images have no depth image")
    named = {f.stem for f in images}
    _warn_of_single([f for f in depths.values() if f.stem not in named], "depth images have no colour image")
    camera = camera_for(folder, folder)
    return [FramePaths(f.stem, f, depths[f.stem], camera) for f in images if f.stem in depths]


def _matched(files: Sequence[Path], folder: Path) -> list[FramePaths]:
    """Pair files with names such as 0001-color.png and 0001-depth.png. folder: folder of the camera file."""
    images = list(best_of_each(f for f in files if f.suffix.lower() in DEPTHS)) if files else []
    pairs = match_by_name(images)
    taken = {path for pair in pairs for path in pair}
    if pairs:
        _warn_of_single([f for f in images if f not in taken], "images have no partner")
    camera = camera_for(folder, folder) if pairs else None
    return [FramePaths(rest_of(color) or folder.name, color, depth, camera) for color, depth in pairs]


def _warn_of_single(images: Sequence[Path], lack: str) -> None:
    """Warn of images that are skipped because they have no partner."""
    if images:
        named = ", ".join(str(image) for image in images[:3]) + (", ..." if len(images) > 3 else "")
        warn(f"{len(images)} {lack} of their name: {named}")
