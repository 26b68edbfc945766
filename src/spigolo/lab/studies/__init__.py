"""Scripts that measure the numbers given in the documentation, such as accuracies and CPU times.

The command `python -m spigolo.lab.studies.NAME --help` prints the purpose and the options of the script NAME.py.

Real frames are read from the subfolder `frames` of the data folder. The environment variable SPIGOLO_DATA sets the data
folder (default: ../shared/data).
"""

from __future__ import annotations

import os
from pathlib import Path

FRAMES = Path(os.environ.get("SPIGOLO_DATA", "../shared/data")) / "frames"
"""Folder with real RGB-D frames."""
