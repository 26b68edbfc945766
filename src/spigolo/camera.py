"""Pinhole cameras, from whatever form their intrinsics come in.

Pixel centres have whole coordinates: an image of width W reaches from -0.5 to W - 0.5.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError

DISTORTION_LENGTHS = (0, 4, 5, 8, 12, 14)
"""How many coefficients OpenCV knows: k1 k2 p1 p2, k3, k4 k5 k6, s1 s2 s3 s4, tau_x tau_y."""
MAX_SKEW = 1e-3
"""Skew of K, relative to fx, that is taken for rounding: half a pixel over 500 rows."""
MAX_ASPECT_CHANGE = 0.01
"""848x480 counts as 16:9."""
NOMINAL = {
    "kinect-v1": ((525.0, 525.0, 319.5, 239.5, 640, 480),),
    "kinect-v2": ((1081.4, 1081.4, 959.5, 539.5, 1920, 1080),),
    "xtion": ((570.3, 570.3, 319.5, 239.5, 640, 480),),
    "orbbec-astra": ((570.3, 570.3, 319.5, 239.5, 640, 480),),
    "realsense-d415": ((615.0, 615.0, 319.5, 239.5, 640, 480), (922.5, 922.5, 639.5, 359.5, 1280, 720)),
    "realsense-d435": ((615.0, 615.0, 319.5, 239.5, 640, 480), (922.5, 922.5, 639.5, 359.5, 1280, 720)),
    "azure-kinect": ((605.0, 605.0, 639.5, 359.5, 1280, 720),),
}
"""fx, fy, cx, cy, width, height of each aspect ratio of a camera's colour stream, the default one first."""
MATRIX_NAMES = ("K", "k", "camera_matrix", "cam_K", "intrinsic_matrix")
DISTORTION_NAMES = ("distortion", "distortion_coefficients", "dist_coeffs", "coeffs", "D", "d")
OPENCV_MODELS = ("", "none", "brown_conrady", "plumb_bob", "rational_polynomial", "opencv")
REALSENSE_MODELS = ("none", "modified_brown_conrady", "inverse_brown_conrady", "ftheta", "brown_conrady")
"""librealsense's numbers of its models."""


@dataclass(frozen=True, slots=True)
class Camera:
    """Pinhole intrinsics in pixels, of the colour image that depth is registered to.

    fx, fy: focal lengths; cx, cy: principal point; width, height: image size; distortion: OpenCV's coefficients
    (k1 k2 p1 p2 k3 ..., 4, 5, 8, 12 or 14 of them), () for none; nothing but zeros is none. Raises CameraError.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    distortion: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for name in ("fx", "fy", "cx", "cy"):  # whole numbers would be another type to the kernels
            object.__setattr__(self, name, _number(name, getattr(self, name)))
        for name in ("width", "height"):
            object.__setattr__(self, name, _whole_number(name, getattr(self, name)))
        object.__setattr__(self, "distortion", _coefficients(self.distortion))
        if self.fx <= 0 or self.fy <= 0:
            raise CameraError(f"expected positive finite focal lengths in pixels, got fx={self.fx}, fy={self.fy}")
        if self.width < 1 or self.height < 1:
            raise CameraError(f"expected an image size of at least 1x1, got {self.width}x{self.height}")

    @classmethod
    def from_matrix(cls, K: Any, width: int, height: int, distortion: Sequence[float] = ()) -> Camera:
        """A camera of K: (3, 3), or its nine numbers row by row. Raises CameraError."""
        rows = _array(K)
        if rows.shape not in ((3, 3), (9,)):
            raise CameraError(f"expected a camera matrix of shape (3, 3) or nine numbers, got shape {rows.shape}")
        (fx, skew, cx), (below, fy, cy), last = rows.reshape(3, 3).tolist()
        if abs(skew) > MAX_SKEW * abs(fx) or below != 0 or last != [0, 0, 1]:
            raise CameraError(
                "expected a camera matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], got"
                f" {rows.reshape(3, 3).tolist()}: transpose it where it is stored column by column"
            )
        return cls(fx, fy, cx, cy, width, height, tuple(distortion))

    @classmethod
    def from_fov(
        cls, width: int, height: int, *, horizontal_deg: float | None = None, vertical_deg: float | None = None
    ) -> Camera:
        """A camera of its field of view in degrees, principal point in the middle; square pixels if one is given.

        Raises CameraError.
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
        """The nominal colour intrinsics of a well-known camera whose depth is registered to colour.

        Nominal: every single camera differs by a per cent or two. Good for a first look; calibrate for 3-D.
        width, height: size of the images, by default the camera's own; another one is scaled to, with its aspect ratio.
        Raises CameraError, which lists the names.
        """
        modes = NOMINAL.get(name.strip().lower().replace("_", "-").replace(" ", "-"))
        if modes is None:
            raise CameraError(f"expected a camera file that exists or one of {', '.join(NOMINAL)}, got {name!r}")
        cameras = [cls(*mode) for mode in modes]
        width, height = width or cameras[0].width, height or cameras[0].height
        for camera in cameras:
            if abs(width * camera.height / (height * camera.width) - 1) <= MAX_ASPECT_CHANGE:
                return camera.scaled(width, height)
        sizes = " or ".join(f"{camera.width}x{camera.height}" for camera in cameras)
        raise CameraError(
            f"expected images of the aspect ratio of {sizes} for {name}, got {width}x{height}: give its intrinsics"
        )

    def scaled(self, width: int, height: int) -> Camera:
        """The camera of the whole image after it is resized to width x height; no crop."""
        x, y = width / self.width, height / self.height
        cx, cy = (self.cx + 0.5) * x - 0.5, (self.cy + 0.5) * y - 0.5
        return Camera(self.fx * x, self.fy * y, cx, cy, width, height, self.distortion)

    def without_distortion(self) -> Camera:
        """The camera of its undistorted images."""
        return replace(self, distortion=())

    def undistort(self, image: npt.NDArray[Any], *, nearest: bool = False) -> npt.NDArray[Any]:
        """An image (H, W) or (H, W, C) as the same camera without distortion sees it; 0 where this one saw nothing.

        Bilinear, or `nearest` for depth and labels, which must not mix.
        """
        if not self.distortion:
            return image
        import cv2

        K, size = self.matrix, (self.width, self.height)
        map_x, map_y = cv2.initUndistortRectifyMap(K, np.array(self.distortion), np.eye(3), K, size, cv2.CV_32FC1)
        return np.asarray(cv2.remap(image, map_x, map_y, cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR))

    @property
    def matrix(self) -> npt.NDArray[np.float64]:
        """K, (3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def back_project(
        self, depth: npt.NDArray[Any], where: npt.NDArray[np.bool_] | None = None
    ) -> npt.NDArray[np.float32]:
        """Points (N, 3) in metres of the pixels of `depth` (H, W) that are valid and, if given, in `where`."""
        valid = depth > 0 if where is None else (depth > 0) & where
        y, x = np.nonzero(valid)
        z = depth[y, x]
        return np.stack([(x - self.cx) / self.fx * z, (y - self.cy) / self.fy * z, z], axis=1).astype(np.float32)


CameraLike = Camera | str | Mapping[str, Any] | npt.NDArray[Any] | Sequence[Sequence[float]] | Sequence[float] | None
"""What `as_camera` takes."""


def as_camera(value: CameraLike, width: int, height: int) -> Camera | None:
    """The camera of images of width x height, from any form; None stays None.

    value: a Camera (kept as it is); K as (3, 3) or as nine numbers row by row; (fx, fy, cx, cy); a name that
    `Camera.named` knows; a mapping as in `camera_from_mapping`. Raises CameraError.
    """
    if value is None or isinstance(value, Camera):
        return value
    if isinstance(value, str):
        return Camera.named(value, width, height)
    if isinstance(value, Mapping):
        return camera_from_mapping(value, width, height)
    numbers = _array(value)
    if numbers.shape == (4,):
        fx, fy, cx, cy = numbers.tolist()
        return Camera(fx, fy, cx, cy, width, height)
    if numbers.shape in ((3, 3), (9,)):
        return Camera.from_matrix(numbers, width, height)
    raise CameraError(
        f"expected a camera as Camera, 3x3 matrix, (fx, fy, cx, cy), name or mapping, got shape {numbers.shape}"
    )


def camera_from_mapping(values: Mapping[str, Any], width: int | None = None, height: int | None = None) -> Camera:
    """A camera of the fields of a camera file, with width and height where it has none of its own.

    Intrinsics: fx, fy, cx, cy (or ppx, ppy); or K, k, camera_matrix or cam_K, nine numbers row by row; or Open3D's
    intrinsic_matrix, column by column; matrices may be 3x3 and may lie in a field "data". Size: width, height or
    image_width, image_height. Distortion: distortion, distortion_coefficients, dist_coeffs, coeffs, D or d, of the
    model in distortion_model or model. Raises CameraError.
    """
    found = {
        "width": _first(values, ("width", "image_width"), width),
        "height": _first(values, ("height", "image_height"), height),
    }
    K = _matrix(values)
    if K is None:
        names = {"fx": ("fx",), "fy": ("fy",), "cx": ("cx", "ppx"), "cy": ("cy", "ppy")}
        found = {name: _first(values, others) for name, others in names.items()} | found
    lacking = [name for name, value in found.items() if value is None]
    if lacking:
        raise CameraError(
            f"expected {', '.join(found)} of a camera (or its matrix as one of {', '.join(MATRIX_NAMES)}):"
            f" {', '.join(lacking)} not found"
        )
    distortion = _distortion(values)
    if K is None:
        return Camera(**found, distortion=distortion)
    return Camera.from_matrix(K, found["width"], found["height"], distortion)


def _matrix(values: Mapping[str, Any]) -> npt.NDArray[np.float64] | None:
    name = next((name for name in MATRIX_NAMES if values.get(name) is not None), None)
    if name is None:
        return None
    stored = _array(_data(values[name]))
    if stored.size != 9:
        raise CameraError(f"expected nine numbers in {name}, got shape {stored.shape}")
    by_columns = name == "intrinsic_matrix" and stored.ndim == 1
    return stored.reshape(3, 3).T if by_columns else stored.reshape(3, 3)


def _distortion(values: Mapping[str, Any]) -> tuple[float, ...]:
    coefficients = _coefficients(_data(_first(values, DISTORTION_NAMES, ())))
    model = _first(values, ("distortion_model", "model"), "")
    if isinstance(model, int) and 0 <= model < len(REALSENSE_MODELS):
        model = REALSENSE_MODELS[model]
    known = str(model).lower().removeprefix("distortion.").replace(" ", "_").replace("-", "_") in OPENCV_MODELS
    if coefficients and not known:
        raise CameraError(
            f"expected the distortion model plumb_bob or rational_polynomial, got {model}: undistort the images first"
            " and give their camera without distortion"
        )
    return coefficients


def _first(values: Mapping[str, Any], names: Sequence[str], default: Any = None) -> Any:
    return next((values[name] for name in names if values.get(name) is not None), default)


def _data(value: Any) -> Any:
    return value.get("data", ()) if isinstance(value, Mapping) else value


def _array(value: Any) -> npt.NDArray[np.float64]:
    try:
        return np.asarray(value, np.float64)
    except (TypeError, ValueError):
        raise CameraError(f"expected the numbers of a camera, got {_shortened(value)}") from None


def _coefficients(values: Any) -> tuple[float, ...]:
    numbers = _array(values).reshape(-1)
    if numbers.size not in DISTORTION_LENGTHS or not np.isfinite(numbers).all():
        raise CameraError(
            f"expected 4, 5, 8, 12 or 14 finite distortion coefficients in OpenCV's order, got {numbers.tolist()}"
        )
    return tuple(numbers.tolist()) if numbers.any() else ()


def _number(name: str, value: Any) -> float:
    if not isinstance(value, int | float | np.integer | np.floating) or not math.isfinite(value):
        focal = "a positive finite focal length" if name in ("fx", "fy") else "a finite number"
        raise CameraError(f"expected {focal} in pixels as {name}, got {_shortened(value)}")
    return float(value)


def _whole_number(name: str, value: Any) -> int:
    if not isinstance(value, int | float | np.integer | np.floating) or value != value // 1:
        raise CameraError(f"expected an image size in whole pixels as {name}, got {_shortened(value)}")
    return int(value)


def _shortened(value: Any) -> str:
    text = repr(value).replace("\n", " ")
    return text if len(text) <= 60 else f"{text[:57]}..."


def kernel_numbers(camera: Camera | None) -> tuple[float, float, float, float]:
    """(fx, fy, cx, cy) as kernels take them; numbers without meaning where there is no camera."""
    return (1.0, 1.0, 0.0, 0.0) if camera is None else (camera.fx, camera.fy, camera.cx, camera.cy)
