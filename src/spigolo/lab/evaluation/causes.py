"""Causes of lost objects: the region was rejected, merged, flooded, split, or has a wrong outline."""

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
"""Minimum share of a region on other objects at which the region counts as merged with them."""


class Cause(str, Enum):
    """Cause of a lost object, in the order in which causes are tested."""

    FOUND = "found"
    """A returned object has an IoU above 0.7 with the labelled object."""
    REJECTED = "rejected"
    """A rejected region has an IoU above 0.7 with the labelled object."""
    MERGED = "merged"
    """The object's region also covers other objects."""
    FLOODED = "flooded"
    """The object's region also covers background."""
    SPLIT = "split"
    """The object's largest region covers only a part of it."""
    OUTLINE = "outline off"
    """The object's region covers most of it and little else, but its IoU is at most 0.7."""


@dataclass(frozen=True, slots=True)
class Fate:
    """Outcome of one labelled object."""

    label: int
    """Label of the object in the ground truth."""
    cause: Cause
    """Cause of the loss, or FOUND."""
    region: int
    """Region with the largest IoU. For merged, flooded and split objects, the region that covers most of the object."""
    iou: float
    """IoU of the region with the object."""


def find_fates(truth: Labels, labels: Labels, regions: Labels, ignore: Mask | None = None) -> list[Fate]:
    """Return the outcome of every labelled object.

    truth, labels: (H, W), 0 = background. regions: (H, W), every region of the frame from 0. ignore: (H, W) bool,
    pixels that do not count.
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
