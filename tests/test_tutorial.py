"""The notebook of the tutorial, run as a reader runs it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).resolve().parents[1] / "examples" / "tutorial.ipynb"
RUN = """
import sys, nbclient, nbformat
from jupyter_client import AsyncKernelManager

manager = AsyncKernelManager(kernel_name="python3")
if sys.platform != "win32":
    manager.transport = "ipc"
notebook = nbformat.read(sys.argv[1], 4)
nbclient.NotebookClient(notebook, km=manager, timeout=900).execute()
nbformat.write(notebook, sys.argv[2])
"""
SCRIPTS = NOTEBOOK.parents[1] / "scripts"
WITHOUT_OUTPUTS = """
import json, sys
import write_tutorial
cells = json.load(open(sys.argv[1], encoding="utf-8"))["cells"]
print(write_tutorial.write_page(cells, []), end="")
"""

pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")


def test_the_notebook_is_kept_without_outputs() -> None:
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    assert len(cells) > 15
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


def test_the_page_of_the_tutorial_has_the_cells_of_the_notebook() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_OUTPUTS, str(NOTEBOOK)], cwd=SCRIPTS, capture_output=True, text=True, check=True
    )
    page = (NOTEBOOK.parents[1] / "docs" / "tutorial.md").read_text(encoding="utf-8")
    kept = re.sub(r"```text\n.*?```\n\n|!\[[^\n]*\n\n", "", page, flags=re.DOTALL)
    assert kept == done.stdout, "python scripts/write_tutorial.py"


def test_the_notebook_goes_from_a_bag_to_boxes_in_the_robots_frame(tmp_path: Path) -> None:
    for extra in ("nbclient", "rosbags"):
        if not os.environ.get("CI"):
            pytest.importorskip(extra)
    words = [sys.executable, "-c", RUN, str(NOTEBOOK), str(tmp_path / "done.ipynb")]
    with tempfile.TemporaryDirectory(prefix="nb-") as own:  # names of sockets must be short
        places = dict.fromkeys(("JUPYTER_RUNTIME_DIR", "JUPYTER_DATA_DIR", "JUPYTER_CONFIG_DIR", "IPYTHONDIR"), own)
        done = subprocess.run(
            words, cwd=tmp_path, env=os.environ | places, capture_output=True, text=True, check=False, timeout=1200
        )
    assert done.returncode == 0, done.stderr[-3000:]
    cells = json.loads((tmp_path / "done.ipynb").read_text(encoding="utf-8"))["cells"]
    outputs = [o for cell in cells for o in cell.get("outputs", ())]
    text = "".join("".join(o.get("text", ())) for o in outputs)
    assert text.count(": centre [") == text.count("m above the table") == 9
    assert "of 9 objects in reach" in text
    assert "segmap" in text
    assert text.count("[1, 2, 3, 4, 5, 6, 7, 8, 9]") == 3
    assert sum("image/png" in o.get("data", ()) for o in outputs) == 2
