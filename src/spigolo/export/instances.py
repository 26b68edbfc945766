"""Export of the objects of many frames in one JSON file, in the formats of COCO and BOP."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from spigolo.errors import FrameError
from spigolo.frames.files import PathLike, write_json
from spigolo.frames.frame import Mask
from spigolo.objects.segmentation import Segmentation

CATEGORY = {"id": 1, "name": "object", "supercategory": "object"}
"""COCO category of all objects, because spigolo does not classify objects."""


def coco(results: Iterable[Segmentation], path: PathLike) -> None:
    """Write a COCO instances file with compressed run-length masks.

    Boxes are (x, y, width, height) in pixels.

    Each image has the file name `NAME.png`, where NAME is the name of its frame. Every object has the category `object`
    and a score. Raises FrameError if two frames have the same name.
    """
    names: set[str] = set()
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for number, result in enumerate(results, start=1):
        height, width = result.labels.shape
        name = _name(result, number)
        if name in names:
            raise FrameError(f"expected a different name for each frame, got {name!r} twice: set Frame(..., name=...)")
        names.add(name)
        images.append({"id": number, "file_name": f"{name}.png", "width": width, "height": height})
        for o in result:
            counts = compress(run_lengths(o.mask)["counts"])
            annotations.append(annotation(len(annotations) + 1, images[-1], counts, o.area_px, o.box_px, o.score))
    write_json(path, document(images, annotations))


def annotation(
    number: int, image: Mapping[str, Any], counts: str, area_px: int, box_px: Sequence[int], score: float
) -> dict[str, Any]:
    """Return an object in COCO's form. image: image in COCO's form. counts: compressed run lengths of the mask."""
    return {
        "id": number,
        "image_id": image["id"],
        "category_id": CATEGORY["id"],
        "segmentation": {"size": [image["height"], image["width"]], "counts": counts},
        "area": area_px,
        "bbox": box_xywh(box_px),
        "iscrowd": 0,
        "score": round(score, 6),
    }


def document(images: list[Any], annotations: list[Any], about: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return the content of a COCO instances file. about: further facts about the file."""
    info = {"description": "Objects found by spigolo, without classes.", **(about or {})}
    return {"info": info, "images": images, "annotations": annotations, "categories": [CATEGORY]}


def bop(results: Iterable[Segmentation], path: PathLike, category_id: int = 1) -> None:
    """Write a BOP results file for 2-D instance segmentation as JSON, with uncompressed run-length masks.

    Scene and image numbers are taken from the frame's name "SCENE/IMAGE". The field `time` is -1, which means not
    measured.

    category_id: category number that is written for every object. Raises FrameError if a frame's name does not have the
    form SCENE/IMAGE.
    """
    records = []
    for result in results:
        scene, image = _bop_place(result)
        for o in result:
            records.append(
                {
                    "scene_id": scene,
                    "image_id": image,
                    "category_id": category_id,
                    "bbox": box_xywh(o.box_px),
                    "score": round(o.score, 6),
                    "time": -1,
                    "segmentation": run_lengths(o.mask),
                }
            )
    write_json(path, records)


def box_xywh(box_px: Sequence[int]) -> list[int]:
    """Return a bounding box (y0, x0, y1, x1) in pixels as (x, y, width, height), in COCO's order."""
    y0, x0, y1, x1 = box_px
    return [x0, y0, x1 - x0, y1 - y0]


def run_lengths(mask: Mask) -> dict[str, Any]:
    """Return COCO's uncompressed run lengths of a mask (H, W), column by column. The first run length is the number of
    pixels outside the mask before the first mask pixel.
    """
    flat = np.concatenate([[False], mask.ravel(order="F"), [False]])
    if flat.size == 2:
        return {"size": list(mask.shape), "counts": []}
    changes = np.flatnonzero(flat[1:] != flat[:-1])
    edges = np.concatenate([[0], changes, [mask.size]])
    runs = np.diff(edges)
    return {"size": list(mask.shape), "counts": (runs if runs[-1] else runs[:-1]).tolist()}


def _name(result: Segmentation, number: int) -> str:
    return result.frame.name or f"{number:06d}"


def _bop_place(result: Segmentation) -> tuple[int, int]:
    scene, _, image = result.frame.name.rpartition("/")
    if not (scene.isdecimal() and image.isdecimal()):
        raise FrameError(
            f"expected a frame named SCENE/IMAGE for BOP, such as 000001/000023, got {result.frame.name!r}: give"
            " the folder of a BOP data set or of its split, which contains the scenes, or set Frame.name"
        )
    return int(scene), int(image)


def compress(counts: Iterable[int]) -> str:
    """Encode run lengths in COCO's compressed text format, which pycocotools reads."""
    text: list[int] = []
    runs = list(counts)
    for k, run in enumerate(runs):
        value = run - runs[k - 2] if k > 2 else run
        more = True
        while more:
            bits = value & 0x1F
            value >>= 5
            more = value != (-1 if bits & 0x10 else 0)
            text.append((bits | 0x20 if more else bits) + 48)
    return bytes(text).decode("ascii")
