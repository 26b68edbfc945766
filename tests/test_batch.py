"""Many frames: whatever ends a run, the next one ends with the files of an undisturbed one."""

from __future__ import annotations

import json
import os
import platform
import random
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.batch import (
    FrameFiles,
    Lost,
    Progress,
    Summary,
    dask_cluster,
    dask_local,
    here,
    in_order,
    local,
    run_batch,
)
from spigolo.batch.cluster import MAX_GROUP, RECENT, _ClusterRun, _Done, _local_settings
from spigolo.batch.manifest import FILE, Manifest
from spigolo.batch.places import check_name, place
from spigolo.batch.tables import writer_of
from spigolo.cli.engines import choose_cluster
from spigolo.errors import ConfigError, FileError, SpigoloError
from spigolo.export.instances import compress, run_lengths
from spigolo.frames.files import write_json, write_png
from spigolo.sources import numbered
from spigolo.sources.base import Source
from spigolo.sources.numbered import numbered_frames
from spigolo.sources.options import Options

pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")
pq = pytest.importorskip("pyarrow.parquet")

SCENE = Path(sp.__file__).parent / "demo_scene"
COUNT = 40
SIZE = (90, 120)
FAILING = "f07"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """40 small frames of boxes on a table, one of them damaged."""
    folder = tmp_path_factory.mktemp("source")
    height, width = SIZE
    write_json(folder / "camera.json", {**camera(), "depth_scale": 0.001})
    for k in range(COUNT):
        rng = np.random.default_rng(k)
        color = np.full((height, width, 3), 90, np.uint8)
        depth = np.full(SIZE, 1000, np.uint16)
        for _ in range(3):
            y, x = rng.integers(5, height - 35), rng.integers(5, width - 35)
            color[y : y + 28, x : x + 28] = rng.integers(0, 255, 3)
            depth[y : y + 28, x : x + 28] = rng.integers(700, 900)
        color += rng.integers(0, 6, color.shape, dtype=np.uint8)
        write_png(folder / "rgb" / f"f{k:02d}.png", color)
        write_png(folder / "depth" / f"f{k:02d}.png", depth)
    (folder / "rgb" / f"{FAILING}.png").write_bytes(b"no image")
    return folder


@pytest.fixture(scope="module")
def undisturbed(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    done = subprocess.run(command(source, out, 1), capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 1, done.stderr
    assert f"{COUNT} frames: {COUNT - 1} computed, 0 kept, 1 failed" in done.stdout
    assert f"{FAILING}: expected an image in" in done.stderr
    return out


def camera() -> dict[str, float]:
    return {"fx": 110.0, "fy": 110.0, "cx": 59.5, "cy": 44.5, "width": SIZE[1], "height": SIZE[0]}


def command(source: Path, out: Path, workers: int = 2) -> list[str]:
    return [sys.executable, "-m", "spigolo", "batch", str(source), "--out", str(out), "--workers", str(workers)]


def jobs_of(source: Path, names: list[str] | None = None) -> list[FrameFiles]:
    found = [f"f{k:02d}" for k in range(COUNT)] if names is None else names
    return [
        FrameFiles(name, source / "rgb" / f"{name}.png", source / "depth" / f"{name}.png", source / "camera.json")
        for name in found
    ]


def contents(out: Path) -> dict[str, bytes]:
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in out.rglob("*") if path.is_file()}


def assert_equal(out: Path, other: Path) -> None:
    mine, theirs = contents(out), contents(other)
    assert sorted(mine) == sorted(theirs)
    assert [name for name in mine if mine[name] != theirs[name]] == []


def lines_in(out: Path) -> int:
    return (out / FILE).read_bytes().count(b"\n") if (out / FILE).exists() else 0


def run(source: Path, out: Path, **options: str) -> Summary:
    return run_batch(jobs_of(source), sp.OBJECTS, out, local(), **options)


def test_a_run_killed_at_random_moments_ends_like_an_undisturbed_one(
    source: Path, undisturbed: Path, tmp_path: Path
) -> None:
    out, rng = tmp_path / "out", random.Random(0)
    for target in sorted(rng.sample(range(1, COUNT - 4), 3)):
        process = subprocess.Popen(command(source, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 300
        while lines_in(out) < target and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.002)
        time.sleep(rng.random() * 0.02)
        process.send_signal(signal.SIGKILL)
        process.wait()
    (out / "labels" / ".f00.png-half").write_bytes(b"half")  # as a kill inside of a write leaves it
    before = {name: os.stat(out / name).st_mtime_ns for name in contents(out) if name.startswith("labels/f")}
    done = subprocess.run(command(source, out), capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 1, done.stderr
    kept = int(done.stdout.partition(" kept")[0].rpartition(" ")[2])
    assert len(before) - 1 <= kept <= len(before)  # one label image may have had no line yet
    same = sum(os.stat(out / name).st_mtime_ns == time_ns for name, time_ns in before.items())
    assert same == kept
    assert_equal(out, undisturbed)


def test_one_more_run_computes_nothing(source: Path, undisturbed: Path, tmp_path: Path) -> None:
    out = shutil.copytree(undisturbed, tmp_path / "out")
    summary = run(source, out)
    assert summary.progress == Progress(COUNT, COUNT - 1, 0, 1)
    assert [name for name, _ in summary.failures] == [FAILING]
    assert_equal(out, undisturbed)


DAMAGES = [b'{"frame": "f0', b"\x00\xff\n", b"[]\n", b'{"frame": 3}\n', b"[" * 100_000 + b"\n"]
LEAVING = [
    "../f",
    "a/../../f",
    "/etc/f",
    "",
    ".",
    "..",
    "a//b",
    "a/",
    "a\\b",
    "c:f",
    ".f",
    "a\0b",
    "con",
    "x" * 300,
    "f ",
]


@pytest.mark.parametrize("damage", DAMAGES, ids=range(len(DAMAGES)))
def test_a_damaged_line_costs_no_more_than_its_frame(
    source: Path, undisturbed: Path, tmp_path: Path, damage: bytes
) -> None:
    out = shutil.copytree(undisturbed, tmp_path / "out")
    lines = (out / FILE).read_bytes().splitlines(keepends=True)
    is_last = not damage.endswith(b"\n")
    (out / FILE).write_bytes(b"".join([*lines[:-1], damage] if is_last else [lines[0], damage, *lines[2:]]))
    if is_last:
        summary = run(source, out)
    else:
        with pytest.warns(UserWarning, match="1 damaged lines are skipped"):
            summary = run(source, out)
    assert summary.progress == Progress(COUNT, COUNT - 2, 1, 1)
    assert_equal(out, undisturbed)


def test_lost_and_cut_files_are_made_again(source: Path, undisturbed: Path, tmp_path: Path) -> None:
    out = shutil.copytree(undisturbed, tmp_path / "out")
    (out / "labels" / "f01.png").unlink()
    os.truncate(out / "objects" / "f02.json", 10)
    os.truncate(out / "labels" / "f03.png", 0)
    (out / "objects.parquet").unlink()
    assert run(source, out).progress == Progress(COUNT, COUNT - 4, 3, 1)
    assert_equal(out, undisturbed)


def test_changed_inputs_and_presets_are_computed_again(source: Path, undisturbed: Path, tmp_path: Path) -> None:
    frames, out = shutil.copytree(source, tmp_path / "source"), shutil.copytree(undisturbed, tmp_path / "out")
    shutil.copy(frames / "depth" / "f01.png", frames / "depth" / "f02.png")
    (frames / "rgb" / "f03.png").touch()  # another time, the same content
    assert run(frames, out).progress == Progress(COUNT, COUNT - 2, 1, 1)
    (frames / "rgb" / "f04.png").write_bytes(b"damaged since")
    assert run(frames, out).progress == Progress(COUNT, COUNT - 2, 0, 2)
    assert not (out / "labels" / "f04.png").exists()
    jobs = jobs_of(frames, ["f00", "f01"])
    assert run_batch(jobs, sp.TABLE, out, local()).progress == Progress(2, 0, 2, 0)
    shutil.copy(source / "rgb" / "f05.png", frames / "camera.json")  # unreadable for all
    assert run_batch(jobs, sp.TABLE, out, local()).progress == Progress(2, 0, 0, 2)


@dataclass(frozen=True)
class Killer:
    """A job whose worker dies: always, or until a file is there."""

    inner: FrameFiles
    mark: Path
    always: bool

    @property
    def name(self) -> str:
        return self.inner.name

    def stamp(self) -> str:
        return self.inner.stamp()

    def fingerprint(self) -> str:
        return self.inner.fingerprint()

    def read(self) -> sp.Frame:
        if self.always or not self.mark.exists():
            self.mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return self.inner.read()


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_killed_worker_loses_nothing(source: Path, undisturbed: Path, tmp_path: Path) -> None:
    jobs = [Killer(job, tmp_path / job.name, False) if job.name == "f05" else job for job in jobs_of(source)]
    summary = run_batch(jobs, sp.OBJECTS, tmp_path / "out", local(2))
    assert summary.progress == Progress(COUNT, 0, COUNT - 1, 1)
    assert_equal(tmp_path / "out", undisturbed)


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_frame_that_kills_its_worker_fails_alone(source: Path, tmp_path: Path) -> None:
    jobs = [Killer(job, tmp_path / job.name, job.name == "f01") for job in jobs_of(source, ["f00", "f01", "f02"])]
    (tmp_path / "f00").touch()
    (tmp_path / "f02").touch()
    summary = run_batch(jobs, sp.OBJECTS, tmp_path / "out", local(1))
    assert summary.progress == Progress(3, 0, 2, 1)
    assert summary.failures[0][0] == "f01"
    assert "worker process died 3 times" in summary.failures[0][1]


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 256 kB."""
    if sys.platform != "linux" or os.getuid() != 0:
        pytest.skip("needs root, to mount a small disk")
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(disk)], capture_output=True, check=False
    )
    if mounted.returncode:
        pytest.skip("this container mounts nothing")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


def test_a_full_disk_ends_the_run_and_the_next_one_continues(source: Path, undisturbed: Path, small_disk: Path) -> None:
    ballast = small_disk / "ballast"
    ballast.write_bytes(bytes(150_000))
    out = small_disk / "out"
    done = subprocess.run(command(source, out), capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 2
    assert "could not write" in done.stderr
    assert "o space left" in done.stderr
    assert "Traceback" not in done.stderr
    assert 0 < lines_in(out) < COUNT
    ballast.unlink()
    subprocess.run(["mount", "-o", "remount,size=4m", str(small_disk)], check=True)
    done = subprocess.run(command(source, out), capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 1, done.stderr
    assert " 0 kept" not in done.stdout
    assert_equal(out, undisturbed)


@pytest.mark.parametrize("name", LEAVING, ids=range(len(LEAVING)))
def test_a_name_that_could_leave_the_folder_fails(source: Path, tmp_path: Path, name: str) -> None:
    with pytest.raises(FileError, match="expected a frame name that can be a file name"):
        check_name(name)
    (inner,) = jobs_of(source, ["f00"])
    job = FrameFiles(name, inner.color, inner.depth, inner.camera)
    out = tmp_path / "deep" / "out"
    summary = run_batch([job], sp.OBJECTS, out, local())
    assert summary.progress == Progress(1, 0, 0, 1)
    assert sorted(contents(tmp_path)) == ["deep/out/.lock", "deep/out/manifest.jsonl", "deep/out/objects.parquet"]


def test_two_frames_of_one_name_are_refused_before_anything_is_written(source: Path, tmp_path: Path) -> None:
    first = jobs_of(source)[0]
    with pytest.raises(FileError, match=r"expected a different name for each frame, got '.*' more than once"):
        run_batch([first, first], sp.TABLE, tmp_path / "out", local())
    assert not (tmp_path / "out").exists()


def test_names_may_have_folders_and_dots(source: Path, tmp_path: Path) -> None:
    (inner,) = jobs_of(source, ["f00"])
    jobs = [FrameFiles(n, inner.color, inner.depth, inner.camera) for n in ("000001/000023", "t=1.5", "A", "a", "é")]
    summary = run_batch(jobs, sp.OBJECTS, tmp_path, local())
    assert [name for name, _ in summary.failures] == ["a"]
    assert (tmp_path / "labels" / "000001" / "000023.png").is_file()
    assert (tmp_path / "labels" / "t=1.5.png").is_file()


def test_links_in_the_output_lead_nowhere(source: Path, tmp_path: Path) -> None:
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / ".kept-file").write_text("mine")
    out.mkdir()
    (out / "labels").symlink_to(elsewhere)
    with pytest.raises(FileError, match="a symbolic link in the path leads out"):
        place(out, "labels", "f00", ".png")
    summary = run_batch(jobs_of(source, ["f00"]), sp.OBJECTS, out, local())
    assert "a symbolic link in the path leads out" in summary.failures[0][1]
    assert [path.name for path in elsewhere.iterdir()] == [".kept-file"]


@pytest.mark.parametrize("kind", ["ros1.bag", "ros2-mcap"])
def test_the_frames_of_a_bag_are_computed_once(tmp_path: Path, kind: str) -> None:
    pytest.importorskip("rosbags")
    from bags import START_NS, usual_bag

    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    bag, out = usual_bag(kind, frame, pairs=4).write(tmp_path), tmp_path / "out"
    done = subprocess.run(command(bag, out), capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr
    assert "4 images without a partner within 20 ms" in done.stdout
    assert "4 frames: 4 computed, 0 kept, 0 failed" in done.stdout
    with sp.open_source(bag) as source:
        source.on_broken = lambda *_: None
        for one in source:
            labels = cv2.imread(str(out / "labels" / f"{one.name}.png"), cv2.IMREAD_UNCHANGED)
            assert np.array_equal(labels, sp.segment(one).labels)
    stamps = pq.read_table(out / "objects.parquet").column("stamp_ns").to_pylist()
    assert stamps[0] == START_NS and None not in stamps
    again = subprocess.run(command(bag, out), capture_output=True, text=True, check=False, timeout=600)
    assert "4 frames: 0 computed, 4 kept, 0 failed" in again.stdout


def test_the_frames_of_a_data_set_keep_their_names(source: Path, tmp_path: Path) -> None:
    for folder in ("rgb", "depth"):
        lines = [f"{k / 30:.6f} {folder}/f{k:02d}.png" for k in range(3)]
        shutil.copytree(source / folder, tmp_path / "tum" / folder)
        (tmp_path / "tum" / f"{folder}.txt").write_text("\n".join(lines))
    jobs = numbered_frames(str(tmp_path / "tum"), "110,110,59.5,44.5", 0.001)
    summary = run_batch(jobs, sp.OBJECTS, tmp_path / "out", local(2))
    assert summary.progress == Progress(3, 0, 3, 0), summary.failures
    for k, job in enumerate(jobs):
        labels = cv2.imread(str(tmp_path / "out" / "labels" / f"{job.name}.png"), cv2.IMREAD_UNCHANGED)
        assert np.array_equal(labels, sp.segment(jobs_of(source)[k].read()).labels)
    shutil.copy(tmp_path / "tum" / "depth" / "f01.png", tmp_path / "tum" / "depth" / "f02.png")
    assert run_batch(jobs, sp.OBJECTS, tmp_path / "out", local(2)).progress == Progress(3, 2, 1, 0)


@pytest.mark.parametrize("bag", [False, True], ids=["data set", "bag"])
def test_a_frame_that_changed_is_computed_again_in_the_same_process(source: Path, tmp_path: Path, bag: bool) -> None:
    pytest.importorskip("rosbags")
    from bags import usual_bag

    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    flipped = sp.Frame(frame.color[:, ::-1], frame.depth[:, ::-1], frame.camera)
    path, found = tmp_path / ("ros1.bag" if bag else "tum"), []
    for k, shown in enumerate((frame, flipped)):
        path.unlink() if path.is_file() else None
        if bag:
            usual_bag("ros1.bag", shown, pairs=1, unmatched=k, corrupt=0).write(tmp_path)
        else:
            for name, image in (("rgb", shown.color), ("depth", np.uint16(shown.depth * 5000))):
                write_png(path / name / "f.png", image)
                (path / f"{name}.txt").write_text(f"0.0 {name}/f.png\n")
        summary = run_batch(numbered_frames(str(path)), sp.OBJECTS, tmp_path / "out", here)
        assert summary.progress == Progress(1, 0, 1, 0), summary.failures
        found.append((tmp_path / "out" / "objects").glob("*.json").__next__().read_bytes())
    assert found[0] != found[1]


def test_a_source_without_numbered_frames_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numbered, "open_source", lambda *_, **__: Live("camera", Options()))
    with pytest.raises(FileError, match="known number of frames, got camera"):
        numbered_frames("camera")


class Live(Source):
    """A source that has no end."""

    def _frames(self) -> Iterator[sp.Frame]:
        yield from ()


def test_frames_without_objects_beyond_the_reach_are_named_at_the_end(source: Path, tmp_path: Path) -> None:
    words = [*command(source, tmp_path), "--depth-scale", "0.01"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=600)
    assert f"{COUNT - 1} frames with warnings" in done.stderr
    assert "more than the maximum of 2.5 m (rejection.max_distance_m): check depth_scale" in done.stderr


def test_a_script_without_a_main_guard_is_told_to_add_one(source: Path, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    job = f"FrameFiles('a', {str(source / 'rgb' / 'f01.png')!r}, {str(source / 'depth' / 'f01.png')!r}, '60deg', 0.001)"
    script.write_text(
        "from pathlib import Path\nimport spigolo as sp\nfrom spigolo.batch import FrameFiles, local, run_batch\n"
        f"run_batch([{job}], sp.OBJECTS, Path({str(tmp_path / 'out')!r}), local(1))\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False, timeout=600)
    assert 'call run_batch inside the block if __name__ == "__main__":' in done.stderr


def test_two_runs_cannot_share_a_folder(source: Path, tmp_path: Path) -> None:
    with Manifest(tmp_path), pytest.raises(FileError, match="another run writes to"):
        run(source, tmp_path)


@pytest.mark.filterwarnings("ignore:__array__:DeprecationWarning")  # pycocotools with NumPy 2
def test_the_table_holds_what_the_label_images_hold(source: Path, undisturbed: Path) -> None:
    mask_of = pytest.importorskip("pycocotools.mask")
    table = pq.read_table(undisturbed / "objects.parquet")
    rows = table.to_pylist()
    assert {row["frame"] for row in rows} <= {job.name for job in jobs_of(source)} - {FAILING}
    assert [(row["frame"], row["label"]) for row in rows] == sorted((row["frame"], row["label"]) for row in rows)
    assert table.schema.metadata[b"spigolo.digest"].decode() == sp.OBJECTS.digest
    assert len(rows) > COUNT
    for row in rows:
        labels = cv2.imread(str(undisturbed / "labels" / f"{row['frame']}.png"), cv2.IMREAD_UNCHANGED)
        size = [row["image_height_px"], row["image_width_px"]]
        mask = mask_of.decode({"size": size, "counts": row["mask_rle"]})
        assert np.array_equal(mask == 1, labels == row["label"])
        assert mask.sum() == row["area_px"]
    for job in jobs_of(source, ["f00", "f01"]):
        result = sp.segment(job.read())
        facts = [json.loads(json.dumps({"label": o.label, **o.to_dict()})) for o in result]
        found = [row for row in rows if row["frame"] == job.name]
        assert [{name: row[name] for name in facts[0]} for row in found] == facts


@pytest.mark.filterwarnings("ignore:__array__:DeprecationWarning")  # pycocotools with NumPy 2
def test_coco_reads_the_other_table(source: Path, undisturbed: Path, tmp_path: Path) -> None:
    coco = pytest.importorskip("pycocotools.coco")
    out = shutil.copytree(undisturbed, tmp_path / "out")
    summary = run(source, out, table="coco")
    assert summary.progress.computed == 0
    assert not (out / "objects.parquet").exists()
    read = coco.COCO(str(summary.table))
    assert len(read.imgs) == COUNT - 1
    first = read.loadAnns(read.getAnnIds(imgIds=[1]))
    labels = cv2.imread(str(out / "labels" / "f00.png"), cv2.IMREAD_UNCHANGED)
    assert all(np.array_equal(read.annToMask(a) == 1, labels == k) for k, a in enumerate(first, start=1))


def test_an_unknown_table_is_refused_before_the_work(source: Path, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="expected parquet or coco"):
        run(source, tmp_path / "out", table="csv")
    assert writer_of("coco")[0] == "coco.json"
    with pytest.raises(SpigoloError, match="at least one worker"):
        local(0)


@pytest.mark.filterwarnings("ignore:__array__:DeprecationWarning")  # pycocotools with NumPy 2
@pytest.mark.parametrize("shape", [(1, 1), (7, 5), (64, 80)])
@pytest.mark.parametrize("share", [0.0, 0.02, 0.5, 1.0])
def test_compressed_run_lengths_are_those_of_pycocotools(shape: tuple[int, int], share: float) -> None:
    mask_of = pytest.importorskip("pycocotools.mask")
    mask = np.random.default_rng(0).random(shape) < share
    expected = mask_of.encode(np.asfortranarray(mask.astype(np.uint8)))["counts"].decode()
    assert compress(run_lengths(mask)["counts"]) == expected


def square(number: int) -> int:
    if number == 3:
        raise ValueError("three\nis odd")
    return number**2


def test_an_engine_answers_for_every_item() -> None:
    outcomes = dict(local(2)(square, range(20)))
    assert outcomes.pop(3) == Lost("ValueError: three is odd")
    assert outcomes == {k: k**2 for k in range(20) if k != 3}


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    """A Dask scheduler with two workers."""
    distributed = pytest.importorskip("distributed")
    options = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", "silence_logs": 50}
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        with _local_settings(), distributed.LocalCluster(n_workers=2, threads_per_worker=1, **options) as running:
            yield running.scheduler_address


@pytest.mark.filterwarnings("default")
def test_a_cluster_makes_the_same_files(source: Path, undisturbed: Path, tmp_path: Path, cluster: str) -> None:
    jobs = [Killer(job, tmp_path / job.name, False) if job.name == "f05" else job for job in jobs_of(source)]
    summary = run_batch(jobs, sp.OBJECTS, tmp_path / "out", dask_cluster(cluster))
    assert summary.progress == Progress(COUNT, 0, COUNT - 1, 1)
    assert_equal(tmp_path / "out", undisturbed)


@pytest.mark.filterwarnings("default")
def test_a_cluster_answers_for_every_item(cluster: str) -> None:
    for group in (1, 7, None):
        outcomes = dict(dask_cluster(cluster, group)(square, range(50)))
        assert outcomes.pop(3) == Lost("ValueError: three is odd")
        assert outcomes == {k: k**2 for k in range(50) if k != 3}


def deadly(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
@pytest.mark.filterwarnings("default")
def test_an_item_that_kills_its_workers_is_lost_alone(cluster: str) -> None:
    outcomes = dict(dask_cluster(cluster, 4)(deadly, range(8)))
    lost = outcomes.pop(3)
    assert isinstance(lost, Lost) and "died repeatedly" in lost.reason
    assert outcomes == {k: k for k in range(8) if k != 3}


def test_an_item_is_lost_only_if_it_kills_its_workers_alone() -> None:
    """Items 1 and 2 die with 3, as Dask blames all that a lost worker held. Alone, only 3 dies."""
    pytest.importorskip("distributed")
    outcomes: dict[int, int | Lost] = {}
    run = _ClusterRun(FakeClient(), square, range(5), 1)
    futures = run._submit()
    assert len(futures) == 5
    while futures:
        future = futures.pop(0)
        blamed = future.item == 3 or (not run.alone and future.item in (1, 2))
        result = (KilledWorker, KilledWorker(), None) if blamed else _Done([future.item], 1.0)
        outcomes.update(run._collect(future, result))
        following = run._submit()
        assert len(following) <= 1 and not (following and futures)
        futures += following
    assert isinstance(outcomes.pop(3), Lost)
    assert outcomes == {k: k for k in (0, 1, 2, 4)}


class KilledWorker(Exception):  # noqa: N818
    """Stands in for Dask's error of this name."""


class FakeFuture:
    def __init__(self, item: int) -> None:
        self.item = item

    def release(self) -> None:
        """Do nothing."""


class FakeClient:
    """Cluster of five threads, whose tasks end when the test says so."""

    status = "running"

    def nthreads(self) -> dict[str, int]:
        return {"worker": 5}

    def submit(self, do: object, work: object, group: list[int], pure: bool) -> FakeFuture:
        return FakeFuture(group[0])


@pytest.mark.filterwarnings("default")
def test_a_cluster_without_workers_is_refused_after_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr("spigolo.batch.cluster.CHECK_S", 0.05)
    monkeypatch.setattr("spigolo.batch.cluster.WORKERLESS_S", 0.2)
    options = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", "silence_logs": 50}
    with (
        distributed.LocalCluster(n_workers=0, **options) as empty,
        pytest.raises(SpigoloError, match="expected a worker in the Dask cluster, but there was none"),
    ):
        list(dask_cluster(empty.scheduler_address)(square, range(4)))


@pytest.mark.filterwarnings("default")
def test_a_foreign_or_lost_scheduler_ends_the_run(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    words = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    address = tmp_path / "scheduler.json"
    with quiet([*words, "--no-dashboard", "--scheduler-file", str(address)]) as scheduler:
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(address), "--no-nanny"]
        with quiet([*worker, "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"]):
            deadline = time.monotonic() + 60
            while not (address.exists() and address.read_text().endswith("}")):
                assert time.monotonic() < deadline, "the scheduler did not start"
                time.sleep(0.02)
            engine = dask_cluster(json.loads(address.read_text())["address"], 1)
            with pytest.raises(SpigoloError, match=r"cannot run the jobs: .* different environments"):
                list(engine(square, range(4)))  # this module is unknown to the scheduler
            outcomes = iter(engine(time.sleep, [0.05] * 10_000))
            assert next(outcomes) == (0.05, None)
            scheduler.kill()
            with pytest.raises(SpigoloError, match="the connection to the Dask scheduler is lost"):
                list(outcomes)


@contextmanager
def quiet(words: list[str]) -> Iterator[subprocess.Popen[bytes]]:
    """A process that is killed at the end."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


class DeafQueue:
    """Queue of results that the results never reach."""

    def has_ready(self) -> bool:
        return False

    def update(self, futures: list[object]) -> None:
        """Do nothing."""


@pytest.mark.parametrize("killed", [True, False])
def test_a_failure_that_the_queue_never_tells_is_seen(killed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("spigolo.batch.cluster.CHECK_S", 0.0)
    error = KilledWorker() if killed else ValueError("no")
    tasks: list[object] = []

    class Failed:
        status = "error"

        def exception(self) -> Exception:
            return error

        def release(self) -> None:
            """Do nothing."""

    def submit(*words: object, pure: bool) -> Failed:
        tasks.append(words)
        return Failed()

    client = SimpleNamespace(submit=submit, nthreads=lambda: {"worker": 1}, status="running", loop=None)
    run = _ClusterRun(client, square, [7], 1)
    outcomes = list(run.outcomes(SimpleNamespace(as_completed=lambda *_, **__: DeafQueue())))
    reason = "the worker process died repeatedly, probably because memory ran out" if killed else "ValueError: no"
    assert outcomes == [(7, Lost(reason))]
    assert len(tasks) == (3 if killed else 2)  # the function, the item, and the item alone


def test_tasks_hold_as_many_items_as_take_a_second() -> None:
    pytest.importorskip("distributed")
    run = _ClusterRun(None, square, range(5000), None)
    assert [len(run._next_group()), run._size()] == [1, 1]
    for seconds, expected in ((0.1, 10), (3.0, 1), (0.0, MAX_GROUP), (1e-5, MAX_GROUP)):
        run.item_s.extend([seconds] * RECENT)
        assert len(run._next_group()) == expected
    run.again.append(17)
    assert run._next_group() == [17]


def test_a_cluster_of_this_machine_starts_by_name(source: Path, undisturbed: Path, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    out = tmp_path / "out"
    arguments = [*command(source, out), "--scheduler", "local"]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 1, done.stderr
    assert f"{COUNT} frames: {COUNT - 1} computed, 0 kept, 1 failed" in done.stdout
    assert "Traceback" not in done.stderr
    assert_equal(out, undisturbed)
    with pytest.raises(SpigoloError, match="at least one worker"):
        dask_local(0)


def page_faults(_: int) -> int:
    resource = pytest.importorskip("resource")
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    segmenter = sp.Segmenter(sp.TABLE)
    for number in range(8):
        if number == 5:
            before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
        segmenter(frame)
    return int(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)


@pytest.mark.filterwarnings("default")
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="memory is freed as glibc does it")
def test_a_cluster_keeps_freed_memory_and_the_environment() -> None:
    pytest.importorskip("distributed")
    before = dict(os.environ)
    assert dict(dask_local(1)(page_faults, [0]))[0] < 600
    assert dict(os.environ) == before


def test_workers_of_another_cluster_cannot_be_chosen() -> None:
    with pytest.raises(ConfigError, match="Only --scheduler local starts a new cluster with -j workers"):
        choose_cluster("tcp://127.0.0.1:9", 2, "-j")


def slow_first(number: int) -> int:
    time.sleep(0.2 * (number == 0))
    return number


def test_outcomes_come_in_the_order_of_the_items() -> None:
    assert list(in_order(local(2), slow_first, range(6))) == list(range(6))
    assert list(in_order(here, square, [1, 2, 4])) == [1, 4, 16]
    with pytest.raises(ValueError, match="three"):
        list(in_order(here, square, range(5)))


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_worker_that_dies_leaves_its_place_in_the_order() -> None:
    outcomes = list(in_order(local(2), deadly, range(6)))
    assert isinstance(outcomes[3], Lost)
    assert [k for k in outcomes if not isinstance(k, Lost)] == [0, 1, 2, 4, 5]


def test_a_scheduler_that_is_not_there_is_named(source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("spigolo.batch.cluster.TIMEOUT_S", 1)
    with pytest.raises(SpigoloError, match="expected a Dask scheduler at tcp://"):
        run_batch(jobs_of(source, ["f00"]), sp.OBJECTS, tmp_path, dask_cluster("tcp://127.0.0.1:9"))
