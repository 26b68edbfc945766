"""Measurements for the values in the docs: `python -m spigolo.lab.studies.NAME --help`.

Real frames come from the folder in SPIGOLO_DATA, by default ../shared/data.
"""

from __future__ import annotations

import os
from pathlib import Path

FRAMES = Path(os.environ.get("SPIGOLO_DATA", "../shared/data")) / "frames"
"""Folder of the real frames."""
