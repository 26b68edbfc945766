"""What is evaluated: methods that take a frame and answer with a segmentation, ours with a preset one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from spigolo.config import Config
from spigolo.errors import ConfigError
from spigolo.evaluation.rows import Row
from spigolo.frame import Frame
from spigolo.objects import Segmentation
from spigolo.stream import Segmenter


class Method(Protocol):
    """A method with its parameters: picklable, as worker processes get a copy each.

    name: of the method. preset: of its parameters. digest: changes with any of their values. parameters: the values,
    as JSON has them.
    """

    name: str
    preset: str
    digest: str
    parameters: Mapping[str, Any]

    def __call__(self, frame: Frame) -> Segmentation:
        """The objects of a frame; raises SpigoloError for one that it cannot work with."""


class Toscana2016:
    """Ours with one configuration, its buffers kept from frame to frame."""

    name = "toscana2016"

    def __init__(self, config: Config) -> None:
        self.preset, self.digest = config.name, config.digest
        self.parameters: Mapping[str, Any] = config.model_dump(mode="json")
        self._segmenter = Segmenter(config)

    def __call__(self, frame: Frame) -> Segmentation:
        """The objects of a frame."""
        return self._segmenter(frame)

    def __reduce__(self) -> tuple[type[Toscana2016], tuple[Config]]:
        """As a configuration: buffers and lock stay behind."""
        return Toscana2016, (self._segmenter.config,)


BASELINES: dict[str, Callable[[], Method]] = {}
"""Every other method by name, made with its own parameters."""


def method_names() -> list[str]:
    """The names that `make_methods` knows."""
    return [Toscana2016.name, *BASELINES]


def make_methods(names: Sequence[str], configs: Sequence[Config]) -> list[Method]:
    """Methods by name: `toscana2016` once per configuration, any other once. The same parameters come once.

    Raises ConfigError for a name that is not known.
    """
    methods: dict[tuple[str, str], Method] = {}
    for name in names:
        if name not in method_names():
            raise ConfigError(f"unknown method {name!r}: expected one of {', '.join(method_names())}")
        made: list[Method] = [Toscana2016(c) for c in configs] if name == Toscana2016.name else [BASELINES[name]()]
        for method in made:
            methods.setdefault((method.name, method.digest), method)
    return list(methods.values())


def remake(row: Row) -> Method | None:
    """The method of a row with the row's parameters, None where it no longer exists with these."""
    if row.method not in method_names():
        return None
    try:
        ours = row.method == Toscana2016.name
        method = Toscana2016(Config(**row.parameters)) if ours else BASELINES[row.method]()
    except ConfigError:
        return None
    return method if method.digest == row.digest else None
