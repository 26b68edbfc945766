"""How good is a segmentation: two label images in, numbers out.

A label image is a 2-D array of whole numbers: 0 is background, every other value is one instance. In use::

    score = score_frame(truth, prediction, ignore=unsure)   # one frame
    total = summarise([score, ...])                         # a data set
    print(format_table({"ours": total}))

Letters used in shapes: H, W = image; N = true objects; S = predicted segments.
Needs the extra ``evaluation`` (scipy): ``pip install "spigolo[evaluation]"``.
"""

from __future__ import annotations

from spigolo.evaluation.matching import (
    OverlapTable,
    boundary_hits,
    boundary_map,
    default_radius_px,
    overlap_table,
    pair_by_f,
)
from spigolo.evaluation.measures import (
    DatasetScore,
    FrameScore,
    format_table,
    score_frame,
    summarise,
    wilson_interval,
)

__all__ = [
    "DatasetScore",
    "FrameScore",
    "OverlapTable",
    "boundary_hits",
    "boundary_map",
    "default_radius_px",
    "format_table",
    "overlap_table",
    "pair_by_f",
    "score_frame",
    "summarise",
    "wilson_interval",
]
