"""Volumes of phase space: kept by every splitting, to round-off, at any step.

A kick changes velocities by a function of the coordinates, a drift turns each pendulum, a bath's
substep turns each oscillator about its bar: each has the determinant 1, and so has any sequence of
them.  The determinant of the derivative of the whole run, over all coordinates and velocities, is
compared with 1.  It shows forces that depend on velocities, and coordinates that are updated within
a kick.  It does not show wrong forces that depend on places alone.
"""

import math
from dataclasses import replace
from unittest import mock

import numpy as np
import pytest

import tribo
from support.everything import everything
from support.flow import volume_ratio
from support.gibbs import rows
from tribo.integrators.methods import METHODS, refusal
from tribo.integrators.splitting import Splitting

STEP = 0.05
DURATION = 2.0
# Largest deviation from 1: errors of differences are below 1e-8.
MOST = 1e-7
POINTS = {"masses": [0.3, 0.2], "frequencies": [1.1, 2.3]}
TORSIONAL = {"inertias": [0.2], "torsional_frequencies": [1.3]}


def started(scene: tribo.Scene, **settings) -> tribo.Scene:
    """The scene with settings of all surfaces, moving in all coordinates."""
    rng = np.random.default_rng(5)
    surfaces = []
    for s in scene.surfaces:
        start = {"swing": rng.normal(0.0, 0.3, s.count), "omega": rng.normal(0.0, 0.3, s.count)}
        if "springs" in settings or "bath" in settings:
            start |= {name: rng.normal(0.0, 0.2, s.count) for name in ("x", "y", "vx", "vy")}
        surfaces.append(replace(s, initial=tribo.Initial(**start), **settings))
    output = tribo.Output(samples=2)
    return replace(scene, surfaces=tuple(surfaces), duration=DURATION, output=output)


SCENES = {
    "pair": started(rows((1, 1))),
    "forced": started(rows()),
    "driven bars": started(rows(drive=tribo.DrivenBars())),
    "springs": started(rows((3, 2)), springs=tribo.Springs(3.0)),
    "bath": started(rows(), bath=tribo.Bath(**POINTS, temperature=1.0)),
    "bars that turn": started(
        rows(), bars="free", springs=tribo.Springs(2.0), bath=tribo.Bath(**POINTS, **TORSIONAL)
    ),
    "free": started(rows(drive=tribo.Free()), springs=tribo.Springs(1.0)),
    "everything": everything(DURATION),
}
SPLITTINGS = [name for name, method in METHODS.items() if method.splits]
DEFAULT = {("pair", name) for name in SPLITTINGS} | {("springs", "verlet"), ("bath", "verlet")}
CASES = [
    pytest.param(kind, method, marks=() if (kind, method) in DEFAULT else pytest.mark.slow)
    for kind, scene in SCENES.items()
    for method in [*SPLITTINGS, "gauss-8"]
    if refusal(METHODS[method], scene) is None
]


@pytest.mark.parametrize(("kind", "method"), CASES)
def test_volume_is_kept(kind, method):
    """Splittings, and a collocation to the tolerance of its iteration."""
    assert abs(volume_ratio(SCENES[kind], method=method, step=STEP) - 1.0) < MOST


@pytest.mark.parametrize(
    ("method", "most"),
    [
        ("midpoint", 1e-2),
        ("rk4", 1e-5),
        *(
            pytest.param(name, MOST, marks=pytest.mark.slow)
            for name in ("dop853", "rkn8", "rkn12", "gauss-radau-15")
        ),
    ],
)
def test_volume_at_the_lowest_accuracy(method, most):
    """Methods that are not symplectic change volumes by less than the accuracy asked for."""
    ratio = volume_ratio(SCENES["pair"], method=method, accuracy=0.1)
    assert abs(ratio - 1.0) < most


@pytest.mark.parametrize(("method", "least"), [("midpoint", 1e-3), ("rk4", 1e-6)])
def test_explicit_methods_change_volume(method, least):
    """By an error of the method: the test can fail."""
    assert abs(volume_ratio(SCENES["pair"], method=method, step=STEP) - 1.0) > least


def test_an_asymmetric_kick_keeps_volume():
    """All kicks are shears: the order of convergence shows it, see `test_order`, volume cannot."""
    first_order = Splitting(np.array([0.2, 0.8]), np.array([1.0]))
    method = replace(METHODS["verlet"], coefficients=first_order)
    with mock.patch.dict(METHODS, verlet=method):
        ratio = volume_ratio(SCENES["pair"], method="verlet", step=STEP)
    assert abs(ratio - 1.0) < MOST


@pytest.mark.parametrize("drive", [tribo.Forced(), tribo.DrivenBars()], ids=["forced", "bars"])
def test_damping_contracts_volume_by_its_rate(drive):
    """With a torque -gamma omega on pendulums of inertia J, volume decays at the rate gamma / J.

    A collocation has it to round-off, Verlet to second order in the step.
    """
    gamma = 0.2
    contraction = 0.0
    scene = started(rows((1, 1), drive), langevin=tribo.Langevin(gamma, on="swing"))
    for s in scene.surfaces:
        inertia = s.each["inertia"]
        if isinstance(drive, tribo.DrivenBars):
            inertia = s.each["m1"] * s.each["length"] ** 2
        contraction += gamma * DURATION * float(np.sum(1.0 / inertia))
    expected = math.exp(-contraction)
    exact = volume_ratio(scene, method="gauss-8", step=STEP)
    assert exact == pytest.approx(expected, rel=MOST)
    coarse, fine = (volume_ratio(scene, method="verlet", step=h) for h in (STEP, 0.5 * STEP))
    assert (coarse - expected) / (fine - expected) == pytest.approx(4.0, rel=0.02)
