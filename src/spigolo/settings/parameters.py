"""What all parameters share, ours and the other methods': frozen, checked, one sentence where they are wrong."""

from __future__ import annotations

import difflib
import hashlib
import json
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

Share = Annotated[float, Field(ge=0, le=1)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True)
class Grows:
    """Marks a length in pixels that is given for a 640x480 image. odd: it stays odd."""

    odd: bool = False

    def times(self, length: float, factor: float) -> float:
        """The length in an image so many times larger; whole numbers stay whole and are 1 at least, unless 0."""
        if isinstance(length, float):
            return length * factor
        if length == 0:
            return 0
        if self.odd:
            return 2 * round((length * factor - 1) / 2) + 1 if length * factor > 1 else 1
        return max(round(length * factor), 1)


Length_px = Annotated[int, Field(ge=0, le=1000), Grows()]
Offset_px = Annotated[int, Field(ge=1, le=100), Grows()]

P = TypeVar("P", bound="Parameters")
S = TypeVar("S", bound="Stage")


class Stage(BaseModel):
    """Parameters of one stage. Raises ConfigError with a sentence for what is unknown or out of range."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise ConfigError(_sentence(error, type(self))) from None

    @model_validator(mode="before")
    @classmethod
    def _none_switches_off(cls, values: Any) -> Any:
        """The word "none" is None for what may be None: preset files and flags have no other."""
        if not isinstance(values, Mapping):
            return values
        optional = {name for name, field in cls.model_fields.items() if type(None) in get_args(field.annotation)}
        return {
            key: None if isinstance(value, str) and value == "none" and key in optional else value
            for key, value in values.items()
        }

    def grown(self: S, factor: float) -> S:
        """A copy whose lengths in pixels, those of its stages too, are so many times longer."""
        values: dict[str, Any] = {}
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if isinstance(value, Stage):
                values[name] = value.grown(factor)
            for mark in field.metadata:
                if isinstance(mark, Grows):
                    several = isinstance(value, tuple)
                    values[name] = tuple(mark.times(v, factor) for v in value) if several else mark.times(value, factor)
        return self.model_copy(update=values)


class Parameters(Stage):
    """All parameters of a method. Frozen: `replace` gives a changed copy."""

    @property
    def digest(self) -> str:
        """Eight hexadecimal digits that change with any value but the name."""
        values = json.dumps(self.model_dump(mode="json", exclude={"name"}), sort_keys=True)
        return hashlib.sha256(values.encode()).hexdigest()[:8]

    def replace(self: P, **changes: Any) -> P:
        """A validated copy. Names may be dotted: `replace(**{"partition.gamma": 0.004})`.

        A mapping changes only the fields it names: `replace(partition={"gamma": 0.004})`.
        """
        values = self.model_dump()
        for key, value in changes.items():
            stage, _, rest = key.partition(".")
            _merge(values, {stage: _nest(rest, _plain(value))})
        return type(self)(**values)


def parse_toml(text: str) -> dict[str, Any]:
    """The tables of a TOML text. Raises ConfigError with the line where it is none."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"expected TOML: {error}") from None


def _plain(value: Any) -> Any:
    return value.model_dump() if isinstance(value, BaseModel) else deepcopy(value)  # the caller's stays as it is


def _nest(dotted: str, value: Any) -> Any:
    for key in reversed(dotted.split(".") if dotted else []):
        value = {key: value}
    return value


def _merge(values: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Changes `values` in place, mapping by mapping; another `kind` of cost starts afresh."""
    for key, new in changes.items():
        old = values.get(key)
        if isinstance(old, dict) and isinstance(new, Mapping) and new.get("kind", old.get("kind")) == old.get("kind"):
            _merge(old, new)
        else:
            values[key] = new


def _sentence(error: ValidationError, model: type[BaseModel]) -> str:
    first = error.errors()[0]
    # the kind of a cost stands in the location like a field: it is none of the user's
    kinds = ("saliency", "boundary", "auto")
    inner = first.get("ctx", {}).get("error")
    if isinstance(inner, ConfigError):
        return str(inner)
    where = ".".join(str(part) for i, part in enumerate(first["loc"]) if i == 0 or part not in kinds)
    if first["type"] == "extra_forbidden":
        wrong = str(first["loc"][-1])
        paths = {path.rpartition(".")[2]: path for path in sorted(_paths(model), key=lambda p: -p.count("."))}
        near = difflib.get_close_matches(wrong, paths, n=1, cutoff=0.5)
        hint = f"did you mean {paths[near[0]]!r}? " if near else ""
        return f"unknown parameter {where!r} in {model.__name__}: {hint}It has {', '.join(model.model_fields)}"
    got = "" if isinstance(first["input"], dict | BaseModel) else f", got {first['input']!r}"
    message = first["msg"].removeprefix("Value error, ")
    return f"{where + ': ' if where else ''}{message}{got} (in {model.__name__})"


def _paths(model: type[BaseModel]) -> Iterator[str]:
    """The dotted names of a model's fields and of those of its stages."""
    for name, field in model.model_fields.items():
        yield name
        for part in (field.annotation, *getattr(field.annotation, "__args__", ())):
            if isinstance(part, type) and issubclass(part, BaseModel):
                yield from (f"{name}.{path}" for path in _paths(part))
