"""Scores of a segmentation, computed from two label images.

A label image is a 2-D array of integers: 0 is background, every other value is one instance. In use::

    score = score_frame(truth, prediction, ignore=unsure)   # one frame
    total = summarise([score, ...])                         # a data set
    print(total.overlap_f, total.found_iou_70)

Rows are the scores of many methods on many frames, in a file (`Row`, `RowFile`, `read_rows`). `pool` combines the rows
of one method, and `compare` compares two methods. `folds` and `leave_one_set_out` split frames into those for choosing
and those for scoring.

Letters used in shapes: H, W = image, N = true objects, S = predicted segments. Needs the extra ``evaluation`` (scipy):
``pip install "spigolo[evaluation]"``.
"""

from __future__ import annotations

from spigolo.lab.evaluation.matching import (
    OverlapTable,
    boundary_hits,
    boundary_map,
    default_radius_px,
    overlap_table,
    pair_by_f,
)
from spigolo.lab.evaluation.measures import FrameScore, Measures, score_frame
from spigolo.lab.evaluation.pooling import Difference, Pooled, compare, pool
from spigolo.lab.evaluation.resampling import Estimate, Split, bootstrap, folds, leave_one_set_out, wilson_interval
from spigolo.lab.evaluation.rows import Key, Row, RowFile, RowScore, read_rows, row_to_json, score_row
from spigolo.lab.evaluation.summary import DatasetScore, summarise

__all__ = [
    "DatasetScore",
    "Difference",
    "Estimate",
    "FrameScore",
    "Key",
    "Measures",
    "OverlapTable",
    "Pooled",
    "Row",
    "RowFile",
    "RowScore",
    "Split",
    "bootstrap",
    "boundary_hits",
    "boundary_map",
    "compare",
    "default_radius_px",
    "folds",
    "leave_one_set_out",
    "overlap_table",
    "pair_by_f",
    "pool",
    "read_rows",
    "row_to_json",
    "score_frame",
    "score_row",
    "summarise",
    "wilson_interval",
]
