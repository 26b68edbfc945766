"""A camera without a camera: the software device of the RealSense SDK, fed on a thread of its own.

`python tests/realsense_device.py` counts how many of 60 frames at 30 Hz are segmented, and how old the results are.
"""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyrealsense2 as rs

import spigolo as sp

FPS = 30


class Device:
    """A depth and a colour stream of one size, fed with a frame that moves."""

    def __init__(self, frame: sp.Frame, unit_m: float = 0.001) -> None:
        self.frame = frame
        self.color = np.ascontiguousarray(frame.color)
        self.depth = np.round(frame.depth / unit_m).astype(np.uint16)
        self.device = rs.software_device()
        self.device.register_info(rs.camera_info.name, "Software D435")
        self.device.register_info(rs.camera_info.serial_number, "000111222")
        self.sensors = [self.device.add_sensor("Stereo"), self.device.add_sensor("RGB")]
        self.sensors[0].add_read_only_option(rs.option.depth_units, unit_m)
        streams = ((rs.stream.depth, rs.format.z16, 2), (rs.stream.color, rs.format.rgb8, 3))
        pairs = enumerate(zip(self.sensors, streams, strict=True))
        self.profiles = [sensor.add_video_stream(self._stream(k, *stream)).as_video_stream_profile()
                         for k, (sensor, stream) in pairs]  # fmt: skip
        still = rs.extrinsics()
        still.rotation, still.translation = np.eye(3).ravel().tolist(), [0.0, 0.0, 0.0]
        self.profiles[0].register_extrinsics_to(self.profiles[1], still)
        self.device.create_matcher(rs.matchers.dlr_c)
        self.sent_s: list[float] = []

    def _stream(self, number: int, kind: Any, form: Any, size: int) -> Any:
        height, width = self.frame.shape
        stream, k = rs.video_stream(), self.frame.camera
        assert k is not None
        own = rs.intrinsics()
        own.width, own.height, own.fx, own.fy, own.ppx, own.ppy = width, height, k.fx, k.fy, k.cx, k.cy
        own.model, own.coeffs = rs.distortion.brown_conrady, [0.0] * 5
        stream.type, stream.index, stream.uid, stream.fmt, stream.bpp = kind, 0, number, form, size
        stream.width, stream.height, stream.fps, stream.intrinsics = width, height, FPS, own
        return stream

    def send(self, number: int) -> None:
        """Send frame `number` of both streams."""
        images = np.roll(self.depth, number, axis=1), np.roll(self.color, number, axis=1)
        for sensor, profile, image, size in zip(self.sensors, self.profiles, images, (2, 3), strict=True):
            frame = rs.software_video_frame()
            frame.pixels = np.ascontiguousarray(image)
            frame.stride, frame.bpp = image.shape[1] * size, size
            frame.timestamp, frame.frame_number = 1000.0 + number * 1000 / FPS, number + 1
            frame.domain, frame.profile = rs.timestamp_domain.hardware_clock, profile
            if size == 2:
                frame.depth_units = 0.001
            sensor.on_video_frame(frame)
        self.sent_s.append(time.perf_counter())

    def feed(self, count: int, wait_s: float = 0.5) -> threading.Thread:
        """Send frames at 30 Hz on a thread, once the pipeline had time to start."""

        def run() -> None:
            time.sleep(wait_s)
            start = time.perf_counter()
            for number in range(count):
                time.sleep(max(0.0, start + number / FPS - time.perf_counter()))
                self.send(number)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        return thread


def record(frame: sp.Frame, path: Path, count: int) -> None:
    """Record frames of a software device with the SDK's recorder."""
    device = Device(frame)
    recorder = rs.recorder(str(path), device.device)
    queue = rs.frame_queue(100)
    for sensor, profile in zip(recorder.query_sensors(), device.profiles, strict=True):
        sensor.open(profile)
        sensor.start(queue)
    for number in range(count):
        device.send(number)
        time.sleep(0.02)
    for sensor in recorder.query_sensors():
        sensor.stop()
        sensor.close()
    recorder.pause()


def measure(config: sp.Config, threads: int, queue: int, count: int = 60) -> str:
    """One row of the table: preset, threads and queue, segmented frames, median and 99 % of the age of results."""
    scene = Path(sp.__file__).parent / "demo_scene"
    frame = sp.read_frame(scene / "rgb.png", scene / "depth.png", scene / "camera.json")
    device, segmenter = Device(frame), sp.Segmenter(config)
    segmenter(frame)
    ages = []
    with sp.open_source("realsense:", device=device.device, queue=queue) as source:
        device.feed(count)
        try:
            for result in segmenter.map(source, threads=threads):
                number = round((result.frame.stamp_ns / 1e9 - 1) * FPS)
                ages.append(1000 * (time.perf_counter() - device.sent_s[number]))
        except sp.SpigoloError as error:
            if "no frame for" not in str(error):
                raise
    size = "half" if config.additions and config.additions.resolution == "half" else "full"
    half = len(ages) // 2
    return (
        f"| `{config.name}`, {size} | {threads} | {queue} | {len(ages)} of {count} | {np.median(ages):.0f} ms"
        f" | {np.percentile(ages, 99):.0f} ms | {np.median(ages[:half]):.0f}, {np.median(ages[half:]):.0f} ms |"
    )


def main() -> None:
    from spigolo.sources import realsense

    realsense.PATIENCE_S = 2.0
    print("| preset, resolution | threads | queue | frames segmented | median age | 99 % | first half, second half |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for config in (sp.OBJECTS.replace(additions={"resolution": "half"}), sp.TABLE, sp.OBJECTS):
        for threads, queue in ((1, 1), (2, 1), (2, 5)):
            print(measure(config, threads, queue), flush=True)


if __name__ == "__main__":
    main()
