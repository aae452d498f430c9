"""The theorems at coarse steps, which splittings fulfil exactly and other methods miss by far.

Bobs pass at a distance, so that coarse steps resolve the encounter.  A splitting preserves volume
and can be reversed at any step, whatever its error.  Two defects show in two theorems:

- A method that is not symplectic misses the integral theorem.  Midpoint with a step h shrinks the
  weights of a pendulum of frequency f by t h^3 f^4 / 4 in a time t.
- An asymmetric sequence of kicks keeps volume, but cannot be reversed.  It misses the detailed
  theorem: starts and reversed ends of runs have the same distribution, if each run is weighted by
  s(w) = 1 / (1 + exp(w / T)).  These weights are bounded, so that means have small errors.
"""

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest

import tribo
from support.gibbs import MOST, PASSING, deviation, passing
from tribo.integrators.methods import METHODS
from tribo.integrators.splitting import Splitting

STEP, TEMPERATURE = 0.2, 1.0


SHORT = passing(3.0, 0.5, 6.0, tribo.Gaussian(8.0, 2.0))


def runs(scene: tribo.Scene, members: int, method: str) -> tuple[np.ndarray, np.ndarray]:
    """Gains over T, and angular velocities at the start less those at the end, of each member."""
    names = [s.name for s in scene.surfaces]
    keep = [f"{name}.{quantity}" for name in names for quantity in ("swing_energy", "omega")]
    data = tribo.ensemble(
        scene,
        members,
        {"*.swing_state": tribo.Canonical(TEMPERATURE)},
        seed=2,
        keep=keep,
        at="samples",
        method=method,
        step=STEP,
        allow_unresolved=True,
    )
    assert data.attrs["members"] == f'{{"completed": {members}}}'
    ends = [data[f"{name}.{q}"].values for name in names for q in ("swing_energy", "omega_end")]
    changes = np.array([each[:, 1, 0] - each[:, 0, 0] for each in ends])
    return changes[::2].sum(axis=0) / TEMPERATURE, -changes[1::2].sum(axis=0)


@pytest.mark.parametrize("method", [name for name, m in METHODS.items() if m.splits] + ["gauss-8"])
def test_methods_that_preserve_volume(method):
    """At a step of a twentieth of the period."""
    w, _ = runs(PASSING, 2048, method)
    assert abs(deviation(np.exp(-w))) < MOST
    assert np.std(w) > 0.5


def test_midpoint_misses_the_integral_theorem():
    """By the volume that two free pendulums lose, and by many standard errors."""
    w, _ = runs(PASSING, 2048, "midpoint")
    weights = np.exp(-w)
    assert deviation(weights) < -3.0 * MOST
    lost = 0.0
    for s in PASSING.surfaces:
        square = float(s.each["kappa"][0] / s.each["inertia"][0])
        lost += PASSING.duration * STEP**3 * square**2 / 4.0
    assert abs(np.log(weights.mean()) + lost) < 0.1


@pytest.mark.parametrize(("kicks", "sound"), [((0.5, 0.5), True), ((0.0, 1.0), False)])
def test_an_asymmetric_kick_misses_the_detailed_theorem(kicks, sound):
    """Angular velocities at the starts and at the reversed ends differ by a part of a kick."""
    coefficients = Splitting(np.array([0.0, 1.0, 0.0]), np.array(kicks))
    method = replace(METHODS["verlet"], coefficients=coefficients)
    with mock.patch.dict(METHODS, verlet=method):
        w, difference = runs(SHORT, 32_768, "verlet")
    assert abs(deviation(np.exp(-w))) < MOST
    missed = difference / (1.0 + np.exp(w))
    error = abs(missed.mean()) / missed.std() * np.sqrt(missed.size)
    assert error < MOST if sound else error > 1.5 * MOST
