"""Tune by looking.

Tune the parameters of a preset without a browser: set a parameter by its name, correct a region by a pixel, and save
the preset. With `--page`, the function `tune` opens a web page with sliders, the object masks and the point cloud.

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
"""Pixel (y, x) on the table."""


def main() -> None:
    """Set a parameter, keep a region as an object, and save the preset."""
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
