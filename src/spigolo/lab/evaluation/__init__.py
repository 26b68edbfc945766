"""Comparison of predicted segmentations with ground truth.

A label image is a 2-D array of integers: 0 is background, and every other value is one object.

Score frames and average the scores::

    score = score_frame(truth, prediction, ignore=unsure)   # one frame
    total = summarise([score, ...])                         # a data set
    print(total.overlap_f, total.found_iou_70)

A `Row` holds the scores of one method on one frame. The class `RowFile` writes rows to a file, and the function
`read_rows` reads them. The function `pool` averages the rows of one method. The function `compare` compares the rows of
two methods. The functions `folds` and `leave_one_set_out` split frames for cross-validation.

Letters in array shapes: H, W = image height and width, N = number of true objects (objects of the ground truth),
S = number of predicted segments. The evaluation requires scipy: ``pip install "spigolo[evaluation]"``.
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
