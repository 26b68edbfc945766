"""Scripts that measure the values in the documentation.

The command `python -m spigolo.lab.studies.NAME --help` describes a script.

Real frames are read from the folder in the environment variable SPIGOLO_DATA, by default ../shared/data.
"""

from __future__ import annotations

import os
from pathlib import Path

FRAMES = Path(os.environ.get("SPIGOLO_DATA", "../shared/data")) / "frames"
"""Folder with real RGB-D frames."""
