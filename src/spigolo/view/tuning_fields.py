"""Description of the controls of a configuration: range, step, unit and help text of each parameter."""

from __future__ import annotations

import math
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from spigolo.settings.config import Config
from spigolo.settings.parameters import Grows
from spigolo.settings.presets import OBJECTS, PRESETS, SHELF

UNITS = {"m": "m", "px": "px", "px2": "px²", "deg": "°", "per_m": "1/m", "px_m": "px/m"}
SHORT = {"min": "min.", "max": "max."}
LIMITS = ("ge", "gt", "le", "lt")
STEPS = 200
"""Approximate number of steps of a slider."""

MAIN = {
    "additions.support.min_height_m": "height above plane (m)",
    "additions.contours.step_m": "depth step (m)",
    "additions.contours.crease_high_deg": "max. crease angle (deg)",
    "additions.rules.wall.min_hides": "min. outline with step",
    "additions.rules.min_contour": "min. contour",
    "additions.merging.max_mean": "max. boundary to merge",
    "partition.gamma": "region size (gamma)",
    "partition.min_size_px2": "min. region (px²)",
    "additions.rules.max_length_m": "max. length (m)",
    "additions.rules.max_width_m": "max. width (m)",
    "rejection.max_distance_m": "max. distance (m)",
}
"""Labels of the most important parameters, indexed by dotted name, in the order in which the page shows them."""

UNSET = {"depth.depth_range": 1.0, "partition.gamma_shadows": SHELF.partition.gamma}
"""Initial values of two parameters that are None in all presets: 1 m for `depth_range`, and the gamma of the preset
SHELF for `gamma_shadows`.
"""


@dataclass(frozen=True, slots=True)
class Range:
    """Range of a slider on the tuning page."""

    low: float
    """Minimum of the slider."""
    high: float
    """Maximum of the slider."""
    step: float
    """Difference between two neighbouring values of the slider."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """Description of the control of one parameter, which is a number, switch, choice or list."""

    path: str
    """Dotted name of the parameter, as in `Config.replace`."""
    key: str
    """Unique name of the control. Parameters of alternative classes, such as the cost functions, can have the same
    path. The keys of two controls are always different.
    """
    label: str
    """Name and unit of the parameter on the page."""
    help: str
    """Help text of the parameter."""
    kind: Literal["number", "integer", "switch", "choice", "list"]
    """Type of the control."""
    optional: bool
    """True if the parameter may be None. The value None switches off the rule to which the parameter belongs."""
    limits: tuple[float | None, float | None]
    """Minimum and maximum of the parameter. The value None means no limit."""
    choices: tuple[str | int, ...]
    """Allowed values of the parameter if its kind is "choice"."""
    above: bool
    """True if the parameter must be larger than its minimum."""
    odd: bool
    """True if the parameter must be an odd number."""
    default: Any
    """Default value of the parameter in its class. The value is None if the class gives no default value."""


@dataclass(frozen=True, slots=True)
class Stage:
    """Description of the controls of one stage. A stage is a class with several parameters."""

    path: str
    """Dotted name of the stage in the configuration, or "" for the configuration itself."""
    key: str
    """Unique name of the stage."""
    label: str
    """Name of the stage on the page."""
    help: str
    """Help text of the stage."""
    optional: bool
    """True if the stage may be None. The value None switches the stage off."""
    model: type[BaseModel]
    """Class that contains the parameters of the stage."""
    parts: tuple[Leaf | Stage | Variants, ...]
    """Descriptions of all parameters of the stage, and of the stages inside it."""


@dataclass(frozen=True, slots=True)
class Variants:
    """Description of the controls of a stage for which the user selects one of several classes, such as the cost
    function.
    """

    path: str
    """Dotted name of the stage in the configuration."""
    key: str
    """Unique name of the stage."""
    label: str
    """Name of the stage on the page."""
    help: str
    """Help text of the stage."""
    stages: dict[str, Stage]
    """Classes that the user can choose for this stage: description of each class, indexed by its field `kind`."""


Part = Leaf | Stage | Variants


def controls_of(model: type[BaseModel] = Config) -> Stage:
    """Return the description of the controls of a parameter class, by default of `Config`."""
    return Stage("", "", "", "", False, model, tuple(_parts(model, "", "")))


def leaves(part: Part) -> Iterator[Leaf]:
    """Yield the descriptions of all parameters inside a part. A part is a parameter, a stage, or a stage with
    alternative classes.
    """
    if isinstance(part, Leaf):
        yield part
        return
    for inner in part.stages.values() if isinstance(part, Variants) else part.parts:
        yield from leaves(inner)


def walk(part: Part) -> Iterator[Part]:
    """Yield a part and all parts inside it. A part is a parameter, a stage, or a stage with alternative classes."""
    yield part
    if not isinstance(part, Leaf):
        for inner in part.stages.values() if isinstance(part, Variants) else part.parts:
            yield from walk(inner)


def value_at(values: Any, path: str) -> Any:
    """Return the value with a dotted name in nested dicts or classes. Return None if the value belongs to a stage that
    is switched off.
    """
    for name in path.split(".") if path else ():
        values = values.get(name) if isinstance(values, Mapping) else getattr(values, name, None)
    return values


def range_of(leaf: Leaf, value: float) -> Range:
    """Return the range of a slider, within the limits of the parameter.

    If the parameter is a floating-point number with an upper limit of at most 180, the slider ends at this limit. Other
    sliders end at four times a typical value, rounded up to 1, 2 or 5 times a power of ten. No slider exceeds the upper
    limit of its parameter. The typical value is the largest of `value` and of the preset values that are at most ten
    times as large as `value`.

    value: current value of the parameter.
    """
    low, high = leaf.limits
    near = [abs(value), *(v for v in _presets(leaf.path) if v <= 10 * abs(value) or value == 0)]
    top = _round_up(4 * max([*near, 1e-3]))
    if high is not None:
        top = min(top, high) if leaf.kind == "integer" or high > 180 else high
    bottom = low if low is not None else min(-top if value < 0 else 0.0, value)
    if leaf.kind == "integer":
        top = max(math.ceil(top), bottom + 2)
        return Range(bottom + leaf.odd * (1 - bottom % 2), top - leaf.odd * (1 - top % 2), 1 + leaf.odd)
    step = _round_down((top - bottom) / STEPS)
    step = min(step, _finest(value, step))
    return Range(bottom + step if leaf.above else bottom, top, step)


def first_value(leaf: Leaf) -> Any:
    """Return an initial value for a parameter that is None in the current configuration.

    The value is taken from the preset OBJECTS, or else from another preset, from the default value of the parameter, or
    from the dict `UNSET`.
    """
    if leaf.key == leaf.path:
        for config in (OBJECTS, *PRESETS.values()):
            value = value_at(config, leaf.path)
            if value is not None:
                return value
    if leaf.default is not None:
        return leaf.default
    return UNSET.get(leaf.path, {"number": 0.5, "integer": 1, "switch": False, "list": (0.0, -1.0, 0.0)}[leaf.kind])


def _parts(model: type[BaseModel], path: str, key: str) -> Iterator[Part]:
    for name, field in model.model_fields.items():
        if name in ("name", "kind"):
            continue
        where, unique = f"{path}{name}", f"{key}{name}"
        models = _models(field.annotation)
        text = " ".join((field.description or "").split())
        if len(models) > 1:
            stages = {str(m.model_fields["kind"].default): _stage(m, where, f"{unique}[{m.__name__}]") for m in models}
            yield Variants(where, unique, _words(name), text, stages)
        elif models:
            optional = type(None) in get_args(field.annotation)
            yield Stage(
                where,
                unique,
                _words(name),
                text,
                optional,
                models[0],
                tuple(_parts(models[0], f"{where}.", f"{unique}.")),
            )
        else:
            yield _leaf(field, where, unique, text)


def _stage(model: type[BaseModel], path: str, key: str) -> Stage:
    kind = str(model.model_fields["kind"].default)
    text = " ".join((model.__doc__ or "").split())
    return Stage(path, key, kind, text, False, model, tuple(_parts(model, f"{path}.", f"{key}.")))


def _leaf(field: FieldInfo, path: str, key: str, text: str) -> Leaf:
    name = path.rpartition(".")[2]
    bare, optional, marks = _bare(field.annotation, list(field.metadata))
    limits = _limits(marks)
    origin = get_origin(bare)
    choices = get_args(bare) if origin is Literal else ()
    kind: Literal["number", "integer", "switch", "choice", "list"]
    if choices:
        kind = "choice"
    elif origin is tuple:
        kind = "list"
    else:
        kind = "switch" if bare is bool else "integer" if bare is int else "number"
    grows = next((mark for mark in marks if isinstance(mark, Grows)), None)
    default = None if field.is_required() else field.default
    odd = grows is not None and grows.odd
    return Leaf(path, key, _label(name), text, kind, optional, limits[:2], choices, limits[2], odd, default)


def _bare(annotation: Any, marks: list[Any]) -> tuple[Any, bool, list[Any]]:
    """Split a type annotation. Return the type without None and metadata, True if None is allowed, and the metadata."""
    optional = False
    while get_origin(annotation) in (Annotated, Union, types.UnionType):
        if get_origin(annotation) is Annotated:
            annotation, *more = get_args(annotation)
            marks = [*marks, *more]
        else:
            optional = type(None) in get_args(annotation)
            annotation = next(part for part in get_args(annotation) if part is not type(None))
    return annotation, optional, marks


def _limits(marks: list[Any]) -> tuple[float | None, float | None, bool]:
    """Return the minimum and the maximum of a parameter. Also return True if the parameter must be larger than the
    minimum.
    """
    found = [inner for mark in marks for inner in (mark, *getattr(mark, "metadata", ()))]
    value = {name: next((v for m in found if (v := getattr(m, name, None)) is not None), None) for name in LIMITS}
    low = value["gt"] if value["ge"] is None else value["ge"]
    return low, value["le"] if value["lt"] is None else value["lt"], value["gt"] is not None


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type):
        return [annotation] if issubclass(annotation, BaseModel) else []
    return [model for part in get_args(annotation) for model in _models(part)]


def _words(name: str) -> str:
    words = [SHORT.get(word, word) for word in name.split("_")]
    return " ".join(words)


def _label(name: str) -> str:
    for suffix in sorted(UNITS, key=len, reverse=True):
        if name.endswith(f"_{suffix}"):
            return f"{_words(name.removesuffix(f'_{suffix}'))} ({UNITS[suffix]})"
    return _words(name)


def _presets(path: str) -> list[float]:
    values = (value_at(config, path) for config in PRESETS.values())
    return [float(v) for v in values if isinstance(v, int | float)]


def _round_up(value: float) -> float:
    """Round a value up to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(float(f"{m * power:.6g}") for m in (1, 2, 5, 10) if m * power >= value * (1 - 1e-9))


def _round_down(value: float) -> float:
    """Round a value down to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(float(f"{m * power:.6g}") for m in (5, 2, 1) if m * power <= value * (1 + 1e-9))


def _finest(value: float, step: float) -> float:
    """Return a smaller step for a slider, so that the value of the parameter is a multiple of the step. The step is
    divided by at most 100.
    """
    for divisor in (1, 2, 5, 10, 20, 50, 100):
        count = value / step * divisor
        if abs(count - round(count)) < 1e-6:
            return float(f"{step / divisor:.6g}")
    return step / 100
