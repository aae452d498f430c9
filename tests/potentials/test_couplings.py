"""Couplings of one's own: the same physics as built-in potentials between the bobs that couple."""

import itertools

import numpy as np
import pytest

import tribo

WELL = tribo.Gaussian(-0.3, np.sqrt(0.5))


class Opposite(tribo.Potential):
    """Acts between charges of opposite sign alone: of 1 and -1 it is WELL."""

    A: float

    def energy(self, r):
        return -self.A * np.exp(-r * r)

    def coupling(self, one, other):
        return max(0.0, -one * other)


class Kinds(tribo.Potential):
    """Two kinds of bobs by their charges, 1 and 2, of which the first alone act on one another."""

    A: float

    def energy(self, r):
        return -self.A * np.exp(-r * r)

    def coupling(self, one, other):
        return (2.0 - one) * (2.0 - other)


class SoftBalls(tribo.Potential):
    """Balls whose radii are the charges."""

    A: float

    def energy_between(self, r, one, other):
        return self.A * np.maximum(one + other - r, 0.0) ** 2.5

    def range(self):
        return 2.0


def work(potential, charges, count=1, **how):
    """The work on the upper asperites, along a row, with the charges of both surfaces."""
    x = 5.0 * np.arange(count)
    places = np.column_stack([x, np.zeros(count), np.zeros(count)])
    upper, lower = ({"charge": charge} for charge in charges)
    surfaces = (
        tribo.Surface(
            "upper",
            positions=places + np.array([0.2, 0.7, 0.0]),
            velocity=(0.5, 0.0),
            asperite=upper,
        ),
        tribo.Surface("lower", facing="up", positions=places, asperite=lower),
    )
    result = tribo.simulate(tribo.Scene(surfaces, potential, 1.0), **how)
    change = result.system["total_energy_change"] - result.system["applied_work"]
    np.testing.assert_allclose(change, 0.0, atol=1e-4)
    return result["upper"].w1[-1]


HOW = [
    {"method": "verlet", "step": 0.0025},
    {"method": "dop853", "accuracy": 1e-8},
    {"method": "gauss-radau-15", "accuracy": 1e-8},
]


def test_between_opposite_charges():
    """Alone, as a part of a sum, scaled and cut off; in one test, as each is compiled once."""
    morse = tribo.Morse(0.1, 1.0, 0.8)
    own = Opposite(0.3)
    for mine, built_in in (
        (own, WELL),
        (own + morse, WELL + morse),
        (2.0 * own, 2.0 * WELL),
        (own.with_cutoff(2.0), WELL.with_cutoff(2.0)),
        ((0.5 * own + morse).with_cutoff(2.0), (0.5 * WELL + morse).with_cutoff(2.0)),
    ):
        for how, count in itertools.product(HOW, (1, 9)):
            wanted = work(built_in, (1.0, 1.0), count, **how)
            np.testing.assert_allclose(work(mine, (1.0, -1.0), count, **how), wanted, rtol=1e-6)
    for how in HOW:
        assert np.all(np.abs(work(own, (1.0, -1.0), **how)) > 0.05)
        assert np.all(work(own, (1.0, 1.0), **how) == 0.0)


def test_between_charges_that_are_not_the_largest():
    how = HOW[1]
    found = work(Kinds(0.3), ([1.0, 2.0], [1.0, 2.0]), 2, **how)
    wanted = work(WELL, (1.0, 1.0), **how)
    np.testing.assert_allclose(found, [wanted[0], 0.0], rtol=1e-6, atol=1e-9)
    found = work(Opposite(0.3), ([-1.0, 2.0], [1.0, 2.0]), 2, **how)
    np.testing.assert_allclose(found, [wanted[0], 0.0], rtol=1e-6, atol=1e-9)


def test_a_part_that_is_zero_changes_nothing():
    """First or last in a sum, and in a sum within a sum."""
    nothing = tribo.Coulomb(0.0)
    how = HOW[0]
    wanted = work(WELL, (1.0, 1.0), **how)
    for potential in (nothing + WELL, WELL + nothing, nothing + (nothing + WELL)):
        np.testing.assert_allclose(work(potential, (1.0, 1.0), **how), wanted, rtol=1e-12)


def test_members_with_charges_of_their_own():
    """In lanes, for some of which the bobs do not act on one another."""
    surfaces = (
        tribo.Surface("upper", bob=(0.2, 0.7), velocity=(0.5, 0.0), asperite={"charge": 1.0}),
        tribo.Surface("lower", facing="up", asperite={"charge": -1.0}),
    )
    scene = tribo.Scene(surfaces, Opposite(0.3) + tribo.Morse(0.1, 1.0, 0.8), 1.0)
    charges = np.linspace(-1.0, 1.0, 9)
    how = {"method": "verlet", "step": 0.0025}
    values = {"lower.asperite.charge": charges}
    found = tribo.sweep(scene, values, keep=["upper.w1"], progress=False, **how)
    sum_ = Opposite(0.3) + tribo.Morse(0.1, 1.0, 0.8)
    wanted = [work(sum_, (1.0, charge), **how)[0] for charge in charges]
    np.testing.assert_allclose(found["upper.w1"].values.ravel(), wanted, rtol=1e-9)


def test_a_card_looks_where_it_acts():
    """A wrong force is seen, of a potential that does not act between two charges of 1."""

    class Wrong(Opposite):
        def force(self, r):
            return -self.A * r * np.exp(-r * r)

    assert tribo.check(Opposite(0.3)).passed
    assert not tribo.check(Wrong(0.3)).passed


def contacts(potential, charges, height):
    """(in contact, pairs in contact, share of time without contact) of two far pairs at rest."""
    places = np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]])
    surfaces = (
        tribo.Surface(
            "upper", positions=places + [[0, h, 0] for h in height], asperite={"charge": charges}
        ),
        tribo.Surface("lower", facing="up", positions=places, asperite={"charge": charges}),
    )
    output = tribo.Output(samples=2, series=["forces", "contacts"])
    scene = tribo.Scene(surfaces, potential, 0.01, output=output)
    result = tribo.simulate(scene, method="verlet", step=0.01)
    upper = result["upper"]
    assert np.array_equal(result.contacts("upper")["number"], upper.contact_number)
    return (
        upper.in_contact[0].tolist(),
        upper.contact_number[0],
        result.time_without_contact("upper"),
    )


def test_contact_is_by_the_charges_of_two_bobs():
    """Not by the largest on their surfaces: soft balls, and an attraction beside a repulsion."""
    assert contacts(SoftBalls(1.0), [0.3, 1.0], [1.0, 5.0]) == ([0.0, 0.0], 0.0, 1.0)
    assert contacts(SoftBalls(1.0), [0.3, 1.0], [0.5, 1.9]) == ([1.0, 1.0], 2.0, 0.0)
    balance = tribo.LennardJones(0.2, 1.0).with_cutoff(2.5) + tribo.Coulomb(0.3).with_cutoff(2.5)
    assert contacts(balance, [0.1, 3.0], [1.5, 9.0]) == ([0.0, 0.0], 0.0, 1.0)
    assert contacts(balance, [0.1, 3.0], [1.5, 1.5]) == ([0.0, 1.0], 1.0, 0.0)


def test_contacts_of_very_many_unlike_charges_are_refused():
    radii = np.linspace(0.3, 1.0, 40)
    row = {"shape": (40, 1), "spacing": (3.0, 0.0), "asperite": {"charge": radii}}
    surfaces = (
        tribo.Surface("upper", bob=(0.0, 1.0), **row),
        tribo.Surface("lower", facing="up", **row),
    )
    output = tribo.Output(samples=2, series=["forces", "contacts"])
    result = tribo.simulate(
        tribo.Scene(surfaces, SoftBalls(1.0), 0.01, output=output), method="verlet", step=0.01
    )
    with pytest.raises(KeyError, match="in_contact"):
        result["upper"]["in_contact"]
    with pytest.raises(tribo.InputError, match="more than 32 unlike charges"):
        result.contacts("upper")
