"""Run the notebook of the tutorial and write its page of the documentation: `python scripts/write_tutorial.py`.

The page is docs/tutorial.md, with the code and the outputs of examples/tutorial.ipynb. Images are written to
docs/images. Requires nbclient and rosbags.
"""

from __future__ import annotations

import argparse
import base64
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOK, PAGE = ROOT / "examples" / "tutorial.ipynb", ROOT / "docs" / "tutorial.md"
IMAGE = "images/tutorial-{}.jpg"
"""Path of an image of the page, relative to the folder of the page."""
HEAD = """
The tutorial is also a notebook: `examples/tutorial.ipynb` in the repository. The outputs below were printed by
`scripts/write_tutorial.py`.
"""


def main() -> None:
    argparse.ArgumentParser(description="Run the notebook of the tutorial and write docs/tutorial.md.").parse_args()
    import nbclient
    import nbformat

    notebook = nbformat.read(NOTEBOOK, 4)
    with tempfile.TemporaryDirectory() as folder:
        nbclient.NotebookClient(notebook, timeout=900, resources={"metadata": {"path": folder}}).execute()
    images: list[bytes] = []
    PAGE.write_text(write_page(notebook["cells"], images), encoding="utf-8")
    for number, png in enumerate(images, start=1):
        image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
        cv2.imwrite(str(PAGE.parent / IMAGE.format(number)), image, [cv2.IMWRITE_JPEG_QUALITY, 90])
    print(f"{PAGE}: {len(notebook['cells'])} cells, {len(images)} images")


def write_page(cells: Sequence[Mapping[str, Any]], images: list[bytes]) -> str:
    """Return the page as Markdown. The PNG images of the outputs are appended to `images`."""
    blocks: list[str] = []
    for cell in cells:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            blocks.append(re.sub(r"\]\(\.\./docs/", "](", source))
        else:
            blocks.append(f"```py\n{source}\n```")
            blocks += write_outputs(cell.get("outputs", ()), images)
    title, rest = blocks[0].split("\n", 1)
    return "\n\n".join([title, HEAD.strip(), rest.strip(), *blocks[1:]]) + "\n"


def write_outputs(outputs: Sequence[Mapping[str, Any]], images: list[bytes]) -> Iterator[str]:
    """Yield the outputs of a cell as Markdown blocks: printed text, and a link for each image."""
    printed = "".join("".join(output["text"]) for output in outputs if output.get("name") == "stdout")
    if printed:
        yield f"```text\n{printed.rstrip()}\n```"
    for output in outputs:
        png = output.get("data", {}).get("image/png")
        if png:
            images.append(base64.b64decode(png))
            yield f"![Objects that the code above found]({IMAGE.format(len(images))})"


if __name__ == "__main__":
    main()
