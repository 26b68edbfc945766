"""The polynomials against the true functions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from spigolo.kernels.powers import exp2, log2, log2_1p, power

UNIT = np.concatenate([np.linspace(0, 1, 5001), 10.0 ** -np.arange(1, 37)]).astype(np.float32)
"""All values are float32, the true functions of them float64."""


def each(function: Callable[..., float], values: np.ndarray, *more: np.float32) -> np.ndarray:
    return np.array([float(function(x, *more)) for x in values])


def test_log2_1p() -> None:
    assert np.abs(each(log2_1p, UNIT) - np.log2(1 + UNIT.astype(float))).max() < 2e-7
    assert log2_1p(np.float32(0)) == 0
    # relatively too, as many weights are tiny
    small = UNIT[(UNIT > 0) & (UNIT < 1e-2)]
    assert each(log2_1p, small) == pytest.approx(np.log1p(small.astype(float)) / np.log(2), rel=3e-7)


def test_log2_and_exp2() -> None:
    positive = UNIT[UNIT > 0]
    assert each(log2, positive) == pytest.approx(np.log2(positive.astype(float)), rel=3e-7, abs=2e-7)
    exponents = np.linspace(-126, 0, 4001).astype(np.float32)
    assert each(exp2, exponents) == pytest.approx(2 ** exponents.astype(float), rel=5e-7)


@pytest.mark.parametrize("exponent", np.float32([1.0, 1.01, 1.5, 2.0]))
def test_power(exponent: np.float32) -> None:
    assert np.abs(each(power, UNIT, exponent) - UNIT.astype(float) ** float(exponent)).max() < 5e-7
    assert power(np.float32(0), exponent) == 0
    assert power(np.float32(1), exponent) == pytest.approx(1, abs=1e-6)
    assert power(np.float32(1e-38), np.float32(2)) == pytest.approx(0, abs=1e-8)
