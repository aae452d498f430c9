"""Asperites are drawn where the run had them, with the contact forces that the run had."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from ase import Atoms
from ase.calculators.emt import EMT
from ase.calculators.lj import LennardJones

import tribo
from support import reference
from tribo import InputError, Interaction, paper
from tribo.plotting.contacts import Contacts
from tribo.plotting.pose import pose
from tribo.potentials import from_calculator


@pytest.fixture(scope="module")
def result():
    """Case A of the paper."""
    scene = replace(paper.scene("A"), output=tribo.Output(samples=401))
    return tribo.simulate(scene, accuracy=1e-6)


@pytest.fixture(scope="module")
def rows():
    """Rows of several species in a periodic box: two interactions between them, one within.

    The scene, and the places of its bobs at the start.
    """
    row = {"shape": (2, 1), "spacing": (1.5, 0.0)}
    charged = tribo.Asperite(charge=(1.0, -0.5))
    turned = tribo.Initial(swing=(0.2, -0.1))
    upper = tribo.Surface(
        "upper", bob=(3.9, 0.9), species=("a", "b"), asperite=charged, initial=turned, **row
    )
    below = row | {"shape": (3, 1), "species": ("b", "a", "c")}
    below |= {"initial": tribo.Initial(swing=(0.3, 0.1, -0.3))}
    lower = tribo.Surface("lower", facing="up", depth=0.3, **below)
    bond = tribo.Morse(0.3, 2.0, 0.8).with_cutoff(2.0)
    charge = tribo.Coulomb(0.2).with_cutoff(2.4, "shift")
    between = ("upper", "lower")
    interactions = (
        Interaction(bond, between=between, species=("a", "b")),
        Interaction(charge, between=between, species=("b", "b")),
        Interaction(charge, between=("lower", "lower")),
    )
    scene = tribo.Scene((upper, lower), interactions, 1.0, periodic=tribo.Periodic(x=5.0))
    result = tribo.simulate(scene, method="verlet", step=0.1)
    tables = [result[surface.name] for surface in scene.surfaces]
    bobs = [np.transpose([table.x_bob[0], table.y_bob[0]]) for table in tables]
    return scene, np.concatenate(bobs)


def copper_rows(calculator):
    """Two rows of copper."""
    row = {"shape": (2, 1), "spacing": (2.6, 0.0), "species": "Cu"}
    upper = tribo.Surface("upper", bob=(-2.0, 2.3), velocity=(0.6, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    return tribo.Scene(
        [upper, lower], from_calculator(calculator), 2.0, output=tribo.Output(samples=5)
    )


class FailingEMT(EMT):
    """EMT until it is told to fail."""

    failing = False

    def calculate(self, *arguments):
        if self.failing:
            raise RuntimeError("no such element")
        super().calculate(*arguments)


@pytest.fixture
def copper():
    """The rows by EMT."""
    return tribo.simulate(copper_rows(FailingEMT()), method="verlet", step=0.02)


def arrows(ax):
    """Start and direction of each arrow."""
    return [(a.xyann, np.subtract(a.xy, a.xyann)) for a in ax.texts if a.arrow_patch]


@pytest.mark.parametrize("t", [23.2, 23.25])
@pytest.mark.parametrize("surface", ["upper", "lower"])
def test_positions(result, surface, t):
    """At a sample those of the series, bit for bit; between samples on the same rigid rod."""
    now = pose(result, t)
    place = now.index(surface, 0)
    series = result[surface]
    k = int(np.searchsorted(result.t, t))
    recorded = {p: [series[f"{axis}_{p}"][k, 0] for axis in "xy"] for p in ("cm", "bob", "bar")}
    for point, expected in recorded.items():
        if result.t[k] == t:
            assert getattr(now, f"{point}s")[place].tolist() == expected
    sizes = result.scene.surfaces[0].asperite.for_each(1)
    assert now.rods[place] == pytest.approx(sizes["l1"][0] + sizes["l2"][0], rel=1e-12, abs=0.0)
    rod = (now.bobs[place] - now.bars[place]) / now.rods[place]
    theta = now.theta[place]
    assert rod == pytest.approx([np.sin(theta), -np.cos(theta)], abs=1e-12)
    assert now.swing[place] == pytest.approx(theta - np.pi * (surface == "lower"), abs=1e-12)


def test_between_samples(result):
    """Bobs are interpolated: with samples four times as far apart they are near the finer run's."""
    coarse = tribo.simulate(replace(paper.scene("A"), output=tribo.Output(samples=101)), 1e-6)
    exact, interpolated = (pose(each, 22.1).bobs[0] for each in (result, coarse))
    assert interpolated == pytest.approx(exact, abs=1e-3)
    with pytest.raises(InputError, match="times: must be from 0 to 40, got 41"):
        pose(result, 41.0)


def test_forces_of_a_pair(result):
    """The force is minus the slope of the potential, and opposite on the other bob."""
    bobs = pose(result, 20.0).bobs
    away = bobs[0] - bobs[1]
    contacts = Contacts(result.scene, bobs)
    force = contacts.force("upper", 0)
    assert force == pytest.approx(0.2 * away / np.hypot(*away) ** 3)
    assert contacts.force("lower", 0) == pytest.approx(-force)
    assert contacts.nearest("upper", 0) == ("lower", 0, pytest.approx(np.hypot(*away)))


@pytest.mark.skipif(reference.compiler() is None, reason="there is no C compiler")
def test_forces_of_rows(rows):
    """Species, cutoffs, charges and periods count; contact within a surface is not in f1."""
    scene, bobs = rows
    expected = reference.solve(tomllib.loads(scene.to_toml())).forces
    contacts = Contacts(scene, bobs)
    found = [contacts.force(s.name, k) for s in scene.surfaces for k in range(s.count)]
    f1 = np.transpose([expected["f1_x"][0], expected["f1_y"][0]])
    assert np.array(found) == pytest.approx(f1, rel=1e-12, abs=1e-15)
    assert not contacts.force("lower", 2).any()  # species c has no interaction with the other row
    assert np.abs(expected["f_within_x"][0]).max() > 0.01


def test_the_nearest_bob(rows):
    """It may be nearest across the period."""
    scene, bobs = rows
    contacts = Contacts(scene, bobs)
    for k, bob in enumerate(bobs[:2]):
        x, y = np.abs(bob - bobs[2:]).T
        distances = np.sqrt(np.minimum(x, 5.0 - x) ** 2 + y**2 + 0.3**2)
        nearest = int(np.argmin(distances))
        found = ("lower", nearest, pytest.approx(distances[nearest]))
        assert contacts.nearest("upper", k) == found


def test_where_nothing_acts_there_is_no_arrow():
    """A calculator whose forces are zero at that distance."""
    result = tribo.simulate(copper_rows(LennardJones(rc=1.0)), method="verlet", step=0.02)
    assert arrows(result.plot.snapshots([0.0], ("upper", 0))) == []


def test_a_calculator_is_drawn(copper):
    """Arrows of a snapshot have the directions of the forces that EMT gives."""
    bobs = pose(copper, 1.0).bobs
    upper = bobs[:2]
    lower = bobs[2:]

    def forces(bobs):
        atoms = Atoms(["Cu"] * len(bobs), np.pad(bobs, ((0, 0), (0, 1))), calculator=EMT())
        return atoms.get_forces()[:, :2]

    expected = (forces(np.concatenate([upper, lower]))[:2] - forces(upper))[0]
    assert Contacts(copper.scene, bobs).force("upper", 0) == pytest.approx(expected, rel=1e-9)
    drawn = arrows(copper.plot.snapshots([1.0], ("upper", 0)))
    assert len(drawn) == 2
    _, direction = drawn[0]
    assert direction / np.hypot(*direction) == pytest.approx(expected / np.hypot(*expected))


def test_a_failing_calculator_says_so(copper):
    """An arrow needs its forces; a snapshot without arrows does not."""
    copper.scene.interactions[0].potential.calculator.failing = True
    copper.plot.snapshots([1.0])
    with pytest.raises(InputError, match="potential: the calculator raises RuntimeError: no such"):
        copper.plot.snapshots([1.0], ("upper", 0))
