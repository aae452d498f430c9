"""Eight numbers in a register: arithmetic as in numpy, sine and cosine to round-off."""

import mpmath
import numpy as np
import pytest
from numba import njit

from tribo.compiler import lanes, lanes_functions, lanes_memory
from tribo.compiler.pointers import CheckedArray


@njit
def _sine_cosine(x, out):
    """Row 0 of `x` into the rows of `out`."""
    angles = lanes_memory.load(lanes_memory.rows_of(x), 0)
    sin, cos, versine = lanes_functions.sine_cosine_versine(angles)
    lanes_memory.store(lanes_memory.rows_of(out), 0, sin)
    lanes_memory.store(lanes_memory.rows_of(out), 1, cos)
    lanes_memory.store(lanes_memory.rows_of(out), 2, versine)


@pytest.mark.parametrize("size", [1e-9, 0.5, 3.0, 50.0, 2364.0, 1e5, 1.6e6, 1.7e6, 1e12])
@pytest.mark.parametrize("near", ["any angle", "multiples of pi/2"])
def test_sine_and_cosine(size, near):
    """To round-off, in all quadrants, and at both sides of the limit of the fast reduction."""
    rng = np.random.default_rng(1)
    out = np.empty((3, 8))
    for _ in range(100):
        x = rng.uniform(-size, size, (1, 8))
        if near == "multiples of pi/2":
            x = np.rint(x / (0.5 * np.pi)) * (0.5 * np.pi)
        _sine_cosine(x, out)
        for i in range(8):
            with mpmath.workdps(40):
                assert abs(out[0, i] - mpmath.sin(mpmath.mpf(x[0, i]))) < 2.3e-16
                assert abs(out[1, i] - mpmath.cos(mpmath.mpf(x[0, i]))) < 2.3e-16
                versine = 2 * mpmath.sin(mpmath.mpf(x[0, i]) / 2) ** 2
                small = min(1.0, float(versine)) if size < 1.0 else 1.0
                assert abs(out[2, i] - versine) <= 3.4e-16 * small


@njit
def _inverse_roots(x, out):
    """1 / sqrt and sqrt of row 0 of `x`, and of its first half, into the rows of `out`."""
    squares = lanes_memory.load(lanes_memory.rows_of(x), 0)
    inverse = lanes.inverse_root(squares)
    half = lanes.inverse_root(lanes.narrow(squares))
    lanes_memory.store(lanes_memory.rows_of(out), 0, inverse)
    lanes_memory.store(lanes_memory.rows_of(out), 1, 1.0 / inverse)
    lanes_memory.store(lanes_memory.rows_of(out), 2, lanes.widen(half))


@pytest.mark.skipif(not lanes.FAST_INVERSE_ROOTS, reason="the processor has no such instruction")
def test_inverse_roots():
    """To 1.2 ulp, over all magnitudes; their inverses are roots to 2 ulp."""
    rng = np.random.default_rng(1)
    out = np.empty((3, 8))
    for _ in range(20_000):
        x = rng.uniform(1.0, 4.0, (1, 8)) * 4.0 ** rng.integers(-490, 500, (1, 8))
        _inverse_roots(x, out)
        root = np.sqrt(x[0].astype(np.longdouble))
        assert np.max(np.abs(out[0] * root - 1)) < 1.2 * 2.0**-52
        assert np.max(np.abs(out[1] / root - 1)) < 2.0 * 2.0**-52
        assert out[2, :4].tobytes() == out[0, :4].tobytes()


@njit
def _exponentials(x, out):
    """Row 0 of `x` into that of `out`."""
    powers = lanes_functions.exponential(lanes_memory.load(lanes_memory.rows_of(x), 0))
    lanes_memory.store(lanes_memory.rows_of(out), 0, powers)


@pytest.mark.parametrize("size", [0.35, 30.0, 708.0])
def test_exponentials(size):
    """To 0.8 ulp; 0 where the result is not a normal number, and infinite above all of them."""
    rng = np.random.default_rng(1)
    out = np.empty((1, 8))
    for _ in range(5000):
        x = rng.uniform(-size, size, (1, 8))
        _exponentials(x, out)
        assert np.max(np.abs(out / np.exp(x.astype(np.longdouble)) - 1)) < 1.7e-16
    ends = np.array([[-np.inf, -1e9, -708.4, -708.38, 709.78, 709.79, np.inf, np.nan]])
    _exponentials(ends, out)
    with np.errstate(over="ignore"):
        expected = np.where(ends == -708.4, 0.0, np.exp(ends))
    np.testing.assert_allclose(out, expected, rtol=1e-15)


@njit
def _everything(x, out):
    """Each operation once."""
    rows = lanes_memory.rows_of(x)
    into = lanes_memory.rows_of(out)
    a = lanes_memory.load(rows, 0)
    b = lanes_memory.load(rows, 1)
    lanes_memory.store(into, 0, a + b)
    lanes_memory.store(into, 1, 2.0 - a * b)
    lanes_memory.store(into, 2, a / b)
    lanes_memory.store(into, 3, lanes.sqrt(lanes.absolute(a)))
    lanes_memory.store(into, 4, lanes.where_less(a, b, a, 7.0))
    lanes_memory.store(into, 5, lanes.with_lane(a, 3, lanes.lane(b, 5)))
    into[6, 0] = lanes.sum_of_lanes(a)
    into[6, 1] = lanes.maximum(a)
    into[6, 2] = rows[1, 4]
    scaled = (a, 2.0 * a, b, lanes.broadcast(rows[0, 1]), a * b, a - b, a + b, 3.0 * b)
    lanes_memory.store(into, 7, lanes.sums_of_lanes(scaled))


def test_arithmetic():
    """Lanes are numpy's arrays of eight."""
    rng = np.random.default_rng(2)
    for _ in range(50):
        x = rng.normal(size=(2, 8))
        out = np.empty((8, 8))
        _everything(x, out)
        a, b = x
        third = a.copy()
        third[3] = b[5]
        expected = (a + b, 2.0 - a * b, a / b, np.sqrt(abs(a)), np.where(a < b, a, 7.0), third)
        assert np.allclose(out[:6], expected, rtol=4e-16, atol=4e-16)
        assert np.allclose(out[6, :3], (np.sum(a), np.max(a), b[4]), rtol=1e-14)
        scaled = (a, 2.0 * a, b, np.full(8, a[1]), a * b, a - b, a + b, 3.0 * b)
        assert np.allclose(out[7], np.sum(scaled, axis=1), rtol=1e-13, atol=1e-14)


def test_small_arrays_stand_side_by_side():
    """Distances of arrays in memory are the same in every process, but for a few of them."""
    small = [lanes_memory.room((2, 9)) for _ in range(200)]
    places = np.array([array.ctypes.data for array in small])
    assert np.count_nonzero(np.diff(places) == 8 * 32) > 190
    for array in (*small, lanes_memory.room((2, 10**5))):
        assert array.ctypes.data % 64 == 0 and array.flags.c_contiguous and not np.any(array)
        array[:] = 1.0


def test_packs_at_an_end_where_nothing_is_compiled():
    """Slices end with the array; what a register has beyond is zero, and is not stored."""
    array = np.arange(10.0).view(CheckedArray)
    eight = lanes_memory._eight_of(array, 5)
    assert eight.tolist() == [5.0, 6.0, 7.0, 8.0, 9.0, 0.0, 0.0, 0.0]
    lanes_memory._set_eight(array, 5, eight + 1.0)
    assert array[5:10].tolist() == [6.0, 7.0, 8.0, 9.0, 10.0]
