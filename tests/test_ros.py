"""The ROS 2 node as a process of its own, and a second process that publishes, listens and asks, on loopback."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytestmark = [pytest.mark.ros, pytest.mark.alone]
ROOT = Path(__file__).resolve().parents[1]
PYTHON = ROOT / ".venv-ros" / "bin" / "python"
PEER = ROOT / "tests" / "ros_peer.py"
DOMAIN = 1 + os.getpid() % 100
ENVIRONMENT = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(DOMAIN)}


@pytest.fixture(autouse=True)
def environment() -> None:
    """Skip without ROS. In the automatic checks (CI is set), fail."""
    if not PYTHON.exists():
        message = "the environment with ROS is absent: make test builds it"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)


@contextlib.contextmanager
def node(log: Path, *words: str) -> Iterator[subprocess.Popen[str]]:
    """A running node. It must end without an error when it is told to."""
    with log.open("w") as out:
        process = subprocess.Popen(
            [PYTHON, "-m", "spigolo", "ros", *words], env=ENVIRONMENT, stdout=out, stderr=subprocess.STDOUT, text=True
        )
        try:
            yield process
            assert process.poll() is None, log.read_text()
            process.send_signal(signal.SIGINT)
            assert process.wait(30) == 0, log.read_text()
        finally:
            process.kill()
            process.wait()


def peer(*words: object) -> Any:
    done = subprocess.run(
        [PYTHON, PEER, *map(str, words)], env=ENVIRONMENT, capture_output=True, text=True, timeout=500, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_hundred_pairs_at_ten_hertz_get_a_hundred_right_answers(tmp_path: Path) -> None:
    log = tmp_path / "log"
    client = [PYTHON, ROOT / "examples" / "ros2" / "list_objects.py", "--count", "3"]
    with node(log, "--queue", "100"):
        listening = subprocess.Popen(client, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True)
        found = peer("answers", "--pairs", 100, "--rate", 10, "--patience", 300, "--all-topics")
        shown = listening.communicate(timeout=60)[0]
    assert (found["sent"], found["answered"], found["equal"]) == (100, 100, 100), log.read_text()
    assert found["other_stamps"] == 0
    assert (found["frame_ids"], found["encodings"]) == (["camera_color_optical_frame"], ["mono16"])
    assert found["overlay"] == ["rgb8", 640, 480]
    assert found["marker_types"] == [1, 9] and "1" in found["marker_texts"]
    assert found["cloud_labels"] == list(range(1, len(found["cloud_labels"]) + 1)) and len(found["cloud_labels"]) > 3
    assert found["object_points"] == found["cloud_points"] > 10_000
    assert listening.returncode == 0 and shown.count("objects at") == 3


def test_with_best_effort_on_both_sides_what_arrives_is_right(tmp_path: Path) -> None:
    # small images: a large one is many packets, and on a busy machine one of them is nearly always lost
    with node(tmp_path / "log", "--reliable", "false", "--queue", "10"):
        found = peer("answers", "--pairs", 40, "--rate", 10, "--patience", 30, "--best-effort", "--every", 4)
    assert found["equal"] == found["answered"] > 0 and found["other_stamps"] == 0


def test_with_a_queue_of_one_the_newest_pair_wins(tmp_path: Path) -> None:
    with node(tmp_path / "log", "--preset", "TABLE", "--tolerance-s", "0.004"):
        found = peer("answers", "--pairs", 60, "--rate", 100, "--patience", 20, "--preset", "TABLE")
    assert found["equal"] == found["answered"] < 60
    assert found["last_answered"] and found["other_stamps"] == 0


def test_parameters_change_at_run_time_and_wrong_ones_are_refused(tmp_path: Path) -> None:
    with node(tmp_path / "log"):
        found = peer("parameters")
    assert {"partition.gamma", "cost.k_y", "additions.rules.wall", "continuous"} < set(found["names"])
    assert all(found["descriptions"])
    assert found["start"] == ["OBJECTS", 0.0065, "on"]
    assert found["set"] == ["", "", ""] and found["after_set"] == [0.02, "none", "none"]
    assert found["equal_after_set"] and found["differs_from_before"]
    told = found["wrong"]
    assert len(told) == 5 and all(told)
    assert "got -1.0" in told[0] and "'steep'" in told[1] and "expected one of OBJECTS" in told[2]
    assert "read-only" in told[3] and "tolerance_s" in told[4]
    assert found["after_wrong"] == [0.02, "OBJECTS", 1, 0.015]
    assert found["preset"] == [""] and found["after_preset"] == ["TABLE", 0.0016, 7.5, "none"]
    assert found["equal_after_preset"]


def test_a_node_that_is_not_continuous_answers_the_service_and_a_click(tmp_path: Path) -> None:
    with node(tmp_path / "log", "--continuous", "false"):
        found = peer("asking")
    assert found["empty"] == [False, "no message on /color, /depth, /camera_info"]
    assert found["unasked"] == 0
    success, told, newest = found["service"]
    assert success and told.endswith(" objects") and newest == 700_100
    assert found["equal"]
    assert found["mask"] == ["mono8", 700, "camera_color_optical_frame", True]
    assert found["masks"] == 1
    assert "a click was ignored: expected a pixel" in (tmp_path / "log").read_text()


def test_ids_last_while_the_view_moves_until_they_are_switched_off(tmp_path: Path) -> None:
    with node(tmp_path / "log", "--ids", "true"):
        found = peer("lasting")
    assert len(found["numbers"][0]) > 3 and found["set"] == [""]
    for later in found["numbers"][1:]:  # rows are rolled: what leaves on one side comes back on the other
        assert len(set(later) & set(found["numbers"][0])) >= len(found["numbers"][0]) - 1
    assert set(found["off"]) <= set(range(1, 30))


def test_topics_and_parameters_are_given_as_flags_or_as_arguments_of_ros(tmp_path: Path) -> None:
    log = tmp_path / "log"
    words = ["--color", "/cam/rgb", "--ros-args", "-r", "__ns:=/arm", "-p", "partition.gamma:=-1.0"]
    done = subprocess.run(
        [PYTHON, "-m", "spigolo", "ros", *words], env=ENVIRONMENT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2 and "got -1.0" in done.stderr and len(done.stderr.splitlines()) == 1
    words[-1] = "tolerance_s:=0.01"
    with node(log, *words):
        for _ in range(600):
            if "ready" in log.read_text():
                break
            with contextlib.suppress(subprocess.TimeoutExpired):
                subprocess.run(["sleep", "0.1"], check=False)
    assert "listening to /cam/rgb, /arm/depth, /arm/camera_info" in log.read_text()
