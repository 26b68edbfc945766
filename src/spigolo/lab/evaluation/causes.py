"""Classification of the reasons why labelled objects are not found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spigolo.lab.evaluation.measures import FOUND_SHARE

Labels = NDArray[np.integer[Any]]
Mask = NDArray[np.bool_]

OTHER_SHARE = 0.2
"""Threshold for the cause `MERGED`: the minimum share of a region's pixels that are on other objects."""


class Cause(str, Enum):
    """Reason why a labelled object was not found.

    The causes are tested in the order FOUND, REJECTED, SPLIT, OUTLINE, MERGED, FLOODED. The first cause that applies is
    used.
    """

    FOUND = "found"
    """A predicted object has an IoU above 0.7 with the labelled object, so the object was found."""
    REJECTED = "rejected"
    """A rejected region has an IoU above 0.7 with the labelled object."""
    MERGED = "merged"
    """One region covers more than 70 % of the object, and at least 20 % of the region's pixels are on other objects."""
    FLOODED = "flooded"
    """One region covers more than 70 % of the object. At least 30 % of the region's pixels are outside the object, but
    less than 20 % are on other objects.
    """
    SPLIT = "split"
    """No region covers more than 70 % of the labelled object."""
    OUTLINE = "outline off"
    """One region covers more than 70 % of the object. More than 70 % of the region's pixels are on the object, but the
    IoU is at most 0.7.
    """


@dataclass(frozen=True, slots=True)
class Fate:
    """Reason why one labelled object was not found. The reason is determined from one region (`region`)."""

    label: int
    """Label of the object in the ground truth."""
    cause: Cause
    """Reason why the object was not found. The value is `FOUND` if the object was found."""
    region: int
    """Number of the region from which the cause is determined.

    For the causes `FOUND` and `REJECTED`, `region` is the region with the largest IoU. For other causes, `region` is
    the region that covers the most pixels of the object.
    """
    iou: float
    """Intersection over union of the object and `region`."""


def find_fates(truth: Labels, labels: Labels, regions: Labels, ignore: Mask | None = None) -> list[Fate]:
    """Determine for every labelled object whether the object was found, and the reason if it was not found.

    Parameters
    ----------
    truth
        Ground truth labels (H, W), 0 = background.
    labels
        Predicted labels (H, W), 0 = background.
    regions
        Region numbers (H, W) from 0, including rejected regions.
    ignore
        Mask (H, W) of pixels to leave out of the comparison.

    """
    counted = np.ones(truth.shape, bool) if ignore is None else ~ignore
    true, found, region = truth[counted], labels[counted], regions[counted]
    area = np.bincount(region, minlength=int(regions.max()) + 1)
    on_objects = np.bincount(region[true > 0], minlength=area.size)
    return [_fate(int(k), true == k, found, region, area, on_objects) for k in np.unique(true[true > 0])]


def _fate(
    label: int, own: Mask, found: Labels, region: Labels, area: NDArray[np.int64], on_objects: NDArray[np.int64]
) -> Fate:
    size = np.count_nonzero(own)
    shared = np.bincount(region[own], minlength=area.size)
    iou = shared / (size + area - shared)
    best, most = int(iou.argmax()), int(shared.argmax())
    if _best_iou(own, found) > FOUND_SHARE:
        return Fate(label, Cause.FOUND, best, float(iou[best]))
    if iou[best] > FOUND_SHARE:
        return Fate(label, Cause.REJECTED, best, float(iou[best]))
    covers, lies_on = shared[most] / size, shared[most] / area[most]
    if covers <= FOUND_SHARE:
        return Fate(label, Cause.SPLIT, most, float(iou[most]))
    if lies_on > FOUND_SHARE:
        return Fate(label, Cause.OUTLINE, most, float(iou[most]))
    others = (on_objects[most] - shared[most]) / area[most]
    return Fate(label, Cause.MERGED if others >= OTHER_SHARE else Cause.FLOODED, most, float(iou[most]))


def _best_iou(own: Mask, found: Labels) -> float:
    shared = np.bincount(found[own], minlength=int(found.max(initial=0)) + 1)
    area = np.bincount(found, minlength=shared.size)
    return float((shared / (np.count_nonzero(own) + area - shared))[1:].max(initial=0))
