"""Paths of output files. A frame name is rejected if its files would be written outside of the output folder."""

from __future__ import annotations

import re
from pathlib import Path

from spigolo.errors import FileError

FORBIDDEN = re.compile(r'[\x00-\x1f\x7f\\:*?"<>|]')
"""Characters that at least one operating system forbids in file names."""
RESERVED = re.compile(r"(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:\..*)?", re.IGNORECASE)
"""Device names, which Windows forbids as file names."""
MAX_BYTES = 200
"""Maximum length in bytes of each part of a frame name between slashes. Most file systems allow 255 bytes for a file
name, including the prefix and the suffix that spigolo adds.
"""


def check_name(name: str) -> None:
    """Raise FileError if the name of a frame is not a valid relative path."""
    for part in name.split("/"):
        if wrong := _wrong_with(part):
            raise FileError(f"expected a frame name that can be a file name, got {name[:MAX_BYTES]!r}: {wrong}")


def _wrong_with(part: str) -> str | None:
    """Return the reason why a part of a frame name between slashes is invalid, or None if the part is valid."""
    wrong = {
        "a part of the name is empty, or the name begins or ends with /": not part,
        "the name would lead out of the output folder": part in (".", ".."),
        "a part of the name begins with a dot": part.startswith("."),
        "a part of the name ends with a dot or a space": part.endswith((".", " ")),
        "the name has a character that some systems forbid in file names": FORBIDDEN.search(part),
        "the name is reserved for a device on Windows": RESERVED.fullmatch(part),
        f"a part of the name has more than {MAX_BYTES} bytes": len(part.encode("utf-8", "surrogatepass")) > MAX_BYTES,
    }
    return next((reason for reason, found in wrong.items() if found), None)


def place(root: Path, folder: str, name: str, suffix: str) -> Path:
    """Return the path of an output file of a frame: ROOT/FOLDER/NAME + suffix.

    Raises FileError for an invalid name, and if a symbolic link leads out of the root folder.
    """
    check_name(name)
    path = root.joinpath(folder, *f"{name}{suffix}".split("/"))
    if not path.parent.resolve().is_relative_to(root.resolve()):
        raise FileError(f"could not write {path}: a symbolic link in the path leads out of {root}. Remove the link")
    return path
