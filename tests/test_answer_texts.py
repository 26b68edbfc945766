"""How answers, frames and settings show themselves: reprs, pictures for notebooks, plain values, stage times."""

from __future__ import annotations

import dataclasses
import json
import threading
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.clock import Lap, stage, stopwatch
from spigolo.lab.bench.stages import PARTS, STAGES
from spigolo.objects.facts import MEASURED, RegionFacts
from spigolo.settings.parameters import Parameters, Settings
from test_objects import CAMERA, scene

CONFIG = sp.TABLE.replace(rejection={"max_lambda1_px2": 20000.0, "max_lambda2_px2": 15000.0})
EMPTY = sp.TABLE.replace(rejection={"max_distance_m": 0.1})


@pytest.fixture(scope="module")
def answer() -> sp.Segmentation:
    return sp.segment(scene(), CONFIG)


# --- reprs ----------------------------------------------------------------------------------------------------


def test_an_answer_shows_its_counts_size_and_parameters(answer: sp.Segmentation) -> None:
    assert repr(answer) == f"Segmentation(2 objects, {len(answer.rejected)} rejected, 160x120, TABLE {CONFIG.digest})"
    one = answer.drop(answer[0])
    assert repr(one).startswith(f"Segmentation(1 object, {len(answer.rejected) + 1} rejected")
    assert repr(sp.segment(scene(), EMPTY)).startswith("Segmentation(0 objects, ")


def test_an_object_shows_its_label_place_and_score(answer: sp.Segmentation) -> None:
    o = answer[0]
    y0, x0, y1, x1 = o.box_px
    place = f"{o.area_px} px in ({y0}, {x0}, {y1}, {x1}) at {o.centroid_m[2]:.2f} m"
    assert repr(o) == f"ObjectMask(1: {place}, score {o.score:.2f})"


def test_an_object_without_a_place_in_space_shows_none() -> None:
    answer = sp.segment(sp.Frame(scene().color, scene().depth, None), CONFIG)
    assert " m, score" not in repr(answer[0]) and "nan" not in repr(answer[0])


def test_a_rejected_region_shows_why(answer: sp.Segmentation) -> None:
    wall = max(answer.rejected, key=lambda r: r.area_px)
    assert repr(wall).startswith(f"RejectedRegion({wall.why}; {wall.area_px} px in (")


def test_facts_a_trace_and_a_frame_fit_on_one_line() -> None:
    run = sp.trace(scene(), CONFIG)
    facts = run.segmentation.scene.measure(run.regions)
    assert repr(facts[0]).startswith(f"RegionFacts({facts[0].area_px} px in (")
    assert repr(run) == f"Trace({run.frame!r}, {run.regions.count} regions, {run.segmentation!r})"
    for thing in (facts[0], run.segmentation, run.segmentation[0], run.segmentation.rejected[0], CAMERA):
        assert "array" not in repr(thing) and "\n" not in repr(thing) and len(repr(thing)) < 200
    for shown in (repr(run), repr(run.frame)):
        assert "array" not in shown and "\n" not in shown and len(shown) < 400


# --- pictures for notebooks -----------------------------------------------------------------------------------


def decoded(png: bytes) -> np.ndarray:
    assert png.startswith(b"\x89PNG")
    return cv2.cvtColor(cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)


def test_the_picture_of_an_answer_is_its_overlay(answer: sp.Segmentation) -> None:
    np.testing.assert_array_equal(decoded(answer._repr_png_()), answer.overlay())
    nothing = sp.segment(scene(), EMPTY)
    np.testing.assert_array_equal(decoded(nothing._repr_png_()), nothing.overlay())


def test_the_picture_of_an_object_is_a_crop_around_its_box(answer: sp.Segmentation) -> None:
    for o in answer:
        y0, x0, y1, x1 = o.box_px
        height, width, _ = decoded(o._repr_png_()).shape
        assert y1 - y0 < height < 1.6 * (y1 - y0) and x1 - x0 < width < 1.6 * (x1 - x0)


def test_the_picture_of_an_object_stays_within_the_image() -> None:
    frame = scene()
    o = sp.segment_at(frame, (5, 80), CONFIG)  # the wall, which fills the frame
    assert decoded(o._repr_png_()).shape == (*frame.shape, 3)


# --- plain values ---------------------------------------------------------------------------------------------

FACTS = {f.name for f in dataclasses.fields(RegionFacts)} - {"regions", "frame", "plane"}


def test_plain_values_are_named_as_the_fields_are(answer: sp.Segmentation) -> None:
    values = json.loads(json.dumps(answer.to_dict(), allow_nan=False))
    assert set(MEASURED) == FACTS
    assert {"missing", "unfilled", "above", "inside"} < FACTS
    for told, o in zip(values["objects"], answer, strict=True):
        assert set(told) == FACTS | {"label", "oriented_box"}
        assert set(o.to_dict()) == FACTS
    for told, r in zip(values["rejected"], answer.rejected, strict=True):
        assert set(told) == FACTS | {"reason", "why"}
        assert (told["reason"], told["why"]) == (r.reason.value, r.why)


def test_a_table_has_a_column_for_each_fact_and_a_row_for_each_object(answer: sp.Segmentation) -> None:
    table = answer.table()
    assert type(table) is dict and list(table) == ["label", *MEASURED]
    assert {len(column) for column in table.values()} == {len(answer)} == {2}
    assert table["label"] == [1, 2]
    assert table["area_px"] == [o.area_px for o in answer]
    json.dumps(table, allow_nan=False)


def test_a_table_without_objects_keeps_its_columns() -> None:
    table = sp.segment(scene(), EMPTY).table()
    assert list(table) == ["label", *MEASURED] and not any(table.values())


# --- settings -------------------------------------------------------------------------------------------------


def models(kind: type[Settings] = Settings) -> Iterator[type[Settings]]:
    for model in kind.__subclasses__():
        yield model
        yield from models(model)


def test_the_papers_presets_have_no_additions() -> None:
    for config in (sp.SHELF, sp.TABLE, sp.CLUTTER):
        assert config.additions is None
        assert "additions" not in config.to_toml()
    assert sp.OBJECTS.additions is not None
    assert sp.Config().additions is None


OURS = [m for m in models() if m.__module__.startswith("spigolo.settings.") and m is not Parameters]


@pytest.mark.parametrize("model", OURS, ids=lambda m: m.__name__)
def test_the_text_of_a_field_stands_alone(model: type[Settings]) -> None:
    for name, field in model.model_fields.items():
        text = field.description or ""
        assert text[:1].isupper() and text.endswith("."), f"{model.__name__}.{name}: {text!r}"


def test_every_model_is_a_public_name_of_the_settings() -> None:
    for model in OURS:
        assert getattr(sp.settings, model.__name__) is model
        assert model.__name__ in sp.settings.__all__


def test_a_model_of_a_stage_is_replaced_alone_and_stays_frozen() -> None:
    before = sp.settings.EdgesConfig()
    after = before.replace(blur_px=9)
    assert (before.blur_px, after.blur_px) == (7, 9)
    assert after == sp.settings.EdgesConfig(blur_px=9)
    with pytest.raises(sp.errors.ConfigError, match="expected an odd number of pixels as blur_px, got 8"):
        before.replace(blur_px=8)
    with pytest.raises(sp.errors.ConfigError, match=r"unknown parameter 'blur' in EdgesConfig: did you mean 'blur_px'"):
        before.replace(blur=9)
    deep = sp.settings.DepthConfig().replace(**{"smoothing.mean": "plain"})
    assert deep.smoothing.mean == "plain" and deep.replace(smoothing={"mean": "valid"}) == sp.settings.DepthConfig()
    with pytest.raises(ValueError, match="frozen"):
        before.blur_px = 9  # type: ignore[misc]


# --- stage times ----------------------------------------------------------------------------------------------


def test_a_stopwatch_has_the_time_of_every_stage() -> None:
    with sp.clock.stopwatch() as times:
        sp.segment(scene(), sp.OBJECTS)
        sp.segment(scene(), sp.OBJECTS)
    assert set(times) <= {*STAGES, *PARTS}
    assert {"depth", "edges", "contours", "weights", "partition", "scene", "objects"} <= set(times)
    assert {len(laps) for laps in times.values()} == {2}
    assert all(isinstance(lap, Lap) and lap.wall_s > 0 and lap.cpu_s >= 0 for laps in times.values() for lap in laps)
    before = {name: len(laps) for name, laps in times.items()}
    sp.segment(scene(), sp.OBJECTS)  # after the block nothing is measured
    assert {name: len(laps) for name, laps in times.items()} == before


def test_a_stopwatch_inside_another_takes_its_stages_alone() -> None:
    @stage("work")
    def work() -> int:
        return 1

    with stopwatch() as outer:
        work()
        with stopwatch() as inner:
            assert work() == 1
        work()
    assert (len(outer["work"]), len(inner["work"])) == (2, 1)


def test_a_stage_that_fails_is_timed_too_and_keeps_its_name() -> None:
    @stage("failing")
    def failing() -> None:
        """It fails."""
        raise KeyError("x")

    assert (failing.__name__, failing.__doc__) == ("failing", "It fails.")
    with stopwatch() as times, pytest.raises(KeyError):
        failing()
    assert len(times["failing"]) == 1


def test_a_stopwatch_measures_its_own_thread_alone() -> None:
    @stage("work")
    def work() -> None:
        pass

    with stopwatch() as times:
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
    assert not times


def test_no_test_file_is_left_out_of_the_table_of_the_readme() -> None:
    folder = Path(__file__).parent
    table = (folder / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in sorted(folder.glob("*.py")) if f"`{path.name}`" not in table] == []
