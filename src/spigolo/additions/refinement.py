"""Refinement of object outlines by colour where depth is missing or smeared (`settings.Refinement`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color, DepthMap, Mask
from spigolo.kernels import bands, moments
from spigolo.kernels import seeding as kernel
from spigolo.settings.additions import Refinement

Labels = npt.NDArray[np.int32]

RAMP_STEP_M = 0.03
RAMP_STEP_SHARE = 0.02
"""Minimum depth difference of a depth step whose width is measured: max(`RAMP_STEP_M`, `RAMP_STEP_SHARE` * distance),
in metres. A ramp is a depth step that is smeared over several pixels.
"""
MEMORY = 0.5
"""Weight from 0 to 1 of the previous mean colour of a tree when a pixel is added to the tree. The colour of the added
pixel has the weight 1 - `MEMORY`. The trees of the spanning forest grow from seed pixels.
"""
CARRY = 0.9
"""Share of the weight of a graph edge that is added to the weight of the next graph edge of the tree. Because of this
addition, the weights across a blurred image edge add up to about the weight of a sharp image edge.
"""
HALVED_BAND_PX = 3
"""Width in pixels, on each side of a border, of the band in which pixels get new labels after a segmentation at half
resolution.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Claimed:
    """Labels of all pixels, after pixels near borders got new labels.

    - labels: (H, W) int32, object at each pixel, 0 = background.
    - source_of: (H * W,) int32. For each pixel in `opened`, the index y * W + x of the seed pixel from which the label
      comes. At pixels outside `opened`, the index is undefined.
    - opened: mask (H, W) of the pixels that got their label from a seed pixel.
    """

    labels: Labels
    source_of: npt.NDArray[np.int32]
    opened: Mask


def refine_labels(labels: Labels, color: Color, depth: DepthMap, config: Refinement) -> Claimed:
    """Move the borders of objects to the nearby colour differences. Only pixels within a band along the borders get new
    labels.

    The band along the borders is wider where depth is smeared or missing. The innermost pixels of each object keep
    their labels. Lengths in `config` must be scaled to the image size.

    - labels: (H, W), 0 = background, 1..N = objects.
    - color: (H, W, 3) uint8 RGB.
    - depth: measured depth (H, W) in metres, 0 where missing.
    """
    width = band_width_px(labels, depth, config)
    near_hole = _widen(np.asarray(depth == 0), config.near_hole_px)
    opened, count = open_band(labels, near_hole, width, max(width, config.hole_width_px), config.max_opened)
    if config.min_solidity is not None:
        count += open_hulls(labels, opened, config.min_solidity)
    return claim(labels, opened, count, color, depth, config)


def open_hulls(labels: Labels, opened: npt.NDArray[np.uint8], min_solidity: float) -> int:
    """Mark background pixels inside the convex hull of nearly convex objects, so that these pixels get new labels.
    Return the number of newly marked pixels.

    For example, the bottom of a bowl has nearly the same depth as the table. The bottom of the bowl may therefore be
    labelled as background.
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
        cv2.fillConvexPoly(inside, hull, bands.OPEN)
        inside[here != 0] = 0
        opened[top:bottom, left:right] |= inside
    bands.flag_columns(opened)
    return int(np.count_nonzero(opened) - opened_before)


def place_outlines(labels: Labels, color: Color, depth: DepthMap, config: Refinement) -> Claimed:
    """Refine labels that were computed at half resolution: move the borders to colour differences and depth steps at
    full resolution.

    Only pixels within `HALVED_BAND_PX` pixels of a border get new labels.

    - labels: (H, W) at full resolution. All pixels of a block of 2x2 pixels have the same label.
    - color: (H, W, 3) uint8 RGB.
    - depth: measured depth (H, W) in metres, 0 where missing.
    """
    opened, count = open_band(
        labels, np.zeros(labels.shape, np.uint8), HALVED_BAND_PX, HALVED_BAND_PX, config.max_opened
    )
    return claim(labels, opened, count, color, depth, config)


def band_width_px(labels: Labels, depth: DepthMap, config: Refinement) -> int:
    """Return the width in pixels, on each side of a border, of the band in which pixels get new labels. The width of
    the band depends on the mean width of smeared depth steps along the borders.
    """
    sums = np.zeros(2, np.int64)
    bands.count_ramps(labels, depth, config.reach_px, np.float32(RAMP_STEP_M), np.float32(RAMP_STEP_SHARE), sums)
    if sums[0] < config.min_profiles:
        return config.min_width_px
    ramp_px = float(sums[1] / sums[0])
    return int(np.clip(round(config.ramp_factor * ramp_px), config.min_width_px, config.max_width_px))


def open_band(
    labels: Labels, near_hole: npt.NDArray[np.uint8], width_px: int, hole_width_px: int, max_opened: float
) -> tuple[npt.NDArray[np.uint8], int]:
    """Mark the pixels near borders between labels, so that these pixels get new labels. Return the marks (H, W) uint8
    and the number of marked pixels.

    near_hole: (H, W) uint8, nonzero near missing depth. The band of marked pixels has a width of hole_width_px near
    missing depth, and of width_px elsewhere.

    Each object is divided into layers that are one pixel wide. Layer 1 is the border of the object, and the next layers
    follow inwards. If an object lies entirely inside the band, only the share `max_opened` of its layers is marked,
    outermost layers first. If an object reaches beyond the band, all its pixels inside the band are marked. All pixels
    of the background (label 0) inside the band are marked too.
    """
    layer, inner = np.empty(labels.shape, np.uint8), np.zeros(int(labels.max(initial=0)) + 1, np.int32)
    bands.measure_layers(labels, near_hole, width_px, min(hole_width_px, 250), layer, inner)
    inner[0] = bands.UNREACHED
    opened = np.empty(labels.shape, np.uint8)
    return opened, int(bands.open_layers(labels, layer, inner, np.float32(max_opened), opened))


def claim(
    labels: Labels,
    opened: npt.NDArray[np.uint8],
    count: int,
    color: Color,
    depth: DepthMap,
    config: Refinement,
) -> Claimed:
    """Give each marked pixel of `opened` the label of a seed pixel. Seed pixels are the unmarked pixels next to marked
    pixels. A spanning tree grows from each seed pixel. A marked pixel gets the label of the first spanning tree that
    reaches it.

    Marked pixels that no tree reaches keep their label.
    """
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
    """Return a mask (H, W) as uint8, dilated by a square with sides of 2 * reach_px + 1 pixels."""
    size = 2 * reach_px + 1
    return np.asarray(cv2.dilate(mask.view(np.uint8), np.ones((size, size), np.uint8)))
