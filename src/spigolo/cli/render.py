"""The verb that renders stand-ins for data sets: render."""

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
    """Renders household scenes with exact masks and poses, as a structured-light camera would record them.

    Examples: `spigolo render table --out rendered`, then `spigolo evaluate rendered --presets TABLE`; or
    `spigolo render shelf --count 72 --layout original --out stand-ins`. It needs the extra `synthetic`.

    Parameters
    ----------
    family
        shelf: products in a bin, in little light, as the Rutgers APC set. table: table-tops of several categories, as
        RGB-D Scenes. multi: three instances of one object among clutter, as the set of Tejani et al.
    count
        Frames. The family's scenes have their turns.
    seed
        Equal seeds give equal frames.
    layout
        folders: one folder a frame. bop: that of the BOP challenge. original: that of the set it stands in for.
    out
        Folder for them. `rendered.json` in it says that they are no photographs.

    """
    from spigolo.lab.synthetic.layouts import write_family

    with progress(transient=True) as bar:
        task = bar.add_task("rendering", total=count)
        written = write_family(family, count, seed, out, layout, lambda done: bar.update(task, completed=done))
    print(f"{written} {'frame' if written == 1 else 'frames'} of {family}, seed {seed}: {out}")
    return DONE
