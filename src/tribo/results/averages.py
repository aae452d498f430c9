"""Averages of series over time, and means of independent members, with intervals.

Intervals of series allow for correlation and for periodic motion.  The low frequencies of a series
are its products with some smooth functions that vanish at both ends, so that the incomplete period
at an end, of stick and slip or of a lattice, hardly matters.  The products are regressed on those
of a constant (D. J. Thomson, Proc. IEEE 70 (1982) 1055): what they leave over is the spectral
density near frequency zero (P. Heidelberger, P. D. Welch, Commun. ACM 24 (1981) 233).  How it
depends on frequency is unknown, so that Student's intervals of several spectra are averaged,
weighted by their likelihoods.  `benchmarks/averages.py` measures how often the interval contains
the exact mean.

Student's interval of members is for a number of members that was fixed beforehand.  With s the
standard deviation of all n, its half-width is t(n - 1) s / sqrt(n).
Student, Biometrika 6 (1908) 1.

Stein's interval is for a wanted half-width d.  With s that of the first n0 members alone,

    n = max(n0, floor((t(n0 - 1) s / d)^2) + 1) ,   half-width t(n0 - 1) s / sqrt(n) <= d .

Its coverage is exact for normal values, whatever n becomes, because the mean and the variance of a
sample are independent.  Adding members until the interval is narrow enough has lower coverage: it
stops too often where the variance happens to be small.
C. Stein, Ann. Math. Stat. 16 (1945) 243.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tribo.validation import InputError, must_be, number, vector

# Most decimals, and the largest number, that a mean is shown with without a power of ten.
MOST_DECIMALS = 6
MOST_PLAIN = 1e6
# Decimals of a mean with a power of ten, at most: a floating-point number has no more.
MOST_DIGITS = 15
# Number of functions; the last one has half as many periods.  More would reach the frequency of
# ten slips, fewer leave few degrees of freedom.
FUNCTIONS = 12
ORDERS = np.arange(1, FUNCTIONS + 1)
# Spectral densities at the frequencies of the functions, relative, (spectra, functions): flat,
# falling as those of exponential correlation with a time in units of the series, or rising with the
# frequency of so many functions, as beside a periodic motion.
SPECTRA = np.array(
    [1.0 / (1.0 + (np.pi * ORDERS * time) ** 2) for time in (0.0, *np.geomspace(0.01, 0.64, 7))]
    + [(1.0 + (ORDERS / rise) ** 2) ** 2 for rise in (16.0, 8.0, 4.0, 2.0)]
)
# The autocorrelation, relative to the variance, at the correlation time.
FALLEN = np.exp(-1.0)
# The time in which the autocorrelation falls to 1/e, in units of the series, above which there is
# no interval: at a correlation time of 1/5 that leaves 4 % of the series one.
LONGEST_CORRELATION = 0.035
# An interval is wider by the factor 1 + (this time over WIDENING)^4, because a series with a short
# one may be one of the short ones of a longer correlation: measured, from 1/20 to 1/50.
WIDENING = 0.032
# Part of the half-width by which the mean with equal weights may differ from that with smooth ends;
# beyond it, the ends are incomplete periods.
SIMILAR = 0.5
# Interval of the mean with equal weights, relative to that of the other, where the ends do not
# matter.
NARROWER = 0.9
# A slip between two samples differs from its neighbours' line by so many times the median.
UNRESOLVED = 5.0
# Probability with which a trend is not one of chance.
TREND = 0.999
# The same for a trend by unresolved slips [standard errors of the mean]: 3.3 standard errors of a
# slope, each the square root of 12 times that of the mean.
SLOPE = 11.4
# Spread, relative to the mean, of the values of a constant.
ROUNDING = 1e-14
# Probability that an interval contains the exact mean.
CONFIDENCE = 0.95


class Average(NamedTuple):
    """The average of a series over time; units are those of the series.

    Attributes
    ----------
    mean : float
        The integral over the time, divided by the time.
    half_width : float
        Half-width of its 95 % interval; NaN where the series is too short for one.
    spread : float
        The standard deviation over time.
    correlation_time : float
        Estimate, accurate to about a third, of the integral of the autocorrelation from zero on
        [time]; small where the motion is periodic.
    effective_samples : float
        Number of independent samples whose mean would be equally exact: the length of the series
        over twice the correlation time.
    after : float
        Time at which the average begins [time].
    note : str
        The reason for a missing interval, a warning of a trend, or the weighted mean where
        incomplete periods at the ends matter; else empty.
    weighted_mean, weighted_half_width : float
        The mean with weights that vanish at both ends, where incomplete periods hardly matter,
        and the half-width of its 95 % interval; NaN where the series is too short for one.
    """

    mean: float
    half_width: float
    spread: float
    correlation_time: float
    effective_samples: float
    after: float
    note: str = ""
    weighted_mean: float = np.nan
    weighted_half_width: float = np.nan


class _Record(NamedTuple):
    """A series in the window over which it is averaged."""

    begin: float  # of the window [time]
    length: float  # of the window [time]
    s: np.ndarray  # (values,) the places of the values, from 0 to 1
    values: np.ndarray
    weights: np.ndarray  # (values,) their parts of the window

    @classmethod
    def of_samples(cls, t: np.ndarray, values: np.ndarray, first: int) -> _Record:
        """From one of its samples on; it is linear between them."""
        t = t[first:]
        values = values[first:]
        if t.size < 2:
            raise InputError("after", f"must leave two samples or more, got {t.size}")
        begin = float(t[0])
        length = float(t[-1] - t[0])
        return cls(begin, length, (t - begin) / length, values, _weights(t))

    @classmethod
    def of_intervals(cls, t: np.ndarray, means: np.ndarray, first: int) -> _Record:
        """Of means over the intervals that end at the samples, from one of the samples on."""
        t = t[first:]
        means = means[first + 1 :]
        if means.size < 2:
            raise InputError("after", f"must leave two intervals or more, got {means.size}")
        begin = float(t[0])
        length = float(t[-1] - t[0])
        middle = 0.5 * (t[:-1] + t[1:])
        return cls(begin, length, (middle - begin) / length, means, np.diff(t) / length)


class _Estimate(NamedTuple):
    """A coefficient of a regression: its value, half-width, and the spectral density left over."""

    value: float
    half_width: float
    density: float


def time_average(
    t: Sequence[float] | np.ndarray,
    values: Sequence[float] | np.ndarray,
    after: float | str = "auto",
) -> Average:
    """The average of a series over time, with a 95 % interval.

    Parameters
    ----------
    t, values : array_like, (times,)
        The series. Times increase and need not be evenly spaced; the series is linear between
        them.
    after : float or "auto"
        Time at which the average begins, to omit the run-in [time]. "auto" omits twice the run-in
        that minimises the standard error, as of independent samples (K. P. White, Simulation 69
        (1997) 323), at most half of the series, if that changes the average by more than its
        half-width.

    Returns
    -------
    Average
        Its mean is the plain one of the samples from `after` on, whose half-width allows for
        incomplete periods at the ends; the weighted mean is a field of its own.

    Raises
    ------
    InputError
        Times or values are not numbers, times do not increase, or fewer than two are left.
    """
    t = vector("t", t, unit="time")
    values = vector("values", values, size=len(t))
    return average_from(t, values, after)


def average_from(
    t: np.ndarray, values: np.ndarray, after: float | str, of_intervals: bool = False
) -> Average:
    """As :func:`time_average`, of arrays.

    The values may be means over the intervals that end at the samples; the first is then unused.
    """
    if t.size < 2:
        raise InputError("t", f"must be two times or more, got {t.size}")
    if np.any(np.diff(t) <= 0.0):
        raise InputError("t", "must increase")
    record = _Record.of_intervals if of_intervals else _Record.of_samples
    if isinstance(after, str) and after != "auto":
        raise must_be("after", 'a time or "auto"', after)
    if not isinstance(after, str):
        first = int(np.searchsorted(t, number("after", after, unit="time")))
        return _average(record(t, values, first))
    whole = record(t, values, 0)
    found = _average(whole)
    later = _average(record(t, values, _run_in(whole, t)))
    return later if abs(found.mean - later.mean) > later.half_width else found


def _average(record: _Record) -> Average:
    """The average of a series over its window."""
    begin, length, s, values, weights = record
    mean = float(values[0] + weights @ (values - values[0]))  # exact for a constant
    rest = values - mean
    spread = float(np.sqrt(weights @ rest**2))
    if spread <= ROUNDING * abs(mean):
        found = mean, 2.0 * spread, spread, 0.0, float(s.size)
        return Average(*found, begin, "", mean, 2.0 * spread)
    if s.size < 2 * FUNCTIONS:
        note = f"too short for an interval: {s.size} samples, {2 * FUNCTIONS} or more would do"
        return Average(mean, np.nan, spread, np.nan, np.nan, begin, note)
    low = _low_frequencies(s, weights)
    smooth = _regression(rest @ low, low.sum(axis=0), CONFIDENCE)
    trend = _regression((rest - smooth.value) @ low, (s - 0.5) @ low, TREND)
    unresolved = _unresolved(s, rest, weights)
    memory = _correlated(s, rest)
    weighted = np.hypot(smooth.half_width * (1.0 + (memory / WIDENING) ** 4), 2.0 * unresolved)
    if memory > LONGEST_CORRELATION:
        weighted = np.nan
    matters = abs(smooth.value) > SIMILAR * weighted
    half_width = abs(smooth.value) + weighted if matters else NARROWER * weighted
    density = smooth.density + unresolved**2
    correlation_time = 0.5 * length * density / spread**2 if spread > 0.0 else 0.0
    effective = spread**2 / density if density > 0.0 else float(s.size)
    found = mean, float(half_width), spread, float(correlation_time), float(effective)
    weighted_mean = mean + smooth.value
    weighted_half_width = float(weighted)
    note = ""
    if memory > LONGEST_CORRELATION:
        note = "too short for an interval: it is correlated for a large part of its length"
    elif matters:
        note = "incomplete periods at its ends count: with weights that vanish there it is "
        note += mean_text(weighted_mean, weighted_half_width)
    if abs(trend.value) > np.hypot(trend.half_width, SLOPE * unresolved):
        note = f"has a trend of {trend.value / length:.2g} per unit of time"
    return Average(*found, begin, note, weighted_mean, weighted_half_width)


def _run_in(record: _Record, t: np.ndarray) -> int:
    """The sample in the first half that is twice as late as the one of the smallest error.

    That is the error of the mean of independent samples from there on, by which an exponential
    approach still has its own error.  Two samples or more are left, if there are so many.
    """
    left = np.cumsum(record.weights[::-1])[::-1]
    rest = record.values - record.weights @ record.values
    mean, square = (np.cumsum((record.weights * x)[::-1])[::-1] / left for x in (rest, rest**2))
    half = int(np.searchsorted(t, 0.5 * (t[0] + t[-1])))
    half = max(0, min(half, record.values.size - 2))
    least = int(np.argmin(((square - mean**2) / left)[: half + 1]))
    return min(half, int(np.searchsorted(t, 2.0 * t[least] - t[0])))


def _weights(t: np.ndarray) -> np.ndarray:
    """The weights of the trapezoidal rule for the mean, (times,)."""
    steps = np.diff(t) / (t[-1] - t[0])
    return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))


def _low_frequencies(s: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Orthonormal functions that vanish at the ends as s^2, times the weights, (times, functions).

    The mean square of the product of each with noise is the noise's spectral density.
    """
    root = np.sqrt(weights)[:, None]
    functions = np.sin(np.pi * s)[:, None] * np.sin(np.pi * np.outer(s, ORDERS))
    return np.asarray(root * np.linalg.qr(root * functions)[0])


def _regression(products: np.ndarray, of_unit: np.ndarray, confidence: float) -> _Estimate:
    """How many times `of_unit` is in the products, averaged over the spectra."""
    from scipy.optimize import brentq
    from scipy.special import stdtr

    spectra = SPECTRA
    degrees = FUNCTIONS - 1
    information = np.sum(of_unit**2 / spectra, axis=1)
    value = np.sum(products * of_unit / spectra, axis=1) / information
    squares = np.sum((products - np.outer(value, of_unit)) ** 2 / spectra, axis=1)
    if not np.all(squares > 0.0):  # a constant
        return _Estimate(float(value[0]), 0.0, 0.0)
    log = -0.5 * (np.sum(np.log(spectra), axis=1) + np.log(information) + degrees * np.log(squares))
    likelihood = np.exp(log - np.max(log))
    likelihood /= np.sum(likelihood)
    mean = float(likelihood @ value)
    errors = np.sqrt(squares / degrees / information)
    # In units of the largest error, since the root is sought to an absolute precision too.
    unit = float(np.max(errors))
    beyond = (value - mean) / errors
    each = errors / unit

    def excess(half_width: float) -> float:
        ends = [side * half_width / each - beyond for side in (-1.0, 1.0)]
        return float(likelihood @ (stdtr(degrees, ends[1]) - stdtr(degrees, ends[0]))) - confidence

    far = 1e3 * (1.0 + float(np.ptp(value)) / unit)
    half_width = unit * float(brentq(excess, 0.0, far, rtol=1e-6))
    density = float(np.exp(likelihood @ np.log(squares / degrees)))
    return _Estimate(mean, half_width, density)


def _unresolved(s: np.ndarray, rest: np.ndarray, weights: np.ndarray) -> float:
    """The standard error of the mean by slips that are anywhere between two samples."""
    part = (s[1:-1] - s[:-2]) / (s[2:] - s[:-2])
    bend = np.abs(rest[1:-1] - rest[:-2] - part * (rest[2:] - rest[:-2]))
    slips = bend > UNRESOLVED * np.median(bend)
    return float(np.sqrt(np.sum((weights[1:-1] * bend)[slips] ** 2) / 6.0))


def _correlated(s: np.ndarray, rest: np.ndarray) -> float:
    """The time in which the autocorrelation falls to 1/e, in units of the series."""
    even = np.interp(np.linspace(0.0, 1.0, s.size), s, rest)
    correlation = np.fft.irfft(np.abs(np.fft.rfft(even, 2 * s.size)) ** 2)[: s.size]
    relative = correlation / correlation[0]
    first = int(np.argmax(relative < FALLEN))  # a sample or more, so that a line leads to it
    before = relative[first - 1]
    return (first - (FALLEN - relative[first]) / (before - relative[first])) / s.size


def student(degrees: int, quantities: int = 1) -> float:
    """The quantile t of Student's distribution at the end of a two-sided interval.

    With several quantities, all their intervals contain the exact means with the probability
    CONFIDENCE at least, by Bonferroni's inequality.
    """
    from scipy.special import stdtrit

    return float(stdtrit(degrees, 1.0 - 0.5 * (1.0 - CONFIDENCE) / quantities))


def mean_text(mean: float, half_width: float, sign: str = "+-") -> str:
    """A mean with its half-width, if that is finite, as summaries and figures show them.

    The half-width has two digits, and the mean ends at the same decimal place.
    """
    if not (np.isfinite(half_width) and np.isfinite(mean)):
        return f"{mean:.4g}"
    if half_width == 0.0:
        return f"{mean:.4g} {sign} 0"
    # Of the half-width after it is rounded: 0.0996 is 0.10.
    _, _, exponent = f"{half_width:.1e}".partition("e")
    decimals = 1 - int(exponent)
    rounded = round(mean, decimals) + 0.0  # never -0
    if decimals <= MOST_DECIMALS and max(abs(mean), half_width) < MOST_PLAIN:
        shown = max(0, decimals)
        return f"{rounded:.{shown}f} {sign} {round(half_width, decimals):.{shown}f}"
    if rounded == 0.0:
        return f"0 {sign} {half_width:.1e}"
    _, _, exponent_of_mean = f"{rounded:e}".partition("e")
    digits = min(max(0, decimals + int(exponent_of_mean)), MOST_DIGITS)
    return f"{rounded:.{digits}e} {sign} {half_width:.1e}"


class Interval(NamedTuple):
    """Means and half-widths of their intervals, each of the shape of one member's values."""

    mean: np.ndarray
    half_width: np.ndarray


def interval(values: np.ndarray, first_stage: int | None = None) -> Interval:
    """The mean over independent members, (members, ...), with Student's interval or Stein's."""
    sample = values[:first_stage]
    degrees = len(sample) - 1
    spread = np.std(sample, axis=0, ddof=1)
    return Interval(np.mean(values, axis=0), student(degrees) * spread / np.sqrt(len(values)))


class SampleMean(NamedTuple):
    """The mean of independent values.

    Attributes
    ----------
    mean : float
        The mean, in the unit of the values.
    half_width : float
        Half-width of its 95 % interval; NaN of a single value.
    """

    mean: float
    half_width: float


def sample_mean(values: np.ndarray) -> SampleMean:
    """The mean of independent values (n,), with Student's interval."""
    if values.size < 2:
        return SampleMean(float(np.mean(values)), np.nan)
    found = interval(values)
    return SampleMean(float(found.mean), float(found.half_width))


def members_needed(sample: np.ndarray, half_width: float) -> float:
    """The number of members by Stein's rule, from values (n0, ...) of the first n0; may be inf."""
    largest = float(np.max(np.std(sample, axis=0, ddof=1)))
    if largest == 0.0:
        return float(len(sample))
    if half_width == 0.0 or not np.isfinite(largest):
        return np.inf
    ratio = student(len(sample) - 1) * largest / half_width
    return max(float(len(sample)), np.floor(ratio**2) + 1.0)
