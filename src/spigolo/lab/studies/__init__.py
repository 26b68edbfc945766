"""Measurements behind the figures of the docs: `python -m spigolo.lab.studies.NAME --help`.

Real frames come from the folder that SPIGOLO_DATA names, by default ../shared/data.
"""

from __future__ import annotations

import os
from pathlib import Path

FRAMES = Path(os.environ.get("SPIGOLO_DATA", "../shared/data")) / "frames"
"""Folder of the real frames."""
