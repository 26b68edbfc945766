"""Contours of the depth map, added to the boundary map (`settings.DepthContours`).

No image edge exists where object and background have the same colour. Depth steps, concave creases and the outline of
everything above the support plane do not depend on colour.
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
"""Step between the rows on which noise is measured, and minimum number of pixels for the measurement."""


@dataclass(frozen=True, slots=True, eq=False)
class Contours:
    """Contours of a frame, and the boundary lines including them."""

    contours: Mask | None
    """Contours (H, W) without E_F. None if no rule finds any."""
    lines: Mask
    """Union of E_F and the contours (H, W), widened to the width of lines."""
    in_holes: bool
    """True if hole outlines are among the contours."""


@stage("contours")
def add_contours(
    edges: EdgeMaps, depth: DepthMap, camera: Camera | None, plane: Plane | None, config: Additions
) -> Contours:
    """Add the contours of a prepared depth map (H, W) in metres to the final boundary map E_F."""
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
    """Find depth steps and concave creases (H, W) of a depth map (H, W) in metres, independent of colour."""
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
    """Return the deviation of depth (H, W) from the chord of its neighbours `reach_px` away, per squared depth, 1/m.

    The result is the median over the frame. Most pixels lie on smooth surfaces, where a deviation is noise. 0 without
    enough depth.
    """
    rows = depth[::NOISE_ROWS]
    before, here, after = rows[:, : -2 * reach_px], rows[:, reach_px:-reach_px], rows[:, 2 * reach_px :]
    known = (before > 0) & (here > 0) & (after > 0)
    before, here, after = before[known], here[known], after[known]
    if here.size < NOISE_SAMPLES:
        return 0.0
    return float(np.median(np.abs(here - 2 * before * after / (before + after)) / (here * here)))


def find_holes(depth: DepthMap, config: DepthContours) -> Mask | None:
    """Return the pixels (H, W) without depth. None if their share of the frame is below `holes_from`."""
    if config.holes_from is None or np.count_nonzero(depth) > (1 - config.holes_from) * depth.size:
        return None
    return np.asarray(depth == 0)


def hole_contours(holes: Mask, canny: Mask, line_px: int) -> Mask:
    """Return both sides of hole outlines and the image edges inside holes (H, W). Depth cannot reject a print there.

    The edges are widened like depth contours. After the blur, a line of one pixel would have a third of their value.
    """
    borders = cv2.morphologyEx(holes.view(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    return np.asarray(borders).view(bool) | (holes & widen(canny, 2 * line_px + 1))


def widen(lines: Mask, line_px: int) -> Mask:
    """Widen lines (H, W) to `line_px` pixels. In a large image the blur would weaken a thin line."""
    if line_px <= 1:
        return lines
    return np.asarray(cv2.dilate(lines.view(np.uint8), np.ones((line_px, line_px), np.uint8))).view(bool)
