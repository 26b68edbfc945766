"""All methods at equal chances: each fitted by the same search, scored on frames that had no say in its parameters.

    python scripts/compare_methods.py search --trials 40
    python scripts/compare_methods.py table

`search` adds trials to docs/data/trials-METHOD.jsonl, the same number for every method, on the same fully labelled
frames. `table` reads these files alone. Frames: SPIGOLO_DATA, or ../shared/data.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import spigolo as sp
from spigolo.experiments import find_labelled_frames
from spigolo.experiments.labelled import FrameFolder
from spigolo.fitting import goodness, search
from spigolo.fitting.trials import Trial

ROOT = Path(__file__).resolve().parents[1]
LOG = ROOT / "docs" / "data"
DATA = Path(os.environ.get("SPIGOLO_DATA", ROOT.parent / "shared" / "data")) / "frames"
SETS = ("osd-mosd", "hand-uoc")
"""Every object of them is labelled."""


def frames() -> list[FrameFolder]:
    return find_labelled_frames([DATA / name for name in SETS])


def search_all(trials: int, jobs: int) -> None:
    for name, method in sp.METHODS.items():

        def tell(done: int, total: int, trial: Trial | None, name: str = name) -> None:
            if trial is not None:
                print(f"{name} {done}/{total}: {goodness(trial.rows):.3f}", flush=True)

        search(frames(), method, LOG / f"trials-{name}.jsonl", trials, 0, jobs, tell)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    searching = verbs.add_parser("search")
    searching.add_argument("--trials", type=int, default=40)
    searching.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    search_all(given.trials, given.jobs)


if __name__ == "__main__":
    main()
