"""`spigolo bench`: its figures from given times, its peers, its report. Nothing here depends on how fast it is."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError, SpigoloError
from spigolo.lab.bench import QUICK, Plan, Report, bench, contestants, markdown, tables
from spigolo.lab.bench import report as bench_report
from spigolo.lab.bench.contestants import CONFIGS, Comparison, check_merging, compare, mergings
from spigolo.lab.bench.figures import fit_power_law, paired_ratio, percentile, summarise
from spigolo.lab.bench.peers import PACKAGES, open_peers
from spigolo.lab.bench.resources import measure_memory
from spigolo.lab.bench.scaling import growth, rescaled
from spigolo.lab.bench.stages import PARTS, STAGES, time_stages
from spigolo.lab.bench.textbook import sort_and_merge
from spigolo.lab.bench.timing import Sample, run_rounds, timed
from spigolo.stages.graph import Graph
from spigolo.stages.regions import partition
from spigolo.view.chart import Axis, Curve, log_log

SCENE = Path(sp.__file__).parent / "demo_scene"
PEERS = Path(__file__).resolve().parents[1] / ".venv-oracle" / "bin" / "python"
TINY = Plan(rounds=2, size_rounds=1, sizes=((64, 48), (96, 72)), frames=2, repeats=1, latency=3)

compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")


def samples(*cpu: float) -> list[Sample]:
    return [Sample(c, 2 * c) for c in cpu]


@pytest.fixture(scope="module")
def scene() -> sp.Frame:
    return sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")


@pytest.fixture(scope="module")
def small(scene: sp.Frame) -> sp.Frame:
    return rescaled(scene, (96, 72))


@pytest.fixture(scope="module")
def report(small: sp.Frame) -> Report:
    return bench({"small": small, "again": small}, TINY, Path(sys.executable))


# --- figures --------------------------------------------------------------------------------------------------


def test_a_summary_holds_medians_and_minima() -> None:
    summary = summarise(samples(5, 1, 3, 4))
    assert (summary.cpu_ms, summary.cpu_min_ms, summary.wall_ms, summary.wall_min_ms) == (3.5, 1, 7, 2)


def test_a_ratio_is_the_median_of_the_ratios_within_the_rounds() -> None:
    assert paired_ratio(samples(6, 10, 100), samples(1, 10, 10)) == 6  # of 6, 1, 10; that of the medians is 1
    assert paired_ratio(samples(4, 9), samples(2, 3)) == 2.5


def test_pairs_do_the_same_task() -> None:
    taken = {
        "TABLE 8c": samples(10, 20), "GraphSegmentation": samples(30, 40), "fine_grained_saliency": samples(1, 1),
        "StaticSaliencyFineGrained": samples(5, 7), "merging, TABLE 8c": samples(2, 4),
        "textbook merging, TABLE 8c": samples(8, 8),
    }  # fmt: skip
    assert compare(taken) == [
        Comparison("GraphSegmentation", "TABLE 8c", 2.5),
        Comparison("StaticSaliencyFineGrained", "fine_grained_saliency", 6),
        Comparison("textbook merging, TABLE 8c", "merging, TABLE 8c", 3),
    ]


def test_the_exponent_of_a_power_law_is_found_exactly() -> None:
    x = [3.0, 10.0, 40.0, 1000.0]
    law = fit_power_law(x, [0.7 * v**1.25 for v in x])
    assert law.exponent == pytest.approx(1.25, abs=1e-12)
    assert law.factor == pytest.approx(0.7)
    assert law.residual == pytest.approx(0, abs=1e-12)


def test_the_residual_of_a_fit_is_the_deviation_of_the_logarithms() -> None:
    law = fit_power_law([1, 1, 2, 2], [math.exp(0.1), math.exp(-0.1), 2 * math.exp(0.1), 2 * math.exp(-0.1)])
    assert law.exponent == pytest.approx(1)
    assert law.residual == pytest.approx(0.1)


def test_growth_fits_both_laws_and_compares_pixels() -> None:
    sizes = [(640, 480), (1920, 1080), (320, 240)]
    pixels = [w * h for w, h in sizes]
    found = growth(sizes, [samples(n * math.log(n)) for n in pixels])
    assert found.pixels_log is not None
    assert found.pixels is not None
    assert found.pixels_log.exponent == pytest.approx(1)
    assert 1 < found.pixels.exponent < 1.2
    assert found.hd_per_vga == pytest.approx(math.log(1920 * 1080) / math.log(640 * 480))
    assert growth(sizes[:1], [samples(3)]).pixels is None
    assert growth(sizes[:1], [samples(3)]).hd_per_vga is None


def test_the_99th_percentile_is_one_of_the_values() -> None:
    values = [float(v) for v in range(1, 1001)]
    assert percentile(values, 0.99) == 990
    assert percentile([7.0], 0.99) == 7


# --- rounds ---------------------------------------------------------------------------------------------------


def test_every_round_runs_everybody_once_in_changing_order_after_one_that_does_not_count() -> None:
    ran: list[str] = []

    def contestant(name: str) -> Sample:
        ran.append(name)
        return Sample(float(len(ran)), 0.0)

    told: list[float] = []
    taken = run_rounds(
        {name: lambda name=name: contestant(name) for name in "abcd"}, 6, lambda what, done: told.append(done)
    )
    rounds = ["".join(ran[k : k + 4]) for k in range(0, len(ran), 4)]
    assert [sorted(r) for r in rounds] == [list("abcd")] * 7
    assert len(set(rounds)) > 2
    assert all(len(s) == 6 and min(t.cpu_ms for t in s) > 4 for s in taken.values())
    assert told == sorted(told)


def test_timed_work_runs_once_and_takes_time() -> None:
    calls: list[int] = []
    sample = timed(lambda: calls.append(1))()
    assert calls == [1]
    assert sample.cpu_ms > 0
    assert sample.wall_ms > 0


# --- merging --------------------------------------------------------------------------------------------------


@compiled
@pytest.mark.parametrize("planes", [2, 4])
@pytest.mark.parametrize("levels", [3, 1000])
def test_the_textbook_gives_our_regions(planes: int, levels: int) -> None:
    rng = np.random.default_rng(planes * levels)
    weights = (rng.integers(0, levels, (planes, 23, 31)) / levels).astype(np.float32)
    weights[[0, 2, 3][: planes - 1], :, -1] = np.inf
    weights[[1, 2][: planes // 2], -1] = np.inf
    weights[3:, 0] = np.inf
    for gamma in (0.0, 0.05, 2.0):
        config = sp.TABLE.replace(partition={"gamma": gamma, "min_size_px2": 0})
        graph = Graph(weights)
        check_merging(graph, config)
        assert partition(graph, gamma).count == sort_and_merge(graph, gamma).max() + 1


def test_regions_that_differ_stop_the_comparison(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = Graph(np.zeros((2, 4, 4), np.float32))
    graph.weights[0, :, -1] = graph.weights[1, -1] = np.inf
    graph.weights[0, :, 1] = 5
    check_merging(graph, sp.TABLE)
    monkeypatch.setattr(contestants, "partition", lambda graph, gamma: partition(graph, gamma, min_size_px=1e6))
    with pytest.raises(SpigoloError, match="textbook"):  # joining small regions is not the textbook's
        check_merging(graph, sp.TABLE)


@compiled
def test_merging_is_compared_on_the_graphs_of_the_presets(small: sp.Frame) -> None:
    assert list(mergings(small)) == [
        "merging, TABLE 8c", "textbook merging, TABLE 8c", "merging, SHELF 8c", "textbook merging, SHELF 8c",
    ]  # fmt: skip


# --- frames and stages ----------------------------------------------------------------------------------------


def test_a_rescaled_frame_keeps_its_depths_and_its_view(scene: sp.Frame) -> None:
    for size in ((64, 48), (900, 700)):
        frame = rescaled(scene, size)
        assert frame.depth.shape == frame.color.shape[:2] == size[::-1]
        assert np.isin(frame.depth, scene.depth).all()
        assert frame.camera is not None
        assert scene.camera is not None
        assert frame.camera.fx / size[0] == pytest.approx(scene.camera.fx / 640)
        assert frame.color.mean() == pytest.approx(scene.color.mean(), abs=1.5)


@compiled
def test_the_stages_are_those_of_the_configuration(small: sp.Frame) -> None:
    taken = time_stages(small, {"table": sp.TABLE, "shelf": sp.SHELF, "objects": sp.OBJECTS}, rounds=2)
    assert set(PARTS.values()) <= set(STAGES)
    assert set(taken["table"]) == {*STAGES, "depth: in-painting", "depth: smoothing"}
    assert set(taken["shelf"]) == {*STAGES, "depth: smoothing", "saliency"} - {"edges"}
    assert set(taken["objects"]) == {*STAGES, "depth: in-painting", "depth: smoothing"}
    assert all(len(runs) == 2 for stages in taken.values() for runs in stages.values())


# --- peers ----------------------------------------------------------------------------------------------------


def test_an_interpreter_that_is_none_is_said(tmp_path: Path) -> None:
    for path in (tmp_path / "python", tmp_path):
        with pytest.raises(FileError, match="expected a Python interpreter in"), open_peers(path):
            pass
    other = tmp_path / "other"
    other.write_text("#!/bin/sh\necho not an interpreter >&2\n")
    other.chmod(0o755)
    with pytest.raises(FileError, match="ended unexpectedly: not an interpreter"), open_peers(other):
        pass


def test_missing_peers_are_a_line_each(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # no .venv-oracle here
    with open_peers() as peers:
        here = set(peers.names)
        missing = peers.missing
    assert len(missing) == len({PACKAGES[name] for name in set(PACKAGES) - here})
    for line in missing:
        assert "\n" not in line
        assert "pip install" in line
    if "GraphSegmentation" not in here:
        assert any("GraphSegmentation" in line and "opencv-contrib-python-headless" in line for line in missing)


def require_peers() -> Path:
    if not PEERS.exists():
        message = "the oracle's environment is absent: make test builds it"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    return PEERS


@pytest.mark.oracle
def test_all_peers_run_on_the_image_they_are_given(small: sp.Frame) -> None:
    with open_peers(require_peers()) as peers:
        assert peers.names == list(PACKAGES)
        assert peers.missing == []
        assert {"python", "opencv", "scikit-image"} <= set(next(iter(peers.versions.values())))
        peers.load("a", small.color)
        taken = run_rounds(peers.contestants("a"), 2)
        assert all(s.cpu_ms > 0 and s.wall_ms > 0 for runs in taken.values() for s in runs)
        with pytest.raises(SpigoloError, match="KeyError"):
            peers.contestants("b")["felzenszwalb"]()
        assert peers.contestants("a")["felzenszwalb"]().cpu_ms > 0  # it goes on


@pytest.mark.oracle
@compiled
def test_peers_take_part_in_the_contest(small: sp.Frame) -> None:
    done = bench({"small": small}, TINY, require_peers())
    rivals = {pair.peer for pair in done.contests[0].comparisons}
    assert set(PACKAGES) <= rivals
    assert "GraphSegmentation" in done.growth
    assert done.missing == []


# --- report ---------------------------------------------------------------------------------------------------


@compiled
def test_the_report_as_json_has_everything(report: Report) -> None:
    values = json.loads(json.dumps(report.to_json(), allow_nan=False))
    assert set(values) == {
        "machine", "plan", "peers", "missing", "contests", "growth", "stages", "memory", "throughput", "latency",
        "startup",
    }  # fmt: skip
    assert set(values["machine"]) == {"cpu", "cores", "system", "load", "versions"}
    assert set(values["machine"]["versions"]) == {"spigolo", "python", "numpy", "numba", "llvmlite", "opencv"}
    assert [c["frame"] for c in values["contests"]] == ["small", "again"]
    contest = values["contests"][0]
    assert (contest["width"], contest["height"]) == (96, 72)
    assert set(CONFIGS) <= set(contest["samples"]) == set(contest["summaries"])
    assert all(len(rounds) == TINY.rounds for rounds in contest["samples"].values())
    pair = contest["comparisons"][0]
    raw = [[s["cpu_ms"] for s in contest["samples"][pair[side]]] for side in ("peer", "ours")]
    assert pair["ratio"] == pytest.approx(sum(p / o for p, o in zip(*raw, strict=True)) / 2)
    assert set(values["growth"]) >= {"TABLE 8c", "SHELF 8c"}
    assert len(values["growth"]["TABLE 8c"]["samples"]) == len(TINY.sizes)
    assert set(values["stages"]) == {"OBJECTS 4c", "TABLE 8c", "SHELF 8c", "CLUTTER 8c"}
    assert values["throughput"]["frames"] == 2
    assert values["latency"]["frames"] == len(values["latency"]["samples"]) == 3
    assert values["latency"]["median_ms"] <= values["latency"]["p99_ms"] <= values["latency"]["worst_ms"]
    assert 0 < values["startup"]["opencv_s"] < values["startup"]["warm_s"]
    assert values["startup"]["cold_s"] is None


@compiled
def test_memory_is_counted_by_pixel(report: Report) -> None:
    for name, memory in report.memory.items():
        assert 10 < memory.workspace < 200, name
        assert 10 < memory.answer < memory.frame < 1000, name


@compiled
@pytest.mark.parametrize(("preset", "most"), [("TABLE", 60), ("SHELF", 60), ("OBJECTS", 90)])
def test_a_frame_takes_few_bytes_a_pixel_beyond_its_answer(preset: str, most: int, scene: sp.Frame) -> None:
    """Outlines by colour take the largest part with OBJECTS: the colour of the tree at every pixel."""
    memory = measure_memory(scene, CONFIGS[f"{preset} 8c"])
    assert memory.workspace + memory.frame - memory.answer <= most


@compiled
def test_the_tables_hold_a_cell_for_each_column(report: Report) -> None:
    titles = []
    for table in tables(report):
        titles.append(table.title)
        assert all(len(row) == len(table.head) for row in table.rows)
        assert table.rows
    assert len(titles) == len(set(titles)) == 12
    text = markdown(report)
    assert text.count("\n## ") == len(titles)
    assert "| TABLE 4c |" in text


@compiled
def test_a_method_that_is_registered_takes_part(small: sp.Frame, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sp.METHODS, "nothing", lambda frame: None)
    monkeypatch.setattr(bench_report, "measure_startup", lambda *_: None)
    done = bench({"small": small}, Plan(rounds=1, sizes=(), frames=1, repeats=1), Path(sys.executable))
    assert "nothing" in done.contests[0].samples
    assert {pair.ours for pair in done.contests[0].comparisons if pair.peer == "nothing"} == set(CONFIGS)
    assert done.growth == {}


def test_a_chart_draws_each_curve_in_its_colour() -> None:
    curves = [Curve("one\ntwo lines", [1, 2, 5], [3, 6, 15]), Curve("other", [1, 2, 5], [30, 40, 90])]
    picture = log_log(curves, "title", "x", "y", "note")
    for tint in ((31, 98, 184), (214, 92, 20)):
        near = np.abs(picture.astype(int) - tint).max(axis=2) < 12
        assert np.count_nonzero(near) > 1500
    assert np.array_equal(picture[0], np.full_like(picture[0], 255))


def test_a_logarithmic_axis_has_ticks_at_1_2_5() -> None:
    axis = Axis(0.09, 6.0, 100, 500)
    assert axis.ticks == [0.1, 0.2, 0.5, 1, 2, 5]
    assert axis(0.09) == 100
    assert axis(6.0) == pytest.approx(500)
    assert axis(math.sqrt(0.09 * 6)) == pytest.approx(300)


# --- command line ---------------------------------------------------------------------------------------------


def spigolo(*words: object, folder: Path) -> subprocess.CompletedProcess[str]:
    code = "from spigolo.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, words)],
        cwd=folder, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip


def write_frame(frame: sp.Frame, folder: Path) -> Path:
    folder.mkdir()
    cv2.imwrite(str(folder / "rgb.png"), frame.color[..., ::-1])
    np.save(folder / "depth.npy", frame.depth)
    camera = frame.camera
    assert camera is not None
    values = {key: getattr(camera, key) for key in ("fx", "fy", "cx", "cy", "width", "height")}
    (folder / "camera.json").write_text(json.dumps(values))
    return folder


@compiled
def test_bench_prints_its_tables_and_writes_its_files(small: sp.Frame, tmp_path: Path) -> None:
    done = spigolo(
        "bench", write_frame(small, tmp_path / "tiny"), "--quick", "--rounds", 1, "--sizes", "64x48,96x72,128x96",
        "--json", "out/bench.json", "--plot", "out/plot.png", "--markdown", "out/bench.md",
        folder=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    for text in ("Machine", "tiny 96x72", "TABLE 4c", "Time by stage", "bytes per pixel", "frames/s"):
        assert text in done.stdout, text
    values = json.loads((tmp_path / "out" / "bench.json").read_text())
    assert values["plan"]["rounds"] == values["plan"]["size_rounds"] == 1
    assert values["plan"]["sizes"] == [[64, 48], [96, 72], [128, 96]]
    assert values["plan"]["frames"] == QUICK.frames
    assert cv2.imread(str(tmp_path / "out" / "plot.png")).shape == (720, 1120, 3)
    assert (tmp_path / "out" / "bench.md").read_text().startswith("# Benchmark")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--sizes", "640"], "expected --sizes as 640x480"),
        (["--sizes", "0x5"], "expected --sizes as 640x480"),
        (["--sizes", "99999x9999"], "at most"),
        (["--sizes", "none", "--plot", "p.png"], "expected sizes to plot"),
        (["--rounds", "0"], "at least one round"),
        (["--latency", "-1"], "number of frames"),
        (["nowhere"], "there is no nowhere"),
        (["--quick", "--peers", "nowhere/python"], "expected a Python interpreter in nowhere/python"),
    ],
)
def test_wrong_words_end_with_2_and_one_sentence(words: list[str], sentence: str, tmp_path: Path) -> None:
    done = spigolo("bench", *words, folder=tmp_path)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []
