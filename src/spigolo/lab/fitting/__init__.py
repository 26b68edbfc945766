"""Fitting of parameters to labelled frames by random search, with cross-validation.

Fit the parameters of the preset `TABLE`, and print the overlap F-measure of the masks on held-out frames::

    frames = find_labelled_frames([Path("frames")])
    tried = search(frames, Toscana2016(sp.TABLE), Path("fit/trials.jsonl"))
    best = best_trial(tried.trials)
    print(pool(hold_out(tried).rows).overlap_f)
"""

from __future__ import annotations

from spigolo.lab.fitting.choosing import HeldOut, best_trial, check_folds, goodness, hold_out, hold_out_sets
from spigolo.lab.fitting.drawing import draw
from spigolo.lab.fitting.report import fitted, score_table, write_fit
from spigolo.lab.fitting.search import only_labelled, search
from spigolo.lab.fitting.spaces import Choice, Range, Space, Switch, apply, space_of
from spigolo.lab.fitting.trials import Search, Subject, Trial, read_search

__all__ = [
    "Choice",
    "HeldOut",
    "Range",
    "Search",
    "Space",
    "Subject",
    "Switch",
    "Trial",
    "apply",
    "best_trial",
    "check_folds",
    "draw",
    "fitted",
    "goodness",
    "hold_out",
    "hold_out_sets",
    "only_labelled",
    "read_search",
    "score_table",
    "search",
    "space_of",
    "write_fit",
]
