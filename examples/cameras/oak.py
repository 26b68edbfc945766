"""Segment what an OAK sees: depth aligned to colour on the device (pip install depthai)."""

from __future__ import annotations

from collections.abc import Iterator

import depthai as dai

import spigolo as sp

SIZE = (640, 480)


def frame_of(group: dai.MessageGroup, K: list[list[float]]) -> sp.Frame:
    """Return the frame of a colour and a depth image of one time: BGR to RGB, depth in millimetres."""
    color, depth = group["rgb"].getCvFrame()[..., ::-1], group["depth"].getFrame()
    return sp.Frame(color, depth, K, depth_scale=0.001)


def frames() -> Iterator[sp.Frame]:
    """Yield the newest frame, without an end."""
    socket = dai.CameraBoardSocket
    with dai.Pipeline() as pipeline:
        cameras = [pipeline.create(dai.node.Camera).build(s) for s in (socket.CAM_A, socket.CAM_B, socket.CAM_C)]
        stereo, sync = pipeline.create(dai.node.StereoDepth), pipeline.create(dai.node.Sync)
        align = pipeline.create(dai.node.ImageAlign)
        colors = cameras[0].requestOutput(SIZE, enableUndistortion=True)  # the intrinsics have no distortion then
        cameras[1].requestOutput((640, 400)).link(stereo.left)
        cameras[2].requestOutput((640, 400)).link(stereo.right)
        stereo.depth.link(align.input)
        colors.link(align.inputAlignTo)
        colors.link(sync.inputs["rgb"])
        align.outputAligned.link(sync.inputs["depth"])
        queue = sync.out.createOutputQueue(maxSize=1, blocking=False)
        K = pipeline.getDefaultDevice().readCalibration().getCameraIntrinsics(socket.CAM_A, *SIZE)
        pipeline.start()
        while pipeline.isRunning():
            yield frame_of(queue.get(), K)


if __name__ == "__main__":
    segmenter = sp.Segmenter(ids=True)
    for frame in frames():
        for o in segmenter(frame):
            print(o.id, o.centroid_m)
