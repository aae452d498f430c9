"""An explanation says what a run does, and predicts what it takes."""

import json
import math
import re
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.command import main
from tribo import explanation, paper
from tribo.accuracy import choose_method, cost_model
from tribo.explanation import prediction
from tribo.integrators.methods import METHODS
from tribo.layout.layout import lay_out
from tribo.loops import integrate
from tribo.model.effects import EFFECTS, Effect, reason_for
from tribo.potentials import expression

ROW = {"shape": (3, 1), "spacing": (1.1, 0.0)}
OSCILLATORS = tribo.Bath(masses=np.full(5, 0.1), frequencies=np.linspace(1.0, 3.0, 5))
STEPPED = tribo.Numerics(method="verlet", step=0.01)


PLUGIN = """
from typing import NamedTuple

class Push(NamedTuple):
    g: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return self.g - fx, -fy

    def end_forces(self, t, phi, nu, twist):
        return 0.0, self.g, 0.0, -self.g
"""


def two_rows(upper=(), lower=(), **scene):
    """Two rows of three with Coulomb contact; the upper one slides over the lower one."""
    above = {"bob": (-1.0, 0.6), "velocity": (0.5, 0.0)} | ROW | dict(upper)
    below = {"facing": "up"} | ROW | dict(lower)
    surfaces = (tribo.Surface("upper", **above), tribo.Surface("lower", **below))
    scene = {"duration": 2.0, "output": tribo.Output(samples=5)} | scene
    return tribo.Scene(surfaces, scene.pop("interactions", tribo.Coulomb(0.05)), **scene)


KNOWN = {
    "forced": (two_rows(), {"swings": 6}),
    "free": (two_rows({"drive": "free"}), {"swings": 6, "x": 3}),
    "loaded": (two_rows({"drive": tribo.Forced(load=0.1)}), {"swings": 6, "y": 3}),
    "pulled and loaded": (
        two_rows({"drive": tribo.Pulled(load=0.1, stiffness=1.0, speed=0.1)}),
        {"swings": 6, "x": 3, "y": 3},
    ),
    "bars": (two_rows({"bars": "free"}, {"bars": "free"}), {"swings": 6, "bars": 6}),
    "springs": (two_rows({"springs": {"stiffness": 1.0}}), {"swings": 6, "x": 3, "y": 3}),
    "bath": (two_rows({"bath": OSCILLATORS}), {"swings": 6, "x": 3, "y": 3, "baths": 30}),
    "langevin": (
        two_rows(lower={"langevin": {"gamma": 0.1}}),
        {"swings": 6, "x": 3, "y": 3},
    ),
    "field": (
        two_rows(fields=tribo.Field(tribo.Corrugation(0.1, 1.0), on=("upper",))),
        {"swings": 6, "x": 3, "y": 3},
    ),
    "torsional bath": (
        two_rows(
            {
                "bars": "free",
                "bath": tribo.Bath(inertias=np.ones(2), torsional_frequencies=np.ones(2)),
            }
        ),
        {"swings": 6, "bars": 3, "baths": 6},
    ),
}


@pytest.mark.parametrize("name", KNOWN)
def test_degrees_of_freedom(name):
    """They are those of the model's equations, and those that the layout gives slots to."""
    scene, known = KNOWN[name]
    scene = replace(scene, numerics=STEPPED)
    layout = lay_out(scene)
    found = explanation.coordinates(layout)
    assert {kind: n for kind, n in found.items() if n} == known
    assert sum(found.values()) == layout.coordinates


CONSTRAINED = (
    ({"drive": "bars"}, {"drive": "bars", "bars": "free"}, {"swings": 6, "bars": 3}),
    ({"drive": "bars", "bath": OSCILLATORS}, {}, {"swings": 6, "baths": 30}),
    ({"asperite": tribo.Asperite(kappa=np.inf), "drive": "free"}, {}, {"swings": 3, "x": 3}),
    ({"drive": tribo.Free(rigid=True)}, {}, {"swings": 6, "x": 1}),
    ({"drive": tribo.Free(block=True)}, {}, {"swings": 6, "x": 1, "y": 1}),
    (
        {"drive": tribo.Pulled(stiffness=1.0, load=1.0, block=True, tilt="free")},
        {},
        {"swings": 6, "x": 1, "y": 1, "bars": 1},
    ),
)


@pytest.mark.parametrize(("upper", "lower", "known"), CONSTRAINED)
def test_constraints_take_degrees_of_freedom(upper, lower, known):
    """Centres of mass on driven bars follow from the swing, and rigid asperites have none."""
    found = explanation.coordinates(lay_out(two_rows(upper, lower)))
    assert {kind: n for kind, n in found.items() if n} == known


def test_reasons_of_constraints():
    """The keys that call for them; driven bars do not slide."""
    rigid = tribo.Asperite(kappa=np.inf)
    damped = {"drive": "bars", "langevin": {"gamma": 0.2, "on": "swing"}}
    scene = two_rows(damped, {"drive": "bars", "asperite": rigid})
    assert reason_for(scene, Effect.DRIVEN_BARS).startswith('surface[0].drive = "bars"')
    assert reason_for(scene, Effect.RIGID) == "surface[1].asperite.kappa = inf"
    assert reason_for(scene, Effect.SWING) == "surface[0].asperite.kappa is finite"
    assert reason_for(scene, Effect.SWING_LANGEVIN) == "surface[0].langevin.gamma = 0.2"
    assert Effect.SLIDING not in scene.effects and Effect.LANGEVIN not in scene.effects


def test_reservoirs_of_a_list_are_named_by_their_place_in_it():
    """The reason for each of two reservoirs names its own table; scenes keep the bars' first."""
    tables = [{"gamma": 0.3, "on": "swing"}, {"gamma": 0.1, "on": "bar"}]
    scene = two_rows({"langevin": tables})
    swing = Effect.SWING_LANGEVIN
    bar = Effect.LANGEVIN
    assert reason_for(scene, swing) == "surface[0].langevin[1].gamma = 0.3"
    assert reason_for(scene, bar) == "surface[0].langevin[0].gamma = 0.1"


def full_scene(tmp_path):
    """A scene that calls for every effect but a calculator."""
    path = tmp_path / "push.py"
    path.write_text(PLUGIN, encoding="utf-8")
    (tmp_path / "full.toml").write_text(FULL, encoding="utf-8")
    return tribo.load_scene(tmp_path / "full.toml")


FULL = """
duration = 1.0
periodic = {x = 20.0}
interaction = [
    {potential = "lennard-jones", epsilon = 0.1, sigma = 0.5, cutoff = 2.0},
    {between = ["a", "a"], potential = "morse", D = 0.1, alpha = 2.0, r0 = 0.5, cutoff = 2.0},
]
field = [{on = ["a"], kind = "corrugation", amplitude = 0.1, period = 1.0}]

[[surface]]
name = "a"
shape = [2, 1]
spacing = [2.0, 0.0]
bob = [0.0, 1.0]
drive = {kind = "push.py:Push", g = 0.1}
springs = {stiffness = 2.0}
langevin = {gamma = 0.2}

[[surface]]
name = "b"
facing = "up"
drive = {kind = "pulled", stiffness = 1.5, speed = 0.1, load = 0.2}
bars = "free"
bath = {oscillators = [{mass = 0.1, frequency = 2}], torsional = [{inertia = 0.1, frequency = 2}]}

[[surface]]
name = "c"
bob = [5.0, 9.0]
bars = {ends = "push.py:Push", g = 0.1}
"""

# What the reason for each effect of this scene names.
NAMED = {
    "contact": 'interaction[0].potential = "lennard-jones"',
    "swing": "every asperite",
    "sliding": "surface[0].drive",
    "turning bars": 'surface[1].bars = "free"',
    "clamped ends": 'surface[0].bars = "clamped"',
    "pull": "surface[1].drive.stiffness = 1.5",
    "load": "surface[1].drive.load = 0.2",
    "own drive": "surface[0].drive = Push",
    "own ends": "surface[2].bars = Push",
    "springs": "surface[0].springs.stiffness = 2.0",
    "bath": "surface[1].bath = 1 point oscillator",
    "torsional bath": "surface[1].bath = 1 torsional oscillator",
    "langevin": "surface[0].langevin.gamma = 0.2",
    "field": "field[0].kind = Corrugation",
    "contact within": 'interaction[1].potential = "morse"',
    "cutoff": "interaction[0] ends at 2",
    "periodic": "periodic.x = 20",
}


def test_reasons(tmp_path):
    """Every effect has a reason that names its key; every absent one says what is missing."""
    scene = full_scene(tmp_path)
    assert set(NAMED) == scene.effects
    for effect in Effect:
        if effect in scene.effects:
            assert NAMED[effect] in reason_for(scene, effect), effect
        assert EFFECTS[effect][0]
    rigid = two_rows({"drive": "free"}, {"drive": "free"})
    assert reason_for(rigid, Effect.SLIDING).count("surface[") == 2


def within_a_factor_of_two(predicted, taken):
    """Whether a prediction is near."""
    return 0.5 <= predicted / taken <= 2.0


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
@pytest.mark.parametrize("name", ["A", "D", "rows"])
def test_predicted_evaluations(name, accuracy):
    """Predictions are within a factor of two of the run, of one asperite on one and of rows."""
    scene = two_rows() if name == "rows" else paper.scene(name)
    scene = replace(scene, numerics=tribo.Numerics(accuracy=accuracy))
    explained = tribo.explain(scene)
    result = tribo.simulate(scene)
    assert explained.method == result.method and explained.why == result.why
    assert within_a_factor_of_two(
        explained.predicted.force_evaluations, result.cost.force_evaluations
    )
    assert explained.predicted.basis == "searched" and explained.step is None
    assert explained.predicted.met is result.met


@pytest.mark.parametrize("method", ["verlet", "midpoint", "kahan-li-6"])
def test_a_given_step_is_counted(method):
    """With a step, no run is needed, and the evaluations are exact."""
    numerics = tribo.Numerics(method=method, step=0.03)
    scene = replace(two_rows(), numerics=numerics)
    explained = tribo.explain(scene)
    assert explained.predicted.basis == "counted" and explained.evaluations_used == 0
    assert explained.step == 0.03
    taken = tribo.simulate(scene).cost.force_evaluations
    assert explained.predicted.force_evaluations == taken


@pytest.mark.parametrize("part", [0.05, 0.3, 0.8])
def test_a_long_search_is_extrapolated(monkeypatch, part):
    """Of a search that exceeds its budget, the rest is predicted from its beginning."""
    still = {"velocity": (0.0, 0.0), "initial": tribo.Initial(swing=0.5)}
    scene = two_rows(still, duration=60.0, numerics=tribo.Numerics(accuracy=1e-6))
    taken = tribo.simulate(scene).cost.force_evaluations
    layout = lay_out(scene)
    method = tribo.prepare(scene).method
    budget = 1e-9 * part * taken * cost_model.evaluation_time(layout, method)
    monkeypatch.setattr(prediction, "BUDGET", budget)
    monkeypatch.setattr(integrate, "FEWEST_TRIALS", 1)  # after which a run is looked at
    explained = tribo.explain(scene)
    assert explained.predicted.basis == "extrapolated"
    assert explained.evaluations_used < min(1.0, 2.0 * part) * taken
    assert within_a_factor_of_two(explained.predicted.force_evaluations, taken)


def test_a_long_run_of_a_pair_is_ended(monkeypatch):
    """The loop for pairs stops within the budget too, at the same step every time."""
    monkeypatch.setattr(prediction, "BUDGET", 0.01)
    monkeypatch.setattr(integrate, "TRIALS", 2**12)
    scene = replace(paper.scene("A"), duration=1e5, output=tribo.Output(samples=2))
    one = tribo.explain(scene)
    other = tribo.explain(scene)
    assert one.predicted.basis == "extrapolated"
    assert one.evaluations_used == other.evaluations_used < 1e6


def test_a_run_without_progress():
    """Is announced with a duration that does; the note of the run says the same."""
    most = tribo.Numerics(max_evaluations=1e6)
    scene = replace(paper.scene("A"), duration=1e6, numerics=most, output=tribo.Output(samples=2))
    found = tribo.explain(scene).predicted
    assert "may take 1e+06" in found.stop and "shorter duration" in found.stop
    with pytest.warns(tribo.TriboWarning, match="NoProgress"):
        result = tribo.simulate(scene)
    part, _ = found.stop.split(";")
    assert result.notes[1] == f"at its mean rate, {part}"
    reach = float(part.rpartition("t = ")[2])
    assert result.t[-1] < reach < 0.3 * scene.duration
    shorter = replace(scene, duration=0.25 * reach)
    assert tribo.explain(shorter).predicted.stop == ""
    assert tribo.simulate(shorter).status == "completed"


MORSE = tribo.Morse(1e6, 2.0, 1.0).with_cutoff(2.0)
STIFF = tribo.Asperite(kappa=1e8)
# What makes a scene slow -> the scene, and its angular frequency [rad / time].  A bob of mass 1 and
# a bar of mass 2 at a distance of 2 turn with an inertia of 8/3.
FASTEST = {
    "pendulums": (two_rows({"asperite": STIFF}), math.sqrt(1e8 / (8 / 3))),
    "springs": (two_rows({"drive": tribo.Pulled(stiffness=1e8, speed=0.1)}), math.sqrt(1e8 / 2)),
    "bath": (two_rows({"bath": tribo.Bath(masses=[0.1], frequencies=[1e4])}), 1e4),
    "field": (
        two_rows(fields=tribo.Field(tribo.Corrugation(1e6, 0.1), on=("upper",))),
        2.0 * math.pi / 0.1 * math.sqrt(1e6),
    ),
    "contact": (two_rows(interactions=MORSE), math.sqrt(2 * 2 * 1e6 * 2.0**2)),
    "encounters": (two_rows({"velocity": (1e6, 0.0)}), None),
}


@pytest.mark.parametrize("name", FASTEST)
def test_the_fastest_motion(name):
    """The one that was made fast, with its frequency where that has a closed form."""
    scene, known = FASTEST[name]
    layout = lay_out(replace(scene, numerics=STEPPED))
    found = {each: frequency(layout) for each, (frequency, _) in prediction.MOTIONS.items()}
    fastest = max(found, key=found.__getitem__)
    assert name in fastest
    assert known is None or found[fastest] == pytest.approx(known, rel=0.01)


def test_what_makes_a_run_slow(monkeypatch):
    """A step that is shorter than the motion needs, or else the motion; not in a short run."""
    monkeypatch.setattr(prediction, "_measured", lambda *given: 1e-3)
    stiff = {"asperite": tribo.Asperite(kappa=1e4)}
    for rows, step, words in (
        ({}, 1e-3, "resolves it"),
        (stiff, 0.01, "a smaller kappa or a larger inertia would allow longer steps"),
    ):
        numerics = tribo.Numerics(method="verlet", step=step)
        scene = two_rows(rows, rows, duration=1e5, numerics=numerics)
        found = tribo.explain(scene)
        assert "that of pendulums" in found.slow and found.slow.endswith(words)
        assert "Slow: the fastest motion" in str(found)
        assert tribo.explain(replace(scene, duration=1.0)).slow == ""


@pytest.mark.parametrize("series", [(), ("forces",)])
def test_memory_is_most_of_what_numpy_allocates(series):
    """The arrays of the loop, the samples and all series; not what computing these takes."""
    row = {"shape": (80, 1)}
    output = tribo.Output(samples=401, series=series)
    scene = two_rows(row, row, output=output, numerics=STEPPED)
    predicted = tribo.explain(scene).predicted.memory_bytes
    few = replace(scene, output=replace(output, samples=101))
    assert tribo.simulate(few).ledger.flat()  # loads and compiles all that it needs
    tracemalloc.start()
    try:
        result = tribo.simulate(scene)
        assert result.ledger.flat()["upper.theta"].shape == (401, 80)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert 0.55 < predicted / peak < 1.1


def test_a_method_that_is_as_fast(monkeypatch):
    """Is said to take hardly longer, not 1 times as long."""
    for seconds, words in ((1.04, "take hardly longer"), (2.04, "take 2 times as long")):
        found = [
            cost_model.Estimate(METHODS[name], 1.0, time)
            for name, time in (("rkn8", 1.0), ("dop853", seconds))
        ]
        monkeypatch.setattr(choose_method, "estimates", lambda *given, found=found: found)
        _, why = choose_method.cheapest(lay_out(two_rows()), 1e-8)
        assert why == f"rkn8 should be the fastest at 1e-08; dop853, the next, should {words}"


def test_contact():
    """All pairs where they are few, lists where they are many."""
    few = tribo.explain(replace(two_rows(), numerics=STEPPED)).contact
    assert (few.pairs, few.by_list, few.arithmetic, few.scalar) == (9, False, "lanes", ())
    grid = {"shape": (9, 9), "spacing": (1.5, 1.5)}
    jones = tribo.LennardJones(0.1, 1.0).with_cutoff(2.5)
    many = two_rows(grid, grid, interactions=jones)
    pairs, by_list = cost_model.pairs_of_bobs(lay_out(many))
    assert by_list and pairs < 81 * 81


def test_formulas_that_do_not_compile_for_lanes():
    """A formula with a sine is computed pair after pair, one of exponentials in lanes."""
    waves = expression("a * sin(r)", a=0.1)
    for contact, scalar in ((tribo.Morse(1.0, 2.0, 1.0), ()), (waves, (type(waves).__name__,))):
        scene = replace(two_rows(interactions=contact), numerics=STEPPED)
        assert explanation.contact(lay_out(scene), METHODS["verlet"]).scalar == scalar


def test_the_formula_within_a_cutoff_is_named():
    """The class of a cutoff is none that its user wrote."""
    waves = expression("a * sin(r)", a=0.1)
    contact = 2.0 * waves.with_cutoff(2.5) + tribo.Morse(1.0, 2.0, 1.0)
    scene = replace(two_rows(interactions=contact), numerics=STEPPED)
    found = explanation.contact(lay_out(scene), METHODS["verlet"])
    assert found.scalar == (type(waves).__name__,)


def test_seconds_are_evaluations_times_their_time(monkeypatch):
    """Of a short run with a given step."""
    monkeypatch.setattr(prediction, "_measured", lambda *given: 1e-3)
    stepped = tribo.explain(replace(two_rows(), numerics=STEPPED)).predicted
    assert stepped.seconds == pytest.approx(1e-3 * stepped.force_evaluations)


@pytest.mark.parametrize("samples", [11, 20_001])
def test_the_time_of_series_is_predicted_where_memory_does_not_hold_them(monkeypatch, samples):
    """It was left out: ten times too little for surfaces of 1,832 asperites."""
    monkeypatch.setattr(prediction, "_recording_time", lambda layout, method: 1.0)
    row = {"shape": (50, 1), "spacing": (1.1, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 1.2), velocity=(0.5, 0.0), **row)
    output = tribo.Output(samples=samples, keep=["upper.W"])
    lower = tribo.Surface("lower", facing="up", **row)
    scene = tribo.Scene((upper, lower), (), 1.0, output=output, numerics=STEPPED)
    found = tribo.explain(scene).predicted.seconds
    assert found > samples if samples > 11 else found < 1.0


def test_seconds_of_recording_are_measured():
    """Of one sample, in a small part of a run; no number, as those depend on the machine."""
    layout = lay_out(paper.scene("A"))
    assert 0.0 < prediction._recording_time(layout, METHODS["verlet"]) < 0.1


def test_command(tmp_path, capsys):
    """The JSON has the keys of the contract; the text fits a screen."""
    path = tmp_path / "scene.toml"
    replace(two_rows(), numerics=STEPPED).save(path)
    assert main(["explain", str(path), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["effects"] == ["contact", "swing", "clamped ends"]
    assert set(table["effects"]) | set(table["absent"]) == set(Effect)
    assert table["degrees_of_freedom"] == 6
    assert table["threads"] == {"number": 1, "why": "since a step is too short to be shared"}
    assert (table["method"], table["step"]) == ("verlet", 0.01)
    assert table["predicted"]["force_evaluations"] == 200
    assert table["predicted"]["seconds"] > 0.0 and table["predicted"]["memory_bytes"] > 0
    assert table["compiled"] is True  # by the tests before, or the explanation before
    assert main(["explain", str(path)]) == 0
    *lines, after = capsys.readouterr().out.splitlines()
    assert after.startswith(f"Next:  tribo run {path} ")
    assert len(lines) <= len(Effect) + 15 and max(map(len, lines)) <= 100
    assert "Degrees of freedom: 6 (6 swings)." in lines
    assert "Threads: 1, since a step is too short to be shared." in lines


def test_reason_of_the_method():
    """A method is chosen, named, or what its scene needs."""
    noisy = two_rows({"langevin": {"gamma": 0.1, "temperature": 1.0}})
    stepped = replace(two_rows(), numerics=tribo.Numerics(step=0.01))
    named = replace(two_rows(), numerics=STEPPED)
    for scene, why in (
        (two_rows(), "chosen because"),
        (named, "which the scene names"),
        (noisy, "which integrates thermal noise"),
        (stepped, "which is the default with a step"),
    ):
        (line,) = re.findall(r"^Method: .*\n", str(tribo.explain(scene)), re.MULTILINE)
        assert f", {why}" in line


def test_steps_that_samples_shorten():
    """The step that is taken is named beside the given one, as in a note of the run."""
    for samples, word in ((3, ""), (31, ", shortened to 0.01667 to fit between samples")):
        scene = replace(
            two_rows(duration=0.5 if samples == 31 else 1.0),
            numerics=tribo.Numerics(method="verlet", step=0.02 if samples == 31 else 0.1),
            output=tribo.Output(samples=samples),
        )
        text = " ".join(str(tribo.explain(scene)).split())
        step = scene.numerics.step
        assert f"verlet, steps of {step:g}{word}, which the scene names" in text


def test_wrong_input():
    """What cannot be run cannot be explained, and the message is that of a run."""
    with pytest.raises(tribo.InputError, match=r"scene: must be a tribo\.Scene"):
        tribo.explain("scene.toml")
    numerics = tribo.Numerics(method="kahan-li-6", step=0.1)
    noisy = two_rows({"langevin": {"gamma": 0.1, "temperature": 1.0}}, numerics=numerics)
    with pytest.raises(tribo.InputError, match=r"numerics\.method"):
        tribo.explain(noisy)


def test_a_scene_that_ends_where_it_starts():
    """Bobs at one place: no evaluation is made, and the text says so."""
    pendulums = (tribo.Surface("one"), tribo.Surface("other", facing="up"))
    found = tribo.explain(tribo.Scene(pendulums, tribo.Coulomb(0.2), 1.0))
    assert found.predicted.force_evaluations == 0 and found.predicted.seconds == 0.0
    text = " ".join(str(found).split())
    assert "will stop as BobsCoincide: it ends where it starts, at t = 0; change the start." in text
