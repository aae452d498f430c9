"""The functions of :mod:`tribo.compiler.lanes` and `simd_arrays` where numba does not compile.

With NUMBA_DISABLE_JIT=1 Python runs the kernels as they are written, as debuggers and the tests of
mutants need; an array of eight numbers then stands for a register.
"""

import numpy as np

LANES = 8

absolute = np.abs
floor = np.floor
sqrt = np.sqrt


def sum_of_lanes(x):
    return float(np.sum(x))


def sums_of_lanes(xs):
    return np.array([np.sum(x) for x in xs])


def maximum(x):
    return float(np.max(x))


def where_less(x, y, one, other):
    return np.where(x < y, one, other)


def broadcast(x):
    return np.full(LANES, x)  # of an array of eight numbers a copy


def spread_like(x, number):
    return np.full(len(x), number)


def narrow(x):
    return x[:4]


def widen(x):
    return np.concatenate([x, np.zeros(4)])


def lane(x, i):
    return float(x[i])


def with_lane(x, i, value):
    new = np.array(x)
    new[i] = value
    return new


def _between(low, high, x):
    numbers = np.arange(x.size)
    return (low <= numbers) & (numbers < high)


def between_lanes(low, high, x, other):
    return np.where(_between(low, high, x), x, other)


def numbers_at_lane(each, i):
    return each


def any_below(low, high, x, limit):
    return bool(np.any(x[_between(low, high, x)] <= limit))


def seldom(condition, usual, kernel, arguments):
    return kernel(usual, *arguments) if condition else usual


def power_of_two(x):
    return np.exp2(x)


def rows_of(array):
    return array


def load(rows, k):
    return rows[k].copy()


def store(rows, k, x):
    rows[k] = x


def block(array, i):
    """The elements that the array has; zeros beyond."""
    own = array[i : i + LANES]
    return np.concatenate([own, np.zeros(LANES - own.size)])


def set_block(array, i, x):
    own = array[i : i + LANES]
    own[:] = x[: own.size]
