"""Edges that are boundaries of objects (eqs. 12-20).

A Canny edge is a boundary where depth steps beside it (depth boundary) or where an object stands on something
(contact boundary); prints and the ridges of an object are neither. Depth comes in as an array.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.camera import kernel_numbers
from spigolo.frames.frame import Camera, Color, DepthMap, Mask
from spigolo.kernels import contours as contour_kernel
from spigolo.kernels import edges as kernel
from spigolo.settings.additions import DepthContours
from spigolo.settings.config import Edges

NO_ANGLE_DEG = 360.0
"""A low threshold that no angle reaches: without intrinsics there are depth steps but no angles."""

SIGN_RULES = {"tangent": kernel.SIGN_TANGENT, "x": kernel.SIGN_X, "none": kernel.SIGN_NONE}

Gradient = npt.NDArray[np.int16]


@dataclass(frozen=True, slots=True, eq=False)
class EdgeMaps:
    """E_E, E_B, E_C, E_F and the cue made of them, all (H, W).

    canny: E_E, every edge of the colour image. depth_boundary: E_B. contact_boundary: E_C. final: E_F, with the
    depth contours where they are asked for; contours: those alone, else None.
    boundary: float32 in [0, 1], E_F as the second cost function takes it, soft or thin. holes: whether the borders of
    what is missing are among the contours.
    """

    canny: Mask
    depth_boundary: Mask
    contact_boundary: Mask
    final: Mask
    contours: Mask | None
    boundary: npt.NDArray[np.float32]
    holes: bool = False


def find_edges(
    image: Color, depth: DepthMap, camera: Camera | None, config: Edges, foot: Mask | None = None
) -> EdgeMaps:
    """All edge maps of an RGB image (H, W, 3) with its depth (H, W) in metres.

    foot: contours (H, W) known from elsewhere, joined to the final map.
    """
    canny, gx, gy = scharr_canny(image, config)
    depth_boundary, contact = classify(canny, gx, gy, depth, camera, config)
    final = final_boundary(depth_boundary, contact)
    contours, holes = foot, None
    if config.depth_contours is not None:
        contours = find_contours(depth, camera, config.depth_contours)
        contours = contours if foot is None else contours | foot
        holes = find_holes(depth, config.depth_contours)
        contours = contours if holes is None else contours | hole_contours(holes, canny, config.line_px)
    if contours is not None:
        final = final | contours
    lines = widen(final, config.line_px)
    cue = soften(lines, config.blur_px) if config.boundary == "soft" else lines.astype(np.float32)
    return EdgeMaps(canny, depth_boundary, contact, final, contours, cue, holes is not None)


def scharr_canny(image: Color, config: Edges) -> tuple[Mask, Gradient, Gradient]:
    """E_E (H, W) and the Scharr gradients along x and y it was found on.

    Thresholds are shares of the frame's largest gradient, with a floor that keeps noise out of plain frames.
    """
    gray = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), (5, 5), 0)
    gx = np.asarray(cv2.Scharr(gray, cv2.CV_16S, 1, 0), np.int16)
    gy = np.asarray(cv2.Scharr(gray, cv2.CV_16S, 0, 1), np.int16)
    largest = float(np.sqrt(np.float32(kernel.steepest(gx, gy))))
    low = max(config.canny_low * largest, config.canny_floor)
    high = low * config.canny_high / config.canny_low if config.canny_low > 0 else config.canny_high * largest
    return cv2.Canny(gx, gy, low, high, L2gradient=True) > 0, gx, gy


def classify(
    canny: Mask, gx: Gradient, gy: Gradient, depth: DepthMap, camera: Camera | None, config: Edges
) -> tuple[Mask, Mask]:
    """Depth boundary E_B and contact boundary E_C, both (H, W), of every pixel of `canny`."""
    depth_boundary, contact = np.zeros(canny.shape, np.uint8), np.zeros(canny.shape, np.uint8)
    kernel.classify_edges(
        canny.view(np.uint8),
        gx,
        gy,
        depth,
        kernel_numbers(camera),
        config.step_offset_px,
        config.step_m,
        config.signed_step,
        config.missing_is_boundary,
        config.contact_offset_px,
        config.contact_low_deg if camera is not None else NO_ANGLE_DEG,
        config.contact_high_deg,
        SIGN_RULES[config.sign_rule],
        depth_boundary,
        contact,
    )
    return depth_boundary.view(bool), contact.view(bool)


def final_boundary(depth_boundary: Mask, contact_boundary: Mask) -> Mask:
    """Eq. 20. E_F (H, W): the union of both boundary maps."""
    return depth_boundary | contact_boundary


def find_contours(depth: DepthMap, camera: Camera | None, config: DepthContours) -> Mask:
    """Depth steps and concave creases (H, W) of a depth map (H, W) in metres, whatever the colour image shows."""
    filled = np.empty_like(depth)
    contour_kernel.fill_shadows(depth, config.max_shadow_px, filled)
    steps, creases = np.zeros(depth.shape, np.uint8), np.zeros(depth.shape, np.uint8)
    contour_kernel.mark_contours(
        depth,
        filled,
        kernel_numbers(camera),
        config.step_offset_px,
        config.step_m,
        config.step_per_m,
        config.crease_offset_px,
        config.crease_low_deg if camera is not None else NO_ANGLE_DEG,
        config.crease_high_deg,
        steps,
        creases,
    )
    return (steps | creases).view(bool)


def find_holes(depth: DepthMap, config: DepthContours) -> Mask | None:
    """Where depth is missing (H, W); None where less of the frame is than `holes_from`."""
    if config.holes_from is None or np.count_nonzero(depth) > (1 - config.holes_from) * depth.size:
        return None
    return np.asarray(depth == 0)


def hole_contours(holes: Mask, canny: Mask, line_px: int) -> Mask:
    """Both sides of the borders of holes, and all colour edges within them (H, W): no depth tells a print there.

    The edges become as wide as depth contours are: once it is soft, a line of one pixel would weigh a third of them.
    """
    borders = cv2.morphologyEx(holes.view(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    return np.asarray(borders).view(bool) | (holes & widen(canny, 2 * line_px + 1))


def widen(final: Mask, line_px: int) -> Mask:
    """E_F with lines of that width: in a large image a line of one pixel would be too thin to hold once it is soft."""
    if line_px <= 1:
        return final
    return np.asarray(cv2.dilate(final.view(np.uint8), np.ones((line_px, line_px), np.uint8))).view(bool)


def soften(final: Mask, blur_px: int) -> npt.NDArray[np.float32]:
    """E_F blurred by a Gaussian and rescaled to a largest value of 1: a thin line would leak between diagonals."""
    blurred = np.asarray(cv2.GaussianBlur(final.astype(np.float32), (blur_px, blur_px), 0), np.float32)
    largest = blurred.max(initial=0)
    return blurred / largest if largest > 0 else blurred
