"""Means of exp(-w / T): intervals that hold where they are trusted, and tails that are noticed."""

import numpy as np
import pytest

import tribo
from tribo import InputError, exponential_average


def gaussian(rng, mean, n):
    """Works with mean `mean` and variance 2 `mean`, at temperature 1: the mean of exp(-w) is 1."""
    return rng.normal(mean, np.sqrt(2.0 * mean), n)


@pytest.mark.parametrize("mean", [0.02, 0.1, 0.3])
def test_trusted_intervals_contain_the_mean(mean):
    """In 95 % of samples or somewhat more, as counts of 400 samples allow."""
    rng = np.random.default_rng(2)
    found = [exponential_average(gaussian(rng, mean, 10_000), 1.0) for _ in range(400)]
    assert np.mean([each.trusted for each in found]) > 0.9
    inside = [abs(each.mean - 1.0) <= each.half_width for each in found if each.trusted]
    assert 0.93 < np.mean(inside) < 0.99


@pytest.mark.parametrize("index", [2.1, 2.4])
def test_few_trusted_intervals_of_heavy_tails_miss_the_mean(index):
    """Samples that happen to lack their tail are neither trusted often nor off."""
    rng = np.random.default_rng(6)
    works = -rng.exponential(1.0 / index, (1000, 3000)) - np.log1p(-1.0 / index)
    found = [exponential_average(each, 1.0) for each in works]
    missed = [each.trusted and abs(each.mean - 1.0) > each.half_width for each in found]
    assert np.mean(missed) < 0.01


@pytest.mark.parametrize("index", [1.05, 1.5, 2.0])
def test_heavy_tails_are_not_trusted(index):
    """exp(-w) has a power law without a finite variance, which few values show."""
    rng = np.random.default_rng(3)
    for n in (1000, 100_000):
        found = exponential_average(-rng.exponential(1.0 / index, n), 1.0)
        assert not found.trusted and "not to be trusted" in str(found)
        assert abs(found.tail_index / index - 1.0) < 4.0 / np.sqrt(np.sqrt(n))


def test_a_mean_that_is_not_seen_is_not_trusted():
    """Works of 20 T on average: the mean of 1 is carried by works of -20 T, which none shows."""
    found = exponential_average(gaussian(np.random.default_rng(4), 20.0, 1000), 1.0)
    assert not found.trusted and found.carriers < 10 and found.mean < 0.5 < found.half_width


def test_units_and_refusals():
    """Works over the temperature count alone, also where the exponents are large."""
    works = gaussian(np.random.default_rng(5), 0.1, 1000)
    one = exponential_average(works, 1.0)
    other = exponential_average(7.0 * works, 7.0)
    assert abs(one.mean / other.mean - 1.0) < 1e-14 and one.trusted and "trusted" not in str(one)
    assert exponential_average(np.full(100, -600.0), 1.0).mean == pytest.approx(np.exp(600.0))
    for works, temperature in ((np.zeros(99), 1.0), (np.zeros(100), 0.0), ("a", 1.0)):
        with pytest.raises(InputError):
            exponential_average(works, temperature)
    assert tribo.ExponentialAverage is type(one)


def test_equal_works_carry_the_mean_alike():
    """Half of 100 equal works carry half of their mean."""
    assert exponential_average(np.zeros(100), 1.0).carriers == 50
