"""Thermal noise beside forces of a user's, by closed forms, and beside encounters.

Asperites are independent, which gives the standard errors of means.
"""

import re
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from tribo import (
    Coulomb,
    Custom,
    Free,
    Initial,
    InputError,
    Interaction,
    Langevin,
    Output,
    Scene,
    Surface,
)
from tribo.accuracy.choose_method import choose
from tribo.integrators import methods
from tribo.layout.layout import lay_out

TEMPERATURE = 0.3
GAMMA = 1.2
DRAG = 0.8


class Hold(NamedTuple):
    """A push, a trap around x = 0, and friction without noise."""

    push: float
    stiffness: float
    drag: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return self.push - self.stiffness * x - self.drag * vx, -self.drag * vy


def held(count, push=0.0, stiffness=0.0, drag=DRAG, end=120.0):
    """Asperites at x = 0 that do not meet, on a reservoir."""
    surface = Surface(
        "one",
        shape=(1, count),
        spacing=(0.0, 5.0),
        drive=Custom(force=Hold(push, stiffness, drag)),
        langevin=Langevin(GAMMA, TEMPERATURE),
    )
    return Scene([surface], [], end, output=Output(times=np.arange(20.0, end + 1.0)))


def assert_mean(values, expected):
    """The mean over asperites and times after the first is as expected, within 4 errors."""
    each = values[1:].mean(axis=0)
    error = each.std() / np.sqrt(each.size)
    assert error < 0.03 * abs(expected)
    assert each.mean() == pytest.approx(expected, abs=4.0 * error + 0.005 * abs(expected))


def test_a_trap_and_a_drag():
    """k <x^2> = T: friction without noise lowers T by gamma / (gamma + drag)."""
    result = tribo.simulate(held(400, stiffness=1.5), step=0.1)
    cooled = TEMPERATURE * GAMMA / (GAMMA + DRAG)
    assert_mean(1.5 * result["one"].x_bar ** 2, cooled)
    inertia = Surface("one").asperite.for_each(1)["inertia"][0]
    assert_mean(inertia * result["one"].omega ** 2, cooled)


def test_a_push():
    """The mean velocity is F / (gamma + drag); no method is named, as in an ensemble."""
    result = tribo.simulate(held(400, push=2.0), step=0.1)
    assert result.method == "verlet"
    assert_mean(result["one"].vx_cm, 2.0 / (GAMMA + DRAG))


def test_a_push_in_an_ensemble():
    """The mean work of the push is its power times the time, but for its start and the noise."""
    scene = replace(held(1, push=2.0, drag=0.0, end=100.0), output=Output(samples=2))
    means = tribo.ensemble(scene, members=60, step=0.1)
    speed = 2.0 / GAMMA
    relaxed = Surface("one").asperite.for_each(1)["mass"][0] / GAMMA
    expected = 2.0 * speed * (100.0 - relaxed)
    found, width = (float(means[f"one.{name}"][-1]) for name in ("w2_mean", "w2_half_width"))
    assert width < 0.05 * expected
    assert found == pytest.approx(expected, abs=2.0 * width)


def test_the_method_for_noise_is_checked(monkeypatch):
    """The automatic choice refuses what the method would refuse by name."""
    verlet = replace(methods.METHODS["verlet"], refuses={"own drive": "drops forces"})
    monkeypatch.setitem(methods.METHODS, "verlet", verlet)
    for name in (None, "verlet"):
        with pytest.raises(InputError, match=r'^method: "verlet" drops forces$'):
            choose(lay_out(held(1)), None, name, 0.1)


def passing(strength, temperature):
    """Free asperites of one surface whose bobs pass one another."""
    surface = Surface(
        "row",
        shape=(4, 1),
        spacing=(0.3, 0.0),
        drive=Free(),
        langevin=Langevin(0.5, temperature),
        initial=Initial(omega=(3.0, -3.0, 2.0, -4.0)),
    )
    contact = Interaction(Coulomb(strength), ("row", "row"))
    return Scene([surface], [contact], 20.0, output=Output(samples=2))


def test_encounters_far_below_the_noise_end_no_run():
    """A note names the asperites; without noise, or where the force matters, the run ends."""
    result = tribo.simulate(passing(1e-14, 0.3), step=0.1)
    assert result.status == "completed"
    (note,) = result.notes
    assert re.match(r'in \d+ steps bobs .* asperite \d of "row" and asperite \d of "row"', note)
    for strength, temperature in ((1e-14, 0.0), (0.3, 0.3)):
        with pytest.warns(tribo.TriboWarning, match="EncounterJumped"):
            tribo.simulate(passing(strength, temperature), method="verlet", step=0.1)


def test_an_automatic_step_resolves_the_encounters():
    """It follows the force of contact at the start, which bounds of the scene do not show."""
    simulation = tribo.prepare(passing(0.3, 0.3))
    step = simulation.plan.setting.step
    result = simulation.run()
    assert result.status == "completed" and step < 0.01
    assert not any("bobs" in note for note in result.notes)
    given = tribo.simulate(passing(0.3, 0.3), method="verlet", step=result.settings["step"])
    assert np.array_equal(given["row"].theta, result["row"].theta)
    with pytest.warns(tribo.TriboWarning, match="EncounterJumped"):
        tribo.simulate(passing(0.3, 0.3), method="verlet", step=32.0 * step)
