"""Subclasses of potentials and fields that define an energy: the force is that of the energy."""

from typing import NamedTuple

import numpy as np
import pytest

import tribo
from tribo import (
    Corrugation,
    Coulomb,
    DrivenBars,
    Field,
    Initial,
    InputError,
    LennardJones,
    Scene,
    Surface,
)
from tribo.export import to_lammps
from tribo.model.fields import curvature_of, period_of
from tribo.potentials import as_potential


class Inverse(NamedTuple):
    """Defines no force."""

    s: float

    def energy(self, r):
        return self.s / r


class InverseCube(Inverse):
    """Another energy than that of its parent."""

    def energy(self, r):
        return self.s / r**3


class Renamed(InverseCube):
    """The same as its parent."""


class SteepCoulomb(Coulomb):
    """Another energy than that of a built-in potential with charges."""

    def energy(self, r):
        return self.strength / r**3


class SteepLennardJones(LennardJones):
    """Another energy than that of a built-in potential, not of a formula."""

    def energy(self, r):
        u = self.epsilon
        u /= r**3
        return u


class Explicit(Inverse):
    """An energy and its force."""

    def energy(self, r):
        return self.s / r**3

    def force(self, r):
        return 3.0 * self.s / r**4


class Charged(NamedTuple):
    """Defines an energy between charges that is no multiple of the other, and no force."""

    s: float

    def energy(self, r):
        return self.s / r**3

    def energy_between(self, r, one, other):
        return self.s * (one + other) / 2.0 / r**3


class OfSum(tribo.potentials.Sum):
    """Another energy than that of a class that defines all methods."""

    def energy(self, r):
        return 1.0 / r**3

    def range(self):
        return np.inf


class Cut(tribo.WeeksChandlerAndersen):
    """Another energy with the range of its parent."""

    def energy(self, r):
        return self.epsilon / r**3


PARTS = as_potential(Inverse(1.0)), Coulomb(0.5)  # the first is complete, as after a run
CUBES = [
    InverseCube(1.0),
    Renamed(1.0),
    SteepCoulomb(1.0),
    SteepLennardJones(1.0, 1.0),
    Explicit(1.0),
    Charged(1.0),
    OfSum(*PARTS),
]


@pytest.mark.parametrize("own", CUBES, ids=lambda own: type(own).__name__)
def test_the_force_is_that_of_the_energy(own):
    """Of 1 / r^3 in each class, alone and inside combined potentials."""
    plain = as_potential(own)
    shifted = plain.with_cutoff(4.0, "shift")
    doubled = plain + plain
    for r in (0.7, 1.3):
        for potential, factor in ((plain, 1.0), (shifted, 1.0), (doubled, 2.0)):
            force = pytest.approx(factor * 3.0 / r**4, rel=1e-13, abs=0.0)
            assert potential.force(r) == force
            assert potential.force_between(r, 1.0, 1.0) == force
        assert plain.energy_between(r, 1.0, 1.0) == pytest.approx(1.0 / r**3, rel=1e-14, abs=0.0)
    assert as_potential(PARTS[0]).force(2.0) == 0.25  # the parent keeps its force


def test_runs_conserve_energy():
    """With a given step too, of a subclass of a potential that has been used."""
    surfaces = (
        Surface("upper", bob=(-1.0, 0.9), drive=DrivenBars(), initial=Initial(omega=0.4)),
        Surface("lower", facing="up", drive=DrivenBars()),
    )
    for own in (Inverse(0.1), InverseCube(0.1), SteepCoulomb(0.1)):
        result = tribo.simulate(Scene(surfaces, own, 4.0), method="verlet", step=0.005)
        contact = result.system["contact_energy"]
        energy = contact.copy()
        for name, rest in (("upper", 0.0), ("lower", np.pi)):
            theta = result[name].theta[:, 0]
            omega = result[name].omega[:, 0]
            energy += 0.5 * 1.0 * 2.0**2 * omega**2 + 0.5 * 2.0 * (theta - rest) ** 2
        assert np.ptp(contact) > 1e-3
        assert np.ptp(energy) < 1e-5, type(own).__name__


def test_an_inherited_range_is_refused():
    """The energy would end where that of the parent does."""
    with pytest.raises(InputError, match=r"Cut defines an energy but inherits range; define range"):
        as_potential(Cut(1.0, 1.0))


class Bump(NamedTuple):
    """A field without a force."""

    a: float

    def energy_at(self, x, y):
        return self.a * np.cos(x) * y


class Twice(Bump):
    """Another energy."""

    def energy_at(self, x, y):
        return self.a * np.cos(2.0 * x) * y


class Sloped(Corrugation):
    """Another energy than the built-in field's, which depends on y and has another period."""

    def energy_at(self, x, y):
        return self.amplitude * np.cos(2.0 * x) * y


class Named(Corrugation):
    """The built-in field under another name."""


def test_a_period_is_that_of_the_energy():
    """A class with another energy does not inherit its parent's period and curvature."""
    own, same = (Field(each, on=["a"]).potential for each in (Sloped(0.3, 1.5), Named(0.3, 1.5)))
    assert (period_of(own), curvature_of(own)) == (None, 0.0)
    assert period_of(same) == 1.5
    assert curvature_of(same) == Corrugation(0.3, 1.5).largest_curvature()


def test_forces_of_fields_are_those_of_their_energies():
    """And no closed form for the parent is taken for a subclass."""
    used = Field(Bump(0.3), on=["a"]).potential
    for own in (Twice(0.3), Sloped(0.3, 1.0)):
        field = Field(own, on=["a"], origin=(0.2, 0.1)).potential
        assert field.force_at(0.4, 0.5) == pytest.approx(
            (0.3 * np.sin(0.8), -0.3 * np.cos(0.8)), rel=1e-13
        )
    assert used.force_at(0.4, 0.5)[0] == pytest.approx(0.15 * np.sin(0.4))
    surface = Surface("a", bob=(5.3, 0.7), drive=DrivenBars(), initial=Initial(omega=0.1))
    fields = [Field(own, on=["a"], origin=(0.2, 0.1)) for own in (Twice(0.3), Sloped(0.3, 1.0))]
    runs = [
        tribo.simulate(Scene([surface], [], 2.0, fields=[field]), method="verlet", step=0.01)
        for field in fields
    ]
    assert np.ptp(runs[0]["a"].theta) > 0.05
    assert runs[1]["a"].theta == pytest.approx(runs[0]["a"].theta, abs=1e-12)


def test_exported_as_their_energies(tmp_path):
    """LAMMPS gets the formula of a subclass, and no style or field of its parent."""
    surfaces = Surface("a", bob=(0.0, 1.0)), Surface("b", facing="up")
    scene = Scene(surfaces, SteepCoulomb(1.0), 1.0, fields=[Field(Sloped(0.3, 1.0), on=["a"])])
    omitted = to_lammps(scene, tmp_path).omitted
    text = "".join(path.read_text() for path in sorted(tmp_path.iterdir()))
    assert "lepton" in text
    assert "coul/cut" not in text
    assert "field[0]: Sloped" in omitted
