"""Reader and writer of object models: triangle meshes in .ply, .obj or .stl files."""

from __future__ import annotations

import importlib
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from spigolo.errors import FileError
from spigolo.frames.files import write_bytes
from spigolo.lab.datasets.sample import Model

MESHES = (".ply", ".obj", ".stl")


@lru_cache(maxsize=64)
def read_model(path: Path, unit_m: float = 1.0) -> Model:
    """Read a triangle mesh.

    The model is named after the file. unit_m: metres per unit of length in the file. Raises FileError if the file
    cannot be read.
    """
    trimesh = _trimesh(path)
    try:
        mesh = trimesh.load_mesh(str(path), process=False)
    except Exception as error:  # readers of the formats may raise any exception
        raise FileError(f"expected a triangle mesh in {path}, but the file cannot be read: {error}") from None
    vertices = np.asarray(getattr(mesh, "vertices", ()), np.float64)
    triangles = np.asarray(getattr(mesh, "faces", ()), np.int32)
    if not triangles.size:
        raise FileError(f"expected a triangle mesh in {path}, got a mesh without triangles")
    if triangles.min() < 0 or triangles.max() >= len(vertices) or not np.isfinite(vertices).all():
        raise FileError(
            f"expected a triangle mesh in {path}, got triangles with corners that do not exist: the file is damaged"
        )
    coloured = mesh.visual.kind == "vertex"
    colors = np.asarray(mesh.visual.vertex_colors, np.uint8)[:, :3] if coloured else None
    return Model(path.stem, vertices * unit_m, triangles, colors)


def write_model(path: Path, model: Model, unit_m: float = 1.0) -> None:
    """Write a model as a binary .ply file.

    unit_m: metres per unit of length in the file. Raises FileError if the file cannot be written.
    """
    trimesh = _trimesh(path)
    mesh = trimesh.Trimesh(model.vertices_m / unit_m, model.triangles, vertex_colors=model.colors, process=False)
    write_bytes(path, trimesh.exchange.ply.export_ply(mesh, vertex_normal=False))


def find_model(folder: Path, name: str) -> Path | None:
    """Find the file NAME.ply, NAME.obj or NAME.stl in `folder` or in its subfolder NAME. Case is ignored.

    Return None if no file is found.
    """
    if not folder.is_dir():
        return None
    wanted = name.lower()
    places = [folder, *(p for p in sorted(folder.iterdir()) if p.is_dir() and p.name.lower() == wanted)]
    files = [p for place in places for p in sorted(place.iterdir()) if p.stem.lower() == wanted]
    return next((p for kind in MESHES for p in files if p.suffix.lower() == kind), None)


def _trimesh(path: Path) -> Any:
    try:
        importlib.import_module("trimesh.exchange.ply")
        return importlib.import_module("trimesh")
    except ImportError:
        raise FileError(f'expected trimesh for {path}, but it is missing: pip install "spigolo[datasets]"') from None
