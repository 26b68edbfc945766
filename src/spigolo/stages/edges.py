"""Selection of the image edges that are boundaries of objects (equations 12-20).

A Canny edge is a depth boundary if the depth changes by a step across the edge. A Canny edge is a contact boundary if
an object touches its support at the edge. Canny edges of all other kinds are removed, such as texture edges and convex
edges of objects.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.camera import kernel_numbers
from spigolo.frames.frame import Camera, Color, DepthMap, Mask
from spigolo.kernels import edges as kernel
from spigolo.settings.paper import EdgesConfig

NO_ANGLE_DEG = 360.0
"""Threshold in degrees that no contact angle reaches. Without intrinsics, `NO_ANGLE_DEG` is used as threshold, so that
no contact boundaries are found.
"""

SIGN_RULES = {"tangent": kernel.SIGN_TANGENT, "x": kernel.SIGN_X, "none": kernel.SIGN_NONE}

Gradient = npt.NDArray[np.int16]


@dataclass(frozen=True, slots=True, eq=False)
class EdgeMaps:
    """Masks (H, W) of the image edges of a frame and of the edges that are boundaries of objects."""

    canny: Mask
    """Mask E_E (H, W) of all Canny edges of the colour image."""
    depth_boundary: Mask
    """Mask E_B (H, W) of Canny edges at a depth step (equation 13)."""
    contact_boundary: Mask
    """Mask E_C (H, W) of Canny edges where an object touches its support (equation 18)."""
    final: Mask
    """Mask E_F (H, W), the union of E_B and E_C (equation 20)."""


@stage("edges")
def find_edges(image: Color, depth: DepthMap, camera: Camera | None, config: EdgesConfig) -> EdgeMaps:
    """Find the image edges of an RGB image (H, W, 3), and classify the edges by a depth map (H, W) in metres."""
    canny, gx, gy = scharr_canny(image, config)
    depth_boundary, contact = classify(canny, gx, gy, depth, camera, config)
    return EdgeMaps(canny, depth_boundary, contact, final_boundary(depth_boundary, contact))


def scharr_canny(image: Color, config: EdgesConfig) -> tuple[Mask, Gradient, Gradient]:
    """Return the mask E_E (H, W) of Canny edges, and the Scharr gradients (H, W) along x and y.

    Canny's thresholds are shares of the largest gradient in the frame. A minimum threshold suppresses noise in images
    without edges.
    """
    gray = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), (5, 5), 0)
    gx = np.asarray(cv2.Scharr(gray, cv2.CV_16S, 1, 0), np.int16)
    gy = np.asarray(cv2.Scharr(gray, cv2.CV_16S, 0, 1), np.int16)
    largest = float(np.sqrt(np.float32(kernel.steepest(gx, gy))))
    low = max(config.canny_low * largest, config.canny_floor)
    high = low * config.canny_high / config.canny_low if config.canny_low > 0 else config.canny_high * largest
    return cv2.Canny(gx, gy, low, high, L2gradient=True) > 0, gx, gy


def classify(
    canny: Mask, gx: Gradient, gy: Gradient, depth: DepthMap, camera: Camera | None, config: EdgesConfig
) -> tuple[Mask, Mask]:
    """Return the masks (H, W) of the depth boundary E_B and the contact boundary E_C among the edge pixels `canny`."""
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
    """Eq. 20. Return the mask E_F (H, W), the union of depth boundary and contact boundary."""
    return depth_boundary | contact_boundary


def boundary_cue(lines: Mask, config: EdgesConfig) -> npt.NDArray[np.float32]:
    """Eq. 21. Compute the boundary map delta_bound (H, W) from 0 to 1 from the lines of E_F. The lines are blurred if
    `config.boundary` is "soft".
    """
    return soften(lines, config.blur_px) if config.boundary == "soft" else lines.astype(np.float32)


def soften(lines: Mask, blur_px: int) -> npt.NDArray[np.float32]:
    """Blur a mask (H, W) by a Gaussian and rescale the result to a maximum of 1."""
    blurred = np.asarray(cv2.GaussianBlur(lines.astype(np.float32), (blur_px, blur_px), 0), np.float32)
    largest = blurred.max(initial=0)
    return blurred / largest if largest > 0 else blurred
