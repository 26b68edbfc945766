"""Pinhole cameras: intrinsics, fields of view, scaling and undistortion.

Pixel centres have integer coordinates. In the x direction, an image of width W therefore reaches from -0.5 to W - 0.5.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError
from spigolo.frames.nominal import NOMINAL

DISTORTION_LENGTHS = (0, 4, 5, 8, 12, 14)
"""Valid numbers of OpenCV's distortion coefficients k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y."""
LEAST_FOCAL_PX, MOST_PX = 0.01, 1e8
"""Minimum focal length, and maximum focal length and coordinate of the principal point, in pixels."""
MAX_SKEW = 1e-3
"""Maximum skew of the camera matrix K, divided by fx, that counts as a rounding error."""
MAX_ASPECT_CHANGE = 0.01
"""Maximum relative difference between two aspect ratios that count as equal. For example, 848:480 counts as equal to
16:9.
"""
LEAST_FOCAL_SHARE = 0.05
"""Minimum focal length as a share of the image width. A focal length of 5 % of the image width means a field of view of
169 degrees.
"""
LEAST_WIDTH = 16
"""Minimum image width in pixels for which the field of view is checked. Narrower images, which are usually crops, are
not checked.
"""
FIELD_OF_VIEW = re.compile(r"(\d+(?:\.\d+)?)[ -]?deg")


@dataclass(frozen=True, slots=True, repr=False)
class Camera:
    """Pinhole intrinsics of the colour camera, in pixels. The depth map is registered to the image of the colour
    camera. Raises CameraError for invalid values.
    """

    fx: float
    """Focal length in x, in pixels."""
    fy: float
    """Focal length in y, in pixels."""
    cx: float
    """The x coordinate of the principal point, in pixels. The centre of the leftmost pixel has x = 0."""
    cy: float
    """The y coordinate of the principal point, in pixels. The centre of the topmost pixel has y = 0."""
    width: int
    """Image width, in pixels."""
    height: int
    """Image height, in pixels."""
    distortion: tuple[float, ...] = ()
    """Distortion coefficients k1 k2 p1 p2 k3 ... of OpenCV, either 4, 5, 8, 12 or 14 numbers. The tuple is empty if the
    camera has no distortion.
    """

    def __post_init__(self) -> None:
        for name in ("fx", "fy", "cx", "cy"):  # compiled kernels accept only floats
            object.__setattr__(self, name, _number(name, getattr(self, name)))
        for name in ("width", "height"):
            object.__setattr__(self, name, _whole_number(name, getattr(self, name)))
        object.__setattr__(self, "distortion", as_coefficients(self.distortion))
        if self.fx <= 0 or self.fy <= 0:
            raise CameraError(f"expected positive finite focal lengths in pixels, got fx={self.fx}, fy={self.fy}")
        if min(self.fx, self.fy) < LEAST_FOCAL_PX or max(self.fx, self.fy, abs(self.cx), abs(self.cy)) > MOST_PX:
            raise CameraError(
                f"expected intrinsics in pixels, a focal length of {LEAST_FOCAL_PX} to {MOST_PX:.0e}, got"
                f" fx={self.fx:g}, fy={self.fy:g}, cx={self.cx:g}, cy={self.cy:g}"
            )
        if self.width < 1 or self.height < 1:
            raise CameraError(f"expected an image size of at least 1x1, got {self.width}x{self.height}")
        if self.width >= LEAST_WIDTH and max(self.fx / self.width, self.fy / self.height) < LEAST_FOCAL_SHARE:
            raise CameraError(_too_wide(self))

    def __repr__(self) -> str:
        bent = f", distortion {self.distortion}" if self.distortion else ""
        place = f"fx={self.fx:g}, fy={self.fy:g}, cx={self.cx:g}, cy={self.cy:g}"
        return f"Camera({place}, width={self.width}, height={self.height}{bent})"

    @classmethod
    def from_matrix(cls, K: Any, width: int, height: int, distortion: Sequence[float] = ()) -> Camera:
        """Return the camera with the camera matrix K, given as (3, 3) or as nine numbers row by row. Raises CameraError
        for an invalid matrix.
        """
        rows = as_numbers(K)
        if rows.shape not in ((3, 3), (9,)):
            raise CameraError(f"expected a camera matrix of shape (3, 3) or nine numbers, got shape {rows.shape}")
        if not rows.any():
            raise CameraError("expected a camera matrix, got zeros: this camera was not calibrated")
        (fx, skew, cx), (below, fy, cy), last = rows.reshape(3, 3).tolist()
        if abs(skew) > MAX_SKEW * abs(fx) or below != 0 or last != [0, 0, 1]:
            raise CameraError(
                "expected a camera matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], got"
                f" {rows.reshape(3, 3).tolist()}: transpose the matrix if it is stored column by column"
            )
        return cls(fx, fy, cx, cy, width, height, tuple(distortion))

    @classmethod
    def from_fov(
        cls, width: int, height: int, *, horizontal_deg: float | None = None, vertical_deg: float | None = None
    ) -> Camera:
        """Return the camera with a given field of view, in degrees, and the principal point in the image centre.

        If only the horizontal or only the vertical angle is given, fx and fy are equal. Raises CameraError for an
        invalid angle.
        """
        given = [angle for angle in (horizontal_deg, vertical_deg) if angle is not None]
        if not given or not all(0 < angle < 180 for angle in given):
            raise CameraError(
                "expected a field of view between 0 and 180 degrees, got"
                f" horizontal_deg={horizontal_deg}, vertical_deg={vertical_deg}"
            )
        fx = None if horizontal_deg is None else width / 2 / math.tan(math.radians(horizontal_deg) / 2)
        fy = None if vertical_deg is None else height / 2 / math.tan(math.radians(vertical_deg) / 2)
        square = fx or fy or 0.0
        return cls(fx or square, fy or square, (width - 1) / 2, (height - 1) / 2, width, height)

    @classmethod
    def named(cls, name: str, width: int | None = None, height: int | None = None) -> Camera:
        """Return the nominal intrinsics of a camera model such as "kinect-v1", or of a field of view such as "60deg".

        Nominal intrinsics refer to the colour image. Nominal intrinsics differ from the calibrated intrinsics of an
        individual camera by one or two per cent. Use nominal intrinsics for a first test, and calibrate the camera for
        accurate positions.

        width, height: image size in pixels. The default size is that of the camera model's colour image, or 640x480 for
        a field of view. Nominal intrinsics are scaled to `width` and `height`, which must have the same aspect ratio.
        Raises CameraError for an unknown name or another aspect ratio.
        """
        if angle := FIELD_OF_VIEW.fullmatch(name.strip().lower()):
            return cls.from_fov(width or 640, height or 480, horizontal_deg=float(angle[1]))
        modes = NOMINAL.get(name.strip().lower().replace("_", "-").replace(" ", "-"))
        if modes is None:
            raise CameraError(
                f"expected a camera file that exists, one of {', '.join(NOMINAL)}, or a horizontal field of view"
                f" such as 60deg, got {name!r}"
            )
        cameras = [cls(*mode) for mode in modes]
        width, height = width or cameras[0].width, height or cameras[0].height
        for camera in cameras:
            if abs(width * camera.height / (height * camera.width) - 1) <= MAX_ASPECT_CHANGE:
                return camera.scaled(width, height)
        sizes = " or ".join(f"{camera.width}x{camera.height}" for camera in cameras)
        raise CameraError(
            f"expected images of the aspect ratio of {sizes} for {name}, got {width}x{height}: give the intrinsics"
            " of this image size"
        )

    def scaled(self, width: int, height: int) -> Camera:
        """Return the intrinsics that are valid after the image has been resized to width x height pixels without
        cropping.
        """
        x, y = width / self.width, height / self.height
        cx, cy = (self.cx + 0.5) * x - 0.5, (self.cy + 0.5) * y - 0.5
        return Camera(self.fx * x, self.fy * y, cx, cy, width, height, self.distortion)

    def without_distortion(self) -> Camera:
        """Return the camera of the undistorted image, which has the same intrinsics and no distortion coefficients."""
        return replace(self, distortion=())

    def undistort(self, image: npt.NDArray[Any], *, nearest: bool = False) -> npt.NDArray[Any]:
        """Remove the lens distortion from an image (H, W) or (H, W, C). Pixels that the camera did not see are 0.

        nearest: True to use nearest-neighbour instead of bilinear interpolation, as required for depth and labels.
        """
        if not self.distortion:
            return image
        import cv2

        K, size = self.matrix, (self.width, self.height)
        map_x, map_y = cv2.initUndistortRectifyMap(K, np.array(self.distortion), np.eye(3), K, size, cv2.CV_32FC1)
        return np.asarray(cv2.remap(image, map_x, map_y, cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR))

    @property
    def matrix(self) -> npt.NDArray[np.float64]:
        """Camera matrix K, (3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def back_project(
        self, depth: npt.NDArray[Any], where: npt.NDArray[np.bool_] | None = None
    ) -> npt.NDArray[np.float32]:
        """Return the points (N, 3), in metres, of all pixels with depth.

        where: mask (H, W) of the pixels to use, or None for all pixels.
        """
        valid = depth > 0 if where is None else (depth > 0) & where
        y, x = np.nonzero(valid)
        z = depth[y, x]
        return np.stack([(x - self.cx) / self.fx * z, (y - self.cy) / self.fy * z, z], axis=1).astype(np.float32)


def _too_wide(camera: Camera) -> str:
    """Return the error message for a focal length that is too small to be in pixels."""
    fx, fy, cx, cy = camera.fx, camera.fy, camera.cx, camera.cy
    view_deg = math.degrees(2 * math.atan(camera.width / (2 * fx)))
    if max(fx, fy) < 10 and max(abs(cx), abs(cy)) <= 2:
        mend = "the values are shares of the image size: multiply fx and cx by the width, fy and cy by the height"
    else:
        mend = "divide a focal length in millimetres by the pixel size in millimetres"
    return (
        f"expected intrinsics in pixels of {camera.width}x{camera.height}, got fx={fx:g}, fy={fy:g}, cx={cx:g},"
        f" cy={cy:g}, a field of view of {view_deg:.0f} degrees: {mend}"
    )


def is_number(value: object) -> bool:
    """Return True for a Python number, a NumPy number or an array of one number, and False for booleans."""
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "uif"
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def as_numbers(value: Any) -> npt.NDArray[np.float64]:
    """Convert a value to an array of float64. Raises CameraError if the value is not numeric."""
    try:
        return np.asarray(value, np.float64)
    except (TypeError, ValueError):
        raise CameraError(f"expected the numbers of a camera, got {shortened(value)}") from None


def as_coefficients(values: Any) -> tuple[float, ...]:
    """Return validated distortion coefficients, or an empty tuple if all coefficients are 0. Raises CameraError for
    invalid coefficients.
    """
    numbers = as_numbers(values).reshape(-1)
    if numbers.size not in DISTORTION_LENGTHS or not np.isfinite(numbers).all():
        raise CameraError(
            f"expected 4, 5, 8, 12 or 14 finite distortion coefficients in OpenCV's order, got {numbers.tolist()}"
        )
    return tuple(numbers.tolist()) if numbers.any() else ()


def _number(name: str, value: Any) -> float:
    if not is_number(value) or not math.isfinite(value):
        focal = "a positive finite focal length" if name in ("fx", "fy") else "a finite number"
        raise CameraError(f"expected {focal} in pixels as {name}, got {shortened(value)}")
    return float(value)


def _whole_number(name: str, value: Any) -> int:
    if not is_number(value) or value != value // 1:
        raise CameraError(f"expected an image size in whole pixels as {name}, got {shortened(value)}")
    return int(value)


def shortened(value: Any) -> str:
    """Return a string of at most 60 characters that represents a value in error messages."""
    text = repr(value).replace("\n", " ")
    return text if len(text) <= 60 else f"{text[:57]}..."


def kernel_numbers(camera: Camera | None) -> tuple[float, float, float, float]:
    """Return the intrinsics (fx, fy, cx, cy) of a camera for kernels, or placeholder numbers if the camera is None."""
    return (1.0, 1.0, 0.0, 0.0) if camera is None else (camera.fx, camera.fy, camera.cx, camera.cy)
