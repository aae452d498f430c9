"""Contact in lanes agrees with one pair after another, for built-in potentials and for a user's."""

from collections import Counter
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.kernels import shared_kernel
from tribo import explanation
from tribo.compiler.jit import compilations
from tribo.compiler.lanes import LANES, NARROW, broadcast, lane, narrow, where_less, widen
from tribo.compiler.lanes_memory import load, rows_of, store
from tribo.compiler.numbers_in_lanes import numbers_at_lane, numbers_in_lanes
from tribo.compiler.plugin_methods import recognize, type_of
from tribo.integrators.methods import METHODS
from tribo.kernels.potential_in_lanes import force_in_lanes, is_vectorized, range_in_lanes
from tribo.layout.layout import lay_out
from tribo.potentials import BUILT_IN, as_potential, expression

# Largest difference, relative to the force nearby: a few ulp of the largest term of a formula.
ROUND_OFF = 2e-14

LJ = tribo.LennardJones(0.3, 0.5)
# A potential of each kind, with its parameters; those of powers that are not whole are scalar.
POTENTIALS = {
    "coulomb": tribo.Coulomb(0.2),
    "yukawa": tribo.Yukawa(0.2, 0.7),
    "plummer": tribo.Plummer(0.2, 0.1),
    "morse": tribo.Morse(0.4, 1.6, 0.7),
    "lennard-jones": LJ,
    "weeks-chandler-andersen": tribo.WeeksChandlerAndersen(0.3, 0.5),
    "buckingham": tribo.Buckingham(2.0, 0.3, 0.1),
    "born-mayer": tribo.BornMayer(2.0, 0.3),
    "mie": tribo.Mie(0.3, 0.5, 12.0, 6.0),
    "hertz": tribo.Hertz(2.0, 1.3),
    "soft-sphere": tribo.SoftSphere(0.2, 0.5, 9.5),
    "gaussian": tribo.Gaussian(-0.3, 0.6),
    "switched": LJ.with_cutoff(2.0),
    "force-shifted": LJ.with_cutoff(2.0, "force-shift"),
    "shifted": LJ.with_cutoff(2.0, "shift"),
    "truncated": LJ.with_cutoff(2.0, "truncate"),
    "sum": LJ + tribo.Coulomb(0.2),
    "scaled": -2.0 * LJ,
    "expression": expression("a * exp(-r / b) / r", a=0.2, b=0.9),
}
SCALAR = {"mie", "soft-sphere"}


@shared_kernel
def forces(potential, places, charges, out):
    """Forces at eight distances: together in row 0 of `out`, one after another in row 1.

    Those at the first four, together, are in row 2.
    """
    r = load(rows_of(places), 0)
    others = load(rows_of(charges), 0)
    end = potential.range()
    store(rows_of(out), 0, force_in_lanes(potential, r, end, 1.3, others, 0, LANES))
    four = force_in_lanes(potential, narrow(r), end, 1.3, narrow(others), 0, NARROW)
    store(rows_of(out), 2, widen(four))
    for i in range(LANES):
        out[1, i] = potential.force_between(places[0, i], 1.3, charges[0, i])


def assert_alike(potential):
    """The forces agree to round-off of the largest force nearby, at all distances in reach."""
    recognize(potential)
    rng = np.random.default_rng(4)
    for _ in range(200):
        r = rng.uniform(0.3, min(3.0, potential.range()), (1, LANES))
        charges = rng.uniform(-1.0, 1.5, (1, LANES))
        out = np.empty((3, LANES))
        forces(potential, r, charges, out)
        pairs = list(zip(r[0].tolist(), charges[0].tolist(), strict=True))
        written = [potential.force_between(x, 1.3, charge) for x, charge in pairs]
        # Of a force that passes through zero the digits are those of its terms.
        near = [[potential.force_between(f * x, 1.3, q) for f in (0.9, 1.0, 1.1)] for x, q in pairs]
        scale = np.max(np.abs(near), axis=1)
        assert np.max(np.abs(out[0] - out[1]) / scale) < ROUND_OFF
        assert np.array_equal(out[2, :NARROW], out[0, :NARROW])
        assert np.max(np.abs(out[1] - written) / scale) < ROUND_OFF


def test_every_built_in_is_here():
    """No formula of a new built-in is left out."""
    assert {type(potential) for potential in POTENTIALS.values()} >= set(BUILT_IN.values())


# A formula of each sort; those like them are thorough, since each compiles for most of a second.
DEFAULT = {"coulomb", "lennard-jones", "mie", "switched", "sum", "expression"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.thorough] * (n not in DEFAULT)) for n in POTENTIALS],
)
def test_lanes_agree_with_scalars(name):
    """In lanes, compiled for one distance, and as Python."""
    potential = as_potential(POTENTIALS[name])
    assert is_vectorized(type_of(potential)) == (name not in SCALAR)
    assert_alike(potential)


class Soft(NamedTuple):
    """A user's potential: a charged repulsion that ends softly."""

    height: float
    width: float

    def energy(self, r):
        """U of a bell with a tail."""
        return self.height / np.sqrt(1.0 + (r / self.width) ** 2) * np.exp(-r)

    def coupling(self, one, other):
        """As of charges."""
        return one * other


class Ripple(NamedTuple):
    """A user's potential that needs a sine."""

    height: float

    def energy(self, r):
        """A ripple."""
        return self.height * np.sin(r) / r


@pytest.mark.parametrize(
    ("potential", "arithmetic"), [(Soft(0.3, 0.5), "lanes"), (Ripple(0.3), "scalar")]
)
def test_a_users_potential(potential, arithmetic):
    """It is computed in lanes where its formula allows, and an explanation says whether it is."""
    assert_alike(as_potential(potential))
    scene = tribo.Scene(
        (tribo.Surface("upper"), tribo.Surface("lower", facing="up")), potential, 1.0
    )
    assert explanation.contact(lay_out(scene), METHODS["verlet"]).arithmetic == arithmetic


class Bell(NamedTuple):
    """A potential that no other test compiles."""

    height: float

    def energy(self, r):
        """U of a bell."""
        return self.height * np.exp(-r * r)


def test_a_formula_is_compiled_once():
    """Whether it can be computed in lanes is found by compiling what kernels then call."""
    potential = as_potential(Bell(0.3))
    formula = type_of(potential).formulas["force_between"]
    with compilations() as recorded:
        assert_alike(potential)
    compiled = Counter(
        event.data["args"]
        for _, event in recorded.buffer
        if event.is_start and event.data["dispatcher"].py_func is formula
    )
    assert len(compiled) >= 3  # of one distance, of four and of eight
    assert set(compiled.values()) == {1}


@shared_kernel
def own_forces(potential, table, places, rows, out):
    """Forces of eight potentials with numbers of their own: together, and one after another."""
    own = numbers_in_lanes(potential, table, rows_of(rows), 0)
    r = load(rows_of(places), 0)
    end = range_in_lanes(own, broadcast(1.3), broadcast(0.7))
    force = force_in_lanes(own, r, end, broadcast(1.3), broadcast(0.7), 0, LANES)
    store(rows_of(out), 0, where_less(r, end, force, 0.0))
    for i in range(LANES):
        one = numbers_at_lane(own, i)
        x = lane(r, i)
        out[1, i] = one.force_between(x, 1.3, 0.7) if x < one.range() else 0.0


@pytest.mark.parametrize("kind", [pytest.param("hertz", marks=pytest.mark.thorough), "mie"])
def test_potentials_side_by_side(kind):
    """Each distance has the numbers of its lane, also where a cutoff or a formula is one by one."""
    potential = as_potential(POTENTIALS[kind])
    recognize(potential)
    table = np.array(potential) * np.linspace(0.8, 1.2, LANES)[:, None]
    places = np.linspace(0.7, 1.4, LANES)[None]
    out = np.zeros((2, LANES))
    own_forces(potential, table, places, np.ascontiguousarray(table.T), out)
    np.testing.assert_allclose(out[0], out[1], rtol=1e-13)
    expected = [
        type(potential)(*row).force_between(x, 1.3, 0.7)
        for row, x in zip(table, places[0], strict=True)
    ]
    reach = [type(potential)(*row).range() for row in table]
    np.testing.assert_allclose(out[1], np.where(places[0] < reach, expected, 0.0), rtol=1e-12)
