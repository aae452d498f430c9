"""Potentials compose: sums, multiples and cutoffs by operators, of built-in and users' classes."""

import copy
import math
import pickle
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribo
from tribo import InputError
from tribo.potentials import Scaled, Sum, as_calculator, as_potential

JONES = tribo.LennardJones(1.0, 1.0)
IONS = tribo.Coulomb(0.2)
COMPOSED = JONES + 0.5 * IONS


class Cube(tribo.Potential):
    """A user's potential with the default of one parameter, and a name defined after it."""

    s: float
    power: float = 3.0

    def energy(self, r):
        return UNIT * self.s / r**3


UNIT = 2.0


class Steep(Cube):
    """Another energy and one more parameter."""

    t: float = 1.0

    def energy(self, r):
        return self.s / r**5 + self.t / r


class Plain(NamedTuple):
    """A user's potential that derives from nothing of this package."""

    s: float

    def energy(self, r):
        return self.s / r**2


class Wave(NamedTuple):
    """A user's field without a force."""

    a: float

    def energy_at(self, x, y):
        return self.a * np.cos(x)


def test_operators_make_sums_and_multiples():
    """They are the classes of sums and multiples, with floats as numbers."""
    ions = Scaled(IONS, 0.5)
    assert Sum(JONES, ions) == COMPOSED
    assert tribo.LennardJones(1, 1) + 0.5 * IONS == COMPOSED
    assert JONES + IONS * 0.5 == COMPOSED == JONES + np.float64(0.5) * IONS
    assert JONES - IONS == Sum(JONES, Scaled(IONS, -1.0)) == JONES + -IONS
    assert (JONES + IONS) + ions == JONES + (IONS + ions) == sum([JONES, IONS, ions])
    assert tribo.Mie(1.0, 1.0, 12.0, 6.0) != JONES and tribo.potentials.Table != IONS
    assert tribo.Gaussian(1.0, 2.0) != tribo.LennardJones(1.0, 2.0)


@given(r=st.floats(0.7, 4.0), one=st.floats(-2.0, 2.0), other=st.floats(-2.0, 2.0))
def test_values_are_those_of_the_parts(r, one, other):
    """To the last bit, by the parts' own methods; only the charged part feels the charges."""
    for method in ("energy", "force"):
        jones = getattr(JONES, method)(r)
        ions = one * other * getattr(IONS, method)(r)
        whole = getattr(COMPOSED, f"{method}_between")(r, one, other)
        assert whole == pytest.approx(jones + 0.5 * ions, rel=1e-13, abs=1e-14)
        by_hand = Sum(JONES, Scaled(IONS, 0.5))
        assert whole == getattr(by_hand, f"{method}_between")(r, one, other)


OWN = {
    "composed": COMPOSED,
    "a user's": Cube(0.3),
    "a subclass": Steep(0.3),
    "a user's in a sum": 2.0 * Cube(0.3) - IONS,
    "a user's with a cutoff": Steep(0.3).with_cutoff(2.5),
    "a plain one in a sum": JONES + Plain(0.4),
    "a plain one before a sum": (Plain(0.4) + JONES).with_cutoff(3.0, "force-shift"),
}


@pytest.mark.parametrize("name", OWN)
def test_the_force_is_the_slope(name):
    """By central differences of order 8 in extended precision."""
    potential = OWN[name]
    weights = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280], dtype=np.longdouble)
    h = np.longdouble(2.0) ** -10
    for r in np.linspace(0.9, 2.4, 7, dtype=np.longdouble):
        terms = (
            w * (potential.energy(r + k * h) - potential.energy(r - k * h))
            for k, w in enumerate(weights, start=1)
        )
        slope = float(sum(terms) / h)
        assert float(potential.force(r)) == pytest.approx(-slope, rel=1e-12, abs=1e-13)


def test_the_same_as_ase():
    """Sums of ASE's own Lennard-Jones, scaled by an epsilon that is three times as large."""
    from ase import Atoms
    from ase.calculators.lj import LennardJones as Peer

    atoms = Atoms("Ar3", positions=[[0.0, 0.0, 0.0], [1.2, 0.0, 0.0], [0.3, 1.1, 0.0]])
    atoms.calc = Peer(epsilon=3.0, sigma=1.0, rc=1e6)
    energy = atoms.get_potential_energy()
    forces = atoms.get_forces()
    atoms.calc = as_calculator(JONES + 2.0 * JONES)
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-12, abs=0.0)
    assert atoms.get_forces() == pytest.approx(forces, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("name", OWN)
def test_copies_and_pickles(name):
    """They are the same potentials with all their methods."""
    potential = OWN[name]
    for other in (copy.copy(potential), copy.deepcopy(potential)):
        assert other == potential
    other = pickle.loads(pickle.dumps(potential))
    assert other == potential and hash(other) == hash(potential)
    assert other.force(1.3) == potential.force(1.3)


def test_a_users_class_is_not_written_to():
    """Nor are fields, and a pickle of what is made of them finds the class again."""

    def written(cls):
        """All that a class has, but for the list that the module pickle keeps in it."""
        return {name: each for name, each in vars(cls).items() if name != "__slotnames__"}

    before = {cls: written(cls) for cls in (Cube, Steep, Plain, Wave)}
    surface = tribo.Surface("a", bob=(0.3, 1.0), drive="bars")
    other = tribo.Surface("b", facing="up", drive="bars")
    field = tribo.Field(Wave(0.3), on=["a"])
    potential = Plain(0.4) + Steep(0.3) - Cube(0.3)
    scene = tribo.Scene([surface, other], potential, 0.1, fields=[field])
    assert tribo.simulate(scene, method="verlet", step=0.05).status == "completed"
    copied = pickle.loads(pickle.dumps(scene))
    assert copied == scene
    force = copied.fields[0].potential.force_at(0.4, 0.0)
    assert force[0] == pytest.approx(0.3 * math.sin(0.4), rel=1e-14, abs=0.0)
    assert {cls: written(cls) for cls in before} == before
    assert isinstance(as_potential(Plain(0.4)), Plain)


def test_potentials_are_frozen():
    """Their fields cannot be set, and others cannot be added."""
    with pytest.raises(AttributeError):
        JONES.epsilon = 2.0
    with pytest.raises(AttributeError):
        JONES.other = 2.0
    assert JONES._replace(epsilon=2.0) == tribo.LennardJones(2.0, 1.0)


def test_what_is_no_potential_is_refused():
    """In one sentence that says what would do."""
    for value in (3, (1.0, 2.0), "coulomb"):
        with pytest.raises(InputError, match="potential: can be added to potentials only, not to"):
            JONES + value
    with pytest.raises(InputError, match=r"factor: must be a number, got LennardJones"):
        JONES * JONES
    with pytest.raises(InputError, match=r"class that derives from tribo\.Potential or a NamedTup"):
        tribo.Interaction((1.0, 2.0))
    with pytest.raises(InputError, match="sigma: must be positive"):
        JONES + tribo.LennardJones(1.0, -1.0)
    with pytest.raises(InputError, match="cutoff: must be given once"):
        JONES.with_cutoff(2.0).with_cutoff(1.0)


def grids(potential, **surface):
    """Two grids of bobs with charges, many enough for lanes and for threads."""
    grid = {"shape": (6, 6), "spacing": (1.3, 1.3), "asperite": tribo.Asperite(charge=0.7)}
    return tribo.Scene(
        [
            tribo.Surface("upper", bob=(0.2, 1.4), velocity=(0.4, 0.0), **grid),
            tribo.Surface("lower", facing="up", **grid),
        ],
        potential,
        0.4,
        output=tribo.Output(samples=5),
    )


def test_runs_in_lanes_threads_and_files(tmp_path):
    """One scene in all ways, and after it was saved: the same bits as the sum made by hand."""
    by_hand = Sum(tribo.LennardJones(0.1, 1.0), Scaled(tribo.Coulomb(0.2), 0.5))
    scene = grids(tribo.LennardJones(0.1, 1.0) + 0.5 * tribo.Coulomb(0.2))
    settings = {"method": "verlet", "step": 0.02}
    result = tribo.simulate(scene, **settings)
    theta = result["upper"].theta
    assert np.ptp(theta) > 1e-3
    assert np.array_equal(theta, tribo.simulate(grids(by_hand), **settings)["upper"].theta)
    assert np.array_equal(theta, tribo.simulate(scene, threads=2, **settings)["upper"].theta)
    scene.save(tmp_path / "scene.toml")
    again = tribo.load_scene(tmp_path / "scene.toml")
    assert again == scene
    assert np.array_equal(theta, tribo.simulate(again, **settings)["upper"].theta)
    result.save(tmp_path / "result.nc")
    assert tribo.load_result(tmp_path / "result.nc").scene == scene


def test_members_of_ensembles_have_composed_potentials():
    """Members side by side in registers are those that run alone, within their accuracy."""
    upper = tribo.Surface("upper", bob=(-1.0, 1.3), velocity=(0.5, 0.0))
    lower = tribo.Surface("lower", facing="up")
    numerics = tribo.Numerics(accuracy=1e-7)
    output = tribo.Output(samples=2)
    scene = tribo.Scene([upper, lower], COMPOSED, 2.0, numerics=numerics, output=output)
    angles = np.linspace(-0.2, 0.2, 16)
    found = tribo.ensemble(scene, 16, {"upper.theta": angles}, keep=["upper.W"])
    prepared = tribo.prepare(scene)
    for k in (0, 7, 15):
        alone = prepared.run({"upper.theta": angles[k]})
        last = float(np.asarray(found["upper.W"].isel(member=k)).ravel()[-1])
        assert last == pytest.approx(alone["upper"]["W"][-1], abs=1e-6)
