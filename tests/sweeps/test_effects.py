"""Every key that is swept changes the result, or is refused; points draw with their own numbers."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import InputError, ensemble, sweep
from tribo.ensembles.batches import SingleRuns
from tribo.model.initial import DISPLACEMENTS, UNITS
from tribo.model.keys import parts_of
from tribo.model.parameters import value_of, with_values
from tribo.model.tables import field_names, table_of
from tribo.potentials.by_key import values_by_key

PAIR = replace(tribo.paper.scene("A"), duration=4.0)
# Runs of equal steps of a trap with noise, whose asperite can move along both axes.
TRAP = tribo.Scene(
    [
        tribo.Surface(
            "p",
            asperite={"kappa": np.inf},
            drive={"kind": "pulled", "stiffness": 1.0, "speed": 0.0},
            langevin={"gamma": 1.2, "temperature": 0.8},
        )
    ],
    (),
    0.4,
    output={"samples": 2},
)
STEPS = {"method": "verlet", "step": 0.02, "progress": False}


@pytest.fixture
def only_batches(monkeypatch):
    """No member is run as a run of its own."""

    def compute(policy, members):
        raise AssertionError("a member is run alone")

    monkeypatch.setattr(SingleRuns, "compute", compute)


@pytest.mark.parametrize("number", ["kappa", "m1", "m2", "length"])
def test_each_point_draws_with_its_own_numbers(number, only_batches):
    """The energies at the start are those of the distribution at every point."""
    starts = {"*.swing_state": tribo.Canonical(1.0)}
    values, keep = {f"*.asperite.{number}": [1.0, 4.0, 16.0]}, ["upper.theta", "upper.omega"]
    data = sweep(PAIR, values, 32, starts, keep=keep, accuracy=1e-4)
    ((key, numbers),) = values.items()
    # A start that follows the number has a value at each point.
    follows = "upper.swing" if number == "kappa" else "upper.omega"
    along = f"{'+'.join(surface.name for surface in PAIR.surfaces)}.asperite.{number}"
    assert data[follows].dims == (along, "member", "upper_asperite")
    energies = []
    for k, value in enumerate(numbers):
        asperite = replace(PAIR.surfaces[0].asperite, **{number: value})
        own, at = asperite.for_each(1), data.isel({along: k})
        kinetic = own["inertia"] * at["upper.omega"].values ** 2
        energies.append(0.5 * (kinetic + own["kappa"] * at["upper.swing"].values ** 2))
        scene = with_values(PAIR, {key: value})
        alone = ensemble(scene, 32, starts, keep, accuracy=1e-4)
        np.testing.assert_allclose(at["upper.swing"], alone["upper.swing"], rtol=1e-12)
        bound = 2e-3 * np.ptp(alone["upper.omega_end"].values)
        assert np.max(np.abs(at["upper.omega_end"] - alone["upper.omega_end"])) < bound
    np.testing.assert_allclose(energies, np.broadcast_to(energies[0], np.shape(energies)))


def test_displaced_starts_in_batches(only_batches):
    """Displacements and their rates differ between members, with the bits of single runs."""
    names = ("x", "y", "vx", "vy")
    vary = {f"p.{name}": stats.norm(0.5, 0.1) for name in names}
    keep = ["p.x_cm", "p.vy_cm", "p.w2"]
    data = ensemble(TRAP, 9, vary, keep, **STEPS)
    swept = sweep(TRAP, {"p.x": [0.1, 0.7]}, 3, {"p.vx": stats.norm()}, keep, **STEPS)
    assert data["p.x"].dims == ("member", "p_asperite") and data["p.x"].attrs["units"] == "length"
    for k in (0, 8):
        own = {f"p.{name}": float(data[f"p.{name}"][k, 0]) for name in names}
        scene = replace(with_values(TRAP, own), seed=int(data["seed"][k]))
        run = tribo.simulate(scene, **STEPS)["p"]
        for name in keep:
            assert data[name][k].values == run[name.removeprefix("p.")][-1]
    own = {"p.x": 0.7, "p.vx": float(swept["p.vx"][1, 0])}
    scene = replace(with_values(TRAP, own), seed=int(swept["seed"][1]))
    assert swept["p.w2"][1, 1].values == tribo.simulate(scene, **STEPS)["p"].w2[-1]
    thermal = with_values(TRAP, {"p.temperature": 0.8})
    data = ensemble(thermal, 3, {"p.x": [0.1, 0.2, 0.3]}, keep, **STEPS)
    scene = replace(with_values(thermal, {"p.x": 0.3}), seed=int(data["seed"][2]))
    assert data["p.w2"][2].values == tribo.simulate(scene, **STEPS)["p"].w2[-1]


def test_displacements_of_prepared_scenes():
    """Initial values of a run are those of a scene; what is held is refused."""
    simulation = tribo.prepare(TRAP, **STEPS)
    own = {"p.x": 0.3, "p.vy": -0.2}
    run, whole = simulation.run(own), tribo.simulate(with_values(TRAP, own), **STEPS)
    np.testing.assert_array_equal(run["p"].x_cm, whole["p"].x_cm)
    prepared = tribo.prepare(PAIR, accuracy=1e-4)
    one = prepared.run({"*.theta": 0.2}, estimate=False)["upper"].theta
    np.testing.assert_array_equal(
        one, prepared.run({"upper.theta": 0.2, "lower.theta": 0.2}, estimate=False)["upper"].theta
    )
    for wrong, problem in (
        ({"upper.x": 0.1}, r"upper\.x: cannot be given, as the drive holds"),
        ({"upper.theta": 0.1, "*.swing": 0.1}, r"upper\.swing: cannot go with upper\.theta"),
    ):
        with pytest.raises(InputError, match=problem):
            prepared.run(wrong)


STATES = {"upper.swing_state": tribo.Canonical(0.1)}


@pytest.mark.parametrize(
    ("values", "how", "problem"),
    [
        ({"numerics.step": [0.2, 0.02]}, {"step": 0.1}, "step: cannot go with step"),
        ({"numerics.method": ["verlet", "rk4"]}, {"method": "rk4"}, "method: cannot go with"),
        ({"numerics.accuracy": [1e-3, 1e-4]}, {"step": 0.1}, "accuracy: cannot go with step"),
        ({"upper.theta": [0.1, 0.5]}, {"members": 3, "vary": STATES}, "cannot go with upper.theta"),
        (
            {"upper.theta": [0.1, 0.5]},
            {"members": 3, "vary": {"upper.swing": stats.norm()}},
            "vary.upper.swing: cannot go with upper.theta",
        ),
        ({"upper.omega": [0.1]}, {"members": 3, "vary": STATES}, "cannot go with upper.omega"),
        ({"upper.temperature": [0.1]}, {"members": 3, "vary": STATES}, "upper.temperature"),
        ({"upper.theta": [0.1], "upper.swing": [0.1]}, {}, "cannot go with upper.theta"),
        ({"output.samples": [3, 30]}, {"at": "samples"}, "output.samples: cannot be swept where"),
        ({"duration": [3.0, 4.0]}, {"at": "samples"}, "duration: cannot be swept where"),
        (
            {"duration": [3.0, 4.0]},
            {"half_width": {"upper.W": 0.1}, "keep": None},
            "duration: cannot be swept",
        ),
        ({"output.samples": [3, 30]}, {}, "output.samples: changes averages over time alone"),
        ({"output.run_in": [0.0, 1.0]}, {}, "output.run_in: changes averages over time alone"),
        ({"output.ledger": ["asperites", "none"]}, {}, "output.ledger: changes no kept"),
        ({"numerics.max_evaluations": [10, 20]}, {}, "max_evaluations: limits runs"),
        ({"title": ["a", "b"]}, {}, "title: is text for reports"),
        ({"seed": [1, 2]}, {}, "seed: changes nothing: the scene has no noise"),
        (
            {"seed": [1, 2]},
            {"members": 3, "vary": {"upper.swing": stats.norm()}},
            "seed: changes nothing: members have other seeds",
        ),
    ],
)
def test_keys_without_effect(values, how, problem):
    """A sentence names the key and what would replace it."""
    with pytest.raises(InputError, match=problem.replace(".", r"\.")):
        sweep(PAIR, values, **{"keep": ["upper.W"], **how})


def test_seeds_of_members_with_noise_are_no_values():
    """Members of a point have seeds of their own, by which their noise differs."""
    with pytest.raises(InputError, match="changes nothing: members have other seeds"):
        sweep(TRAP, {"seed": [1, 2]}, 4, keep=["p.W"], step=0.1)


def numbers_by_key(scene):
    """Two values of every number of a scene that has a key."""
    keys = ["duration", "seed", *(f"interaction.{k}" for k in _numbers(scene.interactions))]
    keys += [f"field.{k}" for k in _numbers(scene.fields)]
    for part in ("output", "numerics", "periodic"):
        keys += [f"{part}.{name}" for name in field_names(getattr(scene, part))]
    for surface in scene.surfaces:
        own = [*UNITS, *DISPLACEMENTS, "temperature", "velocity", "depth"]
        for part in parts_of(surface):
            name, _, on = part.partition(".")
            item = getattr(surface, name)
            item = item[["bar", "swing"].index(on)] if on else item
            own += [f"{part}.{each}" for each in table_of(item)] if item is not None else []
        keys += [f"{surface.name}.{name}" for name in own]
    for key in keys:
        present = value_of(scene, key)
        if isinstance(present, (bool, str, list, dict)):
            continue
        if isinstance(present, int):
            yield key, [present + 2, present + 3]
        else:
            first = present or 0.1
            yield key, [first, (2.0 if key.startswith("numerics") else 1.1) * first]


def _numbers(items):
    return values_by_key(items[0].potential) if len(items) == 1 else ()


def idle_keys(scene, tried, keep, **how):
    """Keys, without their surfaces, that neither change a result nor are refused on any."""
    acts, idle = set(), set()
    names = [surface.name for surface in scene.surfaces]
    for key, values in tried:
        surface, _, rest = key.partition(".")
        word = rest if surface in names else key
        try:
            data = sweep(scene, {key: values}, keep=keep, progress=False, **how)
        except InputError:
            acts.add(word)
            continue
        refused = np.any(data["status"] != "completed")
        changed = any(not np.array_equal(data[n][0], data[n][1], equal_nan=True) for n in keep)
        (acts if refused or changed else idle).add(word)
    return idle - acts


def test_numbers_of_asperites():
    """All but the inertia of bars that are clamped."""
    parts = ("upper.asperite.", "lower.asperite.", "interaction.", "output.")
    tried = [(key, values) for key, values in numbers_by_key(PAIR) if key.startswith(parts)]
    found = idle_keys(PAIR, tried, ["upper.w1", "upper.wL", "lower.wL"], accuracy=1e-3)
    assert len(tried) > 12 and found == {"asperite.i2"}


@pytest.mark.slow
def test_every_number_of_a_pair():
    """Likewise; numbers that bring other forces are left out."""
    absent = ("drive.", "langevin.", "bath.", "springs.", "numerics.", "temperature", "periodic.")
    tried = [
        (key, values)
        for key, values in numbers_by_key(PAIR)
        if not any(word in key for word in absent)
    ]
    keep = ["upper.w1", "upper.wL", "lower.w1", "lower.wL", "upper.theta", "lower.theta"]
    found = idle_keys(PAIR, tried, keep, accuracy=1e-3)
    assert len(tried) > 30 and found == {"asperite.i2"}


def everything():
    """Two rows with noise, on which every kind of force acts that has numbers with keys."""
    common = {
        "shape": (2, 1),
        "spacing": (1.0, 0.0),
        "springs": {"stiffness": 0.8, "turned": 0.1},
        "langevin": [
            {"gamma": 0.3, "temperature": 0.1},
            {"gamma": 0.2, "temperature": 0.1, "on": "swing"},
        ],
        "bath": {"spectrum": "drude", "gamma": 0.3, "cutoff": 2.0, "n": 3, "temperature": 0.1},
        "initial": {"swing": 0.0, "phi": 0.1, "omega": 0.2, "x": 0.1, "y": 0.1, "vx": 0.1},
    }
    drive = {"kind": "pulled", "stiffness": 1.0, "speed": 0.6, "load": 0.05}
    upper = tribo.Surface("upper", bob=(-2.4, 1.0), drive=drive, bars="free", **common)
    lower = tribo.Surface("lower", facing="up", drive="free", **common)
    contact = 2.0 * (tribo.LennardJones(0.1, 1.0) + tribo.Coulomb(0.1)).with_cutoff(2.4, "shift")
    field = {"kind": "corrugation", "amplitude": 0.1, "period": 1.5, "on": ["upper", "lower"]}
    return tribo.Scene(
        [upper, lower],
        contact,
        0.2,
        fields=field,
        periodic={"x": 4.9},
        output={"samples": 3},
        numerics={"method": "verlet", "step": 0.02},
    )


@pytest.mark.slow
def test_every_number_of_a_scene_with_everything():
    """No number that has a key is without an effect, and none that is refused is silent."""
    scene = everything()
    keep = [f"upper.{name}" for name in ("w1", "w2", "w_int", "w_T", "w_field", "theta", "x_cm")]
    keep += ["lower.w1", "lower.wL", "lower.wR", "lower.theta", "upper.phi", "contact_energy"]
    tried = list(numbers_by_key(scene))
    assert len(tried) > 80
    assert idle_keys(scene, tried, keep) == set()


def test_intervals_without_a_value_are_noted():
    """A sweep, an ensemble and one point by point say how many averages have no interval."""
    slow = replace(TRAP, output=tribo.Output(samples=3))
    values, name = {"p.drive.stiffness": [1.0, 2.0]}, "p.pull_force_time_half_width"
    data = sweep(slow, values, keep=["p.pull_force"], **STEPS)
    assert np.isnan(data[name]).all() and "of 2 of 2 runs have no interval" in data.attrs["notes"]
    one = ensemble(slow, 3, keep=["p.pull_force"], **STEPS)
    assert np.isnan(one[name]).all() and "of 3 of 3 members have no" in one.attrs["notes"]
    how = {"members": 3, "statistics": True, "keep": ["p.pull_force"], **STEPS}
    assert sweep(slow, values, **how).attrs["notes"].count("3 of 3 members have no interval") == 2
