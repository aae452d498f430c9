"""Reference digits, all ways in which a run stops, and numbers that make no run hang.

Scenes on which simple integrators fail stand in the atlas.
"""

from dataclasses import replace

import numpy as np
import pytest

from support.hard_scenes import broken, changed, side_by_side, simulate, stopped
from tribo import (
    Asperite,
    Forced,
    Free,
    Initial,
    InputError,
)

# Reference digits at the end of a case's run.
DIGITS = {
    ("A", 40.0, "theta"): 0.261760416587400463,
    ("C", 50.0, "w1"): -0.517720441542645418,
}


@pytest.mark.parametrize(("name", "end", "quantity"), DIGITS)
def test_reference_digits(name, end, quantity):
    """Nine digits at an accuracy of 1e-10; the error is within its estimate."""
    result = simulate(changed(name, end), accuracy=1e-10)
    error = abs(result["upper"][quantity][-1, 0] - DIGITS[name, end, quantity])
    assert error <= min(1e-9, result.error_estimate[quantity])


# A scene, the arguments of its run, and the final status.
STOPS = {
    "bobs at one place, own step": (changed("A", start=0.0), {"step": 0.1}, "BobsCoincide"),
    "head on, roughly": (side_by_side(Forced()), {"accuracy": 1e-2}, "StepUnderflow"),
    "head on, own step": (side_by_side(Forced()), {"step": 0.001}, "EncounterJumped"),
    "head on and free, own step": (side_by_side(Free()), {"step": 0.001}, "EncounterJumped"),
    "no value": (broken(1.0), {}, "NotFinite"),
    "no value at the start": (broken(20.0), {}, "NotFinite"),
    "no value, own step": (broken(1.0), {"step": 0.01}, "NotFinite"),
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "no value, own step")) for n in STOPS]
)
def test_run_that_stops(name):
    """A named status, all samples up to the last state, and no accuracy met."""
    scene, how, status = STOPS[name]
    result = stopped(status, scene, **how)
    assert 0.0 <= result.t[-1] < scene.duration
    assert np.all(np.diff(result.t) > 0.0)
    for name in result.ledger.surfaces:
        assert all(values.shape[0] == result.t.size for values in result[name].values())
    assert not result.met


@pytest.mark.parametrize("drive", [Forced(), Free()], ids=["forced", "free"])
def test_collision_is_where_it_should_be(drive):
    """The time of a head-on collision depends neither on the accuracy nor on the method."""
    scene = side_by_side(drive)
    found = [stopped("StepUnderflow", scene, accuracy=accuracy) for accuracy in (1e-4, 1e-6, 1e-8)]
    times = [result.t[-1] for result in found]
    assert max(times) - min(times) < 1e-4
    coarse = stopped("EncounterJumped", scene, step=0.001)
    assert coarse.t[-1] == pytest.approx(times[-1], abs=0.01)


# Each number is valid, but no method can integrate the scene.
ABSURD = {
    "a huge angle": {"initial": Initial(theta=1e90)},
    "a bar that spins": {"initial": Initial(nu=1e90)},
    "a stiff spring": {"asperite": Asperite(kappa=1e90)},
    "tiny": {"asperite": Asperite(m1=1e-90, m2=1e-90, length=1e-90)},
    "huge": {"asperite": Asperite(m1=1e90, m2=1e90, length=1e90)},
    "a huge speed": {"velocity": (1e90, 0.0)},
    "far away": {"bob": (-1e90, 0.0)},
}


@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::tribo.TriboWarning")
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "huge")) for n in ABSURD]
)
def test_no_run_hangs(name):
    """A run ends after few steps: complete, with a named status, or refused."""
    scene = changed("A", 10.0, start=-1.0)
    upper, lower = scene.surfaces
    try:
        result = simulate(replace(scene, surfaces=(replace(upper, **ABSURD[name]), lower)))
    except InputError:
        return
    assert result.status == "completed" or result.status in result.shortcoming
