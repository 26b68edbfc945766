"""ROS 2 node that subscribes to colour, aligned depth and CameraInfo, and publishes segmentation results."""

from __future__ import annotations

import copy
import threading
import time
import traceback
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spigolo.errors import SpigoloError
from spigolo.frames.frame import Frame
from spigolo.objects.segmentation import Segmentation
from spigolo.ros.answers import Answers
from spigolo.ros.kinds import Kinds, find_kinds
from spigolo.ros.pairing import Pair, Waiting
from spigolo.ros.parameters import NodeParameters, Options, State
from spigolo.sources.pairing import StampMatcher
from spigolo.sources.ros_images import MILLIMETRES, color_of, depth_of, stamp_ns
from spigolo.stream import Segmenter, warm_up

STATUS_S = 10.0
"""Interval between log messages about received and segmented pairs of images, in seconds."""
QUIET_S = 5.0
"""Minimum interval between log messages about pairs of images that cannot be segmented, in seconds."""
TAKE_S = 0.2
KEPT = 5
"""Minimum queue length of each topic, so that no image of a pair is lost if many messages arrive together."""
TOPICS = ("color", "depth", "camera_info")


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """Newest segmentation result of the node. A click of the user selects an object in the newest result."""

    pair: Pair
    """Colour and depth message from which the result was computed."""
    result: Segmentation
    """Segmentation result of the pair of colour and depth images."""
    state: State
    """Parameter values of the node and of the segmentation method at the time of the segmentation."""


class SpigoloNode:
    """ROS 2 node with two threads. The thread that calls `rclpy.spin` receives messages, and a second thread segments
    images.
    """

    def __init__(self, kinds: Kinds, overrides: Mapping[str, Any]) -> None:
        parameter = kinds.rclpy.parameter.Parameter
        given = [parameter(name, value=value) for name, value in overrides.items()]
        self.node = kinds.rclpy.create_node("spigolo", parameter_overrides=given)
        self._kinds, self._log = kinds, self.node.get_logger()
        self._parameters = NodeParameters(self.node, kinds, self._apply)
        options = self._parameters.state.options
        self._matcher = StampMatcher(round(options.tolerance_s * 1e9))
        self._waiting = Waiting(options.queue)
        self._segmenter = Segmenter(self._parameters.state.config, options.ids)
        self._busy = threading.Lock()
        self._newest: Pair | None = None
        self._info: Any = None
        self._answer: Answer | None = None
        self._received = dict.fromkeys(TOPICS, 0)
        self._answered, self._failed = 0, 0
        self._times_ms: deque[float] = deque(maxlen=300)
        self._open(options)
        self._ended = threading.Event()
        self._worker = threading.Thread(target=self._work, name="segmenter", daemon=True)

    def _open(self, options: Options) -> None:
        """Create the subscriptions, the publishers, the service and the timer of the node."""
        qos = self._kinds.rclpy.qos
        policy = qos.ReliabilityPolicy.RELIABLE if options.reliable else qos.ReliabilityPolicy.BEST_EFFORT
        incoming = qos.QoSProfile(depth=max(options.queue, KEPT), reliability=policy)
        sensor, node = self._kinds.sensor, self.node
        node.create_subscription(sensor.Image, "color", self._on_color, incoming)
        node.create_subscription(sensor.Image, "depth", self._on_depth, incoming)
        node.create_subscription(sensor.CameraInfo, "camera_info", self._on_info, incoming)
        node.create_subscription(self._kinds.geometry.PointStamped, "~/click", self._on_click, 10)
        self._answers = Answers(node, self._kinds, qos.QoSProfile(depth=max(options.queue, KEPT)))
        if self._kinds.services is not None:
            node.create_service(self._kinds.services.Trigger, "~/segment", self._on_segment)
        node.create_timer(STATUS_S, self._report)

    def start(self) -> None:
        """Compile the numerical kernels, and then start the segmentation thread."""
        warm_up(self._parameters.state.config)
        self._worker.start()
        config = self._parameters.state.config
        topics = ", ".join(self.node.resolve_topic_name(name) for name in TOPICS)
        self._log.info(f"ready with {config.name} {config.digest}, listening to {topics}")

    def stop(self) -> None:
        """Stop the segmentation thread."""
        self._ended.set()
        if self._worker.is_alive():
            self._worker.join(10)

    # subscriptions

    def _on_color(self, message: Any) -> None:
        self._add("color", message)

    def _on_depth(self, message: Any) -> None:
        self._add("depth", message)

    def _on_info(self, message: Any) -> None:
        self._received["camera_info"] += 1
        self._info = message

    def _add(self, topic: str, message: Any) -> None:
        self._received[topic] += 1
        found = self._matcher.add(topic, stamp_ns(message), message)
        if found is not None:
            self._newest = Pair(*found, time.perf_counter())
            if self._parameters.state.options.continuous:
                self._waiting.put(self._newest)

    def _apply(self, state: State) -> None:
        self._matcher.tolerance_ns = round(state.options.tolerance_s * 1e9)

    # segmentation

    def _work(self) -> None:
        """Segment pairs of images until the node stops. This function runs on the segmentation thread."""
        try:
            while not self._ended.is_set():
                pair = None if self._info is None else self._waiting.take(TAKE_S)
                if pair is not None:
                    self._segment(pair)
                elif self._info is None:
                    self._ended.wait(TAKE_S / 10)
        except Exception:
            self._log.fatal(f"the segmenter ended: {traceback.format_exc()}")
            self._kinds.rclpy.try_shutdown()

    def _segment(self, pair: Pair) -> Answer | str:
        """Segment a pair of images and publish the result. If the segmentation fails, return the reason as text."""
        with self._busy:
            state = self._parameters.state
            if self._segmenter.ids != state.options.ids:
                self._segmenter = Segmenter(state.config, state.options.ids)
            self._segmenter.config = state.config
            try:
                result = self._segmenter(_frame_of(pair, self._info, state.options))
            except SpigoloError as error:
                self._failed += 1
                self._log.error(str(error), throttle_duration_sec=QUIET_S)
                return str(error)
            self._answer = Answer(pair, result, state)
        if not self._ended.is_set():
            self._answers.publish(pair.color.header, result)
        self._answered += 1
        self._times_ms.append((time.perf_counter() - pair.arrived_s) * 1000)
        return self._answer

    def _current(self) -> Answer | str:
        """Return the segmentation result in which a click selects an object. If no result exists, return the reason as
        text.

        If the node parameter `continuous` is false, the newest pair of images is segmented first.
        """
        state, answer, pair = self._parameters.state, self._answer, self._newest
        if pair is None or self._info is None:
            return self._lacking()
        fresh = answer is not None and answer.state is state and (state.options.continuous or answer.pair is pair)
        return answer if fresh and answer is not None else self._segment(pair)

    def _lacking(self) -> str:
        """Return a text that names the topics on which no message has arrived. If messages have arrived on all topics,
        the text says that no colour and depth messages form a pair.
        """
        silent = [self.node.resolve_topic_name(name) for name, count in self._received.items() if not count]
        return f"no message on {', '.join(silent)}" if silent else "no pair of colour and depth within the tolerance"

    # services and clicks

    def _on_segment(self, _: Any, response: Any) -> Any:
        """Handle a call of the service `segment`, which segments the newest pair of images."""
        pair = self._newest
        found = self._lacking() if pair is None or self._info is None else self._segment(pair)
        response.success = isinstance(found, Answer)
        response.message = found if isinstance(found, str) else f"{len(found.result)} objects"
        return response

    def _on_click(self, message: Any) -> None:
        """Publish the mask of the object at the pixel of a click. The fields x (to the right) and y (down) of the
        message are pixel coordinates.
        """
        found = self._current()
        if isinstance(found, str):
            self._log.warning(f"a click was ignored: {found}")
            return
        try:
            object_mask = found.result.object_at((message.point.y, message.point.x))
        except (IndexError, ValueError) as error:
            self._log.warning(f"a click was ignored: {error}")
            return
        self._answers.publish_mask(found.pair.color.header, object_mask)

    def _report(self) -> None:
        """Log the numbers of segmented, dropped and failed pairs of images."""
        if self._newest is None or self._info is None:
            self._log.warning(f"nothing to segment: {self._lacking()}{self._hint()}")
            return
        median = f", median {np.median(self._times_ms):.0f} ms" if self._times_ms else ""
        self._log.info(
            f"{self._answered} pairs segmented{median}; {self._waiting.dropped} pairs dropped for newer pairs,"
            f" {self._matcher.unmatched} images without a partner, {self._failed} pairs failed"
        )

    def _hint(self) -> str:
        """Return advice about a topic on which no message has arrived. Either the topic has no publisher, or the
        publisher's quality of service does not match that of the node.
        """
        for name in (topic for topic, count in self._received.items() if not count):
            publishers = self.node.get_publishers_info_by_topic(self.node.resolve_topic_name(name))
            if not publishers:
                return f". The topic has no publisher: give another topic with --{name.replace('_', '-')}"
            if self._parameters.state.options.reliable:
                return ". If the driver publishes with best-effort reliability, start the node with --reliable false"
        return ""


def _frame_of(pair: Pair, info: Any, options: Options) -> Frame:
    """Convert a pair of messages to a Frame. Raises FrameError or CameraError for unusable messages."""
    depth = depth_of(pair.depth)
    usual = MILLIMETRES if depth.dtype.kind == "u" else None
    camera = info
    if options.rectified:
        camera = copy.copy(info)
        camera.k, camera.d = np.asarray(info.p, float).reshape(3, 4)[:, :3].ravel(), []
    return Frame(color_of(pair.color), depth, camera, "", stamp_ns(pair.color), options.depth_scale or usual)


def run(overrides: Mapping[str, Any], ros_args: Sequence[str]) -> None:
    """Run the ROS 2 node until it is interrupted.

    - overrides: values of node parameters, indexed by name.
    - ros_args: arguments for ROS such as remappings.

    Raises SpigoloError if rclpy is missing or a parameter has an invalid value.
    """
    kinds = find_kinds()
    rclpy = kinds.rclpy
    rclpy.init(args=["spigolo", *ros_args])
    served: SpigoloNode | None = None
    try:
        served = SpigoloNode(kinds, overrides)
        served.start()
        rclpy.spin(served.node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass
    finally:
        if served is not None:
            served.stop()
            served.node.destroy_node()
        rclpy.try_shutdown()
