"""Time measurements: ours and others' code on the same frames, round by round.

In use::

    report = bench({"mine": frame}, QUICK)          # everything that is measured
    report.to_json()                                # with the raw rounds
    print(markdown(report))

The methods that ours is compared with (`spigolo.METHODS`) run in the rounds as well.
"""

from __future__ import annotations

from spigolo.lab.bench.report import QUICK, Plan, Report, bench
from spigolo.lab.bench.scaling import SIZES, Size
from spigolo.lab.bench.tables import markdown, tables
from spigolo.lab.page import Table

__all__ = ["QUICK", "SIZES", "Plan", "Report", "Size", "Table", "bench", "markdown", "tables"]
