"""Source for ROS 1 and ROS 2 bags. The package `rosbags` reads the bags, so ROS need not be installed.

A first pass over the bag reads all stamps, pairs colour and depth images, and counts the frames.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from spigolo.errors import FileError, FrameError, SpigoloError, warn
from spigolo.frames.camera import Camera
from spigolo.frames.files import known_camera
from spigolo.frames.frame import Frame
from spigolo.frames.listing import listed
from spigolo.sources.bag_files import Decoder, Stamped, find_message, open_bag, read_stamps
from spigolo.sources.base import Report, SizedSource
from spigolo.sources.options import Options
from spigolo.sources.pairing import pair_stamps
from spigolo.sources.ros_images import MILLIMETRES, color_of, depth_of
from spigolo.sources.topics import IMAGE_TYPES, INFO_TYPE, Topics, choose_topics

RECTIFIED = re.compile(r"(^|[/_])rect(ified)?([/_]|$)")
"""Word of a topic name that marks rectified images, such as in image_rect_color."""


@dataclass(frozen=True, slots=True)
class Content:
    """Content of a bag, found by a first pass over the file."""

    topics: Topics
    """Topics of the colour images, of the depth images and of CameraInfo."""
    partner: dict[tuple[str, int], int]
    """Number of the pair to which an image message belongs, indexed by topic and message number. A pair consists of a
    colour and a depth message.
    """
    pairs: tuple[tuple[Stamped, Stamped], ...]
    """Colour and depth message of each pair."""
    headless: frozenset[tuple[str, int]]
    """Topic and number of each message that is too short for a stamp."""
    unpaired: int
    """Number of image messages that belong to no pair."""
    info: Any
    """First readable CameraInfo message, or None."""
    cut: str
    """Reason why reading stopped before the end of the file. The text is empty if the whole file was read."""


class BagSource(SizedSource):
    """Source for ROS bags. A frame is a pair of a colour and a depth image whose time stamps differ by at most the
    option `tolerance_ms`.
    """

    def __init__(self, path: Path, options: Options) -> None:
        self._path = path
        with closing(open_bag(path)) as reader:
            self._types = {c.topic: c.msgtype for c in reader.connections}
            self._decoder = Decoder(reader)
            self.content = self._survey(reader, options)
        super().__init__(str(path), options, len(self.content.pairs))
        topics = self.content.topics
        if options.camera is None and topics.info is not None and self.content.info is not None:
            self.intrinsics = f"topic {topics.info}"
        if not self._count:
            warn(f"{path}: no pair of {topics.color} and {topics.depth} within {options.tolerance_ms:g} ms")

    def __getitem__(self, number: int) -> Frame:
        topics, (color, depth) = self.content.topics, self.content.pairs[number]
        wanted = {topics.color: color, topics.depth: depth}
        with closing(open_bag(self._path)) as reader:
            found = {topic: find_message(reader, topic, message) for topic, message in wanted.items()}
        return self._read(number % self._count, found)

    def name_of(self, number: int) -> str:
        """Return the name of a frame without reading the frame."""
        return _name(number)

    def files_of(self, number: int) -> tuple[Path, ...]:
        """Return the files of the bag, which are the same for all frames."""
        return tuple(listed(self._path)) if self._path.is_dir() else (self._path,)

    def report(self) -> Report:
        """Return the numbers of frames and images since the start of the last iteration, and the maximum stamp
        difference of a pair.
        """
        counts = super().report()
        return replace(counts, tolerance_ms=self.options.tolerance_ms)

    def _frames(self) -> Iterator[Frame]:
        content, waiting = self.content, dict[int, tuple[str, bytes]]()
        done: dict[int, Frame | None] = {}
        turn = 0
        for topic, number, data in self._messages(content.topics):
            pair = content.partner.get((topic, number))
            if pair is None:
                self._count_single(topic, number, data)
            elif pair not in waiting:
                waiting[pair] = topic, data
            else:
                done[pair] = self._frame(pair, dict([waiting.pop(pair), (topic, data)]))
            while turn in done:
                frame = done.pop(turn)
                turn += 1
                if frame is not None:
                    yield frame
        if content.cut:
            self._skip(self.name, FileError(f"the recording cannot be read to its end: {content.cut}"))

    def _count_single(self, topic: str, number: int, data: bytes) -> None:
        """Count an image message that belongs to no pair: as broken if the message is unreadable, else as unmatched."""
        name = f"{topic}, message {number}"
        if (topic, number) in self.content.headless:
            self._skip(name, FrameError(f"too short for a stamp ({len(data)} bytes)"))
            return
        try:
            self._decode(topic, data)
        except SpigoloError as error:
            self._skip(name, error)
        else:
            self._unmatched += 1

    def _frame(self, pair: int, messages: dict[str, bytes]) -> Frame | None:
        try:
            return self._read(pair, messages)
        except SpigoloError as error:
            self._skip(_name(pair), error)
            return None

    def _read(self, pair: int, messages: dict[str, bytes]) -> Frame:
        """Decode the two messages of a pair to a frame. Raises SpigoloError."""
        topics, own = self.content.topics, self.options
        color = self._decode(topics.color, messages[topics.color])
        depth = self._decode(topics.depth, messages[topics.depth])
        camera, scale = self._camera(color.shape[1], color.shape[0])
        stamp = self.content.pairs[pair][0].stamp_ns
        usual = (scale or MILLIMETRES) if depth.dtype.kind in "ui" else None
        unit_m = usual if own.depth_scale is None else own.depth_scale
        return Frame(color, depth, camera, _name(pair), stamp, unit_m, max_pixels=own.max_pixels)

    def _camera(self, width: int, height: int) -> tuple[Camera | None, float | None]:
        given, info = self.options.camera, self.content.info
        if given is None and info is not None:
            return known_camera(_camera_info(info, self.content.topics.color), width, height)[0], None
        return known_camera(given, width, height)

    def _decode(self, topic: str, data: bytes) -> Any:
        """Decode an image message to an array. Raises FrameError for a damaged message."""
        message = self._decoder.message(data, self._types[topic])
        read = depth_of if topic == self.content.topics.depth else color_of
        return read(message, self.options.max_pixels)

    def _messages(self, topics: Topics) -> Iterator[tuple[str, int, bytes]]:
        """Yield topic, number and bytes of the image messages, up to the first unreadable part of the file."""
        numbers = {topics.color: 0, topics.depth: 0}
        with closing(open_bag(self._path)) as reader:
            wanted = [c for c in reader.connections if c.topic in numbers]
            with suppress(Exception):  # the first pass has recorded the reason in Content.cut
                for connection, _, data in reader.messages(connections=wanted):
                    number = numbers[connection.topic]
                    numbers[connection.topic] += 1
                    yield connection.topic, number, bytes(data)

    def _survey(self, reader: Any, options: Options) -> Content:
        images = [c for c in reader.connections if c.msgtype in IMAGE_TYPES]
        infos = sorted({c.topic for c in reader.connections if c.msgtype == INFO_TYPE})
        holds = {c.topic: self._decoder.holds_depth(c) for c in images}
        topics = choose_topics(holds, infos, options, self._path.name)
        info = self._decoder.first([c for c in reader.connections if c.topic == topics.info])
        stamps, headless, cut = read_stamps(reader, topics)
        colors, depths = stamps[topics.color], stamps[topics.depth]
        found = pair_stamps([s.stamp_ns for s in colors], [s.stamp_ns for s in depths], options.tolerance_ms * 1e6)
        pairs = tuple((colors[color], depths[depth]) for color, depth in found)
        partner = {}
        for pair, (color, depth) in enumerate(pairs):
            partner[topics.color, color.number] = pair
            partner[topics.depth, depth.number] = pair
        unpaired = len(colors) + len(depths) + len(headless) - 2 * len(pairs)
        return Content(topics, partner, pairs, headless, unpaired, info, cut)


def _camera_info(info: Any, topic: str) -> Any:
    """Return the intrinsics in a CameraInfo message. For a topic of rectified images, return the matrix P of the
    message and no distortion coefficients.
    """
    projection = getattr(info, "p", None) if hasattr(info, "p") else getattr(info, "P", None)
    is_rectified = RECTIFIED.search(topic.lower()) is not None
    if not is_rectified or projection is None or not any(projection):
        return info
    return SimpleNamespace(width=info.width, height=info.height, P=list(map(float, projection)))


def _name(pair: int) -> str:
    return f"{pair:06d}"
