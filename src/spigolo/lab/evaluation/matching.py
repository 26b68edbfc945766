"""Matching of true objects with predicted segments, and of their boundary pixels.

Label images must be 2-D arrays of non-negative integers. The function `spigolo.lab.evaluation.score_frame` checks the
label images. Letters in array shapes: H, W = image height and width, N = number of true objects (objects of the ground
truth), S = number of predicted segments.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Labels = NDArray[np.integer[Any]]
Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RADIUS_PER_DIAGONAL = 0.003
"""Default maximum distance between boundary pixels that match, divided by the image diagonal."""

DENSE = 4096
"""If no label is above `DENSE`, pixels are counted in an array that is indexed by the label.

If a label is above `DENSE`, the labels are first converted to consecutive numbers.
"""

LARGE_PX = 16
"""If the matching radius is above `LARGE_PX` pixels, boundary pixels are matched by a distance transform.

For a large matching radius, a distance transform is faster than dilation.
"""

NEEDS_SCIPY = 'the measures need scipy, which is not installed: pip install "spigolo[evaluation]"'


@dataclass(frozen=True, slots=True, eq=False)
class OverlapTable:
    """Numbers of pixels that each true object shares with each predicted segment."""

    object_ids: NDArray[np.integer[Any]]
    """Labels (N,) of the true objects, ascending."""

    segment_ids: NDArray[np.integer[Any]]
    """Labels (S,) of the predicted segments, ascending."""

    shared_px: Ints
    """Number of pixels (N, S) that each object shares with each segment."""

    object_px: Ints
    """Area (N,) of each true object, in pixels."""

    segment_px: Ints
    """Area (S,) of each predicted segment, in pixels."""

    def recall(self) -> Floats:
        """Return the recall (N, S): the share of each object's pixels that each segment covers."""
        return self.shared_px / self.object_px[:, np.newaxis]

    def precision(self) -> Floats:
        """Return the precision (N, S): the share of each segment's pixels that lie on each object."""
        return self.shared_px / self.segment_px[np.newaxis, :]

    def f(self) -> Floats:
        """Return the F measure (N, S), the harmonic mean of precision and recall of each pair."""
        return 2 * self.shared_px / np.add.outer(self.object_px, self.segment_px)

    def iou(self) -> Floats:
        """Return the intersection over union (N, S) of each object and segment."""
        return self.shared_px / (np.add.outer(self.object_px, self.segment_px) - self.shared_px)


def overlap_table(truth: Labels, prediction: Labels) -> OverlapTable:
    """Count the pixels that true objects and predicted segments share.

    Parameters
    ----------
    truth, prediction
        (H, W) label images, 0 = background.

    """
    true_values, true_rank = _ranked(truth)
    pred_values, pred_rank = _ranked(prediction)
    size = (len(true_values), len(pred_values))
    couple = np.multiply(true_rank, size[1], dtype=np.intp)
    np.add(couple, pred_rank, out=couple, dtype=np.intp)  # in place, because allocating an array takes longer
    counts = np.bincount(couple, minlength=math.prod(size)).reshape(size)
    object_px, segment_px = counts.sum(axis=1), counts.sum(axis=0)
    is_object, is_segment = (true_values != 0) & (object_px > 0), (pred_values != 0) & (segment_px > 0)
    return OverlapTable(
        object_ids=true_values[is_object],
        segment_ids=pred_values[is_segment],
        shared_px=counts[is_object][:, is_segment],
        object_px=object_px[is_object],
        segment_px=segment_px[is_segment],
    )


def _ranked(labels: Labels) -> tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]]]:
    """Return an ascending array of label values, and the index (H * W,) of each pixel's label in this array.

    If no label is above `DENSE`, label k has index k in the array of label values, so the pixels need not be sorted.
    """
    highest = int(labels.max(initial=0))
    if highest <= DENSE:
        return np.arange(highest + 1, dtype=labels.dtype), labels.ravel()
    return np.unique(labels.ravel(), return_inverse=True)


def pair_by_f(table: OverlapTable) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pair objects and segments one to one so that the sum of their F measures is maximal.

    Returns
    -------
    objects, segments
        Row and column numbers (min(N, S),) of the pairs in the table. If several pairings have the same maximum sum of
        F measures, the order of the labels decides.

    """
    try:
        from scipy.optimize import linear_sum_assignment
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(NEEDS_SCIPY) from missing
    objects, segments = linear_sum_assignment(table.f(), maximize=True)
    return objects, segments


def default_radius_px(shape: tuple[int, ...]) -> int:
    """Return the default maximum distance between boundary pixels that match: 0.3 % of the image diagonal, rounded up
    to pixels.
    """
    return math.ceil(RADIUS_PER_DIAGONAL * math.hypot(*shape))


def boundary_map(labels: Labels) -> Mask:
    """Return a mask (H, W) of the pixels whose right or lower neighbour has another label."""
    edge = np.zeros(labels.shape, np.bool_)
    edge[:, :-1] = labels[:, :-1] != labels[:, 1:]
    edge[:-1] |= labels[:-1] != labels[1:]
    return edge


def boundary_hits(boundary: Mask, other: Mask, radius_px: float) -> int:
    """Count the pixels of the mask `boundary` that are at most `radius_px` from a pixel of the mask `other`.

    One pixel of the mask `other` may match several pixels of the mask `boundary`.
    """
    return int(np.count_nonzero(boundary & _within(other, radius_px)))


def _within(mask: Mask, radius_px: float) -> Mask:
    """Return a mask (H, W) of the pixels that are at most `radius_px` from the given mask."""
    if radius_px > LARGE_PX:
        if not mask.any():
            return mask
        nearest_px = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        return np.asarray(np.sqrt(np.rint(nearest_px.astype(np.float64) ** 2)) <= radius_px)  # squares are integers
    reach = np.arange(-int(radius_px), int(radius_px) + 1)
    disk = np.hypot(reach[:, np.newaxis], reach) <= radius_px
    return np.asarray(cv2.dilate(mask.astype(np.uint8), disk.astype(np.uint8)) > 0)
