"""Conversion of segmentation results to ROS messages, and publishers for these messages.

Every message has the header of the segmented colour image.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from spigolo.objects.boxes import OrientedBox
from spigolo.objects.drawing import tint_of
from spigolo.objects.segmentation import ObjectMask, Segmentation
from spigolo.ros.kinds import Kinds
from spigolo.ros.messages import POINT, fill_cloud, fill_image, fill_pose, point_records

TEXT_HEIGHT_M = 0.03
OPACITY = 0.4
MAX_NUMBER = 65535
"""Maximum object number in a 16-bit image."""


def number_of(o: ObjectMask) -> int:
    """Return the number that identifies an object in all ROS messages. The number is the id of the object. If ids are
    switched off, the number is the label. After 65535, the numbers restart at 1.
    """
    return (o.number - 1) % MAX_NUMBER + 1


def label_image(kinds: Kinds, header: Any, result: Segmentation) -> Any:
    """Return a mono16 Image with the object number at each pixel, 0 for background."""
    numbers = np.zeros(len(result) + 1, np.uint16)
    for o in result:
        numbers[o.label] = number_of(o)
    return fill_image(kinds.sensor.Image(), header, numbers[result.labels], "mono16")


def overlay_image(kinds: Kinds, header: Any, result: Segmentation) -> Any:
    """Return an rgb8 Image: the colour image, in which each object is tinted and numbered."""
    return fill_image(kinds.sensor.Image(), header, result.overlay(), "rgb8")


def mask_image(kinds: Kinds, header: Any, found: ObjectMask) -> Any:
    """Return a mono8 Image of the mask of an object, 255 for the object and 0 elsewhere."""
    return fill_image(kinds.sensor.Image(), header, found.mask.astype(np.uint8) * np.uint8(255), "mono8")


def object_clouds(kinds: Kinds, header: Any, result: Segmentation) -> Iterator[Any]:
    """Yield a PointCloud2 for each object in the order of labels. Without intrinsics, no message is yielded."""
    for records in _records(result):
        yield fill_cloud(kinds.sensor.PointCloud2(), kinds.sensor.PointField, header, records)


def cloud(kinds: Kinds, header: Any, result: Segmentation) -> Any:
    """Return one PointCloud2 with the points of all objects. The field `label` of a point is the object number."""
    everything = np.concatenate([np.empty(0, POINT), *_records(result)])
    return fill_cloud(kinds.sensor.PointCloud2(), kinds.sensor.PointField, header, everything)


def _records(result: Segmentation) -> Iterator[Any]:
    if result.frame.camera is None:
        return
    for o in result:
        yield point_records(o.points_m(), result.frame.color[o.mask & (result.frame.depth > 0)], number_of(o))


def markers(kinds: Kinds, header: Any, result: Segmentation) -> Any:
    """Return a MarkerArray with a box and a number for each object. The first marker deletes all earlier markers."""
    assert kinds.visualization is not None
    kind = kinds.visualization.Marker
    clear = kind()
    clear.header, clear.action = header, kind.DELETEALL
    drawn = [clear]
    for o, box in _boxes(result):
        solid, text = kind(), kind()
        for marker, space in ((solid, "boxes"), (text, "labels")):
            marker.header, marker.ns, marker.id, marker.action = header, space, number_of(o), kind.ADD
            fill_pose(marker.pose, box.center_m, box.R_camera_box)
            color = marker.color
            color.r, color.g, color.b = map(float, tint_of(o.number) / 255)
        solid.type, solid.color.a = kind.CUBE, OPACITY
        solid.scale.x, solid.scale.y, solid.scale.z = map(float, box.size_m)
        text.type, text.color.a, text.text = kind.TEXT_VIEW_FACING, 1.0, str(number_of(o))
        text.scale.z = TEXT_HEIGHT_M
        drawn += [solid, text]
    message = kinds.visualization.MarkerArray()
    message.markers = drawn
    return message


def detections(kinds: Kinds, header: Any, result: Segmentation) -> Any:
    """Return a Detection3DArray with the box, the score and the number of each object. The class of all objects is
    "object".
    """
    assert kinds.vision is not None
    found = []
    for o, box in _boxes(result):
        detection, hypothesis = kinds.vision.Detection3D(), kinds.vision.ObjectHypothesisWithPose()
        detection.header, detection.id = header, str(number_of(o))
        fill_pose(detection.bbox.center, box.center_m, box.R_camera_box)
        size = detection.bbox.size
        size.x, size.y, size.z = map(float, box.size_m)
        hypothesis.hypothesis.class_id, hypothesis.hypothesis.score = "object", float(o.score)
        hypothesis.pose.pose = copy.deepcopy(detection.bbox.center)
        detection.results = [hypothesis]
        found.append(detection)
    message = kinds.vision.Detection3DArray()
    message.header, message.detections = header, found
    return message


def _boxes(result: Segmentation) -> Iterator[tuple[ObjectMask, OrientedBox]]:
    """Yield each object with its oriented box. Objects without an oriented box are skipped."""
    for o in result:
        box = o.oriented_box()
        if box is not None:
            yield o, box


class Answers:
    """Publishers of segmentation results. The label image is always published. The overlay, point clouds, markers and
    detections are created only if their topic has subscribers.
    """

    def __init__(self, node: Any, kinds: Kinds, qos: Any) -> None:
        self._kinds = kinds
        image, points = kinds.sensor.Image, kinds.sensor.PointCloud2
        topics: dict[str, tuple[Any, Callable[..., Any]]] = {
            "overlay": (image, overlay_image),
            "cloud": (points, cloud),
        }
        if kinds.visualization is not None:
            topics["markers"] = kinds.visualization.MarkerArray, markers
        if kinds.vision is not None:
            topics["detections"] = kinds.vision.Detection3DArray, detections
        self._labels = node.create_publisher(image, "~/labels", qos)
        self._mask = node.create_publisher(image, "~/mask", qos)
        self._objects = node.create_publisher(points, "~/objects", qos)
        self._others = [(node.create_publisher(kind, f"~/{name}", qos), make) for name, (kind, make) in topics.items()]

    def publish(self, header: Any, result: Segmentation) -> None:
        """Publish a segmentation result, with the label image first. header: header of the segmented colour image."""
        self._labels.publish(label_image(self._kinds, header, result))
        for publisher, make in self._others:
            if publisher.get_subscription_count():
                publisher.publish(make(self._kinds, header, result))
        if self._objects.get_subscription_count():
            for message in object_clouds(self._kinds, header, result):
                self._objects.publish(message)

    def publish_mask(self, header: Any, found: ObjectMask) -> None:
        """Publish the mask of the object that the user clicked. header: header of the segmented colour image."""
        self._mask.publish(mask_image(self._kinds, header, found))
