"""Result of a segmentation: objects, rejected regions, and corrections by hand."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import SpigoloError
from spigolo.frames.camera import shortened
from spigolo.frames.frame import Color, Frame, Mask
from spigolo.frames.roi import pixel_of
from spigolo.objects.drawing import draw_numbers, draw_objects
from spigolo.objects.facts import MEASURED, Labels, RegionFacts
from spigolo.objects.scene import Scene
from spigolo.objects.verdicts import Reason, Verdict
from spigolo.stages.regions import Regions

FACTS = tuple(f.name for f in dataclasses.fields(RegionFacts))
CROP_MARGIN = 0.15
"""Margin of an object's picture, as a share of its box."""
_facts = attrgetter(*FACTS)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class ObjectMask(RegionFacts):
    """One object: its mask, its measurements and its number."""

    label: int
    """Number of the object in `Segmentation.labels`, from 1."""
    id: int | None = None
    """Id of the object, from 1. It stays the same from frame to frame. None without `Segmenter(ids=True)`."""

    @property
    def number(self) -> int:
        """Number that pictures and messages show: the id if the object has one, else the label."""
        return self.label if self.id is None else self.id

    def _summary(self) -> str:
        return f"{self.label}: {RegionFacts._summary(self)}"

    def _repr_png_(self) -> bytes:
        """Return the object cut out of its frame as a PNG, for notebooks."""
        picture = draw_objects(self.frame.color, {self.number: self.mask})
        y0, x0, y1, x1 = self.box_px
        dy, dx = round(CROP_MARGIN * (y1 - y0)) + 1, round(CROP_MARGIN * (x1 - x0)) + 1
        return _png(picture[max(y0 - dy, 0) : y1 + dy, max(x0 - dx, 0) : x1 + dx])


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class RejectedRegion(RegionFacts):
    """A region that is not an object."""

    reason: Reason
    """First rule that the region breaks."""
    why: str
    """Reason in words, with the measured value and the limit."""

    def _summary(self) -> str:
        return f"{self.why}; {RegionFacts._summary(self)}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Segmentation:
    """Result of `segment`. Iterating, indexing and len() use the objects, best score first. np.asarray() gives
    the labels.
    """

    labels: Labels
    """Label image (H, W) int32: 0 = background, 1..N = objects."""
    objects: tuple[ObjectMask, ...]
    """The objects, best score first."""
    rejected: tuple[RejectedRegion, ...]
    """All regions that are not objects, each with the reason for its rejection."""
    left_out: tuple[str, ...]
    """Results that need intrinsics and were left out."""
    preset: str
    """Name of the parameters."""
    digest: str
    """Hash of the parameters."""
    regions: Regions
    """All regions of the frame."""
    scene: Scene
    """Input of the rejection rules: frame, depth, plane and limits."""

    def __repr__(self) -> str:
        height, width = self.labels.shape
        found = f"{len(self)} object{'' if len(self) == 1 else 's'}, {len(self.rejected)} rejected"
        return f"Segmentation({found}, {width}x{height}, {self.preset} {self.digest})"

    def _repr_png_(self) -> bytes:
        """Return the overlay as a PNG, for notebooks."""
        return _png(self.overlay())

    @property
    def frame(self) -> Frame:
        """The frame that was segmented."""
        return self.scene.frame

    @property
    def support(self) -> Mask | None:
        """Background pixels (H, W) on the support plane, a new array each time. None if there is no plane."""
        return self.scene.on_support(self.labels)

    def overlay(self) -> Color:
        """Return the colour image (H, W, 3) with the background dimmed and each object tinted and numbered.

        The numbers and tints are those of ids, if objects have them, so that they last from frame to frame.
        """
        masks = {o.number: o.mask for o in self}
        picture = draw_objects(self.frame.color, masks)
        draw_numbers(picture, masks)
        return picture

    def to_dict(self) -> dict[str, Any]:
        """Return all except the pixels as a dictionary for json.dumps: objects, and rejected regions with reasons.

        Names are those of `RegionFacts`. Metres in the camera's frame (X right, Y down, Z forward), pixels as (y, x).
        """
        return {
            "preset": self.preset,
            "digest": self.digest,
            "image_size_px": list(self.labels.shape),
            "stamp_ns": self.frame.stamp_ns,
            "left_out": list(self.left_out),
            "objects": [{**_numbers(o), **o.to_dict(), "oriented_box": _box(o)} for o in self],
            "rejected": [{"reason": r.reason.value, "why": r.why, **r.to_dict()} for r in self.rejected],
        }

    def table(self) -> dict[str, list[Any]]:
        """Return the measurements of the objects as columns, one row per object: `pandas.DataFrame(result.table())`."""
        rows = [{**_numbers(o), **o.to_dict()} for o in self]
        names = [*(["label", "id"] if any(o.id is not None for o in self) else ["label"]), *MEASURED]
        return {name: [row.get(name) for row in rows] for name in names}

    def __iter__(self) -> Iterator[ObjectMask]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __getitem__(self, index: int) -> ObjectMask:
        return self.objects[index]

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False and dtype is not None and np.dtype(dtype) != self.labels.dtype:
            raise ValueError(f"labels are int32: another type ({np.dtype(dtype)}) needs a copy")
        labels = self.labels if dtype is None else self.labels.astype(dtype, copy=False)
        return labels.copy() if copy else labels

    def at(self, point: tuple[float, float]) -> ObjectMask | RejectedRegion:
        """Return the object or rejected region at a pixel (y, x). Raises IndexError outside the image."""
        region = int(self.regions.labels[pixel_of(point, self.frame.shape)])
        everything: tuple[ObjectMask | RejectedRegion, ...] = (*self.objects, *self.rejected)
        return next(r for r in everything if r.region == region)

    def object_at(self, point: tuple[float, float]) -> ObjectMask:
        """Return the object at a pixel (y, x), even if its region breaks a rule, as after a click of a user."""
        found = self.at(point)
        kept = found if isinstance(found, ObjectMask) else self.keep(found).at(point)
        assert isinstance(kept, ObjectMask)
        return kept

    def keep(self, region: RegionFacts) -> Segmentation:
        """Return the result with a rejected region as an object. Raises SpigoloError for a region of another result."""
        self._check_own(region)
        return self._with(region, None)

    def drop(self, region: RegionFacts) -> Segmentation:
        """Return the result without an object. Raises SpigoloError for an object of another result."""
        self._check_own(region)
        return self._with(region, (Reason.BY_HAND, "dropped by hand"))

    def merge(self, a: RegionFacts, b: RegionFacts) -> Segmentation:
        """Return the result with two objects or regions merged to one object, measured again.

        The regions of the new result have new numbers, so keep, drop and merge of it require regions from its own `at`.
        Raises SpigoloError for regions of another result.
        """
        self._check_own(a, b)
        if a.region == b.region:
            return self.keep(a)
        first, second = sorted((a.region, b.region))
        root = np.arange(self.regions.count)
        root[second] = first
        regions = self.regions.joined(root)
        verdicts = self.verdicts()
        verdicts[first] = None
        del verdicts[second]
        return assemble(self.scene, regions, self.scene.measure(regions), verdicts)

    def _check_own(self, *regions: RegionFacts) -> None:
        own = self.regions.labels
        for region in regions:
            if not isinstance(region, RegionFacts):
                raise SpigoloError(
                    f"expected an object or region of this answer, as its `at` gives it, got {shortened(region)}"
                )
            # pickled apart from its answer, a region has labels of its own
            if region.regions is not own and not np.array_equal(region.regions, own):
                raise SpigoloError(
                    "expected an object or region of this answer, got one of regions that were numbered otherwise, such"
                    " as those before a merge: ask this answer's `at`"
                )

    def _with(self, region: RegionFacts, verdict: Verdict | None) -> Segmentation:
        verdicts = self.verdicts()
        verdicts[region.region] = verdict
        return assemble(
            self.scene, self.regions, sorted((*self.objects, *self.rejected), key=lambda r: r.region), verdicts
        )

    def verdicts(self) -> list[Verdict | None]:
        """Return the verdict of each region, indexed by region number. None: an object."""
        verdicts: list[Verdict | None] = [None] * self.regions.count
        for r in self.rejected:
            verdicts[r.region] = (r.reason, r.why)
        return verdicts


def assemble(
    scene: Scene, regions: Regions, facts: Sequence[RegionFacts], verdicts: Sequence[Verdict | None]
) -> Segmentation:
    """Return the result from the measurements and the verdict (None: an object) of each region, by region number."""
    accepted = sorted((f for f, v in zip(facts, verdicts, strict=True) if v is None), key=lambda f: -f.score)
    objects = tuple(ObjectMask(label=k, id=getattr(f, "id", None), **_fields(f)) for k, f in enumerate(accepted, 1))
    rejected = tuple(
        RejectedRegion(reason=v[0], why=v[1], **_fields(f))
        for f, v in zip(facts, verdicts, strict=True)
        if v is not None
    )
    label_of = np.zeros(regions.count, np.int32)
    for o in objects:
        label_of[o.region] = o.label
    labels = regions.spread(label_of)
    return Segmentation(
        labels=labels,
        objects=objects,
        rejected=rejected,
        left_out=scene.all_left_out(),
        preset=scene.preset,
        digest=scene.digest,
        regions=regions,
        scene=scene,
    )


def _numbers(o: ObjectMask) -> dict[str, int]:
    return {"label": o.label} if o.id is None else {"label": o.label, "id": o.id}


def _box(o: ObjectMask) -> dict[str, Any] | None:
    box = o.oriented_box()
    return None if box is None else box.to_dict()


def _fields(facts: RegionFacts) -> dict[str, Any]:
    return dict(zip(FACTS, _facts(facts), strict=True))


def _png(picture: Color) -> bytes:
    return cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))[1].tobytes()
