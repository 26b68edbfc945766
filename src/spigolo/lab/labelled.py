"""Names of data sets in which every object is labelled. The module imports nothing, so the command line stays fast."""

from __future__ import annotations

FULL_SETS = ("osd-*", "hand-uoc*", "hand-pcpt*", "hand-posecnn*", "field")
"""Name patterns of data sets in which every object is known to be labelled."""
