"""A force that is exactly zero has no encounter: bobs that meet head-on pass through each other."""

import numpy as np
import pytest

import tribo
from tribo import Coulomb, Gaussian, LennardJones
from tribo.potentials import expression


class Own(tribo.Potential):
    """A user's formula, of which a field is a factor."""

    k: float
    a: float

    def energy(self, r):
        x = r / self.a
        return 2.0 * self.k * np.exp(-x) / r


UNREADABLE = """
class Unreadable(tribo.Potential):
    k: float
    a: float

    def energy(self, r):
        x = r / self.a
        return -(2.0 * self.k * np.exp(-x) - self.k) / r + 3.0 * self.k * {factor}
"""


def unreadable(factor):
    """A class whose source no file contains."""
    scope = {"tribo": tribo, "np": np, "__name__": __name__}
    exec(UNREADABLE.format(factor=factor), scope)
    return scope["Unreadable"]


ZERO = {
    "strength": (Coulomb(0.0), 1.0),
    "charge": (Coulomb(0.2), 0.0),
    "factor": (0.0 * Coulomb(0.2), 1.0),
    "sum": (Coulomb(0.0) + 0.0 * LennardJones(1.0, 0.5), 1.0),
    "cutoff": (LennardJones(0.0, 0.5).with_cutoff(1.25), 1.0),
    "own": (Own(0.0, 1.0), 1.0),
    "unreadable": (unreadable("r**-2")(0.0, 1.0), 1.0),
    "expression": (expression("k/r", k=0.0), 1.0),
}


def head_on(potential, charge=1.0, count=1):
    """Bobs that coincide at a recorded time."""
    asperite = tribo.Asperite(charge=charge)
    row = {"shape": (count, 1), "spacing": (1.0, 0.0)}
    upper = tribo.Surface("upper", bob=(-2.0, 0.0), velocity=(0.5, 0.0), asperite=asperite, **row)
    surfaces = [upper, tribo.Surface("lower", facing="up")]
    return tribo.Scene(surfaces, potential, 8.0, output=tribo.Output(samples=9))


@pytest.mark.parametrize("name", ["strength", "charge"])
@pytest.mark.parametrize("count", [1, 3])
def test_bobs_pass_where_no_force_acts(name, count):
    """By the loop of a pair and by the general one, without a short step."""
    result = tribo.simulate(head_on(*ZERO[name], count))
    assert result.status == "completed" and result.met
    assert result.cost.steps < 100
    assert np.all(result["upper"].w1 == 0.0)


@pytest.mark.parametrize("name", ZERO)
def test_potentials_know_that_they_are_zero(name):
    """No clearance ends, no range begins; others with the same classes act."""
    potential, charge = ZERO[name]
    assert not potential.acts_between(charge, 1.0)
    assert potential.clearance_between(0.1, charge, 1.0) == np.inf
    assert potential.range_between(charge, 1.0) == 0.0
    for acting in (Coulomb(0.2), 0.5 * Coulomb(0.2), Coulomb(0.0) + Gaussian(1.0, 1.0)):
        assert acting.acts_between(1.0, 1.0) and acting.range_between(1.0, 1.0) == np.inf


def test_an_energy_of_ones_own_acts_unless_a_factor_is_zero():
    """A class does not inherit what a parent with another energy knows."""

    class Shifted(Coulomb):
        def energy(self, r):
            return self.strength + 1.0 / r

    assert Shifted(0.0).acts_between(1.0, 1.0)
    assert Own(1.0, 2.0).acts_between(1.0, 1.0)
    for unknown in ("r**-2 + 1.0 / r", "1.0 + np.exp(self.k)", "(1.0 if r > 1.0 else 0.0)"):
        assert unreadable(unknown)(0.0, 1.0).acts_between(1.0, 1.0)


@pytest.mark.thorough
def test_zero_parts_of_sums_have_no_encounter():
    """A strength of zero beside a soft core, and members of a sweep with that strength."""
    soft = Gaussian(1e-3, 0.5)
    alone, beside = tribo.simulate(head_on(soft)), tribo.simulate(head_on(Coulomb(0.0) + soft))
    assert beside.status == "completed"
    assert beside["upper"].w1[-1, 0] == pytest.approx(alone["upper"].w1[-1, 0], rel=1e-6)
    swept = tribo.sweep(
        head_on(Coulomb(0.1)), {"interaction.strength": [0.0, 0.1]}, keep=["upper.W"]
    )
    assert swept.status.values[0] == "completed"
    assert swept["upper.W"].values.ravel()[0] == 0.0
