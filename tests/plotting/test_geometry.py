"""Asperites are drawn where the run had them, with the contact forces that the run had."""

from dataclasses import replace

import numpy as np
import pytest
from ase import Atoms
from ase.calculators.emt import EMT

import tribo
from tribo import Interaction, paper, plotting
from tribo.plotting.geometry import Contacts, scene_geometry
from tribo.potentials import live
from tribo.validation import InputError

# Distance of the samples from which an acceleration is taken [time], and their middle.
GAP, MIDDLE = 1e-3, 1.5


@pytest.fixture(scope="module")
def result():
    """Case A of the paper."""
    scene = replace(paper.scene("A"), output=tribo.Output(samples=401))
    return tribo.simulate(scene, accuracy=1e-6)


@pytest.fixture(scope="module")
def rows():
    """Rows of several species in a periodic box: two interactions between them, one within."""
    row = {"shape": (2, 1), "spacing": (1.5, 0.0), "drive": "free"}
    charged = tribo.Asperite(charge=(1.0, -0.5))
    upper = tribo.Surface(
        "upper", bob=(-1.0, 0.9), velocity=(0.5, 0.0), species=("a", "b"), asperite=charged, **row
    )
    lower = tribo.Surface(
        "lower", facing="up", species=("b", "a", "c"), **(row | {"shape": (3, 1)})
    )
    bond = tribo.with_cutoff(tribo.Morse(0.3, 2.0, 0.8), 2.0)
    charge = tribo.with_cutoff(tribo.Coulomb(0.2), 2.4, "shift")
    between = ("upper", "lower")
    interactions = (
        Interaction(bond, between=between, species=("a", "b")),
        Interaction(charge, between=between, species=("b", "b")),
        Interaction(charge, between=("lower", "lower")),
    )
    times = (0.0, MIDDLE - GAP, MIDDLE, MIDDLE + GAP)
    settings = {"periodic": tribo.Periodic(x=5.0), "output": tribo.Output(times=times)}
    scene = tribo.Scene((upper, lower), interactions, 2.0, **settings)
    return tribo.simulate(scene, method="verlet", step=5e-4)


def copper_rows(calculator):
    """Two rows of copper."""
    row = {"shape": (2, 1), "spacing": (2.6, 0.0), "species": "Cu"}
    upper = tribo.Surface("upper", bob=(-2.0, 2.3), velocity=(0.6, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    return tribo.Scene([upper, lower], live(calculator), 2.0, output=tribo.Output(samples=5))


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
    (asperite,) = scene_geometry(result, t)[surface]
    series = result[surface]
    k = int(np.searchsorted(result.t, t))
    recorded = {p: [series[f"{axis}_{p}"][k, 0] for axis in "xy"] for p in ("cm", "bob", "bar")}
    for point, expected in recorded.items():
        if result.t[k] == t:
            assert getattr(asperite, point).tolist() == expected
    sizes = result.scene.surfaces[0].asperite.for_each(1)
    assert asperite.length == pytest.approx(sizes["l1"][0] + sizes["l2"][0], rel=1e-12)
    rod = (asperite.bob - asperite.bar) / asperite.length
    assert rod == pytest.approx([np.sin(asperite.theta), -np.cos(asperite.theta)], abs=1e-12)


def test_between_samples(result):
    """Bobs are interpolated: with samples four times as far apart they are near the finer run's."""
    coarse = tribo.simulate(replace(paper.scene("A"), output=tribo.Output(samples=101)), 1e-6)
    (exact,) = scene_geometry(result, 22.1)["upper"]
    (interpolated,) = scene_geometry(coarse, 22.1)["upper"]
    assert interpolated.bob == pytest.approx(exact.bob, abs=1e-3)
    with pytest.raises(InputError, match="t: must be from 0 to 40, got 41"):
        scene_geometry(result, 41.0)


def test_one_sample_is_enough():
    """A result of one sample has one snapshot."""
    output = tribo.Output(times=(5.0,))
    result = tribo.simulate(replace(paper.scene("A"), duration=5.0, output=output), 1e-6)
    (asperite,) = scene_geometry(result, 5.0)["upper"]
    assert asperite.bob.tolist() == [result["upper"].x_bob[0, 0], result["upper"].y_bob[0, 0]]


def test_forces_of_a_pair(result):
    """The force is minus the slope of the potential, and opposite on the other bob."""
    geometry = scene_geometry(result, 20.0)
    away = geometry["upper"][0].bob - geometry["lower"][0].bob
    contacts = Contacts(result.scene, geometry)
    force = contacts.force("upper", 0)
    assert force == pytest.approx(0.2 * away / np.hypot(*away) ** 3)
    assert contacts.force("lower", 0) == pytest.approx(-force)
    assert contacts.nearest("upper", 0) == ("lower", 0, pytest.approx(np.hypot(*away)))


def test_forces_are_those_of_the_run(rows):
    """On a freely sliding asperite f1 alone acts along x: f1_x = M dv_x/dt.

    On the lower surface contact within acts too, which adds up to zero.
    """
    contacts = Contacts(rows.scene, scene_geometry(rows, MIDDLE))
    drawn, felt = {}, {}
    for surface in rows.scene.surfaces:
        mass = surface.asperite.for_each(surface.count)["mass"]
        v = rows[surface.name].vx_cm
        felt[surface.name] = mass * (v[3] - v[1]) / (2.0 * GAP)
        drawn[surface.name] = [contacts.force(surface.name, k)[0] for k in range(surface.count)]
    assert drawn["upper"] == pytest.approx(felt["upper"], abs=1e-6)
    assert sum(drawn["lower"]) == pytest.approx(sum(felt["lower"]), abs=1e-6)
    assert min(np.abs(felt["upper"])) > 0.01
    assert max(np.abs(drawn["lower"] - felt["lower"])) > 1e-3


def test_the_nearest_bob(rows):
    """Across the period where that is nearer."""
    contacts = Contacts(rows.scene, scene_geometry(rows, MIDDLE))
    for k in range(2):
        x = rows["upper"].x_bob[2, k] - rows["lower"].x_bob[2]
        y = rows["upper"].y_bob[2, k] - rows["lower"].y_bob[2]
        distances = np.hypot(np.minimum(np.abs(x), 5.0 - np.abs(x)), y)
        nearest = int(np.argmin(distances))
        found = ("lower", nearest, pytest.approx(distances[nearest]))
        assert contacts.nearest("upper", k) == found


def test_where_nothing_acts_there_is_no_arrow(rows):
    """Species c interacts with no other surface."""
    assert not Contacts(rows.scene, scene_geometry(rows, MIDDLE)).force("lower", 2).any()
    bob = [rows["lower"].x_bob[2, 2], rows["lower"].y_bob[2, 2]]
    drawn = arrows(plotting.snapshot(rows, MIDDLE, forces=("lower", 2)))
    assert all(np.hypot(*np.subtract(start, bob)) > 0.5 for start, _ in drawn)
    assert len(drawn) == 1  # of the nearest bob, on which others act


def test_a_calculator_is_drawn(copper):
    """Arrows of a snapshot have the directions of the forces that EMT gives."""
    geometry = scene_geometry(copper, 1.0)
    upper, lower = (np.array([each.bob for each in geometry[s]]) for s in ("upper", "lower"))

    def forces(bobs):
        atoms = Atoms(["Cu"] * len(bobs), np.pad(bobs, ((0, 0), (0, 1))), calculator=EMT())
        return atoms.get_forces()[:, :2]

    expected = (forces(np.concatenate([upper, lower]))[:2] - forces(upper))[0]
    assert Contacts(copper.scene, geometry).force("upper", 0) == pytest.approx(expected, rel=1e-9)
    drawn = arrows(plotting.snapshot(copper, 1.0, forces=("upper", 0)))
    assert len(drawn) == 2
    _, direction = drawn[0]
    assert direction / np.hypot(*direction) == pytest.approx(expected / np.hypot(*expected))


def test_a_failing_calculator_says_so(copper):
    """An arrow needs its forces; a snapshot without arrows does not."""
    copper.scene.interactions[0].potential.calculator.failing = True
    plotting.snapshot(copper, 1.0)
    with pytest.raises(InputError, match="potential: the calculator raises RuntimeError: no such"):
        plotting.snapshot(copper, 1.0, forces=("upper", 0))
