"""Conversion of results to the Python objects of other libraries, without files."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from spigolo.errors import SpigoloError
from spigolo.export.instances import box_xywh
from spigolo.objects.segmentation import Segmentation


def sam(result: Segmentation) -> list[dict[str, Any]]:
    """Return a list of dicts like those of SAM's automatic mask generator, one dict for each object in the order of
    labels.

    Each dict has the following keys:

    - `segmentation`: mask (H, W) bool of the object
    - `bbox`: bounding box (x, y, width, height) in pixels
    - `predicted_iou`, `stability_score`: score of the object
    - `point_coords`: centroid (x, y) in pixels
    """
    height, width = result.labels.shape
    return [
        {
            "segmentation": o.mask,
            "area": o.area_px,
            "bbox": box_xywh(o.box_px),
            "predicted_iou": o.score,
            "stability_score": o.score,
            "point_coords": [[o.centroid_px[1], o.centroid_px[0]]],
            "crop_box": [0, 0, width, height],
        }
        for o in result
    ]


def detections(result: Segmentation) -> Any:
    """Return the objects as `supervision.Detections`, with their labels in `data["label"]`, and their ids, if they have
    ids, in `tracker_id`.

    Boxes are (x0, y0, x1, y1) in pixels, x1 and y1 exclusive. The class of every object is 0. Raises SpigoloError if
    the package supervision is not installed.
    """
    try:
        supervision = importlib.import_module("supervision")
    except ImportError:
        raise SpigoloError('Detections need supervision, which is missing: pip install "spigolo[export]"') from None
    boxes = np.array([o.box_px for o in result], np.float32).reshape(-1, 4)
    masks = np.array([o.mask for o in result], bool).reshape(-1, *result.labels.shape)
    return supervision.Detections(
        xyxy=boxes[:, [1, 0, 3, 2]],
        mask=masks,
        confidence=np.array([o.score for o in result], np.float32),
        class_id=np.zeros(len(result), int),
        tracker_id=None if any(o.id is None for o in result) else np.array([o.id for o in result], int),
        data={"label": np.array([o.label for o in result], int)},
    )
