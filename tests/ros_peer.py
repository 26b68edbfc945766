"""The other side of the ROS 2 node, run in a process of its own by test_ros.py: camera, viewer and operator.

    .venv-ros/bin/python tests/ros_peer.py answers --pairs 100 --rate 10

Prints what it saw as JSON.
"""

from __future__ import annotations

import argparse
import array
import contextlib
import json
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import PointStamped
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.executors import ExternalShutdownException
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

import spigolo as sp

SCENE = Path(sp.__file__).parent / "demo_scene"
FRAME_ID = "camera_color_optical_frame"
FIRST_S = 1000
VARIANTS = 5
WAIT_S = 120.0
KEPT = 200
"""Messages kept for each topic: more than a run sends, so that a busy machine loses none."""


def variants(every: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Colour and depth in millimetres of different views: each pixel, or one of `every` along both axes."""
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    color, depth = frame.color[::every, ::every], np.round(frame.depth * 1000).astype(np.uint16)[::every, ::every]
    return [(np.roll(color, 16 * k, axis=1), np.roll(depth, 16 * k, axis=1)) for k in range(VARIANTS)]


def scaled_camera(every: int) -> sp.Camera:
    k = sp.read_camera(SCENE / "camera.json")[0]
    return sp.Camera(k.fx / every, k.fy / every, k.cx / every, k.cy / every, k.width // every, k.height // every)


class Peer:
    """Publishes pairs and collects answers by stamp."""

    def __init__(self, best_effort: bool, every: int) -> None:
        self.node = rclpy.create_node("peer")
        self.views, self.camera = variants(every), scaled_camera(every)
        self.sent_s: dict[int, float] = {}
        self.greetings: set[int] = set()
        """Stamps of pairs that only ask whether the node answers: some answers come late."""
        self.labels: dict[int, tuple[float, str, str, bytes]] = {}
        self.seen: dict[str, list] = {name: [] for name in ("overlay", "markers", "cloud", "objects", "mask")}
        reliable = QoSProfile(depth=KEPT)
        self.color = self.node.create_publisher(Image, "color", reliable)
        self.depth = self.node.create_publisher(Image, "depth", reliable)
        self.info = self.node.create_publisher(CameraInfo, "camera_info", reliable)
        self.click = self.node.create_publisher(PointStamped, "spigolo/click", 10)
        policy = ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE
        self.node.create_subscription(
            Image, "spigolo/labels", self.on_labels, QoSProfile(depth=KEPT, reliability=policy)
        )
        self.spinning = threading.Thread(target=self.spin, daemon=True)
        self.spinning.start()

    def spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            rclpy.spin(self.node)

    def watch(self, **kinds: type) -> None:
        for name, kind in kinds.items():
            self.node.create_subscription(kind, f"spigolo/{name}", self.seen[name].append, KEPT)

    def on_labels(self, message: Image) -> None:
        stamp = message.header.stamp
        key = stamp.sec * 1000 + stamp.nanosec // 1_000_000
        self.labels[key] = time.perf_counter(), message.header.frame_id, message.encoding, bytes(message.data)

    def send(self, key: int, view: int = 0, late_ms: int = 3) -> None:
        """Publish the pair of a stamp in milliseconds: every other one with floating-point depth and BGR."""
        color, depth = self.views[view]
        swapped = key % 2
        stored = depth.astype(np.float32) * np.float32(0.001) if swapped else depth
        self.publish_info(key)
        self.depth.publish(filled(key + late_ms, stored, "32FC1" if swapped else "16UC1"))
        self.sent_s[key] = time.perf_counter()
        self.color.publish(filled(key, color[..., ::-1] if swapped else color, "bgr8" if swapped else "rgb8"))

    def publish_info(self, key: int) -> None:
        k = self.camera
        info = CameraInfo(width=k.width, height=k.height, distortion_model="plumb_bob", d=[0.0] * 5)
        info.k = [float(v) for v in k.matrix.ravel()]
        info.p = [float(v) for v in np.hstack([k.matrix, np.zeros((3, 1))]).ravel()]
        set_stamp(info, key)
        self.info.publish(info)

    def until(self, wanted: Callable[[], object], message: str) -> None:
        end = time.monotonic() + WAIT_S
        while not wanted():
            if time.monotonic() > end:
                raise SystemExit(f"no {message} within {WAIT_S} s")
            time.sleep(0.02)

    def connect(self, answers: bool = True) -> None:
        """Wait for the node, and for its first answer."""
        publishers = (self.color, self.depth, self.info, self.click)
        self.until(lambda: all(p.get_subscription_count() for p in publishers), "node")
        self.until(lambda: self.node.count_publishers("/spigolo/labels"), "labels topic")
        end = time.monotonic() + WAIT_S
        key = 1000
        while answers and not self.labels:
            if time.monotonic() > end:
                raise SystemExit("no first answer")
            self.send(key)
            self.greetings.add(key)
            key += 100
            time.sleep(0.5)
        time.sleep(0.5)
        self.labels.clear()

    def call(self, kind: type, name: str, **fields: object) -> object:
        client = self.node.create_client(kind, name)
        if not client.wait_for_service(WAIT_S):
            raise SystemExit(f"no service {name}")
        done = client.call_async(kind.Request(**fields))
        self.until(done.done, f"answer of {name}")
        return done.result()

    def set(self, **values: object) -> list[str]:
        """Set parameters ("__" for a dot). Returns "" or the reason of each."""
        parameters = [Parameter(n.replace("__", "."), value=v).to_parameter_msg() for n, v in values.items()]
        answers = self.call(SetParameters, "/spigolo/set_parameters", parameters=parameters).results
        return ["" if a.successful else a.reason for a in answers]

    def get(self, *names: str) -> list[object]:
        found = self.call(GetParameters, "/spigolo/get_parameters", names=list(names)).values
        return [Parameter.from_parameter_msg(message(n, v)).value for n, v in zip(names, found, strict=True)]


def message(name: str, value: object) -> object:
    from rcl_interfaces.msg import Parameter as ParameterMessage

    return ParameterMessage(name=name, value=value)


def set_stamp(message: object, key: int) -> None:
    message.header.stamp.sec, milliseconds = divmod(key, 1000)
    message.header.stamp.nanosec = milliseconds * 1_000_000
    message.header.frame_id = FRAME_ID


def filled(key: int, pixels: np.ndarray, encoding: str) -> Image:
    pixels = np.ascontiguousarray(pixels)
    image = Image(height=pixels.shape[0], width=pixels.shape[1], encoding=encoding, step=pixels.nbytes // len(pixels))
    image.data = array.array("B", pixels.tobytes())
    set_stamp(image, key)
    return image


def expected(peer: Peer, view: int, config: sp.Config) -> bytes:
    frame = sp.Frame(*peer.views[view], peer.camera, depth_scale=0.001)
    return sp.segment(frame, config).labels.astype("<u2").tobytes()


def answers(peer: Peer, given: argparse.Namespace) -> dict[str, object]:
    """Send pairs at a rate and compare the answers with `sp.segment`."""
    wanted = [expected(peer, view, sp.preset(given.preset)) for view in range(VARIANTS)]
    if given.all_topics:
        peer.watch(overlay=Image, markers=MarkerArray, cloud=PointCloud2, objects=PointCloud2)
    peer.connect()
    for seen in peer.seen.values():
        seen.clear()
    keys = [FIRST_S * 1000 + k * 1000 // given.rate for k in range(given.pairs)]
    start = time.perf_counter()
    for k, key in enumerate(keys):
        time.sleep(max(0.0, start + k / given.rate - time.perf_counter()))
        peer.send(key, k % VARIANTS)
    end = time.monotonic() + given.patience
    while not peer.labels.keys() >= set(keys) and time.monotonic() < end:
        time.sleep(0.05)
    found = {key: peer.labels[key] for key in keys if key in peer.labels}
    times = [1000 * (found[key][0] - peer.sent_s[key]) for key in found]
    return {
        "sent": len(keys),
        "answered": len(found),
        "other_stamps": len(peer.labels.keys() - set(keys) - peer.greetings),
        "equal": sum(found[key][3] == wanted[k % VARIANTS] for k, key in enumerate(keys) if key in found),
        "last_answered": keys[-1] in found,
        "frame_ids": sorted({one[1] for one in found.values()}),
        "encodings": sorted({one[2] for one in found.values()}),
        "latency_ms": {"median": float(np.median(times)), "99 %": float(np.percentile(times, 99))} if times else None,
        **(described(peer) if given.all_topics else {}),
    }


def lasting(peer: Peer, _: argparse.Namespace) -> dict[str, object]:
    """Numbers of the objects while the view moves: by id, and after the parameter is off by label."""
    peer.connect()
    found = {}
    for k in range(4):
        found[k] = numbers(
            peer, 800_000 + 100 * k, np.roll(peer.views[0][0], 8 * k, 1), np.roll(peer.views[0][1], 8 * k, 1)
        )
    before = peer.set(ids=False)
    return {"numbers": list(found.values()), "set": before, "off": numbers(peer, 900_000, *peer.views[0])}


def numbers(peer: Peer, key: int, color: np.ndarray, depth: np.ndarray) -> list[int]:
    """Numbers in the label image that answers a pair, those of large areas."""
    peer.views.append((color, depth))
    peer.send(key, len(peer.views) - 1)
    peer.until(lambda: key in peer.labels, f"answer to {key}")
    values, counts = np.unique(np.frombuffer(peer.labels[key][3], "<u2"), return_counts=True)
    return [int(v) for v, n in zip(values, counts, strict=True) if v and n > 2000]


def described(peer: Peer) -> dict[str, object]:
    """Facts of the other topics' last messages."""
    frame = sp.Frame(*peer.views[0], peer.camera, depth_scale=0.001)
    objects = {key: len(value) for key, value in peer.seen.items()}
    cloud, marks, overlay = peer.seen["cloud"][-1], peer.seen["markers"][-1], peer.seen["overlay"][-1]
    kind = np.dtype([(field.name, {6: "<u4", 7: "<f4"}[field.datatype]) for field in cloud.fields])
    labels = np.frombuffer(bytes(cloud.data), kind)["label"]
    stamp = (cloud.header.stamp.sec, cloud.header.stamp.nanosec)

    def points() -> int:
        """Points in the clouds of single objects that have the stamp of the last cloud. They may arrive after it."""
        every = peer.seen["objects"]
        return sum(one.width for one in every if (one.header.stamp.sec, one.header.stamp.nanosec) == stamp)

    peer.until(lambda: points() >= cloud.width, "clouds of the objects")
    return {
        "seen": objects,
        "cloud_points": int(cloud.width),
        "cloud_labels": sorted({int(v) for v in labels}),
        "object_points": points(),
        "marker_types": sorted({m.type for m in marks.markers if m.action == 0}),
        "marker_texts": sorted({m.text for m in marks.markers if m.text}),
        "overlay": [overlay.encoding, overlay.width, overlay.height],
        "shape": list(frame.shape),
    }


def parameters(peer: Peer, _: argparse.Namespace) -> dict[str, object]:
    """Change parameters at run time, right and wrong ones."""
    peer.connect()
    names = peer.call(ListParameters, "/spigolo/list_parameters").result.names
    told = peer.call(DescribeParameters, "/spigolo/describe_parameters", names=["partition.gamma", "queue"]).descriptors
    out: dict[str, object] = {"names": list(names), "descriptions": [d.description for d in told]}
    out["start"] = peer.get("preset", "partition.gamma", "additions.rules.wall")
    out["set"] = peer.set(partition__gamma=0.02, rejection__max_distance_m="none", additions__rules__wall="none")
    out["after_set"] = peer.get("partition.gamma", "rejection.max_distance_m", "additions.rules.wall")
    changed = sp.OBJECTS.replace(
        **{"partition.gamma": 0.02, "rejection.max_distance_m": None, "additions.rules.wall": None}
    )
    out["equal_after_set"] = same(peer, 500_000, changed)
    out["differs_from_before"] = expected(peer, 0, changed) != expected(peer, 0, sp.OBJECTS)
    out["wrong"] = peer.set(
        partition__gamma=-1.0, edges__contact_low_deg="steep", preset="NOPE", queue=3, tolerance_s=-0.1
    )
    out["after_wrong"] = peer.get("partition.gamma", "preset", "queue", "tolerance_s")
    out["preset"] = peer.set(preset="TABLE")
    out["after_preset"] = peer.get("preset", "partition.gamma", "cost.k_x", "additions")
    out["equal_after_preset"] = same(peer, 600_000, sp.TABLE)
    return out


def same(peer: Peer, key: int, config: sp.Config) -> bool:
    """Whether the answer to the first view is that of a configuration."""
    peer.send(key)
    peer.until(lambda: key in peer.labels, f"answer to {key}")
    return peer.labels[key][3] == expected(peer, 0, config)


def asking(peer: Peer, _: argparse.Namespace) -> dict[str, object]:
    """A node that segments on request: the service, and a click."""
    peer.watch(mask=Image)
    peer.connect(answers=False)
    out: dict[str, object] = {}
    empty = peer.call(Trigger, "/spigolo/segment")
    out["empty"] = [empty.success, empty.message]
    for key in (700_000, 700_100):
        peer.send(key)
        time.sleep(1.0)
    out["unasked"] = len(peer.labels)
    for _ in range(30):  # on a busy machine the pair may come after the request
        done = peer.call(Trigger, "/spigolo/segment")
        if done.success and 700_100 in peer.labels:
            break
        peer.send(700_100)
        time.sleep(1.0)
    peer.until(lambda: 700_100 in peer.labels, f"labels after the service said {done.message!r}")
    out["service"] = [done.success, done.message, max(peer.labels)]
    out["equal"] = peer.labels[700_100][3] == expected(peer, 0, sp.OBJECTS)
    frame = sp.Frame(*peer.views[0], peer.camera, depth_scale=0.001)
    y, x = sp.segment(frame)[0].centroid_px
    click = PointStamped()
    click.point.x, click.point.y = float(round(x)), float(round(y))
    peer.click.publish(click)
    peer.until(lambda: peer.seen["mask"], "mask")
    mask = peer.seen["mask"][0]
    wanted = sp.segment_at(frame, (round(y), round(x))).mask.astype(np.uint8) * 255
    out["mask"] = [mask.encoding, mask.header.stamp.sec, mask.header.frame_id, bytes(mask.data) == wanted.tobytes()]
    click.point.x = -5.0
    peer.click.publish(click)
    time.sleep(1.0)
    out["masks"] = len(peer.seen["mask"])
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["answers", "parameters", "asking", "lasting"])
    parser.add_argument("--pairs", type=int, default=100)
    parser.add_argument("--rate", type=int, default=10)
    parser.add_argument("--patience", type=float, default=30.0)
    parser.add_argument("--preset", default="OBJECTS")
    parser.add_argument("--best-effort", action="store_true")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--all-topics", action="store_true")
    given = parser.parse_args()
    rclpy.init()
    peer = Peer(given.best_effort, given.every)
    print(
        json.dumps({one.__name__: one for one in (answers, parameters, asking, lasting)}[given.what](peer, given)),
        flush=True,
    )
    rclpy.try_shutdown()
    peer.spinning.join(10)  # a thread inside rclpy would abort the process at its end


if __name__ == "__main__":
    main()
