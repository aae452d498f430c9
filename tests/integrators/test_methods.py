"""Every method alike: what it agrees with, how it stops, that it does not mind pauses."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tribo
import tribo.loops.integrate
from support.hard_scenes import Well, broken, changed, side_by_side, simulate, stopped
from tribo import (
    Asperite,
    Bath,
    Coulomb,
    Forced,
    Free,
    Initial,
    InputError,
    Langevin,
    Output,
    Scene,
    Surface,
)
from tribo.accuracy.scales import COMMON, reported_scales
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.layout.layout import lay_out
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting
from tribo.paper import scene as case

ADAPTIVE = [m.name for m in METHODS.values() if m.adaptive]
# Steps of the others, and the errors that go with them on the paper's cases.
STEPS = {
    "midpoint": (0.02, 1e-3),
    "rk4": (0.02, 1e-7),
    "verlet": (0.02, 1e-4),
    "kahan-li-6": (0.05, 1e-8),
    "kahan-li-8": (0.1, 1e-10),
    "blanes-moan-6": (0.05, 1e-9),
    "gauss-8": (0.1, 1e-11),
}
SYMMETRIC = ("verlet", "kahan-li-6", "kahan-li-8", "blanes-moan-6", "gauss-8")


def how(name, accuracy=1e-9):
    """Arguments with which a method is run."""
    if METHODS[name].adaptive:
        return {"method": name, "accuracy": accuracy}
    return {"method": name, "step": STEPS[name][0]}


def largest_error(result, truth):
    """Over all quantities, in units of the scales of their kinds."""
    layout = lay_out(truth.scene)
    scales = reported_scales(layout, truth.ledger)
    return max(
        np.max(np.abs(one - other)) / scales.of(name)
        for name in COMMON
        for one, other in zip(result.ledger.series(name), truth.ledger.series(name), strict=True)
        if scales.of(name) > 0.0
    )


def test_every_method_is_here():
    """A new one chooses its steps, or is given one."""
    assert {*ADAPTIVE, *STEPS} == METHODS.keys()


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("letter", "AC")
def test_agrees_with_dop853(letter, name):
    """On the paper's cases, every quantity of the ledger."""
    scene = replace(case(letter), output=Output(samples=9))
    truth = tribo.simulate(scene, accuracy=1e-13)
    result = simulate(scene, **how(name))
    assert result.status == "completed"
    assert largest_error(result, truth) < (1e-9 if METHODS[name].adaptive else STEPS[name][1])
    if METHODS[name].adaptive:
        assert result.met
        for quantity, bar in result.error_estimate.items():
            pairs = zip(result.ledger.series(quantity), truth.ledger.series(quantity), strict=True)
            assert max(np.max(np.abs(one - other)) for one, other in pairs) <= bar, quantity


@pytest.mark.parametrize("name", ADAPTIVE)
def test_no_encounter_is_jumped(name):
    """A short and deep well that is passed after a long way through nothing."""
    scene = changed("A", 40.0, Well(50.0, 20.0, 0.3), gap=0.25)
    result = simulate(scene, method=name, accuracy=1e-8)
    assert result.status == "completed" and result.met
    assert result["upper"].delta_e_int[-1, 0] == pytest.approx(2.06392267, abs=1e-7)


@pytest.mark.parametrize("name", ADAPTIVE)
def test_weak_coupling_is_followed(name):
    """Works of 1e-8 have their digits: the controller looks at the powers as well."""
    scene = changed("A", 40.0, Coulomb(1e-8), gap=0.3)
    truth = simulate(scene, accuracy=1e-12)["upper"]
    rough = simulate(scene, method=name, accuracy=1e-6)["upper"]
    scale = max(np.max(np.abs(truth[w])) for w in ("w1", "w2", "w", "delta_e_int"))
    for quantity in ("w1", "w2", "w1_ps", "w2_ps", "w", "delta_e_int"):
        assert np.max(np.abs(rough[quantity] - truth[quantity])) <= 1e-6 * scale, quantity


@pytest.mark.parametrize("name", ADAPTIVE)
def test_accounts_are_looked_at(name):
    """Less error wanted in the accounts alone, and steps are shorter."""
    layout = lay_out(changed("A", 40.0))
    integrate = Integrator(layout, METHODS[name])
    steps = []
    for wanted in (1e-4, 1e-12):
        y = np.full(layout.start.size, 1e-4)
        s = np.full(layout.accounts, wanted)
        run = integrate(Setting(tolerance=Tolerance(y, s, 1e-4)), np.array([40.0]))
        steps.append(run.steps)
    assert steps[1] > 1.2 * steps[0]


@pytest.mark.parametrize("name", METHODS)
def test_samples_are_of_one_instant(name):
    """The contact energy that is recorded is that of the bobs where they are recorded."""
    scene = replace(case("A"), duration=30.0, output=Output(samples=31))
    result = simulate(scene, **how(name, accuracy=1e-4))
    upper = result["upper"]
    lower = result["lower"]
    apart = np.hypot(upper.x_bob - lower.x_bob, upper.y_bob - lower.y_bob)[:, 0]
    energy = scene.interactions[0].potential.energy(apart)
    assert np.allclose(result.system["contact_energy"], energy, rtol=1e-13, atol=0.0)


@pytest.mark.parametrize("name", ADAPTIVE)
def test_adaptive_methods_stop_alike(name):
    """Bobs at one place, a head-on collision, a force that is no number: each has its name."""
    settings = {"method": name, "accuracy": 1e-8}
    stopped("BobsCoincide", changed("A", start=0.0), **settings)
    collision = stopped("StepUnderflow", side_by_side(Forced()), **settings)
    expected = stopped("StepUnderflow", side_by_side(Forced()), accuracy=1e-8).t[-1]
    assert collision.t[-1] == pytest.approx(expected, abs=1e-4)
    stopped("NotFinite", broken(1.0), **settings)


@pytest.mark.parametrize("name", STEPS)
def test_given_steps_stop_alike(name):
    """Steps too long, and steps too short, whatever is done with them."""
    scene = changed("A")
    stopped("EncounterJumped", scene, method=name, step=0.8)
    stopped("StepUnderflow", scene, method=name, step=1e-30)
    stopped("BobsCoincide", changed("A", start=0.0), method=name, step=0.1)


def test_iteration_that_does_not_converge():
    """A step far longer than the period of a spring: the equations are not solved by iteration."""
    stiff = Asperite(kappa=1e6)
    upper = Surface("upper", bob=(-50.0, 0.0), asperite=stiff, initial=Initial(theta=0.1))
    lower = Surface("lower", facing="up", bob=(50.0, -1.0), asperite=stiff)
    scene = Scene((upper, lower), Coulomb(0.1), 1.0, output=Output(samples=2))
    stopped("NotConverged", scene, method="gauss-8", step=0.1)
    assert simulate(scene, method="gauss-8", step=1e-4).status == "completed"


@pytest.mark.parametrize("name", METHODS)
def test_pauses_change_nothing(monkeypatch, name):
    """However often a run looks at the keyboard, it ends the same, to the last bit."""
    scene = replace(case("A"), duration=30.0, output=Output(samples=601))
    results = []
    for seconds in (0.0, 1e9):
        monkeypatch.setattr(tribo.loops.integrate, "CHUNK_SECONDS", seconds)
        results.append(tribo.simulate(scene, **how(name)))
    one, other = results
    assert (one.status, one.cost.steps) == (other.status, other.cost.steps)
    assert one.cost.steps >= 600  # more than are done before the first look
    for surface in one.ledger.surfaces:
        for quantity in one[surface]:
            assert np.array_equal(one[surface][quantity], other[surface][quantity]), quantity


@pytest.mark.parametrize("name", SYMMETRIC)
def test_equal_steps_keep_time(name):
    """A hundred thousand steps take as long as they should: a pendulum alone has its phase."""
    upper = Surface("upper", initial=Initial(theta=0.3))
    lower = Surface("lower", facing="up", bob=(0.0, -1e3))
    scene = Scene((upper, lower), Coulomb(1e-200), 100.0, output=Output(samples=2))
    result = tribo.simulate(scene, method=name, step=1e-3)
    each = upper.asperite.for_each(1)
    frequency = float(np.sqrt(each["kappa"] / each["inertia"]).item())
    assert result.cost.steps == 100_000
    expected = 0.3 * np.cos(frequency * 100.0)
    assert result["upper"].theta[-1, 0] == pytest.approx(expected, abs=2e-13)


def pair(theta, omega, end):
    """Two at rest that swing against each other; theta and omega of each."""
    places = {"upper": ("down", (-0.7, 0.6)), "lower": ("up", (0.5, -0.4))}
    surfaces = (
        Surface(name, facing=facing, bob=bob, initial=Initial(theta=theta[k], omega=omega[k]))
        for k, (name, (facing, bob)) in enumerate(places.items())
    )
    return Scene(tuple(surfaces), Coulomb(0.5), end, output=Output(samples=11))


def swings(result, sample):
    """theta and omega of both, at a sample."""
    tables = [result[name] for name in ("upper", "lower")]
    return [[float(table[q][sample, 0]) for table in tables] for q in ("theta", "omega")]


@pytest.mark.parametrize("name", SYMMETRIC)
def test_a_step_back_undoes_a_step(name):
    """From the end, with all rates reversed, the run comes back to where it began."""
    start = [[0.4, np.pi], [0.0, 0.3]]
    theta, omega = swings(tribo.simulate(pair(*start, 20.0), method=name, step=0.1), -1)
    back = tribo.simulate(pair(theta, [-w for w in omega], 20.0), method=name, step=0.1)
    theta, omega = swings(back, -1)
    assert np.allclose(theta, start[0], rtol=0.0, atol=1e-12)
    assert np.allclose(omega, [-w for w in start[1]], rtol=0.0, atol=1e-12)


def drift_of_energy(name, step, steps):
    """Largest change of the conserved energy of a pair, in units of round-off."""
    result = tribo.simulate(pair([0.4, np.pi], [0.0, 0.3], steps * step), method=name, step=step)
    assert result.cost.steps == steps
    energy = result.system["contact_energy"].copy()
    for surface in result.scene.surfaces:
        each = surface.asperite.for_each(1)
        share = each["l1"] / (each["l1"] + each["l2"])
        energy += share.item() * result[surface.name].delta_e_int[:, 0]
    return np.max(np.abs(energy - energy[0])) / energy[0] / np.finfo(float).eps


FINE = {"kahan-li-6": 0.04, "kahan-li-8": 0.1, "blanes-moan-6": 0.05, "gauss-8": 0.05}


@pytest.mark.parametrize("name", FINE)
def test_round_off_is_a_random_walk(name):
    """Steps so fine that only rounding is left: the energy drifts as the root of their number."""
    steps = 20_000 if name == "gauss-8" else 100_000
    assert drift_of_energy(name, FINE[name], steps) < 5.0 * np.sqrt(steps)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kahan-li-6", "kahan-li-8", "blanes-moan-6"])
def test_round_off_over_ten_million_steps(name):
    """The same, where the least bias of a step would show."""
    assert drift_of_energy(name, FINE[name], 10_000_000) < 5.0 * np.sqrt(1e7)


class Push(NamedTuple):
    """A drive that knows its bar's velocity."""

    gamma: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """A constant pull against friction."""
        return 0.1 - self.gamma * vx - fx, -fy


EFFECTS = {
    "own drive": {"drive": tribo.Custom(force=Push(0.3))},
    "langevin": {"drive": Free(), "langevin": Langevin(0.2)},
    "bath": {"bath": Bath(masses=(0.2,), frequencies=(0.8,))},
}


def with_effects(*names):
    """Case A, cut short, whose upper surface has some effects."""
    upper, lower = changed("A", 8.0, start=-2.0).surfaces
    for name in names:
        upper = replace(upper, **EFFECTS[name])
    return Scene((upper, lower), Coulomb(0.2), 8.0, output=Output(samples=3))


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("name", METHODS)
def test_what_a_method_cannot_do_is_refused(name, effect):
    """By its name, and with the reason; and only that."""
    scene = with_effects(effect)
    assert effect in scene.effects
    refused = METHODS[name].refuses
    if effect in refused:
        with pytest.raises(InputError, match=f'^method: "{name}" {refused[effect]}$'):
            tribo.prepare(scene, **how(name))
    assert (effect in refused) == (name in REFUSED[effect])


PLACES = {"rkn8", "rkn12", "kahan-li-6", "kahan-li-8", "blanes-moan-6"}
REFUSED = {
    "own drive": PLACES,
    "langevin": PLACES,
    "bath": {"blanes-moan-6"},
}


@pytest.mark.parametrize(
    "name", [pytest.param("gauss-8", marks=pytest.mark.slow), "gauss-radau-15"]
)
def test_collocation_follows_velocities(name):
    """Forces that depend on velocities are as good as any."""
    scene = with_effects("langevin", "own drive")
    assert largest_error(simulate(scene, **how(name)), simulate(scene, accuracy=1e-12)) < 1e-9
