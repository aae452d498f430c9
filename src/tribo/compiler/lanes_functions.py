"""Elementary functions of eight numbers at once."""

import math
import operator
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload

from tribo.compiler.jit import OVERLOAD, inlined, kernel
from tribo.compiler.lanes import (
    LANES,
    LanesType,
    absolute,
    floor,
    lane,
    maximum,
    power_of_two,
    spread_like,
    sqrt,
    where_less,
    with_lane,
)

# Adding and subtracting this rounds a float below 2^51 to an integer.
ROUNDING = 1.5 * 2.0**52

# pi / 2 as a sum of three numbers, from fdlibm (Sun Microsystems 1993).  The first two have 33
# significant bits, so that their products with an integer below MOST_QUARTERS are exact, with or
# without fused multiply-add; the third is rounded, and what is missing is below 1e-36.
QUARTER_TURN = 1.57079632673412561417e00
QUARTER_TURN_MIDDLE = 6.07710050630396597660e-11
QUARTER_TURN_LOW = 2.02226624879595063154e-21

# Number of quarter turns below which products with a number of 33 bits are exact: 53 - 33 bits.
MOST_QUARTERS = 2.0**20


@inlined
def sine_cosine(x):
    """Sine and cosine of eight angles.

    Absolute errors are below 2.3e-16 for every finite angle, with and without fused multiply-add.
    """
    sin, cos, _ = sine_cosine_versine(x)
    return sin, cos


@inlined
def sine_cosine_versine(x):
    """The same and 1 - cos x, which loses no digits near x = 0.

    The largest angle decides for all eight whether they need a reduction, and which one.
    """
    largest = maximum(absolute(x))
    if largest < 0.5 * QUARTER_TURN:  # as most swings are
        return near_zero(x)
    if largest < MOST_QUARTERS * QUARTER_TURN:
        return reduced(x)
    return lane_by_lane(x)


@kernel
def lane_by_lane(x):
    """Sine, cosine and 1 - cosine by the C library, for angles beyond a million quarter turns."""
    sin = x
    cos = x
    for i in range(LANES):
        sin = with_lane(sin, i, math.sin(lane(x, i)))
        cos = with_lane(cos, i, math.cos(lane(x, i)))
    return sin, cos, 1.0 - cos


@inlined
def reduced(x):
    """Sine, cosine and 1 - cosine from those of x less the nearest multiple of pi/2.

    The reduction is Cody and Waite's (Software Manual for the Elementary Functions, 1980).
    """
    quarters = (x * 0.6366197723675814 + ROUNDING) - ROUNDING
    rest = (x - quarters * QUARTER_TURN) - quarters * QUARTER_TURN_MIDDLE
    sin, cos, versine = near_zero(rest - quarters * QUARTER_TURN_LOW)
    quadrant = quarters - 4.0 * ((quarters * 0.25 - 0.375 + ROUNDING) - ROUNDING)  # 0, 1, 2 or 3
    even = absolute(absolute(quadrant - 2.0) - 1.0)  # 1 in quadrants 0 and 2, else 0
    one = where_less(even, 0.5, cos, sin)
    other = where_less(even, 0.5, sin, cos)
    one = where_less(quadrant, 1.5, one, 0.0 - one)
    other = where_less(absolute(quadrant - 1.5), 1.0, 0.0 - other, other)
    return one, other, where_less(quadrant, 0.5, versine, 1.0 - other)


@inlined
def near_zero(r):
    """sin r, cos r and 1 - cos r by polynomials of the least largest error on (-pi/4, pi/4).

    K. C. Ng's, of fdlibm (Sun Microsystems 1993), whose coefficients these are.
    """
    z = r * r
    z2 = z * z
    z4 = z2 * z2
    sin = (
        (-1.66666666666666324348e-01 + z * 8.33333333332248946124e-03)
        + z2 * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
        + z4 * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    )
    sin = r + r * z * sin
    cos = (
        (4.16666666666666019037e-02 - z * 1.38888888888741095749e-03)
        + z2 * (2.48015872894767294178e-05 - z * 2.75573143513906633035e-07)
        + z4 * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)
    )
    return sin, (1.0 - 0.5 * z) + z2 * cos, 0.5 * z - z2 * cos


# log 2 as a sum of two numbers, from fdlibm (Sun Microsystems 1993).  The first has 32 significant
# bits, so that its product with a whole number below 2^21 is exact.
LOG_2_HIGH = 6.93147180369123816490e-01
LOG_2_LOW = 1.90821492927058770002e-10
# Below the first, exp is not a normal number.  Such numbers are taken for 0, because arithmetic
# with them takes a hundred times as long; above the second, exp is infinite.
LOWEST_EXPONENT = -708.39
HIGHEST_EXPONENT = 710.0


@inlined
def exponential(x):
    """Exponential functions of eight numbers, with relative errors below 2.2e-16; 0 below 2.3e-308.

    exp x = 2^k exp r, with r = x - k log 2 between -log(2)/2 and log(2)/2, and exp r by its series
    up to r^13, the rest of which is below 5e-18.
    """
    given = x
    x = where_less(x, LOWEST_EXPONENT, LOWEST_EXPONENT, x)
    x = where_less(HIGHEST_EXPONENT, x, HIGHEST_EXPONENT, x)
    k = (x * 1.44269504088896338700 + ROUNDING) - ROUNDING
    r = (x - k * LOG_2_HIGH) - k * LOG_2_LOW
    z = r * r
    z2 = z * z
    p = (
        ((1 / 2 + 1 / 6 * r) + z * (1 / 24 + 1 / 120 * r))
        + z2 * ((1 / 720 + 1 / 5040 * r) + z * (1 / 40320 + 1 / 362880 * r))
        + z2 * z2 * ((1 / 3628800 + 1 / 39916800 * r) + z * (1 / 479001600 + 1 / 6227020800 * r))
    )
    y = 1.0 + (r + z * p)
    # In two factors, since 2^k may be too large or too small where the result is not.
    half = (0.5 * k + ROUNDING) - ROUNDING
    y = y * power_of_two(half) * power_of_two(k - half)
    return where_less(given, LOWEST_EXPONENT, 0.0, y)


def for_lanes(function: Any, implementation: Any, otherwise: Any = None) -> None:
    """Let kernels call a function with Lanes, and `otherwise` in its place with numbers alone."""

    @overload(function, **OVERLOAD)
    def find(*kinds):
        of_lanes = any(isinstance(kind, LanesType) for kind in kinds)
        return implementation if of_lanes else otherwise


# Functions that formulas may call with Lanes.
_FUNCTIONS: dict[Any, tuple[Any, ...]] = {
    lambda x: exponential(x): (np.exp, math.exp),
    lambda x: sqrt(x): (np.sqrt, math.sqrt),
    lambda x: absolute(x): (np.abs, math.fabs, abs),
    lambda x: floor(x): (np.floor, math.floor),
    lambda x, y: where_less(x, y, y, x): (np.maximum, max),
    lambda x, y: where_less(y, x, y, x): (np.minimum, min),
}
for _implementation, _functions in _FUNCTIONS.items():
    for _function in _functions:
        for_lanes(_function, _implementation)


@overload(operator.pow, prefer_literal=True, **OVERLOAD)
def _power(x, n):
    if not isinstance(x, LanesType) or not isinstance(n, types.IntegerLiteral):
        return None
    power = abs(n.literal_value)
    if n.literal_value >= 0:
        return lambda x, n: _whole_power(x, power)
    return lambda x, n: 1.0 / _whole_power(x, power)


@inlined
def _whole_power(x, n):
    """x^n for a whole number n that is not negative, by repeated squaring."""
    result = spread_like(x, 1.0)
    while n > 0:
        if n % 2 == 1:
            result = result * x
        x = x * x
        n = n // 2
    return result
