"""Segment what an Orbbec camera sees: depth aligned to colour by the SDK (pip install --no-deps pyorbbecsdk2)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pyorbbecsdk import AlignFilter, Config, FrameSet, OBFormat, OBSensorType, OBStreamType, Pipeline

import spigolo as sp


def frame_of(aligned: FrameSet, K: tuple[float, float, float, float]) -> sp.Frame | None:
    """Return the frame of aligned images. None if one is missing. The SDK's unit is millimetres."""
    c, d = aligned.get_color_frame(), aligned.get_depth_frame()
    if c is None or d is None:
        return None
    color = np.frombuffer(c.get_data(), np.uint8).reshape(c.get_height(), c.get_width(), 3)
    depth = np.frombuffer(d.get_data(), np.uint16).reshape(d.get_height(), d.get_width())
    return sp.Frame(color, depth, K, depth_scale=d.get_depth_scale() / 1000)


def frames() -> Iterator[sp.Frame]:
    """Yield frame after frame, without an end."""
    pipeline, config = Pipeline(), Config()
    colors = pipeline.get_stream_profile_list(OBSensorType.COLOR_SENSOR)
    config.enable_stream(colors.get_video_stream_profile(640, 480, OBFormat.RGB, 30))
    depths = pipeline.get_stream_profile_list(OBSensorType.DEPTH_SENSOR)
    config.enable_stream(depths.get_default_video_stream_profile())
    pipeline.start(config)
    try:
        k, align = pipeline.get_camera_param().rgb_intrinsic, AlignFilter(align_to_stream=OBStreamType.COLOR_STREAM)
        while True:
            received = pipeline.wait_for_frames(1000)
            aligned = align.process(received) if received else None
            frame = frame_of(aligned.as_frame_set(), (k.fx, k.fy, k.cx, k.cy)) if aligned else None
            if frame is not None:
                yield frame
    finally:
        pipeline.stop()


if __name__ == "__main__":
    segmenter = sp.Segmenter(ids=True)
    for frame in frames():
        for o in segmenter(frame):
            print(o.id, o.centroid_m)
