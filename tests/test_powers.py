"""The polynomials against the true functions."""

from __future__ import annotations

import numpy as np
import pytest

from spigolo.kernels.powers import exp2, log2, log2_1p, power

UNIT = np.concatenate([np.linspace(0, 1, 5001), 10.0 ** -np.arange(1, 40)])


def test_log2_1p() -> None:
    assert np.abs([log2_1p(x) - np.log2(1 + x) for x in UNIT]).max() < 3e-8
    assert log2_1p(0.0) == 0
    # relatively too, as many weights are tiny
    small = UNIT[(UNIT > 0) & (UNIT < 1e-2)]
    assert [log2_1p(x) for x in small] == pytest.approx(np.log1p(small) / np.log(2), rel=1e-7)


def test_log2_and_exp2() -> None:
    positive = UNIT[UNIT > 0]
    assert np.abs([log2(x) - np.log2(x) for x in positive]).max() < 3e-8
    assert [exp2(y) for y in np.linspace(-300, 0, 4001)] == pytest.approx(2 ** np.linspace(-300, 0, 4001), rel=1e-8)


@pytest.mark.parametrize("exponent", [1.0, 1.01, 1.5, 2.0])
def test_power(exponent: float) -> None:
    assert np.abs([power(x, exponent) - x**exponent for x in UNIT]).max() < 1e-7
    assert power(0.0, exponent) == 0
    assert power(1.0, exponent) == pytest.approx(1, abs=1e-7)
    assert power(1e-300, 2.0) == pytest.approx(0, abs=1e-8)
