"""How often the 95 % interval of `tribo.time_average` contains the exact mean, zero, of series.

    python benchmarks/averages.py                     # 2,000 series of each kind, some minutes
    python benchmarks/averages.py --series 200 --samples 500 --after auto
    python benchmarks/averages.py --compare --series 500      # with other estimators

Exponential correlation has its correlation time in units of the series, stick-slip its number of
slips.  Regular ones are noiseless, of an incommensurate length; thermal ones have independent
periods, peaks and bottoms.  "Given" is the part of the series that get an interval, and the others
are not counted in the coverage.  The last column is the median half-width relative to 1.96 times
the error of the means.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter
from scipy.special import stdtrit

from tribo import time_average

Made = Callable[[np.random.Generator, int], np.ndarray]
# Mean and half-width of a series at some times.
Estimator = Callable[[np.ndarray, np.ndarray], tuple[float, float]]
BATCHES = 20


class Coverage(NamedTuple):
    """What is found for a kind of series.

    Attributes
    ----------
    given, covered : float
        The part of the series with an interval, and the part of these that contain the mean.
    width : float
        The median half-width over 1.96 times the error of the means.
    """

    given: float
    covered: float
    width: float


def exponential(correlation_time: float, rng: np.random.Generator, samples: int) -> np.ndarray:
    """Exponentially correlated noise of variance 1, AR(1); white noise for a time of zero."""
    decay = np.exp(-1.0 / (correlation_time * samples)) if correlation_time > 0.0 else 0.0
    noise = rng.standard_normal(samples)
    noise[1:] *= np.sqrt(1.0 - decay**2)
    return np.asarray(lfilter([1.0], [1.0, -decay], noise))


def phase(slips: int, rng: np.random.Generator, samples: int) -> np.ndarray:
    """The phase of a regular motion of about so many periods, from 0 to 1."""
    periods = slips * rng.uniform(1.0, 1.3)
    return np.asarray((np.linspace(0.0, periods, samples) + rng.uniform()) % 1.0)


def regular(slips: int, rng: np.random.Generator, samples: int) -> np.ndarray:
    """A sawtooth: slips take no time."""
    return phase(slips, rng, samples) - 0.5


def slow_slips(slips: int, rng: np.random.Generator, samples: int) -> np.ndarray:
    """Stick-slip whose slips take a fifth of the period."""
    at = phase(slips, rng, samples)
    return np.where(at < 0.8, at / 0.8, (1.0 - at) / 0.2) - 0.5


def sine(slips: int, rng: np.random.Generator, samples: int) -> np.ndarray:
    """Smooth sliding over a lattice."""
    return np.sin(2.0 * np.pi * phase(slips, rng, samples))


def thermal(jitter: float, slips: int, rng: np.random.Generator, samples: int) -> np.ndarray:
    """Stick-slip with deviations of periods, peaks and bottoms, relative to the mean period."""
    count = 3 * slips + 60
    peaks, bottoms = (end + jitter * rng.standard_normal(count) for end in (0.5, -0.5))
    periods = np.maximum(1.0 + jitter * rng.standard_normal(count), 0.05)
    edges = np.cumsum(periods) - rng.uniform(10.0, 20.0)
    t = np.linspace(0.0, slips * rng.uniform(1.0, 1.3), samples)
    now = np.searchsorted(edges, t, side="right")
    part = (t - edges[now - 1]) / periods[now]
    return np.asarray(bottoms[now] + (peaks[now] - bottoms[now]) * part)


def kinds() -> dict[str, Made]:
    """The kinds of series by name."""
    times = {"white noise": 0.0} | {f"exponential, 1/{n}": 1 / n for n in (1000, 100, 50, 30, 20)}
    found: dict[str, Made] = {k: partial(exponential, v) for k, v in times.items()}
    found["exponential, 1/5"] = partial(exponential, 0.2)
    shapes: dict[str, Callable[..., np.ndarray]] = {
        "sawtooth": regular,
        "slow slips": slow_slips,
        "sine": sine,
        "thermal 0.02": partial(thermal, 0.02),
        "thermal 0.1": partial(thermal, 0.1),
        "thermal 0.3": partial(thermal, 0.3),
    }
    for name, shape in shapes.items():
        found |= {f"{name}, {slips}": partial(shape, slips) for slips in (10, 30, 100, 300)}
    return found


def tribo_average(
    t: np.ndarray, values: np.ndarray, after: float | str = 0.0
) -> tuple[float, float]:
    """That of `tribo.time_average`."""
    return time_average(t, values, after)[:2]


def autocorrelation(values: np.ndarray) -> np.ndarray:
    """The autocorrelation of a series, from 1 at zero on, by a transform without wrapping."""
    rest = values - values.mean()
    found = np.fft.irfft(np.abs(np.fft.rfft(rest, 2 * rest.size)) ** 2)[: rest.size]
    return found / found[0]


def of_time(values: np.ndarray, tau: float) -> tuple[float, float]:
    """The interval for an integrated time tau = 1 + 2 sum of the autocorrelation, in samples."""
    error = values.std() * np.sqrt(max(tau, 0.0) / values.size)
    return float(values.mean()), float(1.96 * error)


def sokal(t: np.ndarray, values: np.ndarray, window: float = 5.0) -> tuple[float, float]:
    """A window of 5 times the integrated time (A. D. Sokal, 1989), as in emcee.

    Where the series is shorter than 50 of these times, emcee refuses: no interval.
    """
    times = 2.0 * np.cumsum(autocorrelation(values)) - 1.0
    enough = np.arange(times.size) >= window * times
    tau = float(times[np.argmax(enough)] if enough.any() else times[-1])
    mean, half_width = of_time(values, tau)
    return mean, half_width if values.size >= 50.0 * tau else np.nan


def geyer(t: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """The initial monotone sequence of sums of two neighbours (C. J. Geyer, 1992)."""
    rho = autocorrelation(values)
    pairs = rho[: rho.size // 2 * 2].reshape(-1, 2).sum(axis=1)
    negative = pairs <= 0.0
    pairs = pairs[: int(np.argmax(negative)) if negative.any() else pairs.size]
    return of_time(values, 2.0 * float(np.sum(np.minimum.accumulate(pairs))) - 1.0)


def batch_means(t: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Means of 20 batches, as if they were independent."""
    means = values[: values.size // BATCHES * BATCHES].reshape(BATCHES, -1).mean(axis=1)
    error = means.std(ddof=1) / np.sqrt(BATCHES)
    return float(values.mean()), float(stdtrit(BATCHES - 1, 0.975) * error)


ESTIMATORS: dict[str, Estimator] = {
    "tribo": tribo_average,
    "Sokal": sokal,
    "Geyer": geyer,
    "batches": batch_means,
}
COMPARED = ("white noise", "exponential, 1/1000", "exponential, 1/100", "exponential, 1/20")
COMPARED += ("exponential, 1/5", "sawtooth, 10", "sawtooth, 30", "sawtooth, 100", "thermal 0.1, 30")


def coverage(
    made: Made, series: int, samples: int, estimator: Estimator = tribo_average, seed: int = 1
) -> Coverage:
    """The coverage over so many series of a kind."""
    rng, t = np.random.default_rng(seed), np.linspace(0.0, 1.0, samples)
    found = [estimator(t, made(rng, samples)) for _ in range(series)]
    mean, half_width = np.array(found).T
    given = np.isfinite(half_width)
    if not given.any():
        return Coverage(0.0, np.nan, np.nan)
    mean, half_width = mean[given], half_width[given]
    error = 1.96 * np.sqrt(np.mean(mean**2))
    covered = np.mean(np.abs(mean) < half_width)
    return Coverage(float(np.mean(given)), float(covered), float(np.median(half_width) / error))


def compare(series: int, samples: int) -> None:
    """Print coverage, part with an interval and width of each estimator, as a table of Markdown."""
    every = kinds()
    print("| series | " + " | ".join(ESTIMATORS) + " |")
    print("| --- |" + " --- |" * len(ESTIMATORS))
    for name in COMPARED:
        cells = []
        for estimator in ESTIMATORS.values():
            found = coverage(every[name], series, samples, estimator)
            cell = f"{found.covered:.1%}, {found.width:.2f}" if found.given else "no interval"
            cells.append(cell + f" ({found.given:.0%} given)" * (0.0 < found.given < 1.0))
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--series", type=int, default=2000)
    parser.add_argument("--samples", type=int, default=2000)
    parser.add_argument("--after", default="0.0", help='a time, or "auto"')
    parser.add_argument("--compare", action="store_true", help="with other estimators")
    options = parser.parse_args()
    if options.compare:
        compare(options.series, options.samples)
        return
    after = options.after if options.after == "auto" else float(options.after)
    print(f"{'':22}{'given':>8}{'covered':>9}{'width':>7}")
    for name, made in kinds().items():
        found = coverage(made, options.series, options.samples, partial(tribo_average, after=after))
        print(f"{name:22}{found.given:8.1%}{found.covered:9.1%}{found.width:7.2f}", flush=True)


if __name__ == "__main__":
    main()
