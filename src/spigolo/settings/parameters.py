"""Base classes for the classes of parameters. Instances cannot be changed, and their values are validated. An invalid
parameter value raises an error with a one-line message.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import math
import sys
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from spigolo.errors import ConfigError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

VGA_PX = 640 * 480
"""Number of pixels of a 640x480 image. All parameters in pixels are given for an image of 640x480."""


@dataclass(frozen=True, slots=True)
class Grows:
    """Marker of a field that is a length in pixels for a 640x480 image.

    - odd: True if the length must stay an odd number.
    - always: True to scale the length even if `Additions.lengths_grow` is off.
    """

    odd: bool = False
    always: bool = False

    def times(self, length: float, factor: float) -> float:
        """Return the length multiplied by `factor`. An integer length is rounded to an integer of at least 1, but 0
        stays 0.
        """
        if isinstance(length, float):
            return length * factor
        if length == 0:
            return 0
        if self.odd:
            return 2 * round((length * factor - 1) / 2) + 1 if length * factor > 1 else 1
        return max(round(length * factor), 1)


@dataclass(frozen=True, slots=True)
class GrowsAsArea:
    """Marker of a field that is an area in square pixels for a 640x480 image."""


Share = Annotated[float, Field(ge=0, le=1)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Angle_deg = Annotated[float, Field(ge=0, le=180)]
Area_px2 = Annotated[float, Field(ge=0, allow_inf_nan=False), GrowsAsArea()]
MaxArea_px2 = Annotated[Positive | None, GrowsAsArea()]
Length_px = Annotated[int, Field(ge=0, le=1000), Grows()]
Offset_px = Annotated[int, Field(ge=1, le=100), Grows()]

S = TypeVar("S", bound="Settings")


class Settings(BaseModel):
    """Parameters of one stage. Instances cannot be changed, but `replace` returns a changed copy. Raises ConfigError
    for an invalid parameter value.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise ConfigError(_sentence(error, type(self))) from None

    @model_validator(mode="before")
    @classmethod
    def _none_switches_off(cls, values: Any) -> Any:
        """Convert the string "none" to None for fields that may be None. Preset files and command-line flags can
        express None only as the string "none". A truth value for a number becomes a string, which is then refused.
        """
        if not isinstance(values, Mapping):
            return values
        optional = {name for name, field in cls.model_fields.items() if type(None) in get_args(field.annotation)}
        truths = {name for name, field in cls.model_fields.items() if field.annotation is bool}
        changed = dict(values)
        for key, value in values.items():
            if isinstance(value, str) and value == "none" and key in optional:
                changed[key] = None
            elif isinstance(value, bool) and key not in truths:
                changed[key] = str(value).lower()
        return changed

    def replace(self: S, **changes: Any) -> S:
        """Return a validated copy of the parameters with changed values.

        Field names may be dotted, for example `replace(**{"partition.gamma": 0.004})`. The value of a stage may be a
        dict, for example `replace(partition={"gamma": 0.004})`. Fields of the stage that are not in this dict keep
        their values.
        """
        values = self.model_dump()
        for key, value in changes.items():
            stage, _, rest = key.partition(".")
            _merge(values, {stage: _nest(rest, _plain(value))})
        return type(self)(**values)

    def at_size(self: S, shape: tuple[int, int], lengths: bool = False) -> S:
        """Return a copy with lengths and areas in pixels scaled to images of shape (H, W). Call `at_size` only once,
        because a second call scales the lengths and areas again.

        Areas grow in proportion to the number of pixels of the image. Lengths marked with `Grows.always` grow in
        proportion to the square root of the number of pixels. Lengths without the mark `Grows.always` are scaled in the
        same way only if `lengths` is True.
        """
        area = shape[0] * shape[1] / VGA_PX
        return self if area == 1 else self._grown(area, lengths)

    def _grown(self: S, area: float, lengths: bool) -> S:
        values: dict[str, Any] = {}
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if isinstance(value, Settings):
                values[name] = value._grown(area, lengths)
            for mark in field.metadata:
                if isinstance(mark, GrowsAsArea) and value is not None:
                    values[name] = value * area
                if isinstance(mark, Grows) and (lengths or mark.always):
                    several, factor = isinstance(value, tuple), math.sqrt(area)
                    values[name] = tuple(mark.times(v, factor) for v in value) if several else mark.times(value, factor)
        return self.model_copy(update=values)


class Parameters(Settings):
    """All parameters of a method."""

    @property
    def digest(self) -> str:
        """Return a hash of all parameter values except the name, as eight hexadecimal digits."""
        values = json.dumps(self.model_dump(mode="json", exclude={"name"}), sort_keys=True)
        return hashlib.sha256(values.encode()).hexdigest()[:8]


def parse_toml(text: str) -> dict[str, Any]:
    """Parse a TOML text into nested dicts. Raises ConfigError with the line number of a syntax error."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"expected TOML: {error}") from None


def _plain(value: Any) -> Any:
    return value.model_dump() if isinstance(value, BaseModel) else deepcopy(value)  # leave the caller's value unchanged


def _nest(dotted: str, value: Any) -> Any:
    for key in reversed(dotted.split(".") if dotted else []):
        value = {key: value}
    return value


def _merge(values: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Write the values of `changes` into the dict `values`, including nested dicts. If the field `kind` of a cost
    function changes, the whole dict of the cost function is replaced.
    """
    for key, new in changes.items():
        old = values.get(key)
        if isinstance(old, dict) and isinstance(new, Mapping) and new.get("kind", old.get("kind")) == old.get("kind"):
            _merge(old, new)
        else:
            values[key] = new


def _sentence(error: ValidationError, model: type[BaseModel]) -> str:
    first = error.errors()[0]
    inner = first.get("ctx", {}).get("error")
    if isinstance(inner, ConfigError):
        return str(inner)
    # pydantic puts the kind of a cost function into the location as if the kind were a field
    where = ".".join(str(part) for i, part in enumerate(first["loc"]) if i == 0 or str(part) not in _kinds(model))
    if first["type"] == "extra_forbidden":
        wrong = str(first["loc"][-1])
        paths = {path.rpartition(".")[2]: path for path in sorted(_paths(model), key=lambda p: -p.count("."))}
        near = difflib.get_close_matches(wrong, paths, n=1, cutoff=0.5)
        hint = f"did you mean {paths[near[0]]!r}? " if near else ""
        return f"unknown parameter {where!r} in {model.__name__}: {hint}It has {', '.join(model.model_fields)}"
    got = "" if isinstance(first["input"], dict | BaseModel) else f", got {first['input']!r}"
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "tuple_type":
        message = "expected numbers with commas between them, such as 0,-1,0"
    return f"{where + ': ' if where else ''}{message}{got} (in {model.__name__})"


def _parts(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the parameter classes in a type annotation, including the members of unions."""
    for part in (annotation, *getattr(annotation, "__args__", ())):
        if isinstance(part, type) and issubclass(part, BaseModel):
            yield part
        elif part is not annotation:
            yield from _parts(part)


def _kinds(model: type[BaseModel]) -> set[str]:
    """Return the default values of the field `kind` in a parameter class and in its nested classes."""
    kinds = {str(model.model_fields["kind"].default)} if "kind" in model.model_fields else set()
    return kinds.union(*(_kinds(part) for f in model.model_fields.values() for part in _parts(f.annotation)))


def _paths(model: type[BaseModel]) -> Iterator[str]:
    """Yield the dotted names of all fields of a parameter class, including the fields of nested classes."""
    for name, field in model.model_fields.items():
        yield name
        for part in _parts(field.annotation):
            yield from (f"{name}.{path}" for path in _paths(part))
