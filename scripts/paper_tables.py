"""Reproduce one table of the paper: `python scripts/paper_tables.py 1` renders frames, evaluates methods and writes the
table.

Table 1 uses the data set Rutgers APC, table 2 UW RGB-D Scenes v1, and table 3 Tejani et al. With `--data FOLDER`, the
frames of the published data set in this folder are evaluated. Without `--data`, similar frames are rendered in the
layout of the data set. A run that was interrupted continues with the rendered frames and the scores that it has already
written.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import NamedTuple

from spigolo.cli.evaluate import evaluate, report
from spigolo.cli.render import render
from spigolo.errors import SpigoloError


class Recipe(NamedTuple):
    """Parameters of one table. family: family of rendered scenes. preset: preset of the paper for the data set.
    methods: methods to compare.
    """

    family: str
    preset: str
    methods: tuple[str, ...] = ("toscana2016",)


RECIPES = {
    1: Recipe("shelf", "SHELF"),
    2: Recipe("table", "TABLE", ("toscana2016", "mishra2012")),
    3: Recipe("multi", "CLUTTER"),
}


def main() -> int:
    parser = argparse.ArgumentParser(description="Compute one of the paper's tables.")
    parser.add_argument("table", type=int, choices=list(RECIPES))
    parser.add_argument("--data", type=Path, help="folder of the published data set; default: rendered stand-ins")
    parser.add_argument("--frames", type=int, default=60, help="number of rendered stand-ins")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", "-j", type=int, default=1, help="worker processes")
    parser.add_argument("--out", "-o", type=Path, default=Path("spigolo-paper"))
    given = parser.parse_args()
    recipe, out = RECIPES[given.table], given.out
    try:
        frames = given.data or stand_ins(recipe.family, given.frames, given.seed, out)
        rows = out / f"table-{given.table}-{frames.name}.jsonl"
        failed = evaluate(
            str(frames), methods=recipe.methods, presets=(recipe.preset, "OBJECTS"), jobs=given.jobs, out=rows
        )
        report(rows, paper=True, out=out / f"table-{given.table}")
    except SpigoloError as error:
        print(f"paper_tables: {error}", file=sys.stderr)
        return 2
    return failed


def stand_ins(family: str, count: int, seed: int, out: Path) -> Path:
    """Render frames in the layout of a data set and return their folder. If the folder exists, its frames are complete
    and are not rendered again.
    """
    folder = out / f"{family}-{count}-seed-{seed}"
    if not folder.is_dir():
        half = folder.with_name(f"{folder.name}.part")
        shutil.rmtree(half, ignore_errors=True)
        render(family, count=count, seed=seed, layout="original", out=half)
        half.rename(folder)
    return folder


if __name__ == "__main__":
    sys.exit(main())
