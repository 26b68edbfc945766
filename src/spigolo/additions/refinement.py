"""Outlines of objects redrawn by colour where depth does not locate them (`settings.Refinement`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color, DepthMap, Mask
from spigolo.kernels import moments
from spigolo.kernels import seeding as kernel
from spigolo.settings.additions import Refinement

Labels = npt.NDArray[np.int32]

RAMP_STEP_M = 0.03
RAMP_STEP_SHARE = 0.02
"""Minimum depth difference, in metres and as a share of the distance, of the steps that ramps are measured at."""
MEMORY = 0.5
"""Weight of the earlier pixels of a tree in its colour."""
CARRY = 0.9
"""Share of the weight of an edge that is added to the next one."""
HALVED_BAND_PX = 3
"""Width of the band on each side of the borders of repeated labels: one and a half pixels of the halved image."""


@dataclass(frozen=True, slots=True, eq=False)
class Claimed:
    """Labels after the seeded partition.

    labels (H, W) int32. source_of (H * W,) int32: number y * width + x of the seed of each opened pixel, undefined
    elsewhere. opened: (H, W), pixels that a seed has claimed.
    """

    labels: Labels
    source_of: npt.NDArray[np.int32]
    opened: Mask


def refine_labels(labels: Labels, color: Color, depth: DepthMap, config: Refinement) -> Claimed:
    """Redraw the borders of objects by colour where depth cannot be trusted.

    labels: (H, W), 0 = background, others are objects. color: (H, W, 3) uint8 RGB. depth: (H, W) in metres as measured,
    0 = missing. Each object keeps its innermost pixels. Lengths are those of this image.
    """
    width = band_width_px(labels, depth, config)
    near_hole = _widen(np.asarray(depth == 0), config.near_hole_px)
    opened, count = open_band(labels, near_hole, width, max(width, config.hole_width_px), config.max_opened)
    if config.min_solidity is not None:
        count += open_hulls(labels, opened, config.min_solidity)
    return claim(labels, opened, count, color, depth, config)


def open_hulls(labels: Labels, opened: npt.NDArray[np.uint8], min_solidity: float) -> int:
    """Open the background inside the convex hull of each object that fills most of it. Return the number of pixels.

    The bottom of a bowl lies on the table, so that depth does not tell it from the table.
    """
    count = int(labels.max(initial=0)) + 1
    sums, boxes = np.zeros((count, 6)), np.zeros((count, 4), np.int32)
    moments.sum_regions(labels, sums, boxes)
    opened_before = np.count_nonzero(opened)
    for number, (top, left, bottom, right) in enumerate(boxes.tolist()[1:], start=1):
        here = labels[top:bottom, left:right]
        outlines, _ = cv2.findContours((here == number).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        hull: Any = cv2.convexHull(np.vstack(outlines)) if outlines else np.zeros((0, 1, 2), np.int32)
        if not outlines or sum(map(cv2.contourArea, outlines)) < min_solidity * cv2.contourArea(hull):
            continue
        inside = np.zeros(here.shape, np.uint8)
        cv2.fillConvexPoly(inside, hull, kernel.OPEN)
        inside[here != 0] = 0
        opened[top:bottom, left:right] |= inside
    kernel.flag_columns(opened)
    return int(np.count_nonzero(opened) - opened_before)


def place_outlines(labels: Labels, color: Color, depth: DepthMap, config: Refinement) -> Claimed:
    """Place the borders of objects whose labels come from half the width and height, by colour and depth steps.

    labels: (H, W), each repeated in a block of two by two pixels. color: (H, W, 3) uint8 RGB. depth: (H, W) in metres
    as measured, 0 = missing. The pixels that a border may run through are open.
    """
    opened, count = open_band(
        labels, np.zeros(labels.shape, np.uint8), HALVED_BAND_PX, HALVED_BAND_PX, config.max_opened
    )
    return claim(labels, opened, count, color, depth, config)


def band_width_px(labels: Labels, depth: DepthMap, config: Refinement) -> int:
    """Return the width of the band on each side of the borders, from the ramps at the depth steps along them."""
    sums = np.zeros(2, np.int64)
    kernel.count_ramps(labels, depth, config.reach_px, np.float32(RAMP_STEP_M), np.float32(RAMP_STEP_SHARE), sums)
    if sums[0] < config.min_profiles:
        return config.min_width_px
    ramp_px = float(sums[1] / sums[0])
    return int(np.clip(round(config.ramp_factor * ramp_px), config.min_width_px, config.max_width_px))


def open_band(
    labels: Labels, near_hole: npt.NDArray[np.uint8], width_px: int, hole_width_px: int, max_opened: float
) -> tuple[npt.NDArray[np.uint8], int]:
    """Return the pixels (H, W) uint8 within a distance of a border between labels, and their number.

    near_hole: (H, W), pixels at which the distance is hole_width_px, not width_px. If a label is thinner than the
    distance, only the outer share `max_opened` of its layers is opened. Label 0 may be opened entirely.
    """
    layer, inner = np.empty(labels.shape, np.uint8), np.zeros(int(labels.max(initial=0)) + 1, np.int32)
    kernel.measure_layers(labels, near_hole, width_px, min(hole_width_px, 250), layer, inner)
    inner[0] = kernel.UNREACHED
    opened = np.empty(labels.shape, np.uint8)
    return opened, int(kernel.open_layers(labels, layer, inner, np.float32(max_opened), opened))


def claim(
    labels: Labels,
    opened: npt.NDArray[np.uint8],
    count: int,
    color: Color,
    depth: DepthMap,
    config: Refinement,
) -> Claimed:
    """Give each opened pixel the label of the seed whose tree reaches it first. Unreachable pixels keep their label."""
    smooth = color
    if config.sigma_px > 0:
        smooth = np.asarray(cv2.GaussianBlur(color, (0, 0), config.sigma_px, borderType=cv2.BORDER_REPLICATE), np.uint8)
    out, open_now = labels.copy(), opened.copy()
    source_of = np.empty(labels.size, np.int32)
    kernel.grow_seeds(
        smooth,
        depth,
        out,
        open_now,
        count,
        MEMORY,
        CARRY,
        np.float32(config.step_m),
        np.float32(config.step_per_m),
        np.float32(config.step_weight),
        source_of,
    )
    return Claimed(out, source_of, np.asarray(opened > open_now))


def _widen(mask: Mask, reach_px: int) -> npt.NDArray[np.uint8]:
    """Return a mask as uint8, dilated by a square with sides of 2 reach_px + 1."""
    size = 2 * reach_px + 1
    return np.asarray(cv2.dilate(mask.view(np.uint8), np.ones((size, size), np.uint8)))
