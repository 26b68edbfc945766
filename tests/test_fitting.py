"""Fitting: settings drawn, tried, chosen, and scored on frames that had no say in the choice."""

from __future__ import annotations

import gzip
import json
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import spigolo as sp
from spigolo.cli import FAILED
from spigolo.errors import ConfigError, FileError, SpigoloError
from spigolo.lab.evaluation import Row, pool, read_rows
from spigolo.lab.experiments import Method, Toscana2016, evaluate, find_labelled_frames
from spigolo.lab.fitting import (
    Choice,
    Range,
    Search,
    Subject,
    Switch,
    Trial,
    apply,
    best_trial,
    draw,
    fitted,
    goodness,
    hold_out,
    hold_out_sets,
    read_search,
    search,
    space_of,
    write_fit,
)
from spigolo.lab.fitting.report import make_page
from spigolo.lab.fitting.spaces import CONTOURS, JOINING, SUPPORT
from spigolo.lab.fitting.trials import Place
from spigolo.lab.page import to_markdown
from spigolo.lab.studies.objects_preset import source_of
from spigolo.settings.parameters import parse_toml
from test_experiments import BOXES, Counting, row, spigolo, write_frame

ROOT = Path(__file__).resolve().parents[1]
SCENE = Path(sp.__file__).parent / "demo_scene"
STARTS: list[Method] = [*map(Toscana2016, (sp.TABLE, sp.SHELF, sp.CLUTTER, sp.OBJECTS)), *list(sp.METHODS.values())[1:]]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Four frames in which every object is labelled, two of them near-identical, and one without labels."""
    folder = tmp_path / "frames"
    for k in range(5):
        write_frame(folder / "osd-small" / f"f{k}", 4 * k, truth=k < 4)
    (folder / "splits.json").write_text(json.dumps({"near_duplicate_groups": [["osd-small/f0", "osd-small/f1"]]}))
    return folder


def name_of(method: Method) -> str:
    return f"{method.name}-{method.preset}"


# --- spaces -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("start", STARTS, ids=name_of)
def test_what_is_drawn_is_within_the_space_and_makes_a_method(start: Method) -> None:
    space = space_of(start)
    drawn = draw(space, 40, seed=3)
    made = [apply(setting, start) for setting in drawn]
    assert len({method.digest for method in (start, *made)}) == 41
    for setting in drawn:
        for name, value in setting.items():
            match space[name]:
                case Range(low=low, high=high):
                    assert low <= value <= high
                    assert isinstance(value, type(low))
                case Choice(options=options):
                    assert value in options
                case Switch(on=on):
                    assert value in (None, on)


def test_every_value_of_a_setting_reaches_the_method() -> None:
    for start in STARTS:
        setting = draw(space_of(start), 1, seed=5)[0]
        for name, value in setting.items():
            got = apply(setting, start).parameters
            for key in name.split("."):
                got = got[key]
            assert isinstance(got, dict) if isinstance(value, dict) else got == value, name


def test_a_stage_that_is_off_has_no_numbers_and_joining_has_its_support() -> None:
    drawn = draw(space_of(Toscana2016(sp.TABLE)), 60, seed=0)
    for stage in (SUPPORT, CONTOURS, JOINING):
        states = {setting[stage] is None for setting in drawn}
        assert states == {True, False}
        for setting in drawn:
            assert any(name.startswith(f"{stage}.") for name in setting) == (setting[stage] is not None)
    assert all(setting[JOINING] is None for setting in drawn if setting[SUPPORT] is None)
    assert not {SUPPORT, CONTOURS, JOINING} & space_of(Toscana2016(sp.OBJECTS)).keys()


def test_more_draws_begin_with_the_same_and_follow_the_seed() -> None:
    space = space_of(sp.METHODS["rao2010"])
    assert draw(space, 9, seed=1)[:4] == draw(space, 4, seed=1) != draw(space, 4, seed=2)


def test_what_has_no_space_is_refused() -> None:
    auto = sp.TABLE.replace(cost={"kind": "auto"}, partition={"gamma_shadows": 5.0})
    with pytest.raises(ConfigError, match="expected a preset with one cost function, got TABLE"):
        space_of(Toscana2016(auto))

    with pytest.raises(ConfigError, match="expected a method that can be fitted, got 'counting'"):
        space_of(Counting())


def test_without_optuna_one_sentence_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "optuna", None)
    with pytest.raises(SpigoloError, match=r'installed: pip install "spigolo\[fit\]"'):
        draw({"k": Range(1.0, 2.0)}, 1, seed=0)


# --- choosing -----------------------------------------------------------------------------------------------


def tried(*overlaps: dict[str, float], groups: dict[str, str] | None = None) -> Search:
    """Trials with the overlap F of each frame; all find the same."""
    names = list(overlaps[0])
    of = {name: (groups or {}).get(name, name) for name in names}
    places = tuple(Place("s", name, of[name], "full") for name in names)
    trials = tuple(
        Trial(k, {}, tuple(row(name, overlap_f=f, group=of[name]) for name, f in frames.items()))
        for k, frames in enumerate(overlaps)
    )
    return Search(Subject("m", "P", "d", 0, places), trials)


def test_goodness_is_worked_by_hand() -> None:
    rows = [
        row("a", overlap_f=0.9, n_objects=4, true_positives=3),
        row("b", overlap_f=0.5, n_objects=2, true_positives=0, group="g"),
        row("c", overlap_f=0.7, n_objects=2, true_positives=2, group="g"),
        row("d", overlap_f=0.1, n_objects=4, true_positives=4, labelling="part"),
    ]
    assert goodness(rows) == pytest.approx((3 + 1 + 4) / (4 + 2 + 4) + (0.9 + 0.6) / 2)
    assert goodness([row("e", score=None)]) == 0


def test_a_frame_is_scored_by_the_setting_that_is_best_on_the_others() -> None:
    """Each trial is good on one frame alone, so that no frame gets the trial that is good on it."""
    made = tried({"a": 1.0, "b": 0.0, "c": 0.2}, {"a": 0.1, "b": 0.9, "c": 0.0}, {"a": 0.0, "b": 0.2, "c": 0.8})
    held = {one.frame: one.score.overlap_f for one in hold_out(made, 3).rows if one.score}
    assert held == {"a": 0.0, "b": 0.0, "c": 0.2}
    assert best_trial(tried({"a": 0.5}, {"a": 0.7}, {"a": 0.7}).trials).number == 1


def test_near_identical_frames_have_no_say_about_each_other() -> None:
    """Trial 1 is best on a and its twin; were they apart, each would choose it for the other."""
    twins = tried({"a": 0.1, "twin": 0.1, "b": 0.9}, {"a": 1.0, "twin": 1.0, "b": 0.0}, groups={"twin": "a"})
    held = {one.frame: one.score.overlap_f for one in hold_out(twins, 2).rows if one.score}
    assert held == {"a": 0.1, "twin": 0.1, "b": 0.0}
    with pytest.raises(SpigoloError, match=r"distinct labelled frames \(2\), got 3: give another --folds"):
        hold_out(twins, 3)


def test_a_set_is_scored_by_the_setting_that_is_best_on_the_others() -> None:
    """Each trial is good on the frames of one set alone."""
    made = tried({"a": 1.0, "b": 0.9, "c": 0.2}, {"a": 0.1, "b": 0.0, "c": 0.8})
    with pytest.raises(SpigoloError, match="expected frames of at least two different data sets, got s"):
        hold_out_sets(made)
    made = in_sets(made, "left", "left", "right")
    held = {one.frame: one.score.overlap_f for one in hold_out_sets(made).rows if one.score}
    assert held == {"a": 0.1, "b": 0.0, "c": 0.2}
    assert [trial.number for trial in hold_out_sets(made).chosen] == [1, 0]
    assert [trial.number for trial in hold_out_sets(made, with_start=False).chosen] == [1, 1]
    twins = in_sets(tried({"a": 1.0, "b": 0.9}, {"a": 0.1, "b": 0.0}, groups={"b": "a"}), "left", "right")
    with pytest.raises(SpigoloError, match="different data sets, got left, right"):
        hold_out_sets(twins)  # neither has anything to choose by
    first, second = {"a": 0.5, "d": 0.5, "twin": 0.9, "c": 0.1}, {"a": 0.5, "d": 0.5, "twin": 0.0, "c": 0.8}
    shared = in_sets(tried(first, second, groups={"twin": "a"}), "left", "left", "right", "right")
    assert hold_out_sets(shared).chosen[0].number == 1  # the twin has no say about a


def test_sets_of_one_source_are_left_out_together() -> None:
    made = in_sets(tried({"a": 0.9, "b": 0.2, "c": 0.3}, {"a": 0.5, "b": 0.9, "c": 0.8}), "osd-full", "osd-mosd-b", "x")
    alone = hold_out_sets(made)
    together = hold_out_sets(made, source_of=source_of)
    assert len(alone.chosen) == 3 and len(together.chosen) == 2
    assert {source_of(name) for name in ("osd-mosd", "osd-full-b")} == {"osd"}
    assert source_of("hand-uoc-b") == source_of("hand-uoc") == "hand-uoc"


def in_sets(made: Search, *names: str) -> Search:
    """The same trials of frames of these sets."""
    places = tuple(replace(place, data_set=name) for place, name in zip(made.subject.places, names, strict=True))
    trials = tuple(
        replace(trial, rows=tuple(replace(r, data_set=name) for r, name in zip(trial.rows, names, strict=True)))
        for trial in made.trials
    )
    return Search(replace(made.subject, places=places), trials)


def test_the_report_says_what_a_set_left_out_gets_where_there_are_several() -> None:
    made, start = tried({"a": 0.5, "b": 0.5}, {"a": 0.9, "b": 0.2}), Toscana2016(sp.TABLE)
    one = to_markdown(make_page(made, hold_out(made, 2), start))
    assert "set held out" not in one and "The scores do not show" in one
    several = in_sets(made, "left", "right")
    text = to_markdown(make_page(several, hold_out(several, 2), start))
    assert "set held out: each data set is scored with the setting that is best on the other data sets" in text
    assert "| left | start |" in text and "The scores do not show" not in text
    compared = text[text.index("Held-out scores minus the scores of the start:") :]
    assert "| held out |" in compared and "| set held out |" not in compared


def test_the_start_is_left_out_where_it_was_made_on_the_frames() -> None:
    three = tried({"a": 1.0, "b": 1.0}, {"a": 0.5, "b": 0.4})
    assert {trial.number for trial in hold_out(three, 2).chosen} == {0}
    assert {trial.number for trial in hold_out(three, 2, with_start=False).chosen} == {1}


# --- trials -------------------------------------------------------------------------------------------------


def test_a_search_goes_on_where_it_stopped(root: Path, tmp_path: Path) -> None:
    frames, start, out = find_labelled_frames([root]), Toscana2016(BOXES), tmp_path / "new" / "trials.jsonl"
    told: list[tuple[int, int]] = []
    first = search(frames, start, out, 2, tell=lambda done, total, _: told.append((done, total)))
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert [trial.number for trial in first.trials] == [0, 1, 2] and first.start.setting == {}
    assert [place.frame for place in first.subject.places] == ["f0", "f1", "f2", "f3"]
    before = out.read_bytes()
    out.write_bytes(before + b'{"setting": {"cost')
    told.clear()
    more = search(frames, start, out, 3, tell=lambda done, total, _: told.append((done, total)))
    assert told == [(0, 1), (1, 1)] and out.read_bytes().startswith(before)
    (tmp_path / "packed.gz").write_bytes(gzip.compress(out.read_bytes()))
    assert read_search(tmp_path / "packed.gz") == read_search(out)
    assert more.trials[:3] == first.trials == read_search(out).trials[:3] and len(read_search(out).trials) == 4
    assert search(frames, start, out, 1).trials == first.trials[:2]
    for others, seed in ((frames, 1), (frames[1:], 0)):
        with pytest.raises(FileError, match="give another folder with --out"):
            search(others, start, out, 2, seed)


def test_a_search_that_failed_at_the_start_can_be_repeated(root: Path, tmp_path: Path) -> None:
    """A broken frame ends it at once; mended, the frames are others."""
    depth, out = root / "osd-small" / "f2" / "depth.png", tmp_path / "trials.jsonl"
    whole = depth.read_bytes()
    depth.write_bytes(b"")
    with pytest.raises(FileError, match="expected frames that can be segmented and scored"):
        search(find_labelled_frames([root]), Toscana2016(BOXES), out, 1)
    depth.write_bytes(whole)
    made = search(find_labelled_frames([root]), Toscana2016(BOXES), out, 1)
    assert read_search(out) == made and len(made.trials) == 2


def test_a_packed_search_that_is_damaged_is_refused(tmp_path: Path) -> None:
    whole = gzip.compress(bytes(range(256)) * 40)
    (tmp_path / "trials.gz").write_bytes(whole[:20] + b"\xff" * 20 + whole[40:])
    with pytest.raises(FileError, match=r"expected trials in .*trials.gz, but the file cannot be read"):
        read_search(tmp_path / "trials.gz")


def test_trials_read_back_as_they_were_scored(root: Path, tmp_path: Path) -> None:
    frames, start = find_labelled_frames([root])[:4], Toscana2016(BOXES)
    scored = evaluate(frames, [start], tmp_path / "rows.jsonl")
    kept = search(frames, start, tmp_path / "trials.jsonl", 1).start.rows
    assert scored == read_rows(tmp_path / "rows.jsonl")
    for a, b in zip(scored, kept, strict=True):
        assert (a.key, a.group, a.labelling) == (b.key, b.group, b.labelling)
        assert a.score is not None and b.score is not None
        for name in set(a.score.__dataclass_fields__) - {"covered", "covered_by_regions", "names"}:  # left out
            assert getattr(b.score, name) == pytest.approx(getattr(a.score, name), abs=2e-3), name
    assert pool(scored).overlap_f.value > 0.9


def test_worker_processes_try_the_same(root: Path, tmp_path: Path) -> None:
    frames, start = find_labelled_frames([root]), sp.METHODS["felzenszwalb2004"]
    one = search(frames, start, tmp_path / "one.jsonl", 2)
    two = search(frames, start, tmp_path / "two.jsonl", 2, jobs=2)

    def timeless(rows: tuple[Row, ...]) -> list[Row]:
        return [replace(r, cpu_s=None) for r in rows]

    assert [timeless(t.rows) for t in one.trials] == [timeless(t.rows) for t in two.trials]


class Deadly(sp.methods.Toscana2016):
    """Kills its process."""

    def __call__(self, frame: sp.Frame) -> sp.Segmentation:
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_trial_that_kills_its_workers_ends_the_search(root: Path, tmp_path: Path) -> None:
    with pytest.raises(SpigoloError, match="trial 0 failed: the worker process died"):
        search(find_labelled_frames([root])[:1], Deadly(BOXES), tmp_path / "trials.jsonl", 1, jobs=2)


@pytest.mark.parametrize("content", ["{}\n", "nothing\n", '{"method":"m"}\n', "[1]\n", '"x"\n'])
def test_a_file_of_something_else_is_refused_and_left_alone(root: Path, tmp_path: Path, content: str) -> None:
    path = tmp_path / "trials.jsonl"
    path.write_text(content)
    with pytest.raises(FileError, match="expected trials of `spigolo fit`"):
        search(find_labelled_frames([root]), Toscana2016(BOXES), path, 1)
    assert path.read_text() == content


def test_frames_that_cannot_be_tried_are_refused(root: Path, tmp_path: Path) -> None:
    frames = find_labelled_frames([root])
    with pytest.raises(FileError, match="expected labelled frames, got 1 without labels"):
        search(frames[4:], Toscana2016(BOXES), tmp_path / "a.jsonl", 1)
    with pytest.raises(SpigoloError, match="expected a number of trials of 1 or more, got 0"):
        search(frames, Toscana2016(BOXES), tmp_path / "a.jsonl", 0)
    (root / "osd-small" / "f2" / "rgb.png").write_bytes(b"")
    with pytest.raises(FileError, match="got osd-small/f2: expected an image"):
        search(frames, Toscana2016(BOXES), tmp_path / "b.jsonl", 1)


# --- the preset ---------------------------------------------------------------------------------------------


def test_a_fitted_preset_reads_back_as_it_is(tmp_path: Path) -> None:
    start = Toscana2016(sp.TABLE)
    frames = {"a": 0.5, "b": 0.5}
    made = tried(frames, frames | {"a": 0.9})
    setting = next(s for s in draw(space_of(start), 60, seed=0) if s[JOINING] is not None)
    made = replace(made, trials=(made.start, replace(made.trials[1], setting=setting)))
    path, page = write_fit(made, hold_out(made, 2), start, tmp_path / "out")
    config = sp.preset(path)
    assert config == fitted(made, start).config and config.name == "TABLE_FITTED"  # type: ignore[attr-defined]
    assert config.additions is not None and config.additions.joining is not None
    assert config.cost.k_x == setting["cost.k_x"]  # type: ignore[union-attr]
    text = page.read_text(encoding="utf-8")
    assert "| cost.k\\_x | 7.5 |" in text and "Best trial over all frames: 1" in text and "too few" in text


def test_two_commands_fit_a_preset_and_use_it(root: Path, tmp_path: Path) -> None:
    out = tmp_path / "fit"
    words = ("fit", root, "--preset", "TABLE", "--trials", "5", "--folds", "2", "--rejection.max-distance-m", "2")
    done = spigolo(*words, "--out", out)
    assert done.returncode == 0, done.stderr
    assert all(word in done.stdout for word in ("start", "fitted", "held out", "table_fitted.toml"))
    assert sorted(path.name for path in out.iterdir()) == ["report.md", "table_fitted.toml", "trials.jsonl"]
    files = [SCENE / name for name in ("rgb.png", "depth.png")]
    preset = out / "table_fitted.toml"
    done = spigolo("segment", *files, "--camera", SCENE / "camera.json", "--preset", preset, "--out", tmp_path / "seg")
    assert done.returncode == 0, done.stderr
    written = json.loads((tmp_path / "seg" / "objects.json").read_text(encoding="utf-8"))
    assert sp.preset(preset).digest in json.dumps(written)
    assert sp.preset(preset).rejection.max_distance_m == 2


def test_another_method_is_fitted_as_well(root: Path, tmp_path: Path) -> None:
    start = sp.METHODS["rao2010"]
    made = search(find_labelled_frames([root]), start, tmp_path / "trials.jsonl", 3)
    path, _ = write_fit(made, hold_out(made, 2), start, tmp_path)
    again = start.replace(**parse_toml(path.read_text(encoding="utf-8")))
    assert path.name == "rao2010.toml" and again.digest == fitted(made, start).digest


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "expected a folder of labelled frames, got nothing"),
        (["nowhere"], "there is no folder nowhere"),
        (["FRAMES", "--method", "best"], "unknown method 'best'"),
        (["FRAMES", "--preset", "tabel"], "unknown preset 'tabel'"),
        (["FRAMES", "--folds", "9"], "distinct labelled frames (3), got 9"),
        (
            ["FRAMES", "--method", "rao2010", "--partition.gamma", "1"],
            "expected the method toscana2016 with --partition.gamma, got only rao2010",
        ),
        (["FRAMES", "--trials", "0", "--folds", "2"], "expected a number of trials of 1 or more, got 0"),
    ],
)
def test_wrong_input_ends_with_2_and_one_sentence(root: Path, tmp_path: Path, words: list[str], sentence: str) -> None:
    given = [str(root) if word == "FRAMES" else word for word in words]
    done = spigolo("fit", *given, "--out", tmp_path / "out")
    assert done.returncode == FAILED
    assert sentence in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


# --- the comparison -----------------------------------------------------------------------------------------


def test_the_page_of_methods_says_what_the_log_says() -> None:
    text = (ROOT / "docs" / "methods.md").read_text(encoding="utf-8")
    logs = {name: read_search(ROOT / "docs" / "data" / f"trials-{name}.jsonl.gz") for name in sp.METHODS}
    assert len({(len(log.trials), log.subject.seed, log.subject.places) for log in logs.values()}) == 1
    for name, log in logs.items():
        held = pool(hold_out(log).rows)
        figures = held.overlap_precision, held.overlap_recall, held.overlap_f.value, held.boundary_f, held.f75
        assert f"| `{name}` | {' | '.join(f'{value:.3f}' for value in figures)} |" in text


# --- real frames --------------------------------------------------------------------------------------------


@pytest.mark.frames
def test_a_few_trials_beat_table_on_frames_left_out(data: Path, tmp_path: Path) -> None:
    places = [data / "frames" / "osd-mosd" / f"learn{k}" for k in range(6)]
    start = Toscana2016(sp.TABLE)
    made = search(find_labelled_frames(places), start, tmp_path / "trials.jsonl", 6)
    assert pool(hold_out(made, 2).rows).overlap_f.value > pool(made.start.rows).overlap_f.value + 0.1
