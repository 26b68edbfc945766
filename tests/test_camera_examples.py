"""The examples of cameras whose packages are no dependencies: their names, and what runs without a camera."""

from __future__ import annotations

import ast
import builtins
import importlib
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "cameras"
NAMES = {
    "depthai": (
        *("Pipeline.create", "Pipeline.start", "Pipeline.isRunning", "Pipeline.getDefaultDevice", "node.Camera.build"),
        *("node.Camera.requestOutput", "node.StereoDepth.left", "node.StereoDepth.right", "node.StereoDepth.depth"),
        *("node.ImageAlign.input", "node.ImageAlign.inputAlignTo", "node.ImageAlign.outputAligned"),
        *("node.Sync.inputs", "node.Sync.out", "Node.Output.createOutputQueue", "Node.Output.link"),
        *("CameraBoardSocket.CAM_A", "CameraBoardSocket.CAM_B", "CameraBoardSocket.CAM_C", "MessageQueue.get"),
        *("Device.readCalibration", "CalibrationHandler.getCameraIntrinsics"),
        *("ImgFrame.getCvFrame", "ImgFrame.getFrame", "MessageGroup.__getitem__"),
    ),
    "pyorbbecsdk": (
        *("Pipeline.get_stream_profile_list", "Pipeline.get_camera_param", "Pipeline.wait_for_frames"),
        *("Pipeline.start", "Pipeline.stop", "Config.enable_stream", "AlignFilter.process", "Frame.as_frame_set"),
        *("StreamProfileList.get_video_stream_profile", "StreamProfileList.get_default_video_stream_profile"),
        *("FrameSet.get_color_frame", "FrameSet.get_depth_frame", "ColorFrame.get_data", "ColorFrame.get_width"),
        *("ColorFrame.get_height", "DepthFrame.get_data", "DepthFrame.get_width", "DepthFrame.get_height"),
        *("DepthFrame.get_depth_scale", "OBFormat.RGB", "OBSensorType.COLOR_SENSOR", "OBSensorType.DEPTH_SENSOR"),
        *("OBStreamType.COLOR_STREAM", "OBCameraParam.rgb_intrinsic", "OBCameraIntrinsic.fx", "OBCameraIntrinsic.cy"),
    ),
}
"""Names of each package that its example uses."""


def example(name: str) -> ModuleType:
    path = FOLDER / name
    module = ModuleType(path.stem)
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), module.__dict__)
    return module


@pytest.mark.parametrize("name", ["oak.py", "orbbec.py"])
def test_the_page_shows_the_example_and_every_attribute_is_checked(name: str) -> None:
    text = (FOLDER / name).read_text(encoding="utf-8")
    page = (ROOT / "docs" / "sources.md").read_text(encoding="utf-8")
    assert f"```py\n{text}```" in page and f"examples/cameras/{name}" in page
    used = {node.attr for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Attribute)}
    listed = {part for names in NAMES.values() for one in names for part in one.split(".")}
    here = {"Frame", "Segmenter", "id", "centroid_m", "node", "inputs", "frombuffer", "uint8", "uint16", "reshape"}
    same = {"fy", "cx"}  # next to fx and cy
    assert used - listed - here - same - set(dir(builtins)) == set()


@pytest.mark.parametrize("package", NAMES)
def test_the_names_are_those_of_the_installed_package(package: str) -> None:
    module = pytest.importorskip(package)
    for name in NAMES[package]:
        found = module
        for part in name.split("."):
            assert hasattr(found, part), name
            found = getattr(found, part)


def test_a_synchronised_pair_of_depthai_makes_a_frame() -> None:
    dai = pytest.importorskip("depthai")
    with dai.Pipeline(False) as pipeline:  # without a device: only the nodes of the host
        sync = pipeline.create(dai.node.Sync)
        sync.setRunOnHost(True)
        inputs = [sync.inputs[name].createInputQueue() for name in ("rgb", "depth")]
        queue = sync.out.createOutputQueue(maxSize=1, blocking=False)
        pipeline.start()
        color, depth = dai.ImgFrame(), dai.ImgFrame()
        color.setCvFrame(np.full((6, 8, 3), (1, 2, 3), np.uint8), dai.ImgFrame.Type.BGR888p)
        depth.setType(dai.ImgFrame.Type.RAW16)
        depth.setWidth(8)
        depth.setHeight(6)
        depth.setData(np.full((6, 8), 777, np.uint16).view(np.uint8).ravel())
        for one, into in zip((color, depth), inputs, strict=True):
            one.setTimestamp(dai.Clock.now())
            into.send(one)
        frame = example("oak.py").frame_of(queue.get(), [[10, 0, 4], [0, 10, 3], [0, 0, 1]])
    assert frame.color[0, 0].tolist() == [3, 2, 1]
    assert frame.depth[0, 0] == pytest.approx(0.777) and frame.camera.fx == 10


def test_aligned_images_of_orbbec_make_a_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("AlignFilter", "Config", "FrameSet", "OBFormat", "OBSensorType", "OBStreamType", "Pipeline")
    monkeypatch.setitem(sys.modules, "pyorbbecsdk", SimpleNamespace(**dict.fromkeys(names)))
    assert importlib.import_module("pyorbbecsdk").Pipeline is None
    size = {"get_height": lambda: 6, "get_width": lambda: 8}
    color = SimpleNamespace(get_data=lambda: np.full(144, 5, np.uint8), **size)
    stored = np.full(48, 777, np.uint16).view(np.uint8)
    depth = SimpleNamespace(get_data=lambda: stored, get_depth_scale=lambda: 0.5, **size)
    both = SimpleNamespace(get_color_frame=lambda: color, get_depth_frame=lambda: depth)
    frame_of = example("orbbec.py").frame_of
    frame = frame_of(both, (10, 10, 4, 3))
    assert frame.depth[0, 0] == pytest.approx(0.3885) and frame.color.shape == (6, 8, 3)
    assert frame_of(SimpleNamespace(get_color_frame=lambda: color, get_depth_frame=lambda: None), (1, 1, 0, 0)) is None
