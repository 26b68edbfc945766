"""Names of lens models, and rejection of models whose distortion OpenCV cannot remove."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spigolo.errors import CameraError
from spigolo.frames.camera import Camera

OPENCV_MODELS = (
    "", "none", "no_distortion", "pinhole", "perspective", "brown_conrady", "brown", "plumb_bob", "rational_polynomial",
    "rational", "opencv", "full_opencv", "radtan", "radial_tangential", "thin_prism", "tilted", "simple_pinhole",
    "simple_radial", "radial",
)  # fmt: skip
"""Names of lens models whose coefficients `cv2.undistort` accepts."""
INVERSE = "inverse_brown_conrady"
POLYNOMIALS = (INVERSE, "modified_brown_conrady")
"""Names of lens models that OpenCV does not support. A camera with an unsupported lens model is accepted if all its
coefficients are 0.
"""
NO_PINHOLE = (
    "equi", "fish", "kannala", "kb4", "kb8", "omni", "mei", "unified", "sphere", "spherical", "eucm", "ucm", "ftheta",
    "f_theta", "fov", "atan", "ocam", "scaramuzza", "panoram", "cylind", "stereographic", "orthographic", "division",
)  # fmt: skip
"""Parts of the names of lens models that are not pinhole models, even if all their coefficients are 0."""
EXACTLY_NO_PINHOLE = ("ds", "kb", "theta")
REALSENSE_MODELS = (
    "none", "modified_brown_conrady", INVERSE, "ftheta", "brown_conrady", "kannala_brandt4",
)  # fmt: skip
"""Names of librealsense's distortion models, in the order of their numbers."""
MEND = "undistort the images first and give their camera without distortion"


def model_name(value: object) -> str:
    """Return the name of a lens model in lower case with underscores.

    value: text, an enumeration or librealsense's number.
    """
    if isinstance(value, int) and 0 <= value < len(REALSENSE_MODELS):
        return REALSENSE_MODELS[value]
    words = str(value).strip().lower().rpartition(".")[2]
    return words.replace(" ", "_").replace("-", "_").removeprefix("rs2_distortion_")


def check_model(value: object, certain: bool, coefficients: Sequence[float], camera: Camera) -> None:
    """Raise CameraError for a lens model that OpenCV cannot undistort.

    - value: content of the field with the lens model.
    - certain: False if the field may contain something other than a lens model, such as the name of a device.
    - coefficients: distortion coefficients.
    - camera: camera without distortion.
    """
    name = model_name(value)
    if name in OPENCV_MODELS or (name in POLYNOMIALS and not coefficients):
        return
    wanted = f"expected the distortion model plumb_bob or rational_polynomial, got {name}"
    if name in EXACTLY_NO_PINHOLE or any(part in name for part in NO_PINHOLE):
        raise CameraError(f"{wanted}: {MEND}. With this model, coefficients of 0 do not mean a pinhole camera")
    if name == INVERSE:
        raise CameraError(
            f"{wanted}: {MEND}. OpenCV cannot undistort this model. Without the coefficients, if you give"
            f" only fx, fy, cx and cy, the error is up to {inverse_error_px(coefficients, camera):.1f} px in the"
            " corners"
        )
    if coefficients or certain:
        raise CameraError(f"{wanted}: {MEND}")


def inverse_error_px(coefficients: Sequence[float], camera: Camera) -> float:
    """Return the position error in pixels that results if inverse Brown-Conrady coefficients are ignored. The position
    error is computed in the four image corners, and the largest of the four errors is returned.

    Inverse Brown-Conrady coefficients describe a polynomial from distorted pixels to rays.
    """
    corners = [(x, y) for x in (0, camera.width - 1) for y in (0, camera.height - 1)]
    x, y = ((np.array(corners) - (camera.cx, camera.cy)) / (camera.fx, camera.fy)).T
    k1, k2, p1, p2, k3 = (*coefficients, 0.0, 0.0, 0.0, 0.0, 0.0)[:5]
    r2 = x * x + y * y
    radial = k1 * r2 + k2 * r2**2 + k3 * r2**3
    dx = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    dy = y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)
    return float(np.hypot(camera.fx * dx, camera.fy * dy).max())
