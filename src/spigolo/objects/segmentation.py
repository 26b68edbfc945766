"""From regions to objects: the answer, and corrections of it by hand."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.additions.stance import Stance, measure_stance
from spigolo.additions.support import Plane, above_mask, support_mask
from spigolo.errors import SpigoloError, UnitWarning, warn
from spigolo.frames.camera import shortened
from spigolo.frames.frame import DepthMap, Frame, Mask
from spigolo.frames.roi import Roi, pixel_of, roi_mask
from spigolo.objects.facts import (
    Labels,
    RegionFacts,
    contour_cue,
    measure_regions,
)
from spigolo.objects.verdicts import Reason, Verdict, judge, reject_rims
from spigolo.settings.config import Config, Rejection
from spigolo.stages.cues import Cues
from spigolo.stages.graph import Graph
from spigolo.stages.regions import Regions

NEAREST_M, FARTHEST_M = 0.03, 50.0
"""No RGB-D camera sees so near or so far."""
SAMPLED = 8
FACTS = tuple(RegionFacts.__dataclass_fields__)
_facts = attrgetter(*FACTS)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ObjectMask(RegionFacts):
    """An object. label: its number in `Segmentation.labels`."""

    label: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RejectedRegion(RegionFacts):
    """A region that is no object. reason: the first rule it breaks; why: the same with the numbers."""

    reason: Reason
    why: str


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """What regions are judged by, whatever method made them.

    depth: (H, W) metres, in-painted where that is wanted; what is 0 there counts as missing. contour: (H, W) in [0, 1],
    how strong a border is. plane: the support, None where there is none. rules: what is rejected. preset, digest: of
    the parameters that the regions come from. left_out: cues that could not be had for want of intrinsics.
    """

    depth: DepthMap
    contour: npt.NDArray[np.float32]
    plane: Plane | None
    rules: Rejection
    preset: str
    digest: str
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What an answer was made from, kept for corrections by hand."""

    regions: Regions
    frame: Frame
    evidence: Evidence
    above: Mask | None
    inside: tuple[Mask, Mask] | None

    def measure(self, regions: Regions) -> list[RegionFacts]:
        """The facts of these regions."""
        e = self.evidence
        stance = self._stance(regions)
        return measure_regions(regions, e.depth, self.frame, e.contour, self.above, self.inside, stance, e.plane)

    def _stance(self, regions: Regions) -> Stance | None:
        plane, camera, rules = self.evidence.plane, self.frame.camera, self.evidence.rules
        if rules.wall is None or rules.support is None or camera is None:
            return None
        depth = self.evidence.depth
        if plane is None:  # nothing to be tall above: every region is asked
            return measure_stance(regions, depth, camera, np.asarray(depth > 0), rules.wall)
        high = rules.support.model_copy(update={"min_height_m": rules.wall.min_height_m})
        return measure_stance(regions, depth, camera, above_mask(plane, depth, camera, high), rules.wall)


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """The answer. Iterating, indexing and len() go over the objects, best score first; np.asarray() gives the labels.

    labels: (H, W) int32, 0 = background, 1..N = objects. rejected: all other regions with their reasons.
    support: (H, W) bool, background pixels on the plane that objects stand on; None where none was looked for or found.
    left_out: what could not be done for want of intrinsics. preset, digest: name of the configuration and a hash of its
    values.
    """

    labels: Labels
    objects: tuple[ObjectMask, ...]
    rejected: tuple[RejectedRegion, ...]
    support: Mask | None
    left_out: tuple[str, ...]
    preset: str
    digest: str
    scene: Scene = field(repr=False)

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
        """The object or rejected region at a pixel (y, x). Raises IndexError outside the image."""
        region = int(self.scene.regions.labels[pixel_of(point, self.scene.frame.shape)])
        everything: tuple[ObjectMask | RejectedRegion, ...] = (*self.objects, *self.rejected)
        return next(r for r in everything if r.region == region)

    def object_at(self, point: tuple[float, float]) -> ObjectMask:
        """The object at a pixel (y, x), whatever rule its region breaks: a click says that there is one."""
        found = self.at(point)
        kept = found if isinstance(found, ObjectMask) else self.keep(found).at(point)
        assert isinstance(kept, ObjectMask)
        return kept

    def keep(self, region: RegionFacts) -> Segmentation:
        """The answer with a rejected region as an object. Raises SpigoloError for a region of other regions."""
        self._check_own(region)
        return self._with(region, None)

    def drop(self, region: RegionFacts) -> Segmentation:
        """The answer without an object. Raises SpigoloError for one of other regions."""
        self._check_own(region)
        return self._with(region, (Reason.BY_HAND, "dropped by hand"))

    def merge(self, a: RegionFacts, b: RegionFacts) -> Segmentation:
        """The answer with two objects or regions as one object, measured anew.

        Its regions are numbered anew as well: keep, drop and merge of it take what its own `at` gives. Raises
        SpigoloError for others.
        """
        self._check_own(a, b)
        if a.region == b.region:
            return self.keep(a)
        first, second = sorted((a.region, b.region))
        root = np.arange(self.scene.regions.count)
        root[second] = first
        regions = self.scene.regions.joined(root)
        verdicts = self._verdicts()
        verdicts[first] = None
        del verdicts[second]
        return assemble(dataclasses.replace(self.scene, regions=regions), self.scene.measure(regions), verdicts)

    def _check_own(self, *regions: RegionFacts) -> None:
        own = self.scene.regions.labels
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
        verdicts = self._verdicts()
        verdicts[region.region] = verdict
        return assemble(self.scene, sorted((*self.objects, *self.rejected), key=lambda r: r.region), verdicts)

    def _verdicts(self) -> list[Verdict | None]:
        verdicts: list[Verdict | None] = [None] * self.scene.regions.count
        for r in self.rejected:
            verdicts[r.region] = (r.reason, r.why)
        return verdicts


def select_objects(
    regions: Regions, graph: Graph, cues: Cues, frame: Frame, config: Config, roi: Roi | None = None
) -> Segmentation:
    """Measures every region and sorts it into objects and rejected regions.

    Pixel limits are those of a 640x480 image and grow with its area. roi: regions outside are rejected.
    """
    evidence = Evidence(
        depth=cues.depth,
        contour=contour_cue(cues, graph),
        plane=cues.support,
        rules=_rules(config, cues),
        preset=config.name,
        digest=config.digest,
        left_out=("contact boundary",) if frame.camera is None and cues.edges is not None else (),
    )
    warn_of_depth(frame)
    return judge_regions(regions, frame, evidence, roi)


def _rules(config: Config, cues: Cues) -> Rejection:
    """What is rejected in this frame."""
    added = config.edges.depth_contours
    if added is None or added.holes_min_contour is None or cues.edges is None or not cues.edges.holes:
        return config.rejection
    return config.rejection.model_copy(update={"min_contour": added.holes_min_contour})


def judge_regions(regions: Regions, frame: Frame, evidence: Evidence, roi: Roi | None = None) -> Segmentation:
    """The answer from the regions of any method: each measured, and an object or rejected with a reason."""
    plane, rules = evidence.plane, evidence.rules
    above = None
    if plane is not None and rules.support is not None and frame.camera is not None:
        above = above_mask(plane, frame.depth, frame.camera, rules.support)
    scene = Scene(regions, frame, evidence, above, None if roi is None else roi_mask(roi, frame))
    facts = scene.measure(regions)
    if frame.depth.any():
        verdicts = [judge(f, rules, 1 / regions.vga_scale) for f in facts]
        if rules.wall is not None and plane is not None and frame.camera is not None:
            height = plane.height_map_m(evidence.depth, frame.camera)
            verdicts = reject_rims(facts, verdicts, regions, evidence.depth, height, rules.wall)
        return assemble(scene, facts, verdicts)
    return assemble(scene, facts, [(Reason.NO_DEPTH, "no depth: the frame has none at all")] * len(facts))


def warn_of_depth(frame: Frame) -> None:
    """Warns of depth that leaves nothing to be found, as far as a few thousand pixels tell."""
    if not frame.depth.any():
        warn("the frame has no depth at all, so nothing in it is an object")
        return
    few = frame.depth[::SAMPLED, ::SAMPLED]
    median = float(np.median(few[few > 0])) if few.any() else 0.0
    if median > FARTHEST_M:
        warn(f"the median depth is {median:.0f} m: if it is stored in millimetres, give depth_scale=0.001", UnitWarning)
    if 0 < median < NEAREST_M:
        told = f"the median depth is {1000 * median:.2g} mm"
        warn(f"{told}: is depth_scale applied twice? Floating-point depth is in metres already", UnitWarning)


def assemble(scene: Scene, facts: Sequence[RegionFacts], verdicts: Sequence[Verdict | None]) -> Segmentation:
    """The answer from the facts of every region, by number, and what was found against it."""
    accepted = sorted((f for f, v in zip(facts, verdicts, strict=True) if v is None), key=lambda f: -f.score)
    objects = tuple(ObjectMask(label=k, **_fields(f)) for k, f in enumerate(accepted, start=1))
    rejected = tuple(
        RejectedRegion(reason=v[0], why=v[1], **_fields(f))
        for f, v in zip(facts, verdicts, strict=True)
        if v is not None
    )
    label_of = np.zeros(scene.regions.count, np.int32)
    for o in objects:
        label_of[o.region] = o.label
    labels = scene.regions.spread(label_of)
    return Segmentation(
        labels=labels,
        objects=objects,
        rejected=rejected,
        support=_support(scene, labels),
        left_out=_left_out(scene),
        preset=scene.evidence.preset,
        digest=scene.evidence.digest,
        scene=scene,
    )


def _support(scene: Scene, labels: Labels) -> Mask | None:
    plane, rule, frame = scene.evidence.plane, scene.evidence.rules.support, scene.frame
    if plane is None or rule is None or frame.camera is None:
        return None
    return np.asarray(support_mask(plane, frame.depth, frame.camera, rule) & (labels == 0))


def _left_out(scene: Scene) -> tuple[str, ...]:
    if scene.frame.camera is not None:
        return ()
    support = ("support plane",) if scene.evidence.rules.support is not None else ()
    return (*scene.evidence.left_out, *support, "reach", "points, centroids and boxes in metres")


def _fields(facts: RegionFacts) -> dict[str, Any]:
    return dict(zip(FACTS, _facts(facts), strict=True))
