"""Tune by looking.

A page with a slider for each parameter, the masks and the cloud is one call: tune(frames). Without a browser the same
session runs in a script: parameters are set by name, regions are corrected by a pixel, and the preset is saved.

    python examples/08_tune_by_looking.py [--page] [--out FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import spigolo as sp
from spigolo.frames.files import write_png
from spigolo.view.overlay import tile
from spigolo.view.tuning_scene import picture
from spigolo.view.tuning_session import Session

SCENE = Path(sp.__file__).parent / "demo_scene"
TABLE = 440, 150
"""A pixel (y, x) of the table."""


def main() -> None:
    """Set one parameter, keep one region, save the preset."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--page", action="store_true", help="show the page in a browser, until Ctrl-C")
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    if given.page:
        from spigolo.view.tuning import tune  # pip install "spigolo[tune]"

        tune(frame, sp.OBJECTS, folder=given.out)
        return

    session = Session(frame, sp.OBJECTS)
    pictures = {"OBJECTS": picture(session.run(), "objects")}
    session.set("additions.support.min_height_m", 0.05)
    answer = session.run()
    pictures["what stands 5 cm above the table"] = picture(answer, "objects")
    print(f"{len(answer.result)} objects, {len(answer.result.rejected)} rejected, {answer.wall_s * 1000:.0f} ms")
    session.correct("keep", TABLE)
    assert session.answer is not None
    pictures["and the table kept"] = picture(session.answer, "objects")
    print(f"{len(session.answer.result)} objects with the table")
    write_png(given.out / "06_tuned.png", tile(pictures, columns=3))
    session.save(given.out / "mine.toml")
    print((given.out / "mine.toml").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
