"""Benchmark of the time and memory of spigolo, and of the time of other libraries on the same frames.

Run the benchmark on one frame and print the tables::

    report = bench({"mine": frame}, QUICK)          # everything that is measured
    report.to_json()                                # with all measured times
    print(markdown(report))

The benchmark measures the time of the segmentation method `toscana2016` with several presets, and of all other methods
in `spigolo.METHODS`.
"""

from __future__ import annotations

from spigolo.lab.bench.report import QUICK, Plan, Report, bench
from spigolo.lab.bench.scaling import SIZES, Size
from spigolo.lab.bench.tables import markdown, tables
from spigolo.lab.page import Table

__all__ = ["QUICK", "SIZES", "Plan", "Report", "Size", "Table", "bench", "markdown", "tables"]
