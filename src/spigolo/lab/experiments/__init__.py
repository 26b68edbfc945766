"""Evaluation of segmentation methods on labelled frames.

`evaluate` writes scores to a file, and `write_report` creates a report.

Evaluate two presets on labelled frames and write a report::

    frames = find_labelled_frames([Path("frames")])
    evaluate(frames, make_methods(["toscana2016"], [sp.OBJECTS, sp.TABLE]), Path("rows.jsonl"))
    write_report(read_contenders([Path("rows.jsonl")]), Path("report"), frames)
"""

from __future__ import annotations

from spigolo.lab.datasets import Entry, Truth, find_labelled_frames
from spigolo.lab.experiments.contenders import Contender, find_references, gather, read_contenders
from spigolo.lab.experiments.losses import find_losses, loss_table, lost_objects
from spigolo.lab.experiments.methods import make_methods, remake
from spigolo.lab.experiments.paper import write_paper_tables
from spigolo.lab.experiments.report import write_report
from spigolo.lab.experiments.running import evaluate
from spigolo.methods import Method, Toscana2016

__all__ = [
    "Contender",
    "Entry",
    "Method",
    "Toscana2016",
    "Truth",
    "evaluate",
    "find_labelled_frames",
    "find_losses",
    "find_references",
    "gather",
    "loss_table",
    "lost_objects",
    "make_methods",
    "read_contenders",
    "remake",
    "write_paper_tables",
    "write_report",
]
