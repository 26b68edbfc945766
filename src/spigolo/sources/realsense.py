"""RealSense cameras and their recordings, through pyrealsense2. Depth is aligned to colour by the SDK."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from spigolo.errors import FileError, SpigoloError
from spigolo.frames.camera import Camera
from spigolo.frames.files import known_camera
from spigolo.frames.frame import Frame
from spigolo.sources.base import Source
from spigolo.sources.live import LiveSource
from spigolo.sources.options import Options

PIP = 'pip install "spigolo[realsense]"'
WAIT_MS = 500
"""Time after which a stop of the source is looked at while no frame arrives, ms."""
PATIENCE_S = 10.0
"""Time without frames after which a camera counts as lost, s."""
FILTERS = ("decimation", "threshold", "spatial", "temporal", "holes")


class RealSenseCamera(LiveSource):
    """A connected camera, by its serial number or the first one. The newest frame is handed out."""

    def __init__(self, serial: str, options: Options) -> None:
        super().__init__(f"realsense:{serial}", options)
        self._rs, self._serial = _sdk(), serial
        self._filters = _filters(self._rs, options.filters)
        if options.device is None:
            self._check_connected()
        if options.camera is None:
            self.intrinsics = "the device"

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
            yield from _Converter(rs, self._filters, own, self._skip).frames(self._framesets(pipeline))
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


class RealSenseRecording(Source):
    """A recording of the SDK, .db3 or .bag. No frame is dropped."""

    def __init__(self, path: Path, options: Options) -> None:
        super().__init__(str(path), options)
        if not path.is_file():
            raise FileError(f"expected a recording, but there is no {path}")
        self._rs, self._path = _sdk(), path
        self._filters = _filters(self._rs, options.filters)
        if options.camera is None:
            self.intrinsics = "the recording"

    def _frames(self) -> Iterator[Frame]:
        rs = self._rs
        pipeline, config = rs.pipeline(rs.context()), rs.config()
        config.enable_device_from_file(str(self._path), False)
        playback = _start(pipeline, config, self.name).get_device().as_playback()
        playback.set_real_time(False)
        try:
            yield from _Converter(rs, self._filters, self.options, self._skip).frames(_played(pipeline, playback, rs))
        finally:
            pipeline.stop()


class _Converter:
    """From framesets of the SDK to frames."""

    def __init__(
        self, rs: Any, filters: list[Any], options: Options, skip: Callable[[str, SpigoloError], None]
    ) -> None:
        self._rs, self._filters, self._options, self._skip = rs, filters, options, skip
        self._align = rs.align(rs.stream.color)

    def frames(self, framesets: Iterator[Any]) -> Iterator[Frame]:
        for number, frames in enumerate(framesets):
            try:
                frame = self._frame(frames, f"{number:06d}")
            except SpigoloError as error:
                self._skip(f"{number:06d}", error)
                continue
            yield frame

    def _frame(self, frames: Any, name: str) -> Frame:
        for one in self._filters:
            frames = one.process(frames).as_frameset()
        aligned = self._align.process(frames)
        color, depth = aligned.get_color_frame(), aligned.get_depth_frame()
        if not color or not depth:
            raise SpigoloError("the frameset lacks colour or depth")
        pixels = _rgb(self._rs, color)
        camera = self._camera(color, pixels.shape[1], pixels.shape[0])
        scale = self._options.depth_scale or depth.get_units()
        stamp = round(color.get_timestamp() * 1e6)
        limit = self._options.max_pixels
        return Frame(pixels, np.asanyarray(depth.get_data()), camera, name, stamp, scale, max_pixels=limit)

    def _camera(self, color: Any, width: int, height: int) -> Camera | None:
        given = self._options.camera
        own = color.get_profile().as_video_stream_profile().get_intrinsics()
        return known_camera(own if given is None else given, width, height)[0]


def _rgb(rs: Any, color: Any) -> Any:
    """Return the pixels of a colour frame as RGB. Raises SpigoloError for another format."""
    kind, pixels = color.get_profile().format(), np.asanyarray(color.get_data())
    if kind == rs.format.rgb8:
        return pixels
    if kind == rs.format.bgr8:
        return pixels[..., ::-1]
    if kind in (rs.format.rgba8, rs.format.bgra8):
        return pixels[..., :3] if kind == rs.format.rgba8 else pixels[..., 2::-1]
    raise SpigoloError(f"expected colour as rgb8 or bgr8, got {kind}: record the colour stream as rgb8")


def _played(pipeline: Any, playback: Any, rs: Any) -> Iterator[Any]:
    """Yield the framesets of a recording until it ends."""
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
            f"{name} does not start ({error}): choose a size and rate that it has with ?width=W&height=H&fps=N"
        ) from None


def _filters(rs: Any, names: tuple[str, ...]) -> list[Any]:
    """Return the SDK's filters. Raises FileError for an unknown name."""
    unknown = next((name for name in names if name not in FILTERS), None)
    if unknown is not None:
        raise FileError(f"there is no filter {unknown}: expected some of {', '.join(FILTERS)}")
    makers = (
        rs.decimation_filter, rs.threshold_filter, rs.spatial_filter, rs.temporal_filter, rs.hole_filling_filter,
    )  # fmt: skip
    return [dict(zip(FILTERS, makers, strict=True))[name]() for name in names]


def _sdk() -> Any:
    try:
        return importlib.import_module("pyrealsense2")
    except ImportError:
        raise FileError(f"RealSense needs pyrealsense2, which is missing: {PIP}") from None
