"""Source for Kinect v1, Xtion and other PrimeSense cameras through OpenNI2. The device registers depth to colour."""

from __future__ import annotations

import ctypes.util
import importlib
import math
import os
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError, SpigoloError, warn
from spigolo.frames.camera import Camera
from spigolo.frames.files import known_camera
from spigolo.frames.frame import Frame
from spigolo.sources.base import Report
from spigolo.sources.live import LiveSource
from spigolo.sources.options import Options
from spigolo.sources.pairing import StampMatcher

PIP = 'pip install "spigolo[openni]"'
LIBRARY = "install OpenNI2 (apt install libopenni2-0), or set OPENNI2_REDIST64 to the folder of its library"
MILLIMETRES = 0.001
"""Unit of the depth values in metres. The device is set to this unit."""
WAIT_S = 0.5
"""Interval in seconds at which the receiving thread checks if the source was closed, while no image arrives."""
PATIENCE_S = 10.0
"""Maximum time without images, in seconds. After `PATIENCE_S` without an image, iteration raises an error."""


@dataclass(frozen=True, slots=True, eq=False)
class Image:
    """Colour or depth image, copied from the buffers of the device."""

    kind: str
    """Kind of image, "color" or "depth"."""
    stamp_ns: int
    """Time stamp of the image in nanoseconds, on the clock of the device."""
    pixels: npt.NDArray[Any]
    """Colour (H, W, 3) uint8 RGB, or depth (H, W) uint16 in millimetres."""


class OpenNICamera(LiveSource):
    """Source for an OpenNI2 camera: the camera with the given address, or the first connected camera. By default, each
    step of an iteration yields the newest frame.
    """

    def __init__(self, uri: str, options: Options) -> None:
        super().__init__(f"openni:{uri}", options)
        self._sdk, self._uri = _initialised(), uri
        if not uri and not self._sdk.Device.enumerate_uris():
            raise FileError("no OpenNI camera is connected: plug one in, or name the address of one (openni:ADDRESS)")
        if options.camera is None:
            self.intrinsics = "the field of view that the device reports"

    def report(self) -> Report:
        """Return the numbers of frames and images since the start of the last iteration, and the maximum stamp
        difference of a pair.
        """
        return replace(super().report(), tolerance_ms=self.options.tolerance_ms)

    def _receive(self) -> Iterator[Frame]:
        with ExitStack() as stack:
            device = stack.enter_context(self._opened())
            streams = {kind: stack.enter_context(self._stream(device, kind)) for kind in ("color", "depth")}
            self._register(device)
            for stream in streams.values():
                stream.start()
                stack.callback(stream.stop)
            camera = self._camera(streams["color"])
            for number, (color, depth) in enumerate(self._pairs(streams)):
                try:
                    frame = self._frame(color, depth, camera, f"{number:06d}")
                except SpigoloError as error:
                    self._skip(f"{number:06d}", error)
                else:
                    yield frame

    def _opened(self) -> Any:
        """Open the device and return it. Raises FileError."""
        try:
            return self._sdk.Device(self._uri.encode() or None)
        except Exception as error:  # each module of the binding has its own exception class
            found = [one.decode() for one in self._sdk.Device.enumerate_uris()]
            raise FileError(
                f"{self.name} cannot be opened ({_told(error)}). Connected: {', '.join(found) or 'none'}"
            ) from None

    def _stream(self, device: Any, kind: str) -> Any:
        """Create the stream "color" or "depth" with the image size and frame rate of the options. Raises FileError."""
        sdk, own = self._sdk, self.options
        sensor = sdk.SENSOR_COLOR if kind == "color" else sdk.SENSOR_DEPTH
        pixels = sdk.PIXEL_FORMAT_RGB888 if kind == "color" else sdk.PIXEL_FORMAT_DEPTH_1_MM
        info = device.get_sensor_info(sensor)
        if info is None:
            raise FileError(f"{self.name} has no {kind} stream: spigolo needs a camera with colour and depth")
        wanted = own.width, own.height, own.fps, int(pixels)
        modes = [_numbers(mode) for mode in info.videoModes]
        if wanted not in modes:
            having = ", ".join(f"{w}x{h} at {fps} Hz" for w, h, fps, form in modes if form == int(pixels))
            raise FileError(
                f"{self.name} has no {kind} stream of {own.width}x{own.height} at {own.fps} Hz: choose another one with"
                f" ?width=W&height=H&fps=N. Available: {having or 'none'}"
            )
        stream = device.create_stream(sensor)
        if _numbers(stream.get_video_mode()) != wanted:
            stream.configure_mode(own.width, own.height, own.fps, pixels)
        with suppress(self._error):  # some devices cannot mirror images
            stream.set_mirroring_enabled(False)
        return stream

    def _register(self, device: Any) -> None:
        """Enable registration of depth to colour on the device, and synchronise the colour and depth streams if the
        device can do so.
        """
        mode = self._sdk.IMAGE_REGISTRATION_DEPTH_TO_COLOR
        if device.is_image_registration_mode_supported(mode):
            device.set_image_registration_mode(mode)
        else:
            warn(f"{self.name} does not register depth to colour: register it with sp.register_depth")
        with suppress(self._error):
            device.set_depth_color_sync_enabled(True)

    def _pairs(self, streams: dict[str, Any]) -> Iterator[tuple[Image, Image]]:
        matcher = StampMatcher(round(self.options.tolerance_ms * 1e6))
        for image in self._images(streams):
            pair = matcher.add(image.kind, image.stamp_ns, image)
            self._unmatched = matcher.unmatched
            if pair is not None:
                yield pair

    def _images(self, streams: dict[str, Any]) -> Iterator[Image]:
        kind_of = {id(stream): kind for kind, stream in streams.items()}
        waited_s = 0.0
        while not self._stopping.is_set():
            ready = self._sdk.wait_for_any_stream(list(streams.values()), WAIT_S)
            waited_s = waited_s + WAIT_S if ready is None else 0.0
            if ready is not None:
                kind = kind_of[id(ready)]
                try:
                    with ready.read_frame() as image:
                        copied = _copied(image, kind)
                except SpigoloError as error:
                    self._skip(kind, error)
                else:
                    yield copied
            elif waited_s >= PATIENCE_S:
                raise FileError(f"{self.name}: no image for {PATIENCE_S:.0f} s: check the cable, or plug it in again")

    def _camera(self, stream: Any) -> Camera | None:
        """Return the given intrinsics, or nominal intrinsics from the field of view of the colour stream."""
        own = self.options
        if own.camera is not None:
            return known_camera(own.camera, own.width, own.height)[0]
        try:
            fields_rad = stream.get_horizontal_fov(), stream.get_vertical_fov()
        except self._error:
            self.intrinsics = ""
            warn(f"{self.name} reports no field of view: give the camera, such as camera='xtion', for results in 3-D")
            return None
        return nominal_camera(own.width, own.height, *fields_rad)

    def _frame(self, color: Image, depth: Image, camera: Camera | None, name: str) -> Frame:
        given = self.options.depth_scale
        scale = MILLIMETRES if given is None else given
        limit = self.options.max_pixels
        return Frame(color.pixels, depth.pixels, camera, name, color.stamp_ns, scale, max_pixels=limit)

    @property
    def _error(self) -> type[Exception]:
        """Return the exception class of the OpenNI binding."""
        kind: type[Exception] = self._sdk.OpenNIError
        return kind


def nominal_camera(width: int, height: int, horizontal_rad: float, vertical_rad: float) -> Camera:
    """Return the pinhole camera with a given image size and field of view, and its principal point in the image
    centre.
    """
    angles_deg = math.degrees(horizontal_rad), math.degrees(vertical_rad)
    return Camera.from_fov(width, height, horizontal_deg=angles_deg[0], vertical_deg=angles_deg[1])


def _numbers(mode: Any) -> tuple[int, int, int, int]:
    """Return the width, height, frame rate and pixel format of a video mode."""
    return mode.resolutionX, mode.resolutionY, mode.fps, int(mode.pixelFormat)


def _copied(image: Any, kind: str) -> Image:
    """Return a copy of a device image without row padding. Raises SpigoloError if the image is truncated."""
    size, step = (3 if kind == "color" else 2), int(image.stride)
    stored = np.frombuffer(image.get_buffer_as_uint8(), np.uint8)
    if step < image.width * size or stored.size < step * image.height:
        raise SpigoloError(f"expected {image.height} rows of {step} bytes of {kind}, got {stored.size} bytes")
    rows = stored[: step * image.height].reshape(image.height, step)[:, : image.width * size].copy()
    pixels = rows.reshape(image.height, image.width, 3) if kind == "color" else rows.view(np.uint16)
    return Image(kind, int(image.timestamp) * 1000, pixels)


def _initialised() -> Any:
    """Load the OpenNI2 library and return its Python binding. Raises FileError."""
    try:
        sdk: Any = importlib.import_module("openni.openni2")
        raw: Any = importlib.import_module("openni._openni2")
    except ImportError:
        raise FileError(f"OpenNI cameras need the package openni, which is missing: {PIP}") from None
    try:
        name = ctypes.util.find_library("OpenNI2")
        if name is not None and sdk.loaded_dll_directory is None and not _has_own_folder():
            raw.load_dll(name)  # the binding looks for libOpenNI2.so, and Debian installs libOpenNI2.so.0
            sdk.loaded_dll_directory = name
        sdk.initialize()
    except Exception as error:  # each module of the binding has its own exception class
        raise FileError(f"OpenNI2 cannot be loaded ({_told(error)}): {LIBRARY}") from None
    return sdk


def _has_own_folder() -> bool:
    return any(name in os.environ for name in ("OPENNI2_REDIST64", "OPENNI2_REDIST"))


def _told(error: BaseException) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
