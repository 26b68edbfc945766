"""Base-2 logarithm and power as float32 polynomials, with bit-identical results on all machines and no branches.

The polynomials interpolate at Chebyshev nodes. The error of log2_1p is below 2e-7, the error of power is below 5e-7,
and the resulting error of an edge weight is below 1e-6.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined

f32 = np.float32
EXPONENT_BIAS, MANTISSA_BITS = np.int32(127), np.int32(23)
MANTISSA, ONE_BITS = np.int32((1 << 23) - 1), np.int32(127 << 23)
LEAST_EXPONENT = f32(-126.0)

LOG0, LOG1, LOG2, LOG3, LOG4, LOG5, LOG6, LOG7, LOG8 = (
    f32(1.4426949917298517),
    f32(-0.7213395131452158),
    f32(0.480678889587252),
    f32(-0.35829906956891266),
    f32(0.27522121226611657),
    f32(-0.1962389517938464),
    f32(0.1118320738302219),
    f32(-0.041945008878192476),
    f32(0.007395402127151254),
)
"""Coefficients of a polynomial for log2(1 + x) / x on [0, 1]."""
EXP0, EXP1, EXP2, EXP3, EXP4, EXP5, EXP6 = (
    f32(1.0000000025307443),
    f32(0.6931469327589502),
    f32(0.24023045441141705),
    f32(0.055480630200254226),
    f32(0.00968418630379201),
    f32(0.001239133189098083),
    f32(0.00021865784601545537),
)
"""Coefficients of a polynomial for 2^x on [0, 1]."""


@inlined
def log2_1p(x):
    """Return log2(1 + x) for float32 x in [0, 1]."""
    for_x = (((((((LOG8 * x + LOG7) * x + LOG6) * x + LOG5) * x + LOG4) * x + LOG3) * x + LOG2) * x + LOG1) * x + LOG0
    return for_x * x


@inlined
def log2(x):
    """Return the base-2 logarithm of float32 x in (0, 1]."""
    bits = f32(x).view(np.int32)
    exponent = np.int32(np.int32(bits >> MANTISSA_BITS) - EXPONENT_BIAS)
    mantissa = np.int32(np.int32(bits & MANTISSA) | ONE_BITS).view(np.float32)
    return f32(exponent) + log2_1p(mantissa - f32(1.0))


@inlined
def exp2(y):
    """Return 2^y for float32 y in [-126, 0]."""
    whole = np.floor(y)
    f = y - whole
    power = (((((EXP6 * f + EXP5) * f + EXP4) * f + EXP3) * f + EXP2) * f + EXP1) * f + EXP0
    return power * np.int32(np.int32(np.int32(whole) + EXPONENT_BIAS) << MANTISSA_BITS).view(np.float32)


@inlined
def power(x, exponent):
    """Return x^exponent for float32 x in [0, 1] and exponent in [1, 2]."""
    y = exponent * log2(x)
    value = exp2(y if y > LEAST_EXPONENT else LEAST_EXPONENT)
    return value if x > f32(0.0) else f32(0.0)
