"""Pairs of rows: places, ratios, periods, and a short slide."""

from fractions import Fraction

import numpy as np
import pytest

from tribo import (
    Asperite,
    Coulomb,
    InputError,
    Scene,
    commensurate_rows,
    incommensurate_rows,
    periodic_rows,
    simulate,
)

GOLDEN_MEAN = 0.5 * (1.0 + 5.0**0.5)


def x_of(surface):
    return surface.resting_bobs()[:, 0]


def test_commensurate_rows():
    upper, lower = commensurate_rows(4, 0.5, gap=2.0)
    np.testing.assert_allclose(upper.resting_bobs(), [[0.5 * i, 2.0, 0.0] for i in range(4)])
    np.testing.assert_allclose(lower.resting_bobs(), [[0.5 * i, 0.0, 0.0] for i in range(4)])
    assert (upper.name, upper.facing) == ("upper", "down")
    assert (lower.name, lower.facing) == ("lower", "up")


@pytest.mark.parametrize(("slide", "first", "last"), [(0.3, 0.0, 0.7), (-0.25, -0.3, 0.4)])
def test_the_lower_row_is_as_long_as_the_slide(slide, first, last):
    _, lower = commensurate_rows(5, 0.1, slide=slide)
    np.testing.assert_allclose(x_of(lower), np.arange(first, last + 0.05, 0.1), atol=1e-14)


@pytest.mark.parametrize("ratio", [GOLDEN_MEAN, 1 / GOLDEN_MEAN])
def test_incommensurate_rows(ratio):
    upper, lower = incommensurate_rows(10, 2.0, ratio, slide=-7.0)
    assert upper.spacing[0] / lower.spacing[0] == pytest.approx(ratio, rel=1e-15, abs=0.0)
    assert x_of(lower)[0] <= -7.0 < x_of(lower)[1]
    assert x_of(lower)[-2] < x_of(upper)[-1] <= x_of(lower)[-1]
    phase = np.sort(x_of(upper) / lower.spacing[0] % 1.0)
    assert np.diff(phase).min() > 0.01  # no two upper asperites sit alike


def test_a_row_of_given_length():
    _, lower = incommensurate_rows(3, lower_n=7)
    assert lower.count == 7
    assert x_of(lower)[0] == 0.0


@pytest.mark.parametrize(
    ("n", "ratio", "counts"),
    [
        (1, GOLDEN_MEAN, (1, 2)),
        (13, GOLDEN_MEAN, (13, 21)),
        (20, GOLDEN_MEAN, (13, 21)),
        (21, 1 / GOLDEN_MEAN, (21, 13)),
        (100, 1.5, (2, 3)),
    ],
)
def test_approximants(n, ratio, counts):
    """The best fraction with at most n asperites in the upper row."""
    upper, lower, _ = periodic_rows(n, ratio=ratio)
    assert Fraction(upper.count, lower.count) == Fraction(*counts)


@pytest.mark.parametrize(
    ("ratio", "counts"), [(GOLDEN_MEAN, (13, 21)), (1.0, (17, 17)), (1.5, (16, 24))]
)
def test_periodic_rows_close(ratio, counts):
    upper, lower, period = periodic_rows(17, 0.3, ratio)
    assert (upper.count, lower.count) == counts
    for row in (upper, lower):
        assert row.count * row.spacing[0] == pytest.approx(period, rel=1e-14, abs=0.0)


def test_settings_are_passed_on_and_have_the_last_word():
    upper, lower = commensurate_rows(
        3,
        upper={"velocity": (0.5, 0.0), "bob": (0.25, 1.5), "drive": "free"},
        lower={"name": "table", "asperite": Asperite(kappa=[1.0, 2.0, 3.0]), "bars": "free"},
    )
    assert upper.velocity == (0.5, 0.0)
    assert upper.resting_bobs()[1].tolist() == [1.25, 1.5, 0.0]
    assert type(upper.drive).__name__ == "Free"
    assert (lower.name, lower.bars) == ("table", "free")
    assert lower.asperite.kappa.tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("settings", "field"),
    [
        ({"n": 0}, "n"),
        ({"n": 2.5}, "n"),
        ({"spacing": 0.0}, "spacing"),
        ({"gap": "wide"}, "gap"),
        ({"ratio": -1.0}, "ratio"),
        ({"slide": float("inf")}, "slide"),
        ({"lower_n": 0}, "lower_n"),
        ({"lower_n": 5, "slide": 1.0}, "slide"),
        ({"upper": {"velocty": (1.0, 0.0)}}, "upper.velocty"),
        ({"lower": {"drive": "pushed"}}, "lower.drive"),
        ({"lower": 3.0}, "lower"),
    ],
)
def test_what_makes_no_sense_is_named(settings, field):
    with pytest.raises(InputError) as caught:
        incommensurate_rows(**{"n": 3} | settings)
    assert caught.value.field == field


def test_a_ratio_too_small_for_the_row():
    with pytest.raises(InputError, match=r"^ratio: must be above 0.166667 for 3 upper asperites"):
        periodic_rows(3, ratio=0.01)


def test_rows_slide():
    upper, lower = incommensurate_rows(3, 2.0, slide=1.0, upper={"velocity": (0.5, 0.0)})
    scene = Scene((upper, lower), Coulomb(0.02), duration=2.0)
    result = simulate(scene, method="verlet", step=0.02)
    assert result.status == "completed"
    assert len(result.end["surfaces"]["upper"]["theta"]) == 3
    assert np.ptp(result.end["surfaces"]["upper"]["theta"]) > 0.0
