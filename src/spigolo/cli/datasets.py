"""The verbs of data sets: datasets lists those that are known, fetch brings one."""

from __future__ import annotations

from pathlib import Path

from spigolo.cli import DONE
from spigolo.cli.progress import progress


def datasets() -> int:
    """Lists the data sets that are known: name, size, licence, where they are published.

    Other folders in one of their layouts are read as well, and so are your own frames. `spigolo fetch` brings those
    marked with an asterisk. Example: `spigolo evaluate rgbd-scenes/ --presets TABLE`.
    """
    from spigolo.lab.datasets.catalogue import KNOWN_SETS

    for known in KNOWN_SETS:
        print(f"{known.name + ('*' if known.archives else ''):13s} {known.title}")
        print(f"{'':13s} {known.size}; licence {known.licence}; {known.home}")
    return DONE


def fetch(name: str, *, to: Path = Path()) -> int:
    """Fetches a data set, verifies it and unpacks it; a run that was cut off goes on.

    Example: `spigolo fetch ruapc --to data/`, then `spigolo evaluate data/ruapc`.

    Parameters
    ----------
    name
        One that `spigolo datasets` marks with an asterisk. Of the others no hash is known: it says where they are.
    to
        The folder that will hold the folder of the set.

    """
    from rich.progress import DownloadColumn, TaskID, TextColumn, TransferSpeedColumn

    from spigolo.lab.datasets.catalogue import known_set
    from spigolo.lab.datasets.fetching import fetch as run

    known = known_set(name)
    columns = TextColumn("{task.description}"), DownloadColumn(), TransferSpeedColumn()
    with progress(*columns) as bar:
        tasks: dict[str, TaskID] = {}

        def tell(file: str, done: int, total: int | None) -> None:
            if file not in tasks:
                tasks[file] = bar.add_task(file)
            bar.update(tasks[file], completed=done, total=total)

        folder = run(known, to, tell)
    print(f"{known.title}: {folder}; licence {known.licence}")
    return DONE
