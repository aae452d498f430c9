"""Guards of a run: each stops it by name, keeps what was reached and says where it was."""

import re
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.hard_scenes import changed, side_by_side, stopped
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.layout.layout import lay_out
from tribo.ledger import guards, sinks
from tribo.ledger.samples import Samples
from tribo.ledger.separation import closest_bobs
from tribo.loops import integrate
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting


def note_of_stop(result):
    """The note that says where a run stopped."""
    (note,) = (note for note in result.notes if note.startswith("stopped at t = "))
    assert note in str(result) and note in result.end["notes"]
    return note


@pytest.mark.parametrize(
    ("scene", "how", "status", "says"),
    [
        (side_by_side(tribo.Forced()), {}, "StepUnderflow", "after a last step of"),
        (side_by_side(tribo.Forced()), {"step": 1e-3}, "EncounterJumped", "step of 0.001;"),
        (changed("A", start=0.0), {}, "BobsCoincide", "before the first step; .* 0 apart"),
    ],
    ids=["underflow", "jump", "coincidence"],
)
def test_a_stop_says_where_it_was(scene, how, status, says):
    """The time, the last step, and the closest asperites with their distance."""
    result = stopped(status, scene, **how)
    note = note_of_stop(result)
    one, other = (surface.name for surface in scene.surfaces)
    bobs = f'the closest bobs, of asperite 0 of "{one}" and asperite 0 of "{other}", were '
    assert bobs in note
    distance = float(note.partition(bobs)[2].split()[0])
    gaps = [result[one][f"{axis}_bob"] - result[other][f"{axis}_bob"] for axis in "xy"]
    assert distance == pytest.approx(np.hypot(*gaps)[-1, 0], rel=1e-2, abs=1e-12)
    assert re.search(says, note)


def test_closest_bobs_of_lattices():
    """Of periodic surfaces and within one, the smallest distance of any two that interact."""
    upper = tribo.Surface("upper", shape=(3, 2), spacing=(1.0, 1.5), bob=(0.2, 1.0))
    lower = tribo.Surface("lower", facing="up", bob=(4.1, 0.0), shape=(2, 1), spacing=(0.3, 0.0))
    cut = tribo.LennardJones(1.0, 0.3).with_cutoff(1.4)
    between = tribo.Interaction(cut, between=("upper", "lower"))
    within = tribo.Interaction(cut, between=("lower", "lower"))
    box = tribo.Periodic(x=4.0, z=3.0)
    for interactions, expected in (
        ((between,), (np.hypot(0.1, 1.0), {0, 6})),
        ((between, within), (0.3, {6, 7})),
        ((), None),
    ):
        scene = tribo.Scene((upper, lower), interactions, 1.0, periodic=box)
        layout = lay_out(scene)
        start = replace(Samples.at_zero(layout), y=layout.start[None])
        found = closest_bobs(layout, start)
        if expected is None:
            assert found is None
        else:
            assert found[0] == pytest.approx(expected[0], rel=1e-12, abs=0.0)
            assert set(found[1:]) == expected[1]


def impatient(monkeypatch, evaluations=500.0):
    """Look at the progress of a run after every 16 trials."""
    monkeypatch.setattr(integrate, "TRIALS", 16)
    monkeypatch.setattr(integrate, "FEWEST_TRIALS", 16)
    monkeypatch.setattr(integrate, "MOST_WORK", 2.0 * evaluations)
    monkeypatch.setattr(integrate, "ALWAYS_ALLOWED", 0.0)


def test_a_run_that_makes_no_progress_stops(monkeypatch):
    """By the number of its evaluations; what was reached is kept, and no finer run is tried."""
    scene = replace(changed("A"), output=tribo.Output(samples=401))
    assert tribo.simulate(scene).status == "completed"
    impatient(monkeypatch)
    result = stopped("NoProgress", scene)
    assert 0.0 < result.t[-1] < scene.duration and result.met is False
    assert result.cost.force_evaluations < 1000
    assert "closest bobs" in note_of_stop(result)


def test_a_continued_run_that_stops_tells_what_its_rest_would_take(monkeypatch):
    """Evaluations since the state, for the time since the state, are its mean rate."""
    scene = replace(changed("A"), output=tribo.Output(samples=401))
    first = tribo.simulate(replace(scene, duration=5.0, output=tribo.Output(samples=51)))
    impatient(monkeypatch)
    result = stopped("NoProgress", scene, start=first.state())
    t = float(re.search("stopped at t = ([0-9.]+),", note_of_stop(result))[1])
    rest = result.cost.force_evaluations * (scene.duration - 5.0) / (t - 5.0)
    assert f"at its mean rate, the whole run would take about {rest:.2g} " in str(result)


def test_equal_steps_are_not_bounded(monkeypatch):
    """A user who gives a step decides what it costs."""
    impatient(monkeypatch)
    assert tribo.simulate(changed("A"), step=0.02).status == "completed"


def test_a_stop_does_not_depend_on_chunks(monkeypatch):
    """Trials decide when the progress is looked at, in chunks of any number of steps."""
    impatient(monkeypatch)
    layout = lay_out(changed("A"))
    run = Integrator(layout, METHODS["gauss-radau-15"], progress=lambda t: None)
    limits = np.full(2 * layout.coordinates, 1e-9), np.full(layout.accounts, 1e-9)
    tight = Setting(tolerance=Tolerance(*limits, 1e-9))
    ends = set()
    for chunk in (1, 7, 1000):
        monkeypatch.setattr(integrate, "FIRST_CHUNK", chunk)
        monkeypatch.setattr(integrate, "CHUNK_GROWTH", 1)
        done = run(tight, layout.scene.times)
        assert done.status == "NoProgress"
        ends.add((done.steps, done.evaluations, done.samples.t[-1]))
    assert len(ends) == 1


def stiff(**how):
    """A pendulum alone whose spring turns it by 2.2 radians in a step of 0.02."""
    free = tribo.Surface(
        "upper",
        bars="free",
        asperite=tribo.Asperite(kappa=1e4),
        initial=tribo.Initial(theta=0.01),
        **how,
    )
    return tribo.Scene((free,), (), 4.0, output=tribo.Output(samples=41))


def test_energy_that_runs_away_stops_a_run():
    """A step too long for the spring multiplies the energy, which no work accounts for."""
    result = stopped("EnergyRunaway", stiff(), step=0.02, method="midpoint")
    assert 0.0 < result.t[-1] < 1.0
    change = result.system["total_energy_change"]
    assert abs(change[-1]) > 1e3 * 0.5 * 1e4 * 0.01**2 > abs(change[-2])
    assert "a last step of 0.02" in note_of_stop(result)


@pytest.mark.parametrize("samples", [1, 4])
def test_runaway_of_a_run_in_portions(monkeypatch, samples):
    """It ends at the same sample, whatever the number of samples in a portion."""
    scene, how = stiff(), {"step": 0.02, "method": "midpoint"}
    whole = stopped("EnergyRunaway", scene, **how)
    monkeypatch.setattr(sinks, "PORTION_BYTES", 0)
    monkeypatch.setattr(integrate, "portion_size", lambda layout: samples)
    keep = ("total_energy_change", "upper.omega")
    result = stopped(
        "EnergyRunaway", replace(scene, output=replace(scene.output, keep=keep)), **how
    )
    assert np.array_equal(result.t, whole.t)
    assert np.array_equal(result["upper"].omega, whole["upper"].omega)
    assert np.array_equal(result.system[keep[0]], whole.system[keep[0]])
    assert "a last step of 0.02" in note_of_stop(result)


def test_portions_know_the_works_before(monkeypatch):
    """The largest work and energy so far are handed from portion to portion."""
    known = []

    def first_lost(layout, samples, system, before):
        known.append(before)
        return None, before + 1.0

    monkeypatch.setattr(sinks, "first_lost", first_lost)
    monkeypatch.setattr(sinks, "PORTION_BYTES", 0)
    output = tribo.Output(samples=4, keep=("total_energy_change",))
    scene = replace(stiff(), duration=0.06, output=output)
    tribo.simulate(scene, step=0.02, method="midpoint")
    assert known == [0.0, 1.0, 2.0, 3.0]


def test_inaccurate_energy_is_no_runaway():
    """A long step alone does not stop a run."""
    scene = replace(changed("A"), output=tribo.Output(samples=41))
    result = tribo.simulate(scene, step=0.2, method="midpoint")
    system = result.system
    error = np.max(np.abs(system["total_energy_change"] - system["applied_work"]))
    assert result.status == "completed" and error > 1e-4


def test_energy_of_a_field_is_no_runaway(monkeypatch):
    """A point at rest where a field has no energy has none; the field then accelerates it."""
    point = tribo.Surface(
        "point",
        bob=(0.25, 0.0),
        drive=tribo.Free(),
        asperite=tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf),
        langevin=tribo.Langevin(1e-9),
    )
    field = tribo.Field(tribo.Corrugation(0.01, 1.0), on=["point"])
    scene = tribo.Scene([point], [], 4.0, fields=[field], output=tribo.Output(samples=41))
    result = tribo.simulate(scene, step=0.05, method="verlet")
    assert result.status == "completed"
    assert result["point"].delta_k_trans[-1, 0] > 1e-3
    monkeypatch.setattr(sinks, "PORTION_BYTES", 0)
    output = replace(scene.output, keep=("point.delta_k_trans",))
    again = tribo.simulate(replace(scene, output=output), step=0.05, method="verlet")
    assert again.status == "completed"
    assert np.array_equal(again["point"].delta_k_trans, result["point"].delta_k_trans)


def test_a_bar_that_starts_beyond_the_other_surface_has_not_passed():
    """Only what was above the other surface at the start can pass through it."""
    upper = tribo.Surface("upper", bob=(0.0, -5.0), drive=tribo.Free(load=0.1))
    lower = tribo.Surface("lower", facing="up", drive="bars")
    layout = lay_out(tribo.Scene([upper, lower], tribo.Gaussian(0.2, 0.5), 1.0))
    assert not guards._beyond(layout, Samples.at_zero(layout), 0, 1).any()


@pytest.mark.parametrize(
    ("drive", "bodies"), [("free", 3), (tribo.Free(load=0.1, block=True), 1)], ids=["each", "block"]
)
def test_energy_that_a_reservoir_exchanges(drive, bodies):
    """Along each axis T / 2 at the start and T gamma / m a time; a block is one body.

    With gamma of each bar and three bars, a block has three times the friction and the mass.
    """
    gamma, temperature, mass, duration = 0.5, 0.3, 2.0, 7.0
    row = tribo.Surface(
        "row",
        shape=(3, 1),
        spacing=(1.0, 0.0),
        asperite=tribo.Asperite(kappa=np.inf, m1=0.5 * mass, m2=0.5 * mass),
        drive=drive,
        langevin=tribo.Langevin(gamma=gamma, temperature=temperature),
    )
    each = 2.0 * temperature * (0.5 + gamma / mass * duration)
    exchanged = guards._exchanged(lay_out(tribo.Scene([row], [], duration)))
    assert exchanged == pytest.approx(bodies * each)
