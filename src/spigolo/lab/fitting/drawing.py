"""Random parameter values from a search space, drawn by optuna.

All settings (sets of parameter values) are drawn before any frame is scored. Held-out frames therefore have no
influence on the settings.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from spigolo.errors import SpigoloError
from spigolo.lab.fitting.spaces import Choice, Range, Setting, Space, Switch, complete

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution

NEEDS_OPTUNA = 'fitting needs optuna, which is not installed: pip install "spigolo[fit]"'
DIGITS = 4


def draw(space: Space, count: int, seed: int) -> list[Setting]:
    """Draw `count` random settings (sets of parameter values).

    With the same seed, a larger `count` returns the same first settings and appends more settings. Raises SpigoloError
    if optuna is not installed.
    """
    try:
        import optuna
    except ModuleNotFoundError:
        raise SpigoloError(NEEDS_OPTUNA) from None
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(sampler=optuna.samplers.RandomSampler(seed=seed))
    optuna.logging.set_verbosity(before)
    distributions = {name: _distribution(way) for name, way in space.items()}
    drawn = [{name: _short(value) for name, value in study.ask(distributions).params.items()} for _ in range(count)]
    return [complete(values, space) for values in drawn]


def _distribution(way: Range | Choice | Switch) -> BaseDistribution:
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    match way:
        case Range(low=int(low), high=int(high), log=log):
            return IntDistribution(low, high, log=log)
        case Range(low=low, high=high, log=log):
            return FloatDistribution(low, high, log=log)
        case Choice(options=options):
            return CategoricalDistribution(options)
        case Switch():
            return CategoricalDistribution((True, False))


def _short(value: object) -> object:
    """Round a float to `DIGITS` significant digits. Values that are not floats are returned unchanged."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value
