"""Contours of the depth map, added to the boundary map (`settings.DepthContours`).

The Canny edge detector marks no image edge where object and background have the same colour. Depth steps, concave
creases and the outlines of objects on the support plane are found in the depth map, without the colour image.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from spigolo.additions.plane import Plane, foot_contour
from spigolo.clock import stage
from spigolo.frames.camera import kernel_numbers
from spigolo.frames.frame import Camera, DepthMap, Mask
from spigolo.kernels import contours as kernel
from spigolo.settings.additions import Additions, DepthContours
from spigolo.stages.edges import NO_ANGLE_DEG, EdgeMaps

NOISE_ROWS, NOISE_SAMPLES = 16, 1000
"""Depth noise is measured on every `NOISE_ROWS`-th image row. If the noise can be measured at fewer than
`NOISE_SAMPLES` pixels, the noise is set to 0.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Contours:
    """Contours of a depth map, and the union of these contours with the boundary map E_F."""

    contours: Mask | None
    """Mask (H, W) of the contours, without the boundary map E_F. The value is None if contours are switched off."""
    lines: Mask
    """Mask (H, W) of the boundary map E_F and the contours together, dilated to a line width of `line_px` pixels."""
    in_holes: bool
    """True if the contours include hole outlines."""


@stage("contours")
def add_contours(
    edges: EdgeMaps | None, depth: DepthMap, camera: Camera | None, plane: Plane | None, config: Additions
) -> Contours | None:
    """Add the contours of an in-painted and smoothed depth map (H, W), in metres, to the boundary map E_F. Return
    None if `edges` is None, because the cost function then reads no boundary map.
    """
    if edges is None:
        return None
    contours, holes = None, None
    if plane is not None and camera is not None and config.support is not None and config.support.contour:
        contours = foot_contour(plane, depth, camera, config.support)
    if config.contours is not None:
        found = depth_contours(depth, camera, config.contours)
        contours = found if contours is None else found | contours
        holes = find_holes(depth, config.contours)
        contours = contours if holes is None else contours | hole_contours(holes, edges.canny, config.line_px)
    final = edges.final if contours is None else edges.final | contours
    return Contours(contours, widen(final, config.line_px), holes is not None)


def depth_contours(depth: DepthMap, camera: Camera | None, config: DepthContours) -> Mask:
    """Return the mask (H, W) of depth steps and concave creases in a depth map (H, W) in metres."""
    filled = np.empty_like(depth)
    kernel.fill_shadows(depth, config.max_shadow_px, filled)
    steps, creases = np.zeros(depth.shape, np.uint8), np.zeros(depth.shape, np.uint8)
    noise_per_m = 0.0
    if config.crease_noise is not None:
        noise_per_m = config.crease_noise * measure_noise(depth, config.crease_offset_px)
    kernel.mark_contours(
        depth,
        filled,
        kernel_numbers(camera),
        config.step_offset_px,
        config.step_m,
        config.step_per_m,
        config.crease_offset_px,
        config.crease_low_deg if camera is not None else NO_ANGLE_DEG,
        config.crease_high_deg,
        noise_per_m,
        steps,
        creases,
    )
    return (steps | creases).view(bool)


def measure_noise(depth: DepthMap, reach_px: int) -> float:
    """Return the depth noise of a depth map (H, W) in metres, divided by the squared depth, in 1/m.

    The noise at a pixel is the depth difference between the pixel and a straight line in space. The line connects the
    pixels that are `reach_px` columns to the left and to the right. The returned noise is the median over the measured
    pixels. If the noise can be measured at fewer than `NOISE_SAMPLES` pixels, the returned noise is 0.
    """
    rows = depth[::NOISE_ROWS]
    before, here, after = rows[:, : -2 * reach_px], rows[:, reach_px:-reach_px], rows[:, 2 * reach_px :]
    known = (before > 0) & (here > 0) & (after > 0)
    before, here, after = before[known], here[known], after[known]
    if here.size < NOISE_SAMPLES:
        return 0.0
    return float(np.median(np.abs(here - 2 * before * after / (before + after)) / (here * here)))


def find_holes(depth: DepthMap, config: DepthContours) -> Mask | None:
    """Return the mask (H, W) of pixels without depth. Return None if pixels without depth cover less than the share
    `holes_from` of the frame.
    """
    if config.holes_from is None or np.count_nonzero(depth) > (1 - config.holes_from) * depth.size:
        return None
    return np.asarray(depth == 0)


def hole_contours(holes: Mask, canny: Mask, line_px: int) -> Mask:
    """Return the mask (H, W) of two kinds of contours: the outlines of holes, and the image edges inside holes.

    Image edges are dilated to the width of other contours, so that both are equally strong after the Gaussian blur.
    """
    borders = cv2.morphologyEx(holes.view(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    return np.asarray(borders).view(bool) | (holes & widen(canny, 2 * line_px + 1))


def widen(lines: Mask, line_px: int) -> Mask:
    """Dilate the lines of a mask (H, W) to a width of `line_px` pixels, because a Gaussian blur would weaken thin
    lines.
    """
    if line_px <= 1:
        return lines
    return np.asarray(cv2.dilate(lines.view(np.uint8), np.ones((line_px, line_px), np.uint8))).view(bool)
