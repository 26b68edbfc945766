"""Writer of rendered frames in one of three file layouts: one folder per frame, BOP format, or layout of a real data
set.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path

import numpy as np

from spigolo.errors import ConfigError, FileError, SpigoloError
from spigolo.frames.files import write_json, write_png
from spigolo.frames.frame import Frame
from spigolo.lab.datasets.entry import MILLIMETRES, RENDERED
from spigolo.lab.datasets.jsons import read_mapping
from spigolo.lab.datasets.sample import Sample
from spigolo.lab.datasets.writing import (
    rutgers_name,
    tejani_name,
    write_bop,
    write_rutgers,
    write_tejani,
    write_uw_scenes,
)
from spigolo.lab.synthetic.families import FAMILIES, family_models, render_family

__all__ = ["LAYOUTS", "write_family", "write_folders"]

Tell = Callable[[int], None]

_BINS = "ABCDEFGHIJKL"


def write_family(
    family: str, count: int, seed: int, folder: Path, layout: str = "folders", tell: Tell | None = None
) -> int:
    """Render frames 0..count-1 of a family of scenes, and write them to a folder.

    Returns the number of written frames. Raises ConfigError for an unknown family or layout. Raises FileError if a file
    cannot be written.

    Parameters
    ----------
    family
        Kind of scene, a key of `FAMILIES`.
    count
        Number of frames.
    seed
        Random seed of the frames.
    folder
        Folder to write to.
    layout
        File layout of the written frames. The layout "folders" is one folder per frame, read by `Folders`. The layout
        "bop" is the BOP format, read by `Bop`. The layout "original" is that of the real data set that is similar to
        the family of scenes. The layout "original" is read by `Rutgers`, `UwScenes` or `Tejani`.
    tell
        Function that is called after each frame with the number of finished frames.

    """
    if layout not in LAYOUTS:
        raise ConfigError(f"unknown layout {layout!r}: expected one of {', '.join(LAYOUTS)}")
    if count < 1:
        raise ConfigError(f"expected at least one frame, got {count}")
    if seed < 0:
        raise ConfigError(f"expected a seed of 0 or more, got {seed}")
    if layout != "folders":
        _require_extra()
    models = family_models(family)
    about = f"rendered stand-ins, family {family}, seed {seed}, layout {layout}"
    _refuse_others(folder, about)
    samples = _rendered(family, count, seed, tell)
    if layout == "folders":
        return write_folders(folder, samples, family, f"{family}-{seed}", about)
    if layout == "bop":
        return write_bop(folder, (_renamed(s, _bop_name(family, k)) for k, s in samples), models, about)
    if family == "table":
        return write_uw_scenes(folder, (sample for _, sample in samples), about)
    named = (_renamed(s, _original_name(family, k, s)) for k, s in samples)
    return (write_rutgers if family == "shelf" else write_tejani)(folder, named, models, about)


LAYOUTS = ("folders", "bop", "original")


def write_folders(folder: Path, samples: Iterator[tuple[int, Sample]], family: str, data_set: str, about: str) -> int:
    """Write frames in the file layout of `Folders`, with object names and poses in info.json.

    Return the number of written frames.
    """
    count = 0
    write_json(folder / RENDERED, {"about": about})
    for _, sample in samples:
        frame, place = sample.frame, folder / data_set / sample.frame.name
        write_png(place / "rgb.png", frame.color)
        write_png(place / "depth.png", np.round(frame.depth / MILLIMETRES).astype(np.uint16))
        write_png(place / "label.png", sample.labels.astype(np.uint8))
        camera = {k: v for k, v in asdict(frame.camera).items() if k != "distortion"} if frame.camera else {}
        write_json(place / "camera.json", {**camera, "depth_scale": MILLIMETRES})
        objects = [{"label": i.label, "model": i.model, "pose": i.pose.tolist()} for i in sample.instances]
        write_json(place / "info.json", {"fully_labelled": FAMILIES[family].fully_labelled, "objects": objects})
        count += 1
    return count


def _refuse_others(folder: Path, about: str) -> None:
    """Raise FileError if the folder contains rendered frames with another family of scenes, seed or file layout."""
    marker = folder / RENDERED
    there = read_mapping(marker).get("about") if marker.is_file() else about
    if there != about:
        raise FileError(
            f"expected an empty folder or a folder of {about}, got {folder} with {there}: give another --out"
        )


def _require_extra() -> None:
    """Check that scipy and trimesh are installed, before rendering starts. Raise SpigoloError if scipy or trimesh is
    missing.
    """
    for name in ("scipy", "trimesh"):
        if importlib.util.find_spec(name) is None:
            raise SpigoloError(f'this layout needs {name}, which is not installed: pip install "spigolo[datasets]"')


def _rendered(family: str, count: int, seed: int, tell: Tell | None) -> Iterator[tuple[int, Sample]]:
    for number in range(count):
        yield number, render_family(family, number, seed)
        if tell is not None:
            tell(number + 1)


def _bop_name(family: str, number: int) -> str:
    scenes = len(FAMILIES[family].scenes)
    return f"{number % scenes + 1}/{number // scenes}"


def _original_name(family: str, number: int, sample: Sample) -> str:
    scenes = FAMILIES[family].scenes
    turn, position = divmod(number, len(scenes))
    if family == "multi":
        return tejani_name(scenes[position], turn)
    shot, letter = divmod(turn, len(_BINS))
    return rutgers_name(sample.instances[0].model, _BINS[letter], len(sample.instances) - 1, position, shot)


def _renamed(sample: Sample, name: str) -> Sample:
    frame = sample.frame
    return Sample(Frame(frame.color, frame.depth, frame.camera, name=name), sample.labels, sample.instances)
