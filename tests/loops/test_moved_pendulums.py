"""Pendulums on bars that follow a given motion: Kapitza's pendulum, ledger, methods."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tribo
from support.laws import identities, tables
from tribo import Asperite, Coulomb, Field, InputError, Langevin, Moved, Output, Scene, Surface

GRAVITY = 1.0
LENGTH = 0.8
HEIGHT = 0.02 * LENGTH  # by which the bar moves up and down


class Weight(NamedTuple):
    """The weight of bobs."""

    force: float

    def energy_at(self, x, y):
        return self.force * y

    def force_at(self, x, y):
        return 0.0, -self.force


def pendulum(ratio, duration, **settings):
    """A pendulum that stands on a bar at HEIGHT cos(w t), HEIGHT w = ratio sqrt(2 g L)."""
    frequency = ratio * math.sqrt(2.0 * GRAVITY * LENGTH) / HEIGHT
    period = 2.0 * math.pi / frequency
    up = tribo.Schedule.sine(0.0, -HEIGHT * frequency, period)
    surface = Surface(
        "pendulum",
        facing="up",
        asperite=Asperite(m1=1.3, m2=0.6, length=LENGTH, kappa=0.0),
        initial={"swing": 1e-3},
        drive=Moved(speed=(0.0, up)),
        **settings,
    )
    weight = Field(Weight(1.3 * GRAVITY), on=("pendulum",))
    return Scene((surface,), (), duration, fields=(weight,), output=Output(samples=201))


@pytest.mark.parametrize(("ratio", "stands"), [(1.06, True), (0.94, False)])
def test_kapitzas_pendulum_stands_where_its_bar_is_fast_enough(ratio, stands):
    """Upside down it is stable for a w > sqrt(2 g L), where a is much less than L.

    It swings slowly at sqrt(g / L (r^2 - 1)) with r the ratio of the two; below, it falls.
    """
    rate = math.sqrt(GRAVITY / LENGTH * abs(ratio**2 - 1.0))
    duration = 2.0 * math.pi / rate
    result = tribo.simulate(pendulum(ratio, duration), method="dop853", accuracy=1e-6)
    own = result["pendulum"]
    away = np.abs(own["theta"][:, 0] - math.pi)
    if stands:
        assert np.max(away) < 1.3e-3
    else:
        assert away[-1] == pytest.approx(1e-3 * math.cosh(rate * duration), rel=0.1)
    frequency = ratio * math.sqrt(2.0 * GRAVITY * LENGTH) / HEIGHT
    moved = HEIGHT * (np.cos(frequency * result.t) - 1.0)
    assert np.max(np.abs(own["y_bar"][:, 0] - own["y_bar"][0, 0] - moved)) <= 1e-5 * HEIGHT


PATH = (
    tribo.Schedule.sine(0.3, 0.4, 2.0, phase=0.0),
    tribo.Schedule([[0.0, 0.0], [1.5, 0.3], [4.0, -0.2]]),
)


def row(**settings):
    """Three unlike pendulums on moved bars over a row that stands."""
    upper = Surface(
        "upper",
        **{
            "bob": (0.1, 1.3),
            "shape": (3, 1),
            "spacing": (0.9, 0.0),
            "velocity": (0.3, 0.0),
            "asperite": Asperite(kappa=(0.5, 1.0, 2.0), m1=(0.8, 1.0, 1.2), length=0.8),
            "drive": Moved(speed=PATH),
            "initial": {"swing": (0.1, -0.2, 0.3)},
        }
        | settings,
    )
    lower = Surface("lower", facing="up", shape=(4, 1), drive="bars", asperite=Asperite(kappa=0.9))
    output = Output(samples=11, series=("forces",))
    return Scene((upper, lower), Coulomb(0.1), 5.0, output=output)


def test_pendulums_swing_about_accelerated_bars():
    """theta'' of a pendulum whose pivot accelerates, by another program; f2 moves the centre."""
    given = row()
    given = replace(given, surfaces=given.surfaces[:1], interactions=())
    result = tribo.simulate(given, method="gauss-radau-15", accuracy=1e-9)
    each = given.surfaces[0].each
    kappa, m1, rod = each["kappa"], each["m1"], each["length"]

    def rates(t, state):
        theta, omega = np.split(state, 2)
        ax = 0.4 * math.pi * math.cos(math.pi * t)
        ay = 0.2 if t < 1.5 else -0.2 if t < 4.0 else 0.0
        turned = -kappa * theta / (m1 * rod**2)
        return np.concatenate([omega, turned - (np.cos(theta) * ax + np.sin(theta) * ay) / rod])

    state = np.array([0.1, -0.2, 0.3, 0.0, 0.0, 0.0])
    for begin, end in ((0.0, 1.5), (1.5, 4.0), (4.0, 5.0)):
        run = solve_ivp(rates, (begin, end - 1e-12), state, "DOP853", rtol=1e-11, atol=1e-12)
        state = run.y[:, -1]
    own = result["upper"]
    assert np.max(np.abs(own["theta"][-1] - state[:3])) <= 1e-8
    momentum = each["mass"] * own["vx_cm"]
    impulse = momentum[-1] - momentum[0]
    fine = replace(given, output=Output(samples=4001, series=("forces",)))
    fine = tribo.simulate(fine, method="gauss-radau-15", accuracy=1e-9)
    found = np.trapezoid(fine["upper"]["f2_x"], fine.t, axis=0)
    # The force jumps where the acceleration does, which the trapezoidal rule blurs.
    assert np.max(np.abs(found - impulse)) <= 2e-4


@pytest.mark.parametrize("langevin", [None, Langevin(0.2, on="swing")])
def test_ledger_of_moved_pendulums_closes(langevin):
    settings = {} if langevin is None else {"langevin": langevin}
    result = tribo.simulate(row(**settings), method="gauss-radau-15", accuracy=1e-9)
    for _, table in tables(result):
        for law, _, one, other in identities([table]):
            assert np.max(np.abs(one - other)) <= 1e-8, law
    assert np.max(np.abs(result["upper"].w2)) > 0.01
    change = result.system["total_energy_change"] - result.system["applied_work"]
    assert np.max(np.abs(change)) <= 1e-8
    bars = result["upper"]["x_bar"], result["upper"]["y_bar"]
    assert max(np.max(np.ptp(b - b[0], axis=1)) for b in bars) <= 1e-13


def test_moved_pendulums_continue_bit_for_bit():
    how = {"method": "rk4", "step": 0.02}
    whole = tribo.simulate(row(), **how)
    first = tribo.simulate(replace(row(), duration=2.5, output=Output(samples=6)), **how)
    rest = tribo.simulate(row(), start=first.state(), **how)
    for name in ("theta", "x_bar", "w2"):
        assert np.array_equal(rest["upper"][name][-1], whole["upper"][name][-1])


def test_members_are_single_runs():
    swings = [0.1, 0.2, 0.3]
    how = {"accuracy": 1e-8, "method": "dop853"}
    alike = {"asperite": Asperite(kappa=0.7), "initial": {}}
    data = tribo.ensemble(row(**alike), 3, {"upper.swing": swings}, keep=["upper.theta"], **how)
    for k, swing in enumerate(swings):
        alone = tribo.simulate(row(**alike | {"initial": {"swing": swing}}), **how)
        gap = data["upper.theta"].values[k] - alone["upper"]["theta"][-1]
        assert np.max(np.abs(gap)) <= 1e-7


@pytest.mark.parametrize("method", ["verlet", "rkn8"])
def test_methods_that_cannot_take_them_say_so(method):
    with pytest.raises(InputError, match="bars"):
        tribo.simulate(row(), method=method)
