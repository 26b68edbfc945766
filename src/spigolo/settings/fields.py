"""Access to the fields of a preset by dotted name, for command-line flags, sliders and ROS parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from spigolo.settings.config import Config


def field_names(config: Config) -> dict[str, str]:
    """Return a dict of the help texts of all fields that a preset can have, indexed by dotted name."""
    return dict(_walk(config, ""))


def _walk(model: Any, prefix: str) -> Iterator[tuple[str, str]]:
    """Yield the dotted name and help text of each field of a pydantic model or model class. Fields of stages that are
    switched off (None) are included.
    """
    kind: type[BaseModel] = model if isinstance(model, type) else type(model)
    for name, field in kind.model_fields.items():
        value = None if isinstance(model, type) else getattr(model, name)
        candidates = [field.annotation, *getattr(field.annotation, "__args__", ())]
        stages = [c for c in candidates if isinstance(c, type) and issubclass(c, BaseModel)]
        inner = value if isinstance(value, BaseModel) else stages[0] if stages else None
        if inner is not None:
            yield from _walk(inner, f"{prefix}{name}.")
            if type(None) in candidates:
                yield f"{prefix}{name}", "`none` switches off this stage."
        elif name not in ("name", "kind"):
            yield f"{prefix}{name}", " ".join((field.description or "").split())


def value_at(config: Config, field: str) -> Any:
    """Return the value of the field with a dotted name. The value is None if the stage of the field is off, or if the
    field belongs to a cost function that is not used.
    """
    value: Any = config
    for part in field.split("."):
        value = getattr(value, part, None)
    return value


def value_of_text(text: str) -> Any:
    """Convert text to a value: a boolean, an integer, a float or a list such as `1,2`. Text in any other form is
    returned unchanged.
    """
    if "," in text:
        return [value_of_text(part.strip()) for part in text.strip("()[] ").split(",") if part.strip()]
    if text.lower() == "none":
        return "none"
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
