"""Accuracies of everything and of observables, by any method; and their refusal."""

import re
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.hard_scenes import simulate
from support.sliding import long_slide
from tribo import atlas, paper
from tribo.accuracy import choose_method, comparison, cost_model, levels, plan, search
from tribo.accuracy.comparison import (
    DIVERGED,
    LARGE_GROWTH,
    LARGE_PERTURBATIONS,
    PERTURBATION,
    TINY_PERTURBATION,
    error_bounds,
    measure_amplification,
)
from tribo.accuracy.search_runs import MOST_STOPS, PARTS, StopTimes
from tribo.integrators.methods import METHODS
from tribo.kernels.status import COUNTS, EVALUATIONS, STEPS
from tribo.layout.layout import lay_out
from tribo.loops.integrate import Integration
from tribo.loops.setting import Setting
from tribo.potentials.cutoff import AT_CUTOFF
from tribo.results.notes import budget_notes

FEW = tribo.Output(samples=9)


def case(letter: str) -> tribo.Scene:
    """A case of the paper, recorded at a few times."""
    return replace(paper.scene(letter), output=FEW)


def test_accuracy_of_observables():
    """Named quantities keep their accuracy, and their estimates have these names."""
    scene = case("C")
    wanted = {"upper.W": 1e-4, "lower.w1": 1e-3}
    result = tribo.simulate(scene, accuracy=wanted, method="dop853")
    whole = tribo.simulate(scene, accuracy=1e-10)
    assert result.met
    assert result.error_estimate["upper.W"] <= 1e-4
    off = np.max(np.abs(result["upper"]["W"] - whole["upper"]["W"]))
    assert off <= result.error_estimate["upper.W"] + whole.error_estimate["W"]


def test_accuracy_of_observables_in_a_file(tmp_path):
    """A table in the scene file, kept when it is saved."""
    scene = replace(case("A"), numerics=tribo.Numerics(accuracy={"upper.W": 1e-3}))
    scene.save(tmp_path / "scene.toml")
    again = tribo.load_scene(tmp_path / "scene.toml")
    assert again.numerics.accuracy == {"upper.W": 1e-3}
    assert tribo.simulate(again).met


@pytest.mark.parametrize(("status", "least"), [("BobsCoincide", 1.0), ("completed", 0.0)])
def test_a_changed_start_that_stops_is_far_off(status, least):
    """Where a run goes on and that from a changed start stops, the change has grown to a scale."""
    simulation = tribo.prepare(case("A"), accuracy=1e-6)
    layout, setting = simulation.layout, simulation.plan.setting
    run = simulation.integrator(setting, layout.times)
    other = replace(run, status=status)
    found = measure_amplification(layout, lambda *given: other, setting, run)
    assert found == least / TINY_PERTURBATION


def test_errors_are_not_taken_for_growth():
    """Runs that differ as much after a larger change of the start do not differ by that change."""
    simulation = tribo.prepare(case("A"), method="verlet", step=1e-3)
    layout, setting = simulation.layout, simulation.plan.setting
    run = simulation.integrator(setting, layout.times)
    other = simulation.integrator(Setting(step=0.05), layout.times)
    found = measure_amplification(layout, lambda *given: other, setting, run)
    error = found * LARGE_PERTURBATIONS[0]
    assert LARGE_GROWTH * PERTURBATION < error < DIVERGED


def test_errors_of_kinked_forces_are_estimated_as_rough(monkeypatch):
    """Hertz's force has a kink where contact begins, at which steps lose their order."""
    seen = []
    estimate = comparison.estimate

    def watched(finer, coarser, rough, *more):
        seen.append(rough)
        return estimate(finer, coarser, rough, *more)

    monkeypatch.setattr(comparison, "estimate", watched)
    upper = tribo.Surface("a", bob=(-1.5, 0.6), velocity=(0.5, 0.0))
    pair = upper, tribo.Surface("b", facing="up")
    for potential in (tribo.Gaussian(0.1, 0.5), tribo.Hertz(1.0, 1.0)):
        scene = tribo.Scene(pair, potential, 5.0, output=FEW)
        tribo.simulate(scene, method="dop853", accuracy=1e-6)
    assert seen[0] is False and seen[-1] is True


def test_too_many_equal_steps():
    """They are refused before the first run, and not tried after a run that fell short."""
    long = replace(case("A"), duration=4e5)
    with pytest.raises(tribo.InputError, match=r"would take midpoint 8e\+11 steps, more"):
        tribo.prepare(long, accuracy=1e-13, method="midpoint")


def test_a_call_replaces_what_it_names():
    """The file's method stays where a call gives an accuracy or a step, and the reverse."""
    scene = replace(case("A"), numerics=tribo.Numerics(method="rk4", step=0.5))
    assert tribo.prepare(scene, step=0.4).method.name == "rk4"
    assert tribo.prepare(scene, accuracy=1e-2).method.name == "rk4"
    assert tribo.prepare(scene, method="midpoint").plan.setting.step == 0.5
    with pytest.raises(tribo.InputError, match="step: cannot go with gauss-radau-15"):
        tribo.prepare(scene, method="gauss-radau-15")


@pytest.mark.parametrize(
    ("accuracy", "says"),
    [
        ({"upper.speed": 1e-3}, "accuracy.upper.speed: is not a reported quantity"),
        ({"side.W": 1e-3}, "accuracy.side.W: is not a reported quantity"),
        ({}, "accuracy: must be a number, or a table of at least one observable"),
        ({"W": 2.0}, "accuracy.W: must be from 1e-13 to 0.1"),
    ],
)
def test_refused_accuracies(accuracy, says):
    """One sentence names the field."""
    with pytest.raises(tribo.InputError, match=says):
        tribo.simulate(case("A"), accuracy=accuracy)


@pytest.mark.parametrize("method", [m.name for m in METHODS.values() if not m.adaptive])
def test_equal_steps_keep_an_accuracy(method):
    """A method with equal steps finds the step, and its estimate is honest."""
    wanted = 1e-4 if METHODS[method].order == 2 else 1e-8
    result = tribo.simulate(case("C"), accuracy=wanted, method=method)
    truth = tribo.simulate(case("C"), accuracy=1e-12)
    assert result.met and result.method == method
    for name in ("theta", "w1", "w2", "w"):
        off = np.max(np.abs(result["upper"][name] - truth["upper"][name]))
        assert off <= result.error_estimate[name] <= wanted, name


def test_equal_steps_resolve_a_fast_oscillator():
    """Longer ones damp it in all runs alike: an error was 1.3 times its estimate."""
    (entry,) = atlas.chosen(["bath-1e4"])
    result = tribo.simulate(entry.scene(), accuracy=1e-6, method="rk4")
    assert atlas.judge(entry, result, 0.0).outcome == "completed"


def test_level_of_the_finest_run(monkeypatch):
    """It is that of the finest setting, also where the search ends before the request is met."""
    monkeypatch.setattr(search, "ROUNDS", 1)
    scene, method = case("C"), METHODS["midpoint"]
    tuned = tribo.prepare(scene, accuracy=1e-4, method=method.name).plan.tuned
    assert not tuned.met
    assert tuned.fine.step == levels.equal_step(lay_out(scene), method, tuned.level)


@pytest.mark.parametrize("samples", [2, 9, 33, 401, 2001])
@pytest.mark.parametrize("duration", [7.0, 0.3, 33.3])
def test_stops(samples, duration):
    """The coarse runs share only both ends; no two stops differ by no more than rounding."""
    times = np.linspace(0.0, duration, samples)
    stops = StopTimes.for_samples(times)
    assert np.isin(times, stops.fine).all()
    assert np.min(np.diff(stops.fine)) > 1e-10 * duration
    assert stops.fine.size >= PARTS + 1
    shared = np.intersect1d(stops.few, stops.many)
    assert np.array_equal(shared, [0.0, duration])
    assert max(stops.few.size, stops.many.size) <= MOST_STOPS + 2
    if stops.fine.size <= MOST_STOPS:
        assert np.array_equal(np.union1d(stops.few, stops.many), stops.fine)


def test_equal_steps_where_samples_and_parts_meet():
    """Times that differ by rounding are one, so that no step is as short as rounding."""
    scene = replace(case("A"), duration=7.0, output=tribo.Output(samples=401))
    result = tribo.simulate(scene, accuracy=1e-4, method="verlet")
    assert result.status == "completed" and result.met


def test_nothing_is_known_where_a_coarser_run_stopped():
    """An estimate from earlier times would say nothing about later ones."""
    simulation = tribo.prepare(case("A"), accuracy=1e-6)
    *_, few, many, fine = simulation.plan.tuned.runs
    bounds = error_bounds(simulation.layout, fine, [few, many], None, 1e-6).bounds
    assert max(bounds.values()) < np.inf
    short = replace(many, status="EncounterJumped")
    bounds = error_bounds(simulation.layout, fine, [few, short], None, 1e-6).bounds
    assert min(bounds.values()) == np.inf


def test_an_interrupt_ends_all_runs():
    """One interrupt is enough, and a result without error estimates says so."""
    runs = []
    simulation = tribo.prepare(case("A"), accuracy=1e-6)
    integrate = simulation.integrator

    def interrupted(*given, **named):
        runs.append(replace(integrate(*given, **named), status="Interrupted"))
        return runs[-1]

    simulation.integrator = interrupted
    with pytest.raises(KeyboardInterrupt) as caught:
        simulation.run()
    result = caught.value.result
    assert len(runs) == 1 and result.status == "Interrupted" and not result.met


@pytest.mark.parametrize("runs", [1, 4, 5, 6])
def test_an_interrupt_of_any_run_of_a_search_is_raised(runs):
    """Also if another round has completed, and if it ends the run that measures the growth."""
    begun = []

    def stop(t):
        begun.append(t)
        if sum(later <= earlier for earlier, later in pairwise(begun)) == runs - 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        tribo.simulate(case("C"), accuracy=1e-13, progress=stop)
    assert caught.value.result.status == "Interrupted" and not caught.value.result.met


def test_an_interrupt_in_the_search_is_raised():
    """A loop that prepares scenes ends, too."""

    def stop(t):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tribo.prepare(case("A"), accuracy=1e-6, progress=stop)


def test_equal_steps_are_for_fast_baths():
    """A slow bath needs no equal steps, whatever the number of samples."""
    for samples in (9, 401):
        for frequency, equal in ((2.0, False), (3000.0, True)):
            bath = tribo.Bath(masses=(0.01,), frequencies=(frequency,))
            scene = case("A")
            surfaces = tuple(replace(surface, bath=bath) for surface in scene.surfaces)
            scene = replace(scene, surfaces=surfaces, output=tribo.Output(samples=samples))
            best = cost_model.estimates(lay_out(scene), 1e-3)[0]
            assert best.method.adaptive != equal


def test_unreported_quantities_are_refused():
    """A quantity that a scene does not report cannot be kept to an accuracy."""
    with pytest.raises(tribo.InputError, match="is not a reported quantity"):
        tribo.simulate(case("A"), accuracy={"upper.contact_energy": 1e-3})


def test_cost_of_a_digit():
    """A digit more costs more, a digit fewer less, and the printed line says so."""
    result = tribo.simulate(case("D"), accuracy=1e-6, method="dop853")
    cost = result.cost
    assert cost.digit_fewer < cost.wall_seconds < cost.digit_more
    assert "one digit more" in str(result).splitlines()[0]
    own = tribo.simulate(case("D"), method="verlet", step=0.1)
    assert own.cost.digit_more is None and "digit" not in str(own)


def test_reason_of_a_choice():
    """The method, and its advantage over the next; no reason where a method is named."""
    result = tribo.simulate(case("A"), accuracy=1e-6)
    assert result.why.startswith(f"{result.method} should be the fastest at 1e-06")
    assert tribo.simulate(case("A"), accuracy=1e-6, method="dop853").why == ""


def test_the_model_of_costs():
    """More digits never cost less; every method has rates."""
    assert all(method.cost for method in METHODS.values() if not method.own)
    for letter in "AC":
        layout = lay_out(case(letter))
        for one, other in ((1e-3, 1e-6), (1e-6, 1e-9)):
            few = {e.method.name: e.seconds for e in cost_model.estimates(layout, one)}
            more = {e.method.name: e.seconds for e in cost_model.estimates(layout, other)}
            assert all(few[name] <= more[name] for name in few)


@pytest.mark.parametrize("at_cutoff", AT_CUTOFF)
def test_there_is_a_method_for_every_cutoff(at_cutoff):
    """Whatever its smoothness."""
    cut = tribo.Coulomb(0.2).with_cutoff(3.0, at_cutoff)
    scene = replace(case("A"), interactions=(tribo.Interaction(cut),))
    assert choose_method.cheapest(lay_out(scene), 1e-6)[0].smoothness <= max(0, cut.smoothness())


def kicked() -> tribo.Scene:
    """Rough grids in fast sliding, which amplifies round-off."""
    return replace(long_slide({}), duration=6.0, output=FEW)


def test_note_on_an_accuracy_out_of_reach():
    """The best result is delivered, with a note on the amplification of round-off."""
    with pytest.warns(tribo.TriboWarning, match="the accuracy is not met: .* out of reach"):
        result = tribo.simulate(kicked(), accuracy=1e-13, method="dop853")
    assert result.status == "completed" and result.met is False
    (note,) = (note for note in result.notes if "out of reach" in note)
    assert "a change of 1e-11 in the start grows to" in note and "round-off of 2.2e-16" in note
    (near,) = (note for note in result.notes if "bobs were closest" in note)
    assert re.search(r'closest at t = \S+: .* of "\w+" and .* of "\w+" were \S+ apart', near)


def test_out_of_reach_is_refused_early(monkeypatch):
    """If runs would be long and the scene amplifies round-off, only the pilot is run."""
    monkeypatch.setattr(search, "LONG_RUN", 0.0)
    assert tribo.simulate(case("A"), accuracy=1e-9).met
    monkeypatch.setattr(search.comparison, "measure_amplification", lambda *given: 1e8)
    with pytest.raises(tribo.InputError, match=r"accuracy: 1.0e-09 is out of reach.*observables"):
        tribo.simulate(case("A"), accuracy=1e-9)


def test_long_runs_begin_at_the_level_of_growing_errors(monkeypatch):
    """The first round is fine enough for them; where that takes too long, they are refused."""
    usual = tribo.prepare(case("A"), accuracy=1e-3, method="rkn8")
    monkeypatch.setattr(search, "LONG_RUN", 0.0)
    monkeypatch.setattr(search.comparison, "measure_amplification", lambda *given: 1e4)
    finer = tribo.prepare(case("A"), accuracy=1e-3, method="rkn8")
    level = search.AMPLIFIED * 1e-3 / 1e4
    assert finer.plan.tuned.level == pytest.approx(0.1 * level)
    assert usual.plan.tuned.level > 10.0 * finer.plan.tuned.level
    assert finer.first_result().met
    monkeypatch.setattr(search.comparison, "measure_amplification", lambda *given: 1e9)
    refusal = (
        r"accuracy: 1.0e-03 would take about 7 times the evaluations of a run without growing "
        "errors: a change of 1e-11 in the start grows to 1.0e-02 of the scale; name the observables"
    )
    with pytest.raises(tribo.InputError, match=refusal):
        tribo.prepare(case("A"), accuracy=1e-3, method="rkn8")


def test_a_long_run_gets_no_cheaper_setting(monkeypatch):
    """Runs without estimates are cheaper, unless the search for their setting would be long."""
    simulation = tribo.prepare(case("A"), accuracy=1e-9)
    fine = simulation.finest.evaluations
    assert simulation.run(estimate=False).cost.force_evaluations < 0.9 * fine
    monkeypatch.setattr(plan, "LONG_RUN", 0.0)
    simulation = tribo.prepare(case("A"), accuracy=1e-9)
    assert simulation.run(estimate=False).cost.force_evaluations == fine


def test_work_of_calculators():
    """A call of a calculator counts as much as many asperites."""
    layout = lay_out(case("A"))
    counts = np.zeros(COUNTS, int)
    counts[[STEPS, EVALUATIONS]] = 3, 7
    run = Integration(lambda: None, "completed", counts, 1.0, {})
    assert levels.work(layout, run) == 7 * 2
    assert levels.work(replace(layout, calculator_calls=(None,)), run) == 7 * (2 + levels.CALL)


class Wrong(NamedTuple):
    """A force that is half too large at short range."""

    strength: float

    def energy(self, r):
        return self.strength / r

    def force(self, r):
        return self.strength / r**2 * np.where(r < 1.0, 1.5, 1.0)


def test_a_scene_in_which_nothing_happens_keeps_its_accuracy():
    """Bobs out of the range of a shifted potential: works are zero, and a shift rounds."""
    potential = tribo.LennardJones(0.2, 0.6).with_cutoff(1.0, "shift")
    upper = tribo.Surface("upper", bob=(-1.0, 1.3), velocity=(0.5, 0.0), drive="free")
    lower = tribo.Surface("lower", facing="up", drive="free")
    for velocity in (0.5, 0.0):
        still = replace(upper, velocity=(velocity, 0.0))
        scene = tribo.Scene((still, lower), potential, 2.0, output=tribo.Output(samples=5))
        for accuracy in (0.1, 1e-6):
            result = simulate(scene, accuracy=accuracy)
            assert result.met and not any("accuracy" in note for note in result.notes)
            assert not np.any(result["upper"].w1)


OVERLAPPING = {
    "interaction": tribo.LennardJones(0.006406071580384777, 1.0),
    "upper": {"m1": 1.4786634544914772, "m2": 1.44990549790243, "kappa": 1550.9891460308834},
    "lower": {"m1": 0.6313668957813385, "m2": 0.9115466637006286, "kappa": 0.15819376254298434},
}


def test_bobs_that_overlap_keep_a_coarse_accuracy():
    """A change of the start grows by 3e11, yet all runs agree: no bound is twice its scale."""
    upper, lower = (tribo.Asperite(**OVERLAPPING[name]) for name in ("upper", "lower"))
    bob, velocity = (-0.09212501886705385, 0.34312627094102616), (0.011598396786589138, 0.0)
    surfaces = (
        tribo.Surface("upper", bob=bob, velocity=velocity, asperite=upper),
        tribo.Surface("lower", facing="up", asperite=lower),
    )
    output = tribo.Output(samples=2)
    scene = tribo.Scene(surfaces, OVERLAPPING["interaction"], 2.659246744241509, output=output)
    coarse, fine = (simulate(scene, accuracy=accuracy) for accuracy in (0.1, 1e-4))
    assert coarse.met
    for name in ("theta", "w1", "contact_energy", "delta_E_int"):
        pairs = zip(coarse.ledger.series(name), fine.ledger.series(name), strict=True)
        apart = max(float(np.max(np.abs(one - other))) for one, other in pairs)
        assert apart <= coarse.error_estimate[name]
    assert coarse.error_estimate["contact_energy"] < 0.1 * 1.06e4


def test_long_rods_are_no_scale_of_places():
    """Kepler's motion of two rigid asperites, e = 0.9 and axis 1, with rods of 500 [length]."""
    strength, mass, eccentricity = 1.0, 1.5, 0.9
    speed = np.sqrt(strength / mass * (1.0 - eccentricity) / (1.0 + eccentricity))
    period = 2.0 * np.pi * np.sqrt(mass / strength)
    own = {"drive": tribo.Free(load=0.0), "asperite": tribo.Asperite(kappa=np.inf, length=500.0)}
    apart = 1.0 + eccentricity
    surfaces = (
        tribo.Surface("upper", bob=(apart, 0.0), velocity=(0.0, 0.5 * speed), **own),
        tribo.Surface("lower", facing="up", velocity=(0.0, -0.5 * speed), **own),
    )
    output = tribo.Output(samples=41)
    scene = tribo.Scene(surfaces, tribo.Coulomb(-strength), period, output=output)
    result = simulate(scene, accuracy=1e-8)
    mean = np.pi + 2.0 * np.pi * result.t / period
    anomaly = mean
    for _ in range(60):
        off = anomaly - eccentricity * np.sin(anomaly) - mean
        anomaly = anomaly - off / (1.0 - eccentricity * np.cos(anomaly))
    distance = result["upper"].x_bob[:, 0] - result["lower"].x_bob[:, 0]
    error = np.max(np.abs(distance - (eccentricity - np.cos(anomaly))))
    assert result.met
    # With rods as the scale, the bound was 5e-9.
    assert error <= 2.0 * result.error_estimate["x_bob"] < 0.1 * 1e-8 * apart


def test_an_energy_budget_that_stays_open():
    """With a user's force that is not conservative the accuracy is not met, and a note says why."""
    scene = replace(case("A"), interactions=Wrong(0.2))
    with pytest.warns(tribo.TriboWarning, match="the energy budget does not close: .* of Wrong is"):
        result = tribo.simulate(scene, accuracy=1e-6, method="verlet")
    assert result.status == "completed" and result.met is False
    ledger, bounds = result.ledger, result.error_estimate
    gap = np.max(np.abs(ledger.system["total_energy_change"] - ledger.system["applied_work"]))
    assert gap > 1e-3
    layout = lay_out(scene)
    (note,) = budget_notes(layout, ledger, bounds)
    assert f"differ by {gap:.1e}" in note
    wide = bounds | {"applied_work": 1.01 * gap}
    assert budget_notes(layout, ledger, wide) == ()
    assert budget_notes(lay_out(case("A")), ledger, bounds) == ()
