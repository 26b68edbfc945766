"""The paper's tables: which object counts where, what stands beside what is printed, and one command a table."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError
from spigolo.lab.evaluation import Row, RowFile, read_rows, row_to_json, score_row
from spigolo.lab.experiments import gather, write_paper_tables
from spigolo.lab.experiments.printed import TABLES
from spigolo.lab.page import Table
from test_experiments import row, spigolo
from test_synthetic import need_renderer

SCRIPT = Path(__file__).resolve().parents[1] / "scripts" / "paper_tables.py"
SETS = {"I": "rutgers-apc-rendered", "II": "uw-scenes-v1-rendered", "III": "tejani-rendered"}


def paper_row(data_set: str, frame: str, names: str, covered: tuple[float, ...], preset: str, **changes: Any) -> Row:
    """A row of our method, of another where `method` says so, with regions that cover everything."""
    known = {"digest": sp.preset(preset).digest} if preset else {}
    return row(
        frame, data_set=data_set, preset=preset, labelling="part", n_objects=len(covered), names=tuple(names.split()),
        covered=covered, covered_by_regions=(1.0,) * len(covered), **{"method": "toscana2016", **known, **changes},
    )  # fmt: skip


def tables(rows: list[Row], out: Path) -> dict[str, Table]:
    return dict(write_paper_tables(gather({"": rows}), out))


def texts(table: Table) -> list[list[str]]:
    return [[f"{cell.text} ({cell.note})" if cell.note else cell.text for cell in line] for line in table.rows]


def test_the_printed_figures_are_those_of_the_paper() -> None:
    one, two, three = TABLES
    assert [(f.objects, f.found) for f in one.figures.values()] == [(80, "87.9"), (120, "92.3"), (121, "75.6")]
    assert (one.preset, two.preset, three.preset) == ("SHELF", "TABLE", "CLUTTER")
    assert sum(f.objects for f in three.figures.values()) == 2589 + 2127 + 2118 + 894
    assert [len([p for p in two.figures if p[0] == scene]) for scene in two.lines] == [6, 3, 6]
    assert (two.figures["Table_1", "Cereal box"].found, two.figures["Desk_1", "Cap"].beside) == ("72 %", "100 %")
    assert two.figures["Kitchen_small_1", "Coffee mug"].beside == "70.1 %"


def test_table_1_counts_by_how_full_the_bin_is(tmp_path: Path) -> None:
    shots = [("can-A-0-2-0", 0.9), ("can-B-0-1-0", 0.7), ("box-C-2-0-3", 0.71)]
    rows = [paper_row(SETS["I"], frame, frame.split("-")[0], (share,), "SHELF") for frame, share in shots]
    rows += [paper_row(SETS["I"], "can-A-0-2-0", "can", (0.1,), "OBJECTS")]
    ((title, table),) = tables(rows, tmp_path).items()
    assert title == "Table I: rendered stand-in for Rutgers APC"
    assert texts(table) == [
        ["Run_1", "80", "87.9 %", "2", "50.0 %", "100.0 %", "0.0 % (of 1)", "100.0 % (of 1)"],
        ["Run_2", "120", "92.3 %", "0", "–", "–", "–", "–"],
        ["Run_3", "121", "75.6 %", "1", "100.0 %", "100.0 %", "– (of 0)", "– (of 0)"],
    ]
    for page in ("index.html", "report.md"):
        assert "rendered stand-in for Rutgers APC" in (tmp_path / page).read_text(encoding="utf-8")


def test_table_2_has_the_other_method_in_parentheses_and_the_gaps_of_the_paper(tmp_path: Path) -> None:
    shown = "soda_can_4 soda_can_6 cereal_1 bowl_2", (0.8, 0.2, 0.9, 0.0)
    there = "uw-scenes-v1"
    rows = [
        paper_row(there, "kitchen_small_1_7", *shown, "TABLE"),
        paper_row(there, "kitchen_small_1_7", shown[0], (1.0, 0.6, 0.5, 0.0), "", method="mishra2012"),
        paper_row(there, "desk_1_3", "bowl_3 cap_1", (1.0, 1.0), "TABLE"),
        paper_row(there, "desk_2_3", "cap_1", (1.0,), "TABLE"),  # no scene of the table
    ]
    ((title, table),) = tables(rows, tmp_path).items()
    assert title == "Table II: UW RGB-D Scenes v1"
    lines = {(line[0], line[1]): line[2:] for line in texts(table)}
    assert lines["Desk_1", "printed"][2:4] == ["74.2 % (100 %)", "-"]
    ours = "toscana2016 TABLE (mishra2012)"
    assert lines["Desk_1", ours] == ["– (–)", "– (–)", "100.0 % (–)", "-", "-", "-"]
    assert lines["Desk_1", "objects"] == ["0", "0", "1", "-", "-", "-"]
    kitchen = ["50.0 % (100.0 %)", "– (–)", "– (–)", "0.0 % (0.0 %)", "– (–)", "100.0 % (0.0 %)"]
    assert lines["Kitchen_small_1", ours] == kitchen
    assert lines["Kitchen_small_1", "in the regions of toscana2016 TABLE"][0] == "100.0 %"


def test_table_3_counts_the_instances_of_its_objects(tmp_path: Path) -> None:
    rows = [
        paper_row(SETS["III"], "scene_06/img_0", "Milk Milk Milk", (0.9, 0.8, 0.1), "CLUTTER"),
        paper_row(SETS["III"], "scene_05/img_0", "Juice", (1.0,), "CLUTTER"),
    ]
    ((_, table),) = tables(rows, tmp_path).items()
    assert texts(table)[0] == ["Milk", "2589", "66.6 %", "3", "66.7 %", "100.0 %"]
    assert [line[3] for line in texts(table)] == ["3", "0", "0", "0"]


def test_photographs_and_stand_ins_have_tables_of_their_own(tmp_path: Path) -> None:
    rows = [paper_row(name, "x-A-0-0-0", "x", (1.0,), "SHELF") for name in (SETS["I"], "rutgers-apc")]
    assert list(tables(rows, tmp_path)) == ["Table I: Rutgers APC", "Table I: rendered stand-in for Rutgers APC"]


def test_rows_say_what_covers_which_object(tmp_path: Path) -> None:
    truth = np.zeros((20, 30), np.int32)
    truth[2:12, 2:12], truth[2:12, 15:25] = 3, 9
    found, regions = np.zeros_like(truth), np.ones_like(truth)
    found[2:12, 2:10] = 1
    score = score_row(truth, found, regions, names={9: "cap_1", 3: "bowl_2"})
    assert score.names == ("bowl_2", "cap_1")
    assert score.covered == (0.8, 0.0)
    assert score.covered_by_regions == (1.0, 1.0)
    assert score.found_70_recall == 1
    with RowFile(tmp_path / "rows.jsonl") as file:
        file.append(row(score=score))
    assert read_rows(tmp_path / "rows.jsonl")[0].score == score
    old = row_to_json(row()).replace(',"covered":[],"covered_by_regions":[],"names":[]', "")
    assert "covered" not in old
    (tmp_path / "old.jsonl").write_text(f"{old}\n")
    assert read_rows(tmp_path / "old.jsonl") == [row()]


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        ([row()], "expected rows of rutgers-apc, uw-scenes-v1, tejani, or of their stand-ins, got none: "),
        ([row(data_set="tejani")], "with preset CLUTTER on tejani for Table III, got rows of P: "),
        (
            [row(data_set="tejani", method="toscana2016", digest=sp.CLUTTER.digest)],
            "expected the names of the objects in the row of tejani/a, got a row of spigolo 1 without names: ",
        ),
    ],
)
def test_rows_that_cannot_fill_a_table_are_refused(rows: list[Row], sentence: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=sentence):
        tables(rows, tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_command_prints_the_tables_and_refuses(tmp_path: Path) -> None:
    rows, out = tmp_path / "rows.jsonl", tmp_path / "out"
    rows.write_text(row_to_json(paper_row(SETS["III"], "scene_06/img_0", "Milk", (0.9,), "CLUTTER")) + "\n")
    done = spigolo("report", rows, "--paper", "--out", out)
    assert done.returncode == 0, done.stderr
    assert "Table III: rendered stand-in for Tejani et al." in done.stdout
    assert "66.6 %" in done.stdout and (out / "report.md").is_file()
    refused = spigolo("report", rows, "--paper", "--against", "CLUTTER")
    assert refused.returncode == 2 and "expected --paper without" in refused.stderr
    rows.write_text(row_to_json(row()) + "\n")
    refused = spigolo("report", rows, "--paper", "--out", tmp_path / "none")
    assert refused.returncode == 2 and "or of their stand-ins, got none" in refused.stderr
    assert not (tmp_path / "none").exists()


def test_one_command_makes_a_table_and_goes_on(tmp_path: Path) -> None:
    need_renderer()
    command = [sys.executable, str(SCRIPT), "1", "--frames", "2", "--out", str(tmp_path)]
    for there in (0, 4):
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        assert done.returncode == 0, done.stderr
        assert f"4 rows, {there} of them from an earlier run" in done.stdout
        assert "Table I: rendered stand-in for Rutgers APC" in done.stdout
    assert [path.name for path in tmp_path.glob("shelf*")] == ["shelf-2-seed-0"]
    refused = subprocess.run([*command, "--data", "nowhere"], capture_output=True, text=True, check=False, timeout=60)
    assert refused.returncode == 2 and "there is no folder nowhere" in refused.stderr


def test_frames_without_labels_are_told(tmp_path: Path) -> None:
    blind = dataclasses.replace(paper_row("rutgers-apc", "x-A-0-0-0", "", (), "SHELF"), score=None)
    with pytest.raises(FileError, match="got rows without scores: fetch the poses or masks"):
        tables([blind], tmp_path)
