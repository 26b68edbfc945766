"""Statistics of measured times: medians, ratios of the times of two functions, and power laws fitted to the times."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spigolo.lab.bench.timing import Sample


@dataclass(frozen=True, slots=True)
class Summary:
    """Median and minimum time of several runs of one function, in milliseconds."""

    cpu_ms: float
    cpu_min_ms: float
    wall_ms: float
    wall_min_ms: float


def summarise(samples: Sequence[Sample]) -> Summary:
    """Return the median and minimum times of one or more runs."""
    cpu, wall = [s.cpu_ms for s in samples], [s.wall_ms for s in samples]
    return Summary(statistics.median(cpu), min(cpu), statistics.median(wall), min(wall))


def paired_ratio(peer: Sequence[Sample], ours: Sequence[Sample]) -> float:
    """Return the median ratio of the CPU times of two functions, `peer` divided by `ours`.

    The CPU time of sample k of `peer` is divided by the CPU time of sample k of `ours`. The median of the ratios is
    returned.
    """
    return statistics.median(p.cpu_ms / o.cpu_ms for p, o in zip(peer, ours, strict=True))


@dataclass(frozen=True, slots=True)
class PowerLaw:
    """Power law t = factor * x^exponent. x is a measure of the image size, and t is the CPU time."""

    factor: float
    exponent: float
    residual: float
    """Root mean square deviation of ln(t) from the fit, where t is the measured time. A deviation of 0.01 means that
    the times differ from the fit by about 1 %.
    """


def fit_power_law(x: Sequence[float], t: Sequence[float]) -> PowerLaw:
    """Fit a power law t(x) by least squares in ln(x) and ln(t).

    All x and t must be positive, and at least two x must differ.
    """
    log_x, log_t = np.log(x), np.log(t)
    spread = log_x - log_x.mean()
    exponent = float(spread @ (log_t - log_t.mean()) / (spread @ spread))
    offset = float(log_t.mean() - exponent * log_x.mean())
    residual = float(np.sqrt(np.mean((log_t - offset - exponent * log_x) ** 2)))
    return PowerLaw(float(np.exp(offset)), exponent, residual)


def percentile(values: Sequence[float], share: float) -> float:
    """Return a percentile of the values, for example the 99th percentile for `share` = 0.99.

    The returned percentile is always one of the given values, without interpolation.
    """
    return float(np.quantile(values, share, method="inverted_cdf"))
