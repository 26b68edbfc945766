"""Recordings for the Rerun viewer, with colour, depth, masks, point clouds and boxes of each frame."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError
from spigolo.objects.drawing import palette
from spigolo.objects.segmentation import ObjectMask, Segmentation

PIP = 'pip install "spigolo[view]"'
CLASSES = 256
"""Number of classes in the recording: one class for the background, and 255 classes for objects, each with its own
colour.
"""
CAMERA = "world/camera"
Quaternion = npt.NDArray[np.float64]


class Recording:
    """Context manager that records segmentation results in a .rrd file. If `path` is None, the results are sent to a
    new viewer instead.
    """

    def __init__(self, name: str, path: Path | None) -> None:
        try:
            self._rr = importlib.import_module("rerun")
        except ImportError:
            raise FileError(f"the view needs rerun-sdk, which is missing: {PIP}") from None
        self._stream = self._rr.RecordingStream("spigolo", recording_id=None)
        self._frames, self._path = 0, path
        if path is None:
            self._stream.spawn()
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._stream.save(str(aside_of(path)))
        self._log("name", self._rr.TextDocument(name), static=True)
        self._log("world", self._rr.ViewCoordinates.RDF, static=True)
        colors = enumerate(palette(CLASSES - 1).tolist(), start=1)
        named = [self._rr.AnnotationInfo(id=k, label=f"object {k}", color=color) for k, color in colors]
        nothing = self._rr.AnnotationInfo(id=0, color=(0, 0, 0, 0))
        self._log("/", self._rr.AnnotationContext([nothing, *named]), static=True)

    def add(self, result: Segmentation) -> None:
        """Add a frame and its objects to the recording. The name of an object contains its id or, if objects have no
        ids, its label.
        """
        rr, frame = self._rr, result.frame
        self._stream.set_time("frame", sequence=self._frames)
        if frame.stamp_ns is not None:
            self._stream.set_time("stamp", timestamp=np.datetime64(frame.stamp_ns, "ns"))
        self._frames += 1
        k = frame.camera
        if k is not None:
            size, principal = [k.width, k.height], [k.cx, k.cy]
            self._log(CAMERA, rr.Pinhole(focal_length=[k.fx, k.fy], principal_point=principal, resolution=size))
        self._log(f"{CAMERA}/colour", rr.Image(frame.color).compress(jpeg_quality=90))
        self._log(f"{CAMERA}/depth", rr.DepthImage(frame.depth, meter=1.0))
        self._log(f"{CAMERA}/objects", rr.SegmentationImage(_classes(result)))
        self._log("world/objects", rr.Clear(recursive=True))
        for o in result if k is not None else ():
            self._add_object(o, result)

    def _add_object(self, o: ObjectMask, result: Segmentation) -> None:
        rr, number = self._rr, o.number
        colors = result.frame.color[o.mask & (result.frame.depth > 0)]
        self._log(f"world/objects/{number}/cloud", rr.Points3D(o.points_m(), colors=colors))
        box = o.oriented_box()
        if box is not None:
            half, turn = np.array(box.size_m) / 2, quaternion(np.array(box.R_camera_box, float))
            shape = rr.Boxes3D(
                centers=[box.center_m], half_sizes=[half], quaternions=[turn], class_ids=[_class_of(number)]
            )
            self._log(f"world/objects/{number}/box", shape)

    def _log(self, path: str, value: Any, static: bool = False) -> None:
        self._stream.log(path, value, static=static)

    def close(self) -> None:
        """Write the remaining data and close the recording. Without any frame, an existing file stays as it is."""
        self._stream.flush()
        self._stream.disconnect()
        if self._path is not None:
            aside = aside_of(self._path)
            aside.replace(self._path) if self._frames else aside.unlink(missing_ok=True)

    def __enter__(self) -> Recording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def aside_of(path: Path) -> Path:
    """Return the path to which a recording is written until it is complete."""
    return path.with_name(f".{path.stem}-aside{path.suffix}")


def quaternion(R: npt.NDArray[np.float64]) -> Quaternion:
    """Convert a rotation matrix (3, 3) to a unit quaternion (x, y, z, w)."""
    x, y, z = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    squares = np.maximum([1 + R[k, k] * 2 - np.trace(R) for k in range(3)] + [1 + np.trace(R)], 0) / 4
    q: Quaternion = np.sqrt(squares)
    largest = int(q.argmax())
    if largest == 3:
        q[:3] = np.array([x, y, z]) / (4 * q[3])
        return q
    signs = {k: R[largest, k] + R[k, largest] for k in range(3) if k != largest}
    for k, value in signs.items():
        q[k] = value / (4 * q[largest])
    q[3] = (x, y, z)[largest] / (4 * q[largest])
    return q


def _class_of(number: int) -> int:
    """Return the class, from 1 to 255, for the number of an object. Class 0 is the background."""
    return (number - 1) % (CLASSES - 1) + 1


def _classes(result: Segmentation) -> npt.NDArray[np.uint8]:
    """Return an image (H, W) of classes: the class of the object at each pixel, or 0 for background."""
    numbers = np.zeros(len(result) + 1, np.uint8)
    for o in result:
        numbers[o.label] = _class_of(o.number)
    return numbers[result.labels]
