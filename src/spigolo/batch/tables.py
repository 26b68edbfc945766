"""Writers of the table of all objects, which is collected from the JSON files of the frames."""

from __future__ import annotations

import importlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from spigolo.errors import ConfigError, FileError
from spigolo.export.instances import annotation, document
from spigolo.frames.files import write_json
from spigolo.objects.facts import MEASURED

Shard = Mapping[str, Any]
Writer = Callable[[Iterable[Shard], Path, Mapping[str, str]], None]

PARQUET, COCO = TABLES = ("objects.parquet", "coco.json")
"""File names of the Parquet and the COCO table."""
ROWS = 20_000
"""Maximum number of rows in a row group of the Parquet file. Larger row groups require more memory."""
INTEGERS = ("label", "region", "area_px", "image_height_px", "image_width_px")
TEXTS = ("frame", "mask_rle")


def writer_of(kind: str) -> tuple[str, Writer]:
    """Return the file name and the writer for a table format, "parquet" or "coco". Raises ConfigError for another
    format, and FileError if pyarrow is missing.
    """
    if kind == "parquet":
        _arrow()
        return PARQUET, write_parquet
    if kind == "coco":
        return COCO, write_coco
    raise ConfigError(f"unknown table format {kind!r}: expected parquet or coco")


def read_shards(paths: Iterable[Path]) -> Iterator[Shard]:
    """Read the JSON file of each frame and yield its content. Raises FileError for a damaged file."""
    for path in paths:
        try:
            shard = json.loads(path.read_bytes())
        except (OSError, ValueError) as error:
            raise FileError(
                f"expected the objects of a frame in {path}, but the file cannot be read: {error}"
            ) from None
        yield shard


def write_parquet(shards: Iterable[Shard], path: Path, about: Mapping[str, str]) -> None:
    """Write a Parquet file with one row for each object. about: metadata of the file."""
    pa, pq = _arrow()
    schema = _schema(pa).with_metadata({f"spigolo.{name}": text for name, text in about.items()})
    aside = path.with_name(f".{path.name}-aside")
    try:
        with pq.ParquetWriter(aside, schema, compression="zstd") as file:
            for rows in _groups(shards):
                file.write_table(pa.Table.from_pylist(rows, schema=schema))
        os.replace(aside, path)
    except OSError as error:
        aside.unlink(missing_ok=True)
        if isinstance(error, FileError):
            raise
        raise FileError(f"could not write {path}: {error.strerror or error}") from None


def _groups(shards: Iterable[Shard]) -> Iterator[list[dict[str, Any]]]:
    """Yield the rows of the table in groups of `ROWS` rows. A group can contain objects of several frames. The last
    group of rows contains the remaining rows and can be empty.
    """
    rows: list[dict[str, Any]] = []
    for shard in shards:
        rows += _rows(shard)
        while len(rows) >= ROWS:
            yield rows[:ROWS]
            del rows[:ROWS]
    yield rows


def _rows(shard: Shard) -> list[dict[str, Any]]:
    height, width = shard["image_size_px"]
    image = {"stamp_ns": shard["stamp_ns"], "image_height_px": height, "image_width_px": width}
    return [{"frame": shard["frame"], **image, **facts} for facts in shard["objects"]]


def _schema(pa: Any) -> Any:
    """Return the schema of the Parquet file. The columns with measurements of an object have the same names and the
    same order as the fields in objects.json.
    """
    numbers, whole = pa.list_(pa.float64()), pa.list_(pa.int32())
    kinds = dict.fromkeys(TEXTS, pa.string()) | dict.fromkeys(INTEGERS, pa.int32())
    kinds |= {"stamp_ns": pa.int64(), "box_px": whole}
    kinds |= dict.fromkeys(("centroid_px", "centroid_m", "spread_px2"), numbers)
    kinds["oriented_box"] = pa.struct([("center_m", numbers), ("size_m", numbers), ("R_camera_box", pa.list_(numbers))])
    names = ("frame", "stamp_ns", "label", "image_height_px", "image_width_px", *MEASURED, "oriented_box", "mask_rle")
    return pa.schema([(name, kinds.get(name, pa.float64())) for name in names])


def write_coco(shards: Iterable[Shard], path: Path, about: Mapping[str, str]) -> None:
    """Write a COCO JSON file with the mask of each object. Images are numbered from 1 in the order of the frames."""
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for number, shard in enumerate(shards, start=1):
        height, width = shard["image_size_px"]
        images.append({"id": number, "file_name": f"{shard['frame']}.png", "width": width, "height": height})
        for o in shard["objects"]:
            facts = o["mask_rle"], o["area_px"], o["box_px"], o["score"]
            annotations.append(annotation(len(annotations) + 1, images[-1], *facts))
    write_json(path, document(images, annotations, about))


def _arrow() -> tuple[Any, Any]:
    try:
        return importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    except ImportError:
        raise FileError(
            'Parquet needs pyarrow, which is missing: pip install "spigolo[batch]", or use --format coco'
        ) from None
