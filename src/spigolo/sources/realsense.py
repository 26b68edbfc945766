"""Source for RealSense cameras and their recordings through pyrealsense2. The SDK aligns depth to colour."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spigolo.errors import FileError, SpigoloError
from spigolo.frames.camera import Camera
from spigolo.frames.files import known_camera
from spigolo.frames.frame import Frame
from spigolo.sources.base import Report, Source
from spigolo.sources.live import LiveSource
from spigolo.sources.options import Options

PIP = 'pip install "spigolo[realsense]"'
WAIT_MS = 500
"""Maximum time of one wait for a frame, in milliseconds. After each wait without a frame, the receiving thread checks
if the source was closed.
"""
PATIENCE_S = 10.0
"""Maximum time without frames, in seconds. After `PATIENCE_S` without a frame, iteration raises an error."""
FILTERS = ("decimation", "threshold", "spatial", "temporal", "holes")


class _RealSense(Source):
    """Base class of RealSense cameras and recordings, which converts framesets of the SDK to frames."""

    _lost = 0

    def _converted(self, framesets: Iterator[Any]) -> Iterator[Frame]:
        converter, number = _Converter(_sdk(), self.options), 0
        for frames in framesets:
            taken = converter.take(frames)
            self._unmatched, self._lost = converter.unmatched, converter.lost
            if not taken:
                continue
            name, number = f"{number:06d}", number + 1
            try:
                frame = converter.frame(frames, name)
            except SpigoloError as error:
                self._skip(name, error)
                continue
            yield frame

    def report(self) -> Report:
        """Return the numbers of frames and images since the start of the last iteration, and the maximum stamp
        difference of a pair.
        """
        return replace(super().report(), tolerance_ms=self.options.tolerance_ms)


class RealSenseCamera(_RealSense, LiveSource):
    """Source for a RealSense camera: the camera with the given serial number, or the first connected camera. By
    default, each step of an iteration yields the newest frame.
    """

    def __init__(self, serial: str, options: Options) -> None:
        super().__init__(f"realsense:{serial}", options)
        self._rs, self._serial = _sdk(), serial
        _filters(self._rs, options.filters)  # raises an error for an unknown filter before the camera starts
        if options.device is None:
            self._check_connected()
        if options.camera is None:
            self.intrinsics = "the device"

    def report(self) -> Report:
        """Return the numbers of frames and images since the start of the last iteration. Image pairs that the SDK
        replaced count as dropped frames.
        """
        counts = super().report()
        return replace(counts, dropped=counts.dropped + self._lost)

    def _check_connected(self) -> None:
        found = [d.get_info(self._rs.camera_info.serial_number) for d in self._rs.context().query_devices()]
        if not found:
            raise FileError("no RealSense camera is connected: plug one in, or open a recording (realsense:FILE.db3)")
        if self._serial and self._serial not in found:
            raise FileError(f"no RealSense camera has the serial number {self._serial}. Connected: {', '.join(found)}")

    def _receive(self) -> Iterator[Frame]:
        rs, own = self._rs, self.options
        pipeline, config = rs.pipeline(rs.context()), rs.config()
        if own.device is not None:
            pipeline.set_device(own.device)
        elif self._serial:
            config.enable_device(self._serial)
        config.enable_stream(rs.stream.depth, own.width, own.height, rs.format.z16, own.fps)
        config.enable_stream(rs.stream.color, own.width, own.height, rs.format.rgb8, own.fps)
        _start(pipeline, config, self.name)
        try:
            yield from self._converted(self._framesets(pipeline))
        finally:
            pipeline.stop()

    def _framesets(self, pipeline: Any) -> Iterator[Any]:
        waited_ms = 0
        while not self._stopping.is_set():
            arrived, frames = pipeline.try_wait_for_frames(WAIT_MS)
            waited_ms = 0 if arrived else waited_ms + WAIT_MS
            if arrived:
                yield frames
            elif waited_ms >= 1000 * PATIENCE_S:
                raise FileError(f"{self.name}: no frame for {PATIENCE_S:.0f} s: check the cable, or plug it in again")


class RealSenseRecording(_RealSense):
    """Source for a recording of the RealSense SDK, a .db3 or .bag file. No frame is dropped."""

    def __init__(self, path: Path, options: Options) -> None:
        super().__init__(str(path), options)
        if not path.is_file():
            raise FileError(f"expected a recording, but there is no {path}")
        self._rs, self._path = _sdk(), path
        _filters(self._rs, options.filters)  # raises an error for an unknown filter before the camera starts
        if options.camera is None:
            self.intrinsics = "the recording"

    def _frames(self) -> Iterator[Frame]:
        rs = self._rs
        pipeline, config = rs.pipeline(rs.context()), rs.config()
        config.enable_device_from_file(str(self._path), False)
        playback = _start(pipeline, config, self.name).get_device().as_playback()
        playback.set_real_time(False)
        try:
            yield from self._converted(_played(pipeline, playback, rs))
        finally:
            pipeline.stop()


class _Converter:
    """Converter from framesets of the SDK to frames.

    The SDK repeats an image if the other image of the pair is late. Each image is used in at most one pair. If both
    images have stamps of the same clock, the stamps differ by at most the option `tolerance_ms`.
    """

    def __init__(self, rs: Any, options: Options) -> None:
        self._rs, self._options = rs, options
        self._filters = _filters(rs, options.filters)
        self._align = rs.align(rs.stream.color)
        self._seen: dict[str, int] = {}
        self._taken: dict[str, int] = {}
        self._images = self._pairs = 0
        self.lost = 0
        """Number of image pairs that the SDK replaced by newer pairs, counted from gaps in the frame numbers of the
        colour images.
        """

    @property
    def unmatched(self) -> int:
        """Number of colour and depth images without a partner."""
        return max(self._images - 2 * self._pairs, 0)

    def take(self, frames: Any) -> bool:
        """Return True if a frameset is a new pair of images. The stamps of the images must differ by at most
        `tolerance_ms`, if both stamps come from the same clock.
        """
        images = {"color": frames.get_color_frame(), "depth": frames.get_depth_frame()}
        numbers = {kind: image.get_frame_number() for kind, image in images.items() if image}
        self._images += sum(self._seen.get(kind) != number for kind, number in numbers.items())
        self._seen |= numbers
        if len(numbers) < 2 or any(self._taken.get(kind) == number for kind, number in numbers.items()):
            return False
        color, depth = images["color"], images["depth"]
        one_clock = color.get_frame_timestamp_domain() == depth.get_frame_timestamp_domain()
        if one_clock and abs(color.get_timestamp() - depth.get_timestamp()) > self._options.tolerance_ms:
            return False
        self.lost += max(numbers["color"] - self._taken.get("color", numbers["color"]) - 1, 0)
        self._taken = numbers
        self._pairs += 1
        return True

    def frame(self, frames: Any, name: str) -> Frame:
        """Convert a frameset to a frame with depth aligned to colour. Raises SpigoloError."""
        for one in self._filters:
            frames = one.process(frames).as_frameset()
        aligned = self._align.process(frames)
        color, depth = aligned.get_color_frame(), aligned.get_depth_frame()
        pixels = _rgb(self._rs, color)
        camera = self._camera(color, pixels.shape[1], pixels.shape[0])
        given = self._options.depth_scale
        scale = depth.get_units() if given is None else given
        stamp = round(color.get_timestamp() * 1e6)
        limit = self._options.max_pixels
        return Frame(pixels, np.asanyarray(depth.get_data()), camera, name, stamp, scale, max_pixels=limit)

    def _camera(self, color: Any, width: int, height: int) -> Camera | None:
        given = self._options.camera
        own = color.get_profile().as_video_stream_profile().get_intrinsics()
        return known_camera(own if given is None else given, width, height)[0]


def _rgb(rs: Any, color: Any) -> Any:
    """Convert a colour frame of the SDK to RGB. Raises SpigoloError for an unsupported pixel format."""
    kind, pixels = color.get_profile().format(), np.asanyarray(color.get_data())
    if kind == rs.format.rgb8:
        return pixels
    if kind == rs.format.bgr8:
        return pixels[..., ::-1]
    if kind in (rs.format.rgba8, rs.format.bgra8):
        return pixels[..., :3] if kind == rs.format.rgba8 else pixels[..., 2::-1]
    raise SpigoloError(f"expected colour as rgb8 or bgr8, got {kind}: record the colour stream as rgb8")


def _played(pipeline: Any, playback: Any, rs: Any) -> Iterator[Any]:
    """Yield the framesets of a recording until its end."""
    while True:
        arrived, frames = pipeline.try_wait_for_frames(WAIT_MS)
        if arrived:
            yield frames
        elif playback.current_status() == rs.playback_status.stopped:
            return


def _start(pipeline: Any, config: Any, name: str) -> Any:
    try:
        return pipeline.start(config)
    except RuntimeError as error:
        raise FileError(
            f"{name} does not start ({error}): choose a size and rate of the camera with ?width=W&height=H&fps=N"
        ) from None


def _filters(rs: Any, names: tuple[str, ...]) -> list[Any]:
    """Return the filters of the SDK with the given names. Raises FileError for an unknown name."""
    unknown = next((name for name in names if name not in FILTERS), None)
    if unknown is not None:
        raise FileError(f"there is no filter {unknown}: expected one or more of {', '.join(FILTERS)}")
    makers = (
        rs.decimation_filter, rs.threshold_filter, rs.spatial_filter, rs.temporal_filter, rs.hole_filling_filter,
    )  # fmt: skip
    return [dict(zip(FILTERS, makers, strict=True))[name]() for name in names]


def _sdk() -> Any:
    try:
        return importlib.import_module("pyrealsense2")
    except ImportError:
        raise FileError(f"RealSense needs pyrealsense2, which is missing: {PIP}") from None
