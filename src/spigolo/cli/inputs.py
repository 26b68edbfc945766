"""Parsing of command-line arguments: input files, and flags such as `--partition.gamma` for fields of the preset."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter, validators

from spigolo.cli.region import Region
from spigolo.errors import ConfigError

if TYPE_CHECKING:
    from spigolo.settings.config import Config

DEMO_SCENE = Path(__file__).parents[1] / "demo_scene"

SHORT = {"resolution": "additions.resolution"}
"""Short flag names, and the preset fields that these flags set."""

Inputs = Annotated[str, Parameter(allow_leading_hyphen=True)]
Many = Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative=(), show_default=" ".join)]
Out = Annotated[Path, Parameter(alias="-o")]
Frames = Annotated[int | None, Parameter(validator=validators.Number(gte=1))]
Index = Annotated[int | None, Parameter(validator=validators.Number(gte=0))]
Distance_m = Annotated[float | None, Parameter(validator=validators.Number(gte=0))]
Port = Annotated[int, Parameter(validator=validators.Number(gte=0, lte=65535))]
Jobs = Annotated[int | None, Parameter(alias="-j")]


def split_flags(words: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    """Separate input files from flags of the form `--partition.gamma 0.004` or `--partition.gamma=0.004`."""
    inputs: list[str] = []
    flags: dict[str, str] = {}
    rest = iter(words)
    for word in rest:
        if not word.startswith("--"):
            inputs.append(word)
            continue
        key, equals, value = word[2:].replace("-", "_").partition("=")
        if equals:
            value = word.partition("=")[2]
        else:
            value = next(rest, "")
        flags[key] = value
    return inputs, flags


def configure(preset: str, flags: dict[str, str], command: Callable[..., int] | None = None) -> Config:
    """Return a copy of the preset in which the values of the flags replace the values of the fields.

    - preset: name or TOML file.
    - flags: values as text, indexed by field name.
    - command: function that implements the command. If a flag is misspelt, the error message suggests a flag of this
      command.

    Raises ConfigError for an unknown flag.
    """
    from spigolo.settings.fields import field_names, value_of_text
    from spigolo.settings.presets import preset as find

    config = find(preset)
    known = field_names(config)
    flags = {SHORT.get(key, key): value for key, value in flags.items()}
    for key in flags:
        if key not in known:
            meant = difflib.get_close_matches(key, _own_flags(command), n=1, cutoff=0.75)
            near = meant or difflib.get_close_matches(key, known, n=3, cutoff=0.4)
            hint = f"did you mean {' or '.join('--' + n.replace('_', '-') for n in near)}?" if near else ""
            raise ConfigError(f"unknown flag --{key.replace('_', '-')} for preset {config.name}: {hint}".rstrip(": "))
    empty = next((key for key, value in flags.items() if not value), None)
    if empty is not None:
        raise ConfigError(f"expected a value after --{empty.replace('_', '-')}, got none")
    return config.replace(**{key: value_of_text(value) for key, value in flags.items()}) if flags else config


def _own_flags(command: Callable[..., int] | None) -> list[str]:
    parameters = {} if command is None else inspect.signature(command).parameters
    own = [name for name, parameter in parameters.items() if parameter.kind is parameter.KEYWORD_ONLY]
    return own + [field.name for field in fields(Region) if "region" in own]
