"""Command `render`, which renders labelled frames similar to those of published data sets."""

from __future__ import annotations

from pathlib import Path

from spigolo.cli import DONE
from spigolo.cli.inputs import Out
from spigolo.cli.progress import progress


def render(
    family: str,
    *,
    count: int = 60,
    seed: int = 0,
    layout: str = "folders",
    out: Out = Path("spigolo-rendered"),
) -> int:
    """Render household scenes as a structured-light camera would record them, with exact masks and poses of the
    objects.

    Examples: `spigolo render table --out rendered`, then `spigolo evaluate rendered --presets TABLE`. To imitate a
    published data set in its own layout, use `spigolo render shelf --count 72 --layout original`. The command `render`
    requires `pip install "spigolo[synthetic]"`.

    Parameters
    ----------
    family
        Family of scenes: `shelf`, `table` or `multi`. Scenes of `shelf` show products in a bin in low light, as in the
        Rutgers APC data set. Scenes of `table` show table-tops with objects of several categories, as in RGB-D Scenes.
        Scenes of `multi` show three instances of one object in clutter, as in the data set of Tejani et al.
    count
        Number of frames to render. The different scenes of the family alternate from frame to frame.
    seed
        Seed of the random scenes. Equal seeds give equal frames.
    layout
        Layout of the files: `folders`, `bop` or `original`. The layout `folders` has one folder for each frame. The
        layout `bop` is the file layout of the BOP challenge. The layout `original` is the file layout of the imitated
        data set.
    out
        Output folder. The file `rendered.json` in the output folder marks the frames as rendered.

    """
    from spigolo.lab.synthetic.layouts import write_family

    with progress(transient=True) as bar:
        task = bar.add_task("rendering", total=count)
        written = write_family(family, count, seed, out, layout, lambda done: bar.update(task, completed=done))
    print(f"{written} {'frame' if written == 1 else 'frames'} of {family}, seed {seed}: {out}")
    return DONE
