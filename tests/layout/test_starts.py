"""Starts: displacements and rates of centres of mass, thermal starts, what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import Asperite, Bath, Coulomb, DrivenBars, Free, Initial, InputError, Pulled, Surface
from tribo.ensembles.members import is_random
from tribo.export import to_lammps
from tribo.export.lammps_atoms import atoms_of
from tribo.layout.initial_state import InitialState
from tribo.layout.layout import lay_out
from tribo.loops.saved_state import state_at_rest

COUNT = 40_000
TEMPERATURE = 0.3


def passing(lower):
    """One asperite passes one that may move along x."""
    upper = Surface("upper", bob=(-1.0, 0.4))
    output = tribo.Output(samples=5)
    return tribo.Scene((upper, lower), Coulomb(0.2), 4.0, output=output)


def test_displaced_and_moving():
    """A displacement is another place, and a rate is another velocity."""
    how = {"method": "rk4", "step": 0.02}
    plain = Surface("lower", facing="up", drive=Free())
    moved = replace(plain, initial=Initial(x=0.3, vx=-0.2))
    placed = replace(plain, bob=(0.3, 0.0), velocity=(-0.2, 0.0))
    one, other = (tribo.simulate(passing(s), **how)["lower"] for s in (moved, placed))
    assert one.x_cm[0] == pytest.approx(0.3) and one.vx_cm[0] == pytest.approx(-0.2)
    for name in ("x_cm", "vx_cm", "theta", "x_bob", "w1", "w", "w_ps", "delta_k_trans"):
        assert one[name] == pytest.approx(other[name], abs=1e-12), name
    assert np.max(np.abs(one.w)) > 1e-3


@pytest.mark.parametrize("initial", [Initial(x=0.3), Initial(vx=-0.2), Initial(temperature=0.1)])
def test_displaced_at_an_accuracy(initial):
    """A pair that is displaced, moves or is warm at the start is not for the loop of a pair."""
    scene = passing(Surface("lower", facing="up", drive=Free(), initial=initial))
    run = tribo.simulate(scene, accuracy=1e-8)["lower"]
    other = tribo.simulate(scene, method="rk4", step=1e-3)["lower"]
    assert run.x_cm[0] == other.x_cm[0] and run.vx_cm[0] == other.vx_cm[0]
    for name in ("x_cm", "vx_cm", "theta", "w1", "w"):
        assert run[name] == pytest.approx(other[name], abs=1e-7), name


def start(surface, *others, seed=3):
    """Coordinates and rates of a surface at the start of a scene, and its oscillators."""
    layout = lay_out(tribo.Scene((surface, *others), Coulomb(0.2), 1.0, seed=seed))
    q, v = layout.start.reshape(2, -1)
    table, rates = (state_at_rest(layout, values).surfaces[surface.name] for values in (q, v))
    names = {"swing": "omega", "phi": "nu", "x": "vx", "y": "vy"}
    return dict(table) | {names[key]: rates[key] for key in names}, q[layout.core :]


def test_thermal_start():
    """Variances are those of Boltzmann's distribution, asperite by asperite, and independent."""
    kappa = np.linspace(0.5, 3.0, COUNT)
    m1 = np.linspace(0.5, 1.5, COUNT)
    surface = Surface(
        "a",
        shape=(COUNT, 1),
        asperite=Asperite(kappa=kappa, m1=m1),
        drive=Pulled(load=0.1),
        bars="free",
        bath=Bath([0.1], [2.0], inertias=[0.3], torsional_frequencies=[1.5]),
        initial=Initial(temperature=TEMPERATURE, phi=0.1, x=0.5),
    )
    found, oscillators = start(surface)
    l1 = 2.0 * 2.0 / (m1 + 2.0)
    l2 = 2.0 * m1 / (m1 + 2.0)
    mass = m1 + 2.0
    inertia = m1 * l1**2 + 2.0 * l2**2
    drawn = {
        "swing": (found["swing"] - 0.1) * np.sqrt(kappa),
        "omega": found["omega"] * np.sqrt(inertia),
        "nu": found["nu"] * np.sqrt(5.0),
        "vx": found["vx"] * np.sqrt(mass),
        "vy": found["vy"] * np.sqrt(mass),
    }
    for part in (slice(0, COUNT // 2), slice(COUNT // 2, COUNT)):
        table = np.array([values[part] for values in drawn.values()]) / np.sqrt(TEMPERATURE)
        # Variances have a standard error of sqrt(2 / n), correlations of sqrt(1 / n).
        assert np.cov(table) == pytest.approx(np.eye(5), abs=5.0 * np.sqrt(4.0 / COUNT))
        assert np.mean(table**4, axis=1) == pytest.approx(3.0, abs=5.0 * np.sqrt(192.0 / COUNT))
    assert np.all(found["x"] == 0.5) and np.all(found["phi"] == 0.1) and not np.any(found["y"])
    assert np.all(oscillators[2::3] == 0.1)
    assert oscillators[::3] == pytest.approx(0.5 - l2 * np.sin(found["swing"]), abs=1e-15)
    other, _ = start(surface, seed=4)
    assert np.mean(other["swing"] == found["swing"]) < 0.01


def test_thermal_start_of_held_and_rigid():
    """Driven bars stand on their lattice; one body moves as one."""
    warm = Initial(temperature=TEMPERATURE)
    held, _ = start(Surface("a", shape=(COUNT, 1), drive=DrivenBars(), initial=warm))
    error = 5.0 * np.sqrt(2.0 / COUNT)
    # The pendulum is m1 on a rod about the bar; its bar stands, so x is that of r_cm about it.
    assert np.var(held["omega"]) * 1.0 * 2.0**2 / TEMPERATURE == pytest.approx(1.0, abs=error)
    assert held["x"] == pytest.approx(2.0 / 3.0 * np.sin(held["swing"]), abs=1e-15)
    rigid = Asperite(kappa=np.inf)
    body = Surface("a", shape=(9, 1), asperite=rigid, drive=Free(rigid=True), initial=warm)
    found, _ = start(body)
    assert np.ptp(found["vx"]) == 0.0 and found["vx"][0] != 0.0 and not np.any(found["swing"])
    speeds = [start(body, seed=seed)[0]["vx"][0] for seed in range(300)]
    assert np.var(speeds) * 27.0 / TEMPERATURE == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / 300))


@pytest.mark.parametrize(
    ("initial", "settings", "problem"),
    [
        ({"x": 0.1}, {}, r"surface\[0\].initial.x: cannot be given, as the drive holds"),
        ({"vy": 0.1}, {"drive": "free"}, r"initial.vy: .* along y; a load frees them"),
        ({"x": 0.1}, {"drive": "bars"}, "initial.x: cannot be given"),
        ({"vx": 0.1}, {"drive": {"kind": "free", "rigid": True}}, "drive.rigid = true"),
        ({"x": [0.1, 0.2]}, {"drive": "free"}, r"initial.x: .* an array of size 3, got size 2"),
        ({"temperature": -1.0}, {}, "temperature: must not be negative"),
        ({"temperature": 0.1, "theta": 0.0}, {}, "theta: cannot go with temperature"),
        ({"temperature": 0.1}, {"asperite": Asperite(kappa=0.0)}, "needs asperite.kappa > 0"),
        ({"temperature": 0.1}, {"asperite": Asperite(kappa=np.inf)}, "draws nothing"),
    ],
)
def test_refused(initial, settings, problem):
    """One sentence with the field and what would do."""
    with pytest.raises(InputError, match=problem):
        tribo.Scene(
            (Surface("a", shape=(3, 1), initial=Initial(**initial), **settings),), Coulomb(0.2), 1.0
        )


def test_exported_to_lammps(tmp_path):
    """Atoms start displaced and with their rates; what is drawn is listed as omitted."""
    moved = Initial(x=[0.1, 0.2], vx=-0.3)
    surface = Surface("a", shape=(2, 1), spacing=(1.0, 0.0), velocity=(0.5, 0.0), drive=Free())
    scene = tribo.Scene((replace(surface, initial=moved),), Coulomb(0.2), 1.0)
    atoms = atoms_of(scene)
    assert atoms.positions[:, 0] == pytest.approx([0.1, 1.2])
    assert atoms.velocities.tolist() == [[0.2, 0.0, 0.0]] * 2
    warm = tribo.Scene((replace(surface, initial=Initial(temperature=0.1)),), Coulomb(0.2), 1.0)
    omitted = to_lammps(warm, tmp_path).omitted
    assert 'surface "a": the temperature of the start' in omitted


def test_members_have_starts_of_their_own():
    """Each is the run of its scene, whose seed draws the start."""
    lower = Surface("lower", facing="up", drive=Free(), initial=Initial(temperature=0.1))
    numerics = tribo.Numerics(method="rk4", step=0.02)
    scene = replace(passing(lower), duration=0.4, numerics=numerics)
    data = tribo.ensemble(scene, 3, keep=["lower.theta"])
    ends = np.ravel(data["lower.theta"].values)
    seeds = data["seed"].values.tolist()
    alone = [tribo.simulate(replace(scene, seed=seed)) for seed in seeds]
    assert ends.tolist() == [run["lower"].theta[-1, 0] for run in alone]
    assert np.unique(ends).size == 3


WARM = {"initial": Initial(temperature=0.1)}
OSCILLATORS = Bath([0.1, 0.2], [2.0, 3.0], temperature=0.2)
TORSIONAL = Bath([], [], inertias=[0.1], torsional_frequencies=[1.0], temperature=0.3)
KINDS = {
    "warm": WARM,
    "sliding": {"drive": Free(load=0.1), **WARM},
    "body": {"drive": Free(rigid=True), **WARM},
    "turning": {"drive": Free(), "bars": "free", "bath": TORSIONAL, **WARM},
    "held": {"drive": DrivenBars(), **WARM},
    "bathed": {"drive": Free(), "bath": OSCILLATORS, **WARM},
    "cold": {"drive": Free(), "bath": Bath([0.1], [2.0]), "initial": Initial(swing=0.1)},
}


@pytest.mark.parametrize("vary", [(), ("a.theta",), ("a.phi",)])
@pytest.mark.parametrize("kind", KINDS)
def test_starts_of_many_members(kind, vary):
    """Drawn and placed at once, they are those of scenes with the seeds of the members."""
    plain = Surface("a", shape=(2, 1), bath=OSCILLATORS, drive=Free(), bars="free")
    surfaces = plain, Surface("b", facing="up", shape=(3, 1), **KINDS[kind])
    scene = tribo.Scene(surfaces, Coulomb(0.2), 1.0, seed=2)
    values = {key: 0.1 * np.arange(8.0).reshape(4, 2) for key in vary}
    seeds = np.array([5, 2, 2**62, 7])
    found = InitialState(lay_out(scene)).of_members(values, seeds)
    for m, seed in enumerate(seeds.tolist()):
        own = {key.rpartition(".")[2]: rows[m] for key, rows in values.items()}
        moved = replace(plain, initial=Initial(**own)), surfaces[1]
        start = lay_out(replace(scene, surfaces=moved, seed=seed)).start
        np.testing.assert_array_equal(found[m], start)


def test_in_files_and_ensembles(tmp_path):
    """The keys are those of Initial; a start that is drawn cannot be set, and members differ."""
    warm = Surface("warm", initial=Initial(temperature=0.1), drive=Free())
    moved = Surface("moved", facing="up", drive=Free(), initial=Initial(x=[0.1], vx=0.2))
    scene = tribo.Scene((warm, moved), Coulomb(0.2), 1.0)
    scene.save(tmp_path / "scene.toml")
    assert tribo.load_scene(tmp_path / "scene.toml") == scene
    with pytest.raises(
        InputError, match=r"warm.theta: cannot be changed where initial.temperature"
    ):
        scene.initial_value("warm.theta")
    assert is_random(scene)


def test_a_block_starts_at_one_velocity_at_a_temperature():
    """Bars that are joined have no velocities of their own."""
    block = Surface(
        "s",
        asperite=Asperite(kappa=np.inf),
        shape=(50, 1),
        spacing=(1.0, 0.0),
        drive=Free(load=0.1, block=True),
        initial=Initial(temperature=0.2),
    )
    velocities = start(block)[0]["vy"]
    assert np.ptp(velocities) == 0.0
    assert velocities[0] != 0.0
