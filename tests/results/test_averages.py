"""`tribo.time_average`: coverage of its interval, whole periods, run-in, trends, uneven times."""

import runpy
from pathlib import Path

import numpy as np
import pandas
import pytest
import xarray

import tribo
from tribo.results.averages import average_from, mean_text

FUNCTIONS = 12  # trigonometric functions that the estimator fits

ROOT = Path(__file__).parents[2]
BENCHMARK = runpy.run_path(str(ROOT / "benchmarks" / "averages.py"))
KINDS = BENCHMARK["kinds"]()
coverage = BENCHMARK["coverage"]


@pytest.mark.parametrize(
    ("kind", "given"),
    [
        ("white noise", 1.0),
        ("exponential, 1/100", 0.97),
        ("exponential, 1/20", 0.2),
        ("sawtooth, 10", 1.0),
        ("sawtooth, 100", 1.0),
        ("slow slips, 30", 1.0),
        ("thermal 0.1, 10", 0.9),
        ("thermal 0.3, 30", 0.9),
    ],
)
def test_intervals_contain_the_mean(kind, given):
    """In 95 % of 150 series; the binomial deviation is 1.8 %, or 2.7 % of the 40 % at 1/20."""
    found = coverage(KINDS[kind], 150, 1000)
    assert found.given >= given and found.covered >= 0.90
    assert found.width < 4.0


def test_short_series_have_no_interval():
    """Of a correlation time of a fifth of the length, or few samples; the note says it."""
    assert coverage(KINDS["exponential, 1/5"], 150, 1000).given <= 0.08
    t = np.arange(2 * FUNCTIONS - 1.0)
    found = tribo.time_average(t, np.sin(t), 0.0)
    assert np.isnan(found.half_width) and "too short for an interval: 23 samples" in found.note
    noise = np.random.default_rng(1).standard_normal(2000)
    slow = tribo.time_average(np.arange(2000.0), np.cumsum(noise), 0.0)
    assert np.isnan(slow.half_width) and slow.note


@pytest.mark.parametrize("samples", [2 * FUNCTIONS, 28, 30])
def test_few_samples_have_an_interval(samples):
    """White noise is not correlated, however few its samples are."""
    rng = np.random.default_rng(5)
    t = np.arange(samples)
    found = [tribo.time_average(t, rng.standard_normal(samples), 0.0) for _ in range(200)]
    widths = np.array([each.half_width for each in found])
    assert np.mean(np.isfinite(widths)) >= 0.9
    assert np.nanmedian(widths) * np.sqrt(samples) < 4.0


@pytest.mark.parametrize("unit", [2.0**-40, 2.0**-200, 2.0**100])
def test_units_do_not_matter(unit):
    """Powers of two change no digit of the values."""
    t = np.arange(400.0)
    values = np.random.default_rng(2).standard_normal(400) + 0.1 * t / 400.0
    one = tribo.time_average(t, values, 0.0)
    other = tribo.time_average(t, unit * values, 0.0)
    for name in ("mean", "half_width", "weighted_half_width", "spread"):
        assert getattr(other, name) / unit == pytest.approx(getattr(one, name), rel=1e-9)


@pytest.mark.parametrize("value", [0.0, 0.3, -7e80])
@pytest.mark.parametrize("samples", [4, 100_000])
def test_a_constant_is_its_average(value, samples):
    """Up to round-off, which is no correlated motion, and also where samples are few."""
    noise = 1e-16 * np.random.default_rng(1).standard_normal(samples)
    found = tribo.time_average(np.arange(samples), value * (1.0 + noise))
    assert abs(found.mean - value) <= 4e-16 * abs(value)
    assert found.half_width <= 1e-15 * abs(value) and not found.note


def test_arrays_of_other_libraries():
    """Series of xarray, of pandas and of 32 bits are read as those of numpy."""
    t = np.arange(100.0)
    values = np.random.default_rng(1).standard_normal(100).astype(np.float32)
    known = tribo.time_average(t, values.astype(float), 10.0)
    for kind in (xarray.DataArray, pandas.Series):
        assert tribo.time_average(kind(t), kind(values), after=np.float32(10.0)) == known


def test_incomplete_periods_do_not_matter_with_weights():
    """The weighted mean of sine waves has an error far below amplitude over phase.

    The mean itself is that of the window, with an interval that allows for the incomplete period.
    """
    for periods in (10.3, 51.7, 200.25):
        s = np.linspace(0.0, 1.0, 4001)
        values = 7.0 + np.sin(2.0 * np.pi * periods * s)
        found = tribo.time_average(s, values, 0.0)
        plain = np.trapezoid(values, s)
        assert found.mean == pytest.approx(plain, abs=1e-14)
        off = abs(plain - 7.0)
        half_width = found.weighted_half_width
        assert abs(found.weighted_mean - 7.0) < half_width < 0.2 * off
        assert off < found.half_width < 1.3 * off
        assert f"vanish there it is {mean_text(found.weighted_mean, half_width)}" in found.note
        assert found.effective_samples > 4001


def test_the_mean_is_that_of_the_window():
    """The integral over the time, divided by the time, of noise, of slips and of short series."""
    differs = 0
    for kind in ("exponential, 1/50", "sawtooth, 10", "thermal 0.1, 10"):
        for seed in range(10):
            values = KINDS[kind](np.random.default_rng(seed), 500)
            t = 2.0 + np.cumsum(np.random.default_rng(seed).uniform(0.5, 1.5, 500))
            found = tribo.time_average(t, values, t[100])
            plain = np.trapezoid(values[100:], t[100:]) / (t[-1] - t[100])
            assert found.mean == pytest.approx(plain, abs=1e-13) and found.after == t[100]
            noted = "with weights that vanish there" in found.note
            differs += noted
            apart = abs(found.weighted_mean - plain)
            assert noted == (apart > 0.5 * found.weighted_half_width)
    assert differs > 0


@pytest.mark.parametrize("t", [np.geomspace(1.0, 1000.0, 8), np.array([0.0, 0.1, 0.2, 10.0])])
def test_few_samples_in_the_second_half_are_averaged(t):
    """The automatic run-in leaves two samples; one sample is refused by the name of the times."""
    found = tribo.time_average(t, np.exp(-t))
    assert t[0] <= found.after <= t[-2]
    with pytest.raises(tribo.InputError, match=r"^t: must be two times or more, got 1"):
        tribo.time_average(t[:1], t[:1])


def test_correlation_time_and_effective_samples():
    """On average, of exponential correlation with a time of 10: 2000 / (2 * 10) are independent."""
    rng = np.random.default_rng(3)
    t = np.arange(2000.0)
    made = [BENCHMARK["exponential"](1 / 200, rng, 2000) for _ in range(60)]
    found = [tribo.time_average(t, values, 0.0) for values in made]
    assert np.median([each.correlation_time for each in found]) == pytest.approx(10.0, rel=0.4)
    assert np.median([each.effective_samples for each in found]) == pytest.approx(100.0, rel=0.4)
    assert np.mean([each.spread for each in found]) == pytest.approx(1.0, rel=0.03)


def test_uneven_times_weigh_their_intervals():
    """Exact for straight lines; a denser half counts no more than the other."""
    rng = np.random.default_rng(2)
    t = np.sort(np.append(rng.uniform(0.0, 100.0, 3000), rng.uniform(0.0, 50.0, 3000)))
    values = np.where(t < 50.0, 1.0, 3.0) + np.sin(3.0 * t)
    found = tribo.time_average(t, values, 0.0)
    assert found.mean == pytest.approx(2.0, abs=0.02)
    slips = (0.37 * t) % 1.0
    found = tribo.time_average(t, slips, 0.0)
    assert abs(found.mean - 0.5) < found.half_width < 0.02
    flat = tribo.time_average(t, np.full(t.size, 2.5))
    assert flat.mean == pytest.approx(2.5, abs=1e-14) and flat.half_width < 1e-12


def test_units_and_offsets_do_not_matter():
    """Scaled and shifted series in other units of time have scaled results."""
    values = KINDS["thermal 0.1, 30"](np.random.default_rng(4), 1500)
    t = np.linspace(0.0, 1.0, 1500)
    one = tribo.time_average(t, values, 0.0)
    other = tribo.time_average(5.0 + 1e6 * t, 1e-9 * (values - 1e3), 0.0)
    assert other.mean == pytest.approx(1e-9 * (one.mean - 1e3), rel=1e-9, abs=0.0)
    assert other.half_width == pytest.approx(1e-9 * one.half_width, rel=1e-5, abs=0.0)
    assert other.correlation_time == pytest.approx(1e6 * one.correlation_time, rel=1e-5)


def test_the_run_in_is_left_out():
    """Where it matters: an exponential approach, and not of a stationary series."""
    rng = np.random.default_rng(5)
    t = np.linspace(0.0, 100.0, 2000)
    values = 1.0 + 0.1 * rng.standard_normal(2000)
    assert tribo.time_average(t, values).after == 0.0
    found = tribo.time_average(t, values + 5.0 * np.exp(-t / 4.0))
    assert 20.0 < found.after < 50.0 and abs(found.mean - 1.0) < found.half_width < 0.02
    assert abs(tribo.time_average(t, values + 5.0 * np.exp(-t / 4.0), 0.0).mean - 1.0) > 0.1
    trend = tribo.time_average(t, values + 0.002 * t)
    assert "has a trend of 0.00" in trend.note


def test_the_origin_of_time_does_not_matter():
    """The run-in that is left out is as long wherever a series begins in time."""
    t = np.linspace(0.0, 50.0, 501)
    noise = np.random.default_rng(1).standard_normal(t.size)
    values = 5.0 * np.exp(-t / 2.0) + noise
    one = tribo.time_average(t, values)
    other = tribo.time_average(t + 100.0, values)
    assert one.after > 0.0
    assert other.after == pytest.approx(one.after + 100.0)
    assert other.mean == pytest.approx(one.mean, rel=1e-9)


def test_means_over_intervals_have_no_direction_of_time():
    """Means over equal intervals in reverse order have the same average and interval."""
    t = np.linspace(0.0, 10.0, 61)
    walk = np.cumsum(np.random.default_rng(2).standard_normal(60))
    values = 0.1 * walk + np.random.default_rng(3).standard_normal(60)
    one, other = (
        average_from(t, np.append(np.nan, each), 0.0, of_intervals=True)
        for each in (values, values[::-1])
    )
    assert other.weighted_mean == pytest.approx(one.weighted_mean, rel=1e-9)
    assert other.half_width == pytest.approx(one.half_width, rel=1e-9)


def test_slips_between_samples():
    """They make no trend of sawtooths, and intervals of weighted means allow for them."""
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(250):
        t = np.linspace(0.0, 1.0, int(rng.integers(60, 140)))
        values = (rng.uniform(8.0, 14.0) * t + rng.uniform()) % 1.0
        found = tribo.time_average(t, values, after=0.0)
        assert "trend" not in found.note
        covered += abs(found.weighted_mean - 0.5) < found.weighted_half_width
    assert covered >= 0.94 * 250


def test_wrong_input_is_refused():
    """Times that do not increase, values that are no numbers, and words."""
    t = np.arange(40.0)
    for arguments, message in (
        ((t[::-1], t), "t: must increase"),
        ((t, t[:-1]), "values: must be 40 numbers"),
        ((t, np.full(40, np.nan)), r"values\[0\]: must be a finite number"),
        ((t, t, "later"), 'after: must be a time or "auto"'),
        ((t, t, 39.5), "after: must leave two samples or more, got 0"),
    ):
        with pytest.raises(tribo.InputError, match=message):
            tribo.time_average(*arguments)
