"""Choice of the topics of colour, depth and CameraInfo in a bag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from spigolo.errors import FileError, warn
from spigolo.sources.options import Options

IMAGE_TYPES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO_TYPE = "sensor_msgs/msg/CameraInfo"
REGISTERED = ("aligned_depth_to_color", "depth_to_rgb", "depth_registered", "registered", "aligned")
"""Parts of topic names that mark depth as registered to colour, in order of preference."""
COLOR_WORDS = ("color", "colour", "rgb")
NOT_COLOR = ("depth", "infra", "/ir", "mask", "label", "overlay", "confidence", "left", "right", "fisheye", "disparity")


@dataclass(frozen=True, slots=True)
class Topics:
    """Topics from which the frames of a bag are read."""

    color: str
    """Topic of the colour images."""
    depth: str
    """Topic of the depth images."""
    info: str | None
    """Topic of the CameraInfo, or None."""


def choose_topics(depth_of: Mapping[str, bool], infos: Sequence[str], options: Options, name: str) -> Topics:
    """Choose the topics of a bag. Topics that the options do not give are guessed from their names.

    depth_of: dict with True for each image topic that contains depth, and False for the other image topics. infos:
    CameraInfo topics. Raises FileError.
    """
    colors = sorted((t for t, is_depth in depth_of.items() if not is_depth), key=_color_rank)
    depths = sorted((t for t, is_depth in depth_of.items() if is_depth), key=_depth_rank)
    color = _named(options.color, list(depth_of), "color", name) or _guessed(colors, "color", depth_of, name)
    depth = _named(options.depth, list(depth_of), "depth", name) or _guessed(depths, "depth", depth_of, name)
    info = _named(options.info, infos, "info", name) or _info_of(color, depth, infos)
    return Topics(color, depth, info)


def _named(topic: str | None, topics: Sequence[str], what: str, name: str) -> str | None:
    if topic is not None and topic not in topics:
        raise FileError(f"there is no {what} topic {topic} in {name}. Topics: {', '.join(topics) or 'none'}")
    return topic


def _guessed(found: Sequence[str], what: str, depth_of: Mapping[str, bool], name: str) -> str:
    if not found:
        kind = "depth as 16UC1, mono16 or 32FC1" if what == "depth" else "colour"
        raise FileError(
            f"expected a topic with {kind} images in {name}, got {', '.join(depth_of) or 'no images'}: give the topic"
            f" with {what}=TOPIC"
        )
    rank = _color_rank if what == "color" else _depth_rank
    if len(found) > 1 and rank(found[0])[:-1] == rank(found[1])[:-1]:
        warn(
            f"{name}: using {found[0]} as {what} topic, found {', '.join(found)}: choose another topic with"
            f" {what}=TOPIC"
        )
    return found[0]


def _color_rank(topic: str) -> tuple[bool, bool, bool, str]:
    low = topic.lower()
    return (
        any(word in low for word in NOT_COLOR),
        not any(word in low for word in COLOR_WORDS),
        low.endswith("/compressed"),
        topic,
    )


def _depth_rank(topic: str) -> tuple[bool, int, bool, str]:
    low = topic.lower()
    registered = next((k for k, word in enumerate(REGISTERED) if word in low), len(REGISTERED))
    return "infra" in low or "/ir" in low, registered, low.endswith("/compresseddepth"), topic


def _info_of(color: str, depth: str, infos: Sequence[str]) -> str | None:
    """Return the CameraInfo topic whose name has the longest common prefix with the colour topic, or else with the
    depth topic. The only CameraInfo topic of a bag is returned, too, unless its name says that it belongs to another
    image than the colour image.
    """
    for topic in (color, depth):
        best = max(infos, key=lambda info: len(_shared(info, topic)), default=None)
        if best is not None and len(_shared(best, topic)) >= min(2, topic.count("/") - 1):
            return best
    if len(infos) != 1:
        return None
    if any(word in infos[0].lower() for word in NOT_COLOR):
        warn(
            f"no CameraInfo for {color}, and {infos[0]} belongs to another image: give the intrinsics with camera=...,"
            f" or use that topic with info={infos[0]}"
        )
        return None
    return infos[0]


def _shared(one: str, other: str) -> list[str]:
    parts = []
    for a, b in zip(one.strip("/").split("/"), other.strip("/").split("/"), strict=False):
        if a != b:
            break
        parts.append(a)
    return parts
