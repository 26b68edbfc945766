"""The cause of each lost object, on label images drawn for it, and the command that counts them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from spigolo.lab.evaluation.causes import Cause, find_fates

SHAPE = (40, 60)


def paint(**boxes: tuple[int, int, int, int]) -> np.ndarray:
    """Labels by name `kN`: the box (y0, x0, y1, x1) gets label N."""
    out = np.zeros(SHAPE, np.int32)
    for name, (y0, x0, y1, x1) in boxes.items():
        out[y0:y1, x0:x1] = int(name[1:])
    return out


ONE = paint(k1=(10, 10, 30, 30))
TWO = paint(k1=(10, 10, 30, 30), k2=(10, 30, 30, 50))
NOTHING = paint()


@pytest.mark.parametrize(
    ("truth", "labels", "regions", "cause"),
    [
        (ONE, ONE, ONE, Cause.FOUND),
        (ONE, NOTHING, ONE, Cause.REJECTED),
        (TWO, paint(k1=(10, 10, 30, 50)), paint(k1=(10, 10, 30, 50)), Cause.MERGED),
        (ONE, NOTHING, paint(k1=(0, 0, 40, 40)), Cause.FLOODED),
        (ONE, paint(k1=(10, 10, 30, 20)), paint(k1=(10, 10, 30, 20), k2=(10, 20, 30, 30)), Cause.SPLIT),
        (ONE, paint(k1=(10, 10, 27, 25)), paint(k1=(10, 10, 29, 26)), Cause.REJECTED),
        (ONE, paint(k1=(6, 13, 29, 32)), paint(k1=(6, 13, 29, 32)), Cause.OUTLINE),
    ],
)
def test_each_cause(truth: np.ndarray, labels: np.ndarray, regions: np.ndarray, cause: Cause) -> None:
    assert find_fates(truth, labels, regions)[0].cause is cause


def test_ignored_pixels_do_not_count() -> None:
    regions = paint(k1=(0, 0, 40, 40))
    assert find_fates(ONE, NOTHING, regions, ignore=ONE == 0)[0].cause is Cause.REJECTED


def test_every_object_has_one_fate() -> None:
    fates = find_fates(TWO, TWO, TWO)
    assert [fate.label for fate in fates] == [1, 2]
    assert [fate.iou for fate in fates] == [1.0, 1.0]


@pytest.mark.frames
def test_the_verb_counts_them(data: Path) -> None:
    words = ["losses", str(data / "frames" / "hand-uoc" / "000000"), "--preset", "TABLE", "--each"]
    done = subprocess.run([sys.executable, "-m", "spigolo", *words], capture_output=True, text=True, check=True)
    *_, total = done.stdout.splitlines()
    counts = [int(word) for word in total.replace("-", "0").split()[1:]]
    assert counts[0] == sum(counts[1:]) > 5
    assert done.stdout.count("hand-uoc/000000") == counts[0] - counts[1]
