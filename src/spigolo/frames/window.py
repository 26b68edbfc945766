"""Crop and decimation of an image, as given by the fields roi, binning_x and binning_y of ROS CameraInfo."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spigolo.errors import CameraError
from spigolo.frames.camera import Camera, is_number, shortened


@dataclass(frozen=True, slots=True)
class Window:
    """Crop of the full image, followed by decimation.

    - left_px, top_px, width, height: crop in pixels of the full image. A size of 0 x 0 means no crop.
    - binning_x, binning_y: decimation factors.
    """

    left_px: int
    top_px: int
    width: int
    height: int
    binning_x: int
    binning_y: int

    def __str__(self) -> str:
        binned = f"binning_x {self.binning_x} and binning_y {self.binning_y}"
        crop = f"roi {self.width}x{self.height} at x_offset {self.left_px}, y_offset {self.top_px}"
        parts = [crop] if self.width or self.left_px or self.top_px else []
        return " with ".join(parts + ([binned] if (self.binning_x, self.binning_y) != (1, 1) else []))

    def of(self, camera: Camera) -> Camera:
        """Return the camera of the cropped and decimated image. Raises CameraError if the crop exceeds the full
        image.
        """
        width, height = self.width or camera.width - self.left_px, self.height or camera.height - self.top_px
        if self.left_px + width > camera.width or self.top_px + height > camera.height:
            raise CameraError(f"expected {self} inside of the full image of {camera.width}x{camera.height}")
        x, y = self.binning_x, self.binning_y
        return Camera(
            camera.fx / x,
            camera.fy / y,
            (camera.cx - self.left_px + 0.5) / x - 0.5,
            (camera.cy - self.top_px + 0.5) / y - 0.5,
            width // x,
            height // y,
            camera.distortion,
        )


def window_of(values: Mapping[str, Any]) -> Window | None:
    """Return the crop and decimation of the camera fields roi, binning_x and binning_y, or None for the full image."""
    roi = values.get("roi")
    names = ("x_offset", "y_offset", "width", "height")
    crop = [_whole(f"roi.{name}", _field(roi, name)) for name in names]
    binning = [max(_whole(name, values.get(name)), 1) for name in ("binning_x", "binning_y")]
    window = Window(*crop, *binning)
    size = [values.get("width"), values.get("height")]
    full = crop[:2] == [0, 0] and (crop[2:] == [0, 0] or crop[2:] == size)
    return None if full and binning == [1, 1] else window


def _field(roi: Any, name: str) -> Any:
    return roi.get(name) if isinstance(roi, Mapping) else getattr(roi, name, None)


def _whole(name: str, value: Any) -> int:
    if value is None:
        return 0
    if not is_number(value) or value < 0 or value != value // 1:
        raise CameraError(f"expected a whole number of pixels as {name}, got {shortened(value)}")
    return int(value)
