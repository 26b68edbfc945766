"""Segmentation result: objects, rejected regions, and corrections by hand."""

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
"""Margin around the bounding box of an object in the PNG image of the object, as a share of the size of the box."""
_facts = attrgetter(*FACTS)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class ObjectMask(RegionFacts):
    """Object in a frame, with its mask, its measurements and its number."""

    label: int
    """Number of the object in the label image `Segmentation.labels`, from 1."""
    id: int | None = None
    """Id of the object, from 1. The same object has the same id in all frames. The id is None unless
    `Segmenter(ids=True)` is used.
    """

    @property
    def number(self) -> int:
        """Number of the object in images and messages. The number is the id of the object, or its label in the label
        image if objects have no ids.
        """
        return self.label if self.id is None else self.id

    def _summary(self) -> str:
        return f"{self.label}: {RegionFacts._summary(self)}"

    def _repr_png_(self) -> bytes:
        """Return a PNG image of the object for display in notebooks."""
        picture = draw_objects(self.frame.color, {self.number: self.mask})
        y0, x0, y1, x1 = self.box_px
        dy, dx = round(CROP_MARGIN * (y1 - y0)) + 1, round(CROP_MARGIN * (x1 - x0)) + 1
        return _png(picture[max(y0 - dy, 0) : y1 + dy, max(x0 - dx, 0) : x1 + dx])


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class RejectedRegion(RegionFacts):
    """Region that a rule rejected, with the reason for the rejection."""

    reason: Reason
    """Reason for the rejection: the first rule that the region violates."""
    why: str
    """Reason for the rejection as text, with the measured value and the limit."""
    id: int | None = None
    """Id of the region before it was dropped by hand. The id is None if the region never had an id."""

    def _summary(self) -> str:
        return f"{self.why}; {RegionFacts._summary(self)}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Segmentation:
    """Segmentation result of a frame.

    A result behaves like a sequence of its objects, best score first: iteration, indexing and len() are supported.
    np.asarray(result) returns the label image.
    """

    labels: Labels
    """Label image (H, W) int32: 0 = background, 1..N = objects."""
    objects: tuple[ObjectMask, ...]
    """Objects in descending order of their scores."""
    rejected: tuple[RejectedRegion, ...]
    """Rejected regions with the reasons for their rejection. Every region is either an object or a rejected region."""
    left_out: tuple[str, ...]
    """Names of results that were not computed, because the frame has no intrinsics. The tuple is empty if the frame has
    intrinsics.
    """
    preset: str
    """Name of the preset that was used for the segmentation."""
    digest: str
    """Hash of the parameter values, eight hexadecimal digits."""
    regions: Regions
    """All regions of the frame: objects and rejected regions."""
    scene: Scene
    """Input of the rejection rules: frame, depth map, support plane and parameters of the rules."""

    def __repr__(self) -> str:
        height, width = self.labels.shape
        found = f"{len(self)} object{'' if len(self) == 1 else 's'}, {len(self.rejected)} rejected"
        return f"Segmentation({found}, {width}x{height}, {self.preset} {self.digest})"

    def _repr_png_(self) -> bytes:
        """Return the colour image with all objects drawn over it as a PNG image, for display in notebooks."""
        return _png(self.overlay())

    @property
    def frame(self) -> Frame:
        """Frame that was segmented."""
        return self.scene.frame

    @property
    def support(self) -> Mask | None:
        """Mask (H, W) of background pixels on the support plane. The value is None if the frame has no support plane.
        Each access to the property creates a new array.
        """
        return self.scene.on_support(self.labels)

    def overlay(self) -> Color:
        """Return the colour image (H, W, 3) with the background dimmed and each object tinted and numbered.

        If objects have ids, the id of an object determines its number and tint. An object with an id therefore has the
        same number and tint in all frames.
        """
        masks = {o.number: o.mask for o in self}
        picture = draw_objects(self.frame.color, masks)
        draw_numbers(picture, masks)
        return picture

    def to_dict(self) -> dict[str, Any]:
        """Return the measurements of objects and rejected regions as a dict that can be written as JSON. The dict
        contains no masks.

        The keys of the measurements are the field names of `RegionFacts`. Points in space are in metres in the camera's
        frame. Pixels are given as (y, x).
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
        """Return the measurements of the objects as a dict of columns, for `pandas.DataFrame(result.table())`."""
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
        """Return the object or rejected region at a pixel (y, x). Raises IndexError for a point outside the image."""
        region = int(self.regions.labels[pixel_of(point, self.frame.shape)])
        everything: tuple[ObjectMask | RejectedRegion, ...] = (*self.objects, *self.rejected)
        return next(r for r in everything if r.region == region)

    def object_at(self, point: tuple[float, float]) -> ObjectMask:
        """Return the region at a pixel (y, x) as an object. A rejected region is also returned as an object."""
        found = self.at(point)
        kept = found if isinstance(found, ObjectMask) else self.keep(found).at(point)
        assert isinstance(kept, ObjectMask)
        return kept

    def keep(self, region: RegionFacts) -> Segmentation:
        """Return a new result in which a rejected region is an object. Raises SpigoloError for a region of another
        result.
        """
        self._check_own(region)
        return self._with(region, None)

    def drop(self, region: RegionFacts) -> Segmentation:
        """Return a new result in which an object is a rejected region. Raises SpigoloError for an object of another
        result.
        """
        self._check_own(region)
        return self._with(region, (Reason.BY_HAND, "dropped by hand"))

    def merge(self, a: RegionFacts, b: RegionFacts) -> Segmentation:
        """Return a new result in which two objects or rejected regions are merged into one object.

        The merged object has the id of `a`, or the id of `b` if `a` has none. All other objects keep their measurements
        and ids. The regions of the new result have new numbers. Therefore, the methods of the new result do not accept
        regions of the old result. Raises SpigoloError for regions of another result.
        """
        self._check_own(a, b)
        if a.region == b.region:
            return self.keep(a)
        first, second = sorted((a.region, b.region))
        root = np.arange(self.regions.count)
        root[second] = first
        regions = self.regions.joined(root)
        ids = [i for i in (getattr(a, "id", None), getattr(b, "id", None)) if i is not None]
        merged = ObjectMask(label=0, id=next(iter(ids), None), **_fields(self.scene.measure(regions)[first]))
        left = [r for r in self.by_region() if r.region != second]
        facts = [
            merged if k == first else dataclasses.replace(r, region=k, regions=regions.labels)
            for k, r in enumerate(left)
        ]
        verdicts = self.verdicts()
        verdicts[first] = None
        del verdicts[second]
        return assemble(self.scene, regions, facts, verdicts)

    def by_region(self) -> list[ObjectMask | RejectedRegion]:
        """Return objects and rejected regions in the order of their region numbers."""
        return sorted((*self.objects, *self.rejected), key=attrgetter("region"))

    def _check_own(self, *regions: RegionFacts) -> None:
        own = self.regions.labels
        for region in regions:
            if not isinstance(region, RegionFacts):
                raise SpigoloError(
                    f"expected an object or region from the method `at` of this result, got {shortened(region)}"
                )
            # a region that was pickled without its result has a copy of the labels
            if region.regions is not own and not np.array_equal(region.regions, own):
                raise SpigoloError(
                    "expected an object or region of this result, got one of another result, for example of the result"
                    " before a merge: take the region from the method `at` of this result"
                )

    def _with(self, region: RegionFacts, verdict: Verdict | None) -> Segmentation:
        verdicts = self.verdicts()
        verdicts[region.region] = verdict
        return assemble(self.scene, self.regions, self.by_region(), verdicts)

    def verdicts(self) -> list[Verdict | None]:
        """Return a list with one entry for each region, indexed by region number. The entry of a rejected region is the
        reason for its rejection. The entry of an object is None.
        """
        verdicts: list[Verdict | None] = [None] * self.regions.count
        for r in self.rejected:
            verdicts[r.region] = (r.reason, r.why)
        return verdicts


def assemble(
    scene: Scene, regions: Regions, facts: Sequence[RegionFacts], verdicts: Sequence[Verdict | None]
) -> Segmentation:
    """Build the segmentation result from the measurements and the reasons for rejection of all regions.

    - facts: measurements of each region, indexed by region number.
    - verdicts: reason for the rejection of each region, indexed by region number. The entry of an object is None.
    """
    accepted = sorted((f for f, v in zip(facts, verdicts, strict=True) if v is None), key=lambda f: -f.score)
    objects = tuple(ObjectMask(label=k, id=getattr(f, "id", None), **_fields(f)) for k, f in enumerate(accepted, 1))
    rejected = tuple(
        RejectedRegion(reason=v[0], why=v[1], id=getattr(f, "id", None), **_fields(f))
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
