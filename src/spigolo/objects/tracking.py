"""Tracking of objects from frame to frame by mask overlap and position in space (our addition)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from spigolo.objects.facts import Labels
from spigolo.objects.segmentation import ObjectMask, Segmentation

KEPT_FRAMES = 15
"""Maximum number of successive frames in which an object may be missing without losing its id."""
REACH_M = 0.05
"""Distance between two detections at which their closeness is 1 / e, in metres. The closeness of two detections is
exp(-distance / `REACH_M`), from 0 to 1.
"""
MIN_AFFINITY = 0.15
"""Minimum affinity of two detections that are matched as the same object. The affinity is the sum of mask overlap and
closeness.
"""
STILL_M = 0.02
"""If the camera has moved by more than this distance since the last detection of an object, in metres, the mask of the
object no longer counts.
"""
MAX_SIZE_RATIO = 4.0
"""Maximum ratio of the areas (larger divided by smaller) of two detections that are matched as the same object."""

Matrix = npt.NDArray[np.float64]


@dataclass(slots=True)
class Track:
    """Last detection of a tracked object."""

    id: int
    """Id of the object."""
    area_px: int
    """Area of the object in pixels at its last detection."""
    center_m: npt.NDArray[np.float64] | None
    """Centroid (X, Y, Z) of the object at its last detection, moved with the camera since then, metres. The value is
    None if depth or intrinsics are missing.
    """
    unseen: int = 0
    """Number of frames since the last detection of the object."""
    moved_m: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    """Motion (3,) of the object in the camera's frame since its last detection, because of the camera's motion, in
    metres.
    """


class Tracker:
    """Tracker that recognises objects in successive frames and gives each object the same id in all frames."""

    def __init__(self) -> None:
        self._tracks: list[Track] = []
        self._image: Labels | None = None  # 1 + index of the tracked object at each pixel, 0 = no object
        self._next = 1

    def follow(self, result: Segmentation) -> Segmentation:
        """Match the objects of a result with tracked objects, and return the result with ids."""
        if self._image is not None and self._image.shape != result.labels.shape:
            self._tracks, self._image = [], None
        drift = np.zeros(3)
        pairs: dict[int, int] = {}
        if self._tracks and self._image is not None:
            overlap = _overlaps(result, self._image, [t.area_px for t in self._tracks])
            drift = self._drift(result, overlap)
            pairs = match(self._affinity(result, overlap, drift))
        ids = [self._tracks[pairs[k]].id if k in pairs else self._new_id() for k in range(len(result))]
        self._remember(result, ids, {track: k for k, track in pairs.items()}, drift)
        return replace(result, objects=tuple(replace(o, id=one) for o, one in zip(result, ids, strict=True)))

    def _new_id(self) -> int:
        self._next += 1
        return self._next - 1

    def _affinity(self, result: Segmentation, overlap: Matrix, drift: npt.NDArray[np.float64]) -> Matrix:
        """Return a matrix of affinities: mask overlap plus closeness in space. Each row is an object of this frame, and
        each column is a tracked object. The affinity is 0 for pairs that must not be matched.
        """
        closeness = np.array([[_closeness(o, t, drift) for t in self._tracks] for o in result])
        areas = np.array([o.area_px for o in result], float)[:, None]
        others = np.array([t.area_px for t in self._tracks], float)
        ratio = np.maximum(areas / others, others / areas)
        both = overlap + closeness.reshape(overlap.shape)
        return np.where((ratio <= MAX_SIZE_RATIO) & (both >= MIN_AFFINITY), both, 0)

    def _drift(self, result: Segmentation, overlap: Matrix) -> npt.NDArray[np.float64]:
        """Return the median shift (3,) of all objects that overlap with tracked objects, in metres. The shift is an
        estimate of the motion of the camera.
        """
        shifts = [
            np.subtract(o.centroid_m, center)
            for k, o in enumerate(result)
            if overlap[k].max(initial=0) > 0.3
            and o.centroid_m is not None
            and (center := self._tracks[int(overlap[k].argmax())].center_m) is not None
        ]
        return np.median(shifts, axis=0) if shifts else np.zeros(3)

    def _remember(
        self, result: Segmentation, ids: list[int], found: dict[int, int], drift: npt.NDArray[np.float64]
    ) -> None:
        """Store the objects of this frame, and the tracked objects that have been missing for at most `KEPT_FRAMES`
        frames. The positions of missing objects are shifted by the motion of the camera (`drift`).
        """
        lost = [(k, _unseen(t, drift)) for k, t in enumerate(self._tracks) if k not in found and t.unseen < KEPT_FRAMES]
        image = np.zeros(result.labels.shape, np.int32)
        number_of = np.zeros(len(self._tracks) + 1, np.int32)
        for number, (k, t) in enumerate(lost, start=len(result) + 1):
            number_of[k + 1] = number if np.linalg.norm(t.moved_m) <= STILL_M else 0
        if self._image is not None and lost:
            image = number_of[self._image]
        seen = result.labels > 0
        image[seen] = result.labels[seen]
        by_label = sorted(zip(result, ids, strict=True), key=lambda pair: pair[0].label)
        self._tracks = [Track(one, o.area_px, _center(o)) for o, one in by_label]
        self._tracks += [t for _, t in lost]
        self._image = image


def _unseen(track: Track, drift: npt.NDArray[np.float64]) -> Track:
    """Return a track after one more frame without a detection, in which the camera moved by `drift`."""
    center = None if track.center_m is None else track.center_m + drift
    return replace(track, unseen=track.unseen + 1, center_m=center, moved_m=track.moved_m + drift)


def match(affinity: Matrix) -> dict[int, int]:
    """Match rows of an affinity matrix with columns. Each row and each column is matched at most once, and pairs with
    the largest affinity are matched first.

    Pairs of affinity 0 are not matched. Returns a dict from the index of each matched row to the index of its column.
    """
    pairs: dict[int, int] = {}
    taken: set[int] = set()
    for flat in np.argsort(-affinity, axis=None, kind="stable"):
        row, column = divmod(int(flat), affinity.shape[1])
        if affinity[row, column] <= 0:
            break
        if row not in pairs and column not in taken:
            pairs[row] = column
            taken.add(column)
    return pairs


def _overlaps(result: Segmentation, image: Labels, areas: list[int]) -> Matrix:
    """Return a matrix of the intersection over union of masks. Each row is an object of this frame, and each column is
    a tracked object.
    """
    rows, columns = len(result) + 1, len(areas) + 1
    joint = np.bincount((result.labels * columns + image).ravel(), minlength=rows * columns).reshape(rows, columns)
    labels = [o.label for o in result]
    shared = joint[labels][:, 1:].astype(float)
    own = np.array([o.area_px for o in result], float)[:, None]
    return np.asarray(shared / np.maximum(own + np.array(areas, float) - shared, 1))


def _closeness(o: ObjectMask, track: Track, drift: npt.NDArray[np.float64]) -> float:
    if o.centroid_m is None or track.center_m is None:
        return 0.0
    gap_m = float(np.linalg.norm(np.subtract(o.centroid_m, track.center_m) - drift))
    return float(np.exp(-gap_m / REACH_M))


def _center(o: ObjectMask) -> npt.NDArray[np.float64] | None:
    return None if o.centroid_m is None else np.array(o.centroid_m)
