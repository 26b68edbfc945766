"""Command `datasets`, which lists the known data sets, and command `fetch`, which downloads a data set."""

from __future__ import annotations

from pathlib import Path

from spigolo.cli import DONE
from spigolo.cli.progress import progress


def datasets() -> int:
    """List the known data sets with their names, sizes, licences and web addresses.

    `spigolo fetch` can download data sets that are marked with an asterisk. `spigolo evaluate` also reads other folders
    with the same layout as a known data set. Example: `spigolo evaluate rgbd-scenes/ --presets TABLE`.
    """
    from spigolo.lab.datasets.catalogue import KNOWN_SETS

    for known in KNOWN_SETS:
        print(f"{known.name + ('*' if known.archives else ''):13s} {known.title}")
        print(f"{'':13s} {known.size}; licence {known.licence}; {known.home}")
    return DONE


def fetch(name: str, *, to: Path = Path()) -> int:
    """Download a data set, verify its checksum and unpack it.

    An interrupted download continues with the next call. Example: `spigolo fetch ruapc --to data/`, then `spigolo
    evaluate data/ruapc`.

    Parameters
    ----------
    name
        Name of a data set that `spigolo datasets` marks with an asterisk. Other data sets must be downloaded by hand
        from their web address, which `spigolo datasets` prints.
    to
        Folder in which a folder for the data set is created. Default: the current folder.

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
