"""Validation of label images and parameters before scoring.

Letters in array shapes: H, W = image height and width.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from spigolo.lab.evaluation.matching import Labels


def checked_pair(truth: ArrayLike, prediction: ArrayLike, ignore: ArrayLike | None) -> tuple[Labels, Labels]:
    """Validate two label images (H, W), and set ignored pixels to 0 in both. Raises ValueError for invalid images."""
    true, pred = _checked_labels(truth, "truth"), _checked_labels(prediction, "prediction")
    if true.shape != pred.shape:
        raise ValueError(
            f"expected label images of one shape, got truth {true.shape} and prediction {pred.shape}: "
            "resize one of them with nearest-neighbour sampling"
        )
    if ignore is None:
        return true, pred
    mask = np.asarray(ignore)
    if mask.shape != true.shape or mask.dtype != np.bool_:
        raise ValueError(
            f"expected ignore to be a boolean image of shape {true.shape}, "
            f"got {mask.dtype} of shape {mask.shape}: "
            "make it from the label image, for example labels == 255"
        )
    true, pred = true.copy(), pred.copy()
    true[mask] = 0
    pred[mask] = 0
    return true, pred


def _checked_labels(labels: ArrayLike, name: str) -> Labels:
    array = np.asarray(labels)
    if array.ndim != 2:
        raise ValueError(
            f"expected {name} to be a 2-D label image, got shape {array.shape}: pass one channel of one frame"
        )
    if array.dtype.kind not in "iu":
        raise ValueError(
            f"expected {name} to hold whole-number labels, got {array.dtype}: convert it with .astype(np.int32)"
        )
    if array.size and int(array.min()) < 0:
        raise ValueError(
            f"expected {name} to hold labels from 0 up, got {int(array.min())}: "
            "set unlabelled pixels to 0, or pass them as ignore"
        )
    return array


def checked_radius(radius_px: float) -> float:
    """Return the matching radius `radius_px` as a float. Raises ValueError if the radius is negative or NaN."""
    if not radius_px >= 0:
        raise ValueError(f"expected radius_px to be 0 or more, got {radius_px}: leave it out for the default")
    return float(radius_px)
