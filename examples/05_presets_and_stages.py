"""Presets and stages.

Change fields of a preset, write the preset to a TOML file, read the file, and compare the results of several presets.
The function `trace` segments a frame and keeps the result of every stage, to show why a region was rejected.

    python examples/05_presets_and_stages.py [rgb.png depth.png camera.json] [--out FOLDER]
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import spigolo as sp
from spigolo.frames.files import write_png
from spigolo.view.figure1 import figure1

SCENE = Path(sp.__file__).parent / "demo_scene"


def main() -> None:
    """Compare the results of TABLE, of a changed TABLE and of OBJECTS."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=[SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json"])
    parser.add_argument("--out", type=Path, default=Path("spigolo-examples"), help="default: %(default)s")
    given = parser.parse_args()
    if len(given.files) != 3:
        parser.error("expected a colour image, a depth image and a camera file")
    frame = sp.read_frame(*given.files)

    # change TABLE for larger objects: more merging, and larger limits of the region size
    mine = sp.TABLE.replace(
        name="mine", partition={"gamma": 0.0065}, rejection={"max_lambda1_px2": 7000.0, "max_lambda2_px2": 2400.0}
    )
    path = given.out / "mine.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(mine.to_toml(), encoding="utf-8")  # read it with `spigolo segment --preset mine.toml`
    assert sp.preset(path) == mine

    for config in (sp.TABLE, mine, sp.OBJECTS):
        run = sp.trace(frame, config)
        found = run.segmentation
        print(f"{config.name} {config.digest}: {run.regions.count} regions, {len(found)} objects")
        for reason, count in Counter(r.reason for r in found.rejected).most_common():
            example = next(r.why for r in found.rejected if r.reason is reason)
            print(f"  {count:2d} x {reason.value}, such as {example!r}")
        write_png(given.out / f"05_{config.name}.png", figure1(run))


if __name__ == "__main__":
    main()
