"""A pause changes nothing: results do not depend on how many steps a loop takes between two."""

from dataclasses import replace

import numpy as np
import pytest

import tribo.layout.contacts
from tribo import (
    Asperite,
    Bath,
    Coulomb,
    Forced,
    Free,
    Initial,
    LennardJones,
    Output,
    Scene,
    Surface,
)
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.layout.layout import lay_out
from tribo.loops import integrate, pair
from tribo.loops.general import GeneralLoop
from tribo.loops.resolution import first_step
from tribo.loops.setting import Setting
from tribo.paper import scene as case

BUDGETS = (10**9, 1, 7)  # steps between two pauses


def rows(count):
    """Two rows whose bobs pass one another's cutoff again and again, in neighbour lists."""
    places = {"upper": ("down", (-2.0, 0.6), Forced()), "lower": ("up", (0.0, 0.0), Free())}
    surfaces = (
        Surface(
            name,
            facing=facing,
            bob=bob,
            velocity=(0.8 if name == "upper" else 0.0, 0.0),
            shape=(count, 1),
            spacing=(1.1, 0.0),
            drive=drive,
            asperite=Asperite(kappa=2.0),
            initial=Initial(theta=0.2 if facing == "down" else 3.0),
        )
        for name, (facing, bob, drive) in places.items()
    )
    potential = LennardJones(0.5, 0.5).with_cutoff(1.4)
    return Scene(tuple(surfaces), potential, 8.0, output=Output(samples=9))


def falling(count):
    """Two rows at rest that attract each other, too many to compute encounters at every step."""
    surfaces = (
        Surface(name, bob=(x, 0.0), shape=(1, count), spacing=(0.0, 3.0), drive=Forced())
        for name, x in (("left", -0.5), ("right", 0.5))
    )
    return Scene(tuple(surfaces), Coulomb(-1.0), 20.0, output=Output(samples=2))


def in_chunks(monkeypatch, budget):
    """Let loops pause after `budget` steps."""
    monkeypatch.setattr(integrate, "FIRST_CHUNK", budget)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", budget)


def tolerance(layout, level):
    """The same for every component."""
    limits = np.full(layout.start.size, level), np.full(layout.accounts, level)
    return Setting(tolerance=Tolerance(*limits, level))


def outcome(run):
    """Everything that a run returns, in bits."""
    s = run.samples
    arrays = (s.t, s.y, s.s, s.contact, s.field, s.stored)
    return run.status, run.steps, run.evaluations, *(array.tobytes() for array in arrays)


def assert_same(monkeypatch, run, status):
    """The same outcome, with this status, however often the run pauses."""
    outcomes = []
    for budget in BUDGETS:
        with monkeypatch.context() as patch:
            in_chunks(patch, budget)
            outcomes.append(outcome(run()))
    assert outcomes[0][0] == status
    assert outcomes[0] == outcomes[1] == outcomes[2]


SETTINGS = {  # steps or tolerances, and the status of the run
    "verlet": ((0.03, "completed"), (0.06, "EncounterJumped")),
    "rk4": ((0.03, "completed"), (0.06, "EncounterJumped")),
    "gauss-8": ((0.03, "completed"), (0.06, "EncounterJumped")),
    "dop853": ((1e-3, "completed"), (1e-8, "completed")),
    "rkn8": ((1e-3, "completed"), (1e-8, "completed")),
    "gauss-radau-15": ((1e-3, "completed"), (1e-8, "completed")),
}

# Their loops have the same frame as those of rk4 and dop853.
SLOW = {"gauss-8", "rkn8", "gauss-radau-15"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in SETTINGS]
)
def test_pauses_of_rows(monkeypatch, name):
    """Lists of neighbours, the rate of encounters and rejected steps survive a pause."""
    monkeypatch.setattr(tribo.layout.contacts, "UNLISTED_PAIRS", 0)
    layout = lay_out(rows(34))
    assert layout.rows > 0
    method = METHODS[name]
    for setting, status in SETTINGS[name]:
        wanted = tolerance(layout, setting) if method.adaptive else Setting(step=setting)

        def run(wanted=wanted):
            loop = GeneralLoop(layout, method, wanted, layout.start, first_step(layout))
            return integrate.integrate(loop, layout.scene.times)

        assert_same(monkeypatch, run, status)


@pytest.mark.parametrize("name", ["verlet", "rk4"])
def test_refusal_of_a_step(monkeypatch, name):
    """A step is refused when the encounter rate is computed, which no pause brings forward."""
    layout = lay_out(falling(33))
    method = METHODS[name]

    def run():
        loop = GeneralLoop(layout, method, Setting(step=0.2), layout.start, 0.0)
        return integrate.integrate(loop, layout.scene.times)

    assert_same(monkeypatch, run, "EncounterJumped")


def test_pauses_with_baths(monkeypatch):
    """The momentum of warm baths on several bars, which splitting methods keep between kicks."""
    bath = Bath(masses=(0.2, 0.1), frequencies=(1.0, 3.0), temperature=0.1)
    bars = Surface("one", drive="free", shape=(9, 1), bath=bath)
    layout = lay_out(Scene([bars], [], 3.0, output=Output(samples=4)))

    def run():
        loop = GeneralLoop(layout, METHODS["verlet"], Setting(step=0.03), layout.start, 0.0)
        return integrate.integrate(loop, layout.scene.times)

    assert_same(monkeypatch, run, "completed")


@pytest.mark.parametrize("level", [1e-3, 1e-9])
def test_pauses_of_a_pair(monkeypatch, level):
    """The loop for one asperite on one."""
    scene = replace(case("B"), interactions=Coulomb(0.2), output=Output(samples=9))
    layout = lay_out(scene)
    method = METHODS["gauss-radau-15"]
    loop = pair.Pair(layout, method, first_step(layout))

    def run():
        wanted = tolerance(layout, level)
        return loop.integrate(wanted, layout.start, scene.times, progress=lambda t: None)

    assert_same(monkeypatch, run, "completed")
