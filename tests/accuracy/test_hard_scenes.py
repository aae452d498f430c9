"""Scenes on which simple integrators fail, reference digits, and all ways in which a run stops."""

from dataclasses import replace

import numpy as np
import pytest

from support.hard_scenes import Broken, changed, side_by_side, simulate, stopped
from tribo import (
    Asperite,
    Coulomb,
    Forced,
    Free,
    Initial,
    InputError,
    LennardJones,
    Morse,
)
from tribo.kernels.status import MEANINGS

# A scene, and the final delta_e_int of its upper asperite.
HARD = {
    "a deep Morse well": (changed("A", 40.0, Morse(50.0, 20.0, 0.3), gap=0.25), 2.06392267),
    "B without its gap": (changed("B", 40.0, gap=0.0), 1.62892284),
    "a hard core at speed": (changed("A", 2.0, LennardJones(1.0, 0.1), speed=20.0), 300.007232),
    "stiff springs": (changed("A", 20.0, start=-5.0, gap=0.3, kappa=1e4), 4.7557e-8),
}


@pytest.mark.filterwarnings("ignore:the accuracy is not met:tribo.TriboWarning")
@pytest.mark.parametrize("name", HARD)
def test_hard_scene(name):
    """The error is below 1e-6 of the scale, and within the estimate."""
    scene, expected = HARD[name]
    result = simulate(scene, accuracy=1e-8)
    assert result.status == "completed" and result.met
    found = result["upper"].delta_e_int[-1, 0]
    # 4.7557e-8 is all the digits there are of the last one.
    assert found == pytest.approx(expected, rel=1e-6 if expected > 1e-3 else 2e-5)
    finer = simulate(scene, accuracy=1e-11)["upper"].delta_e_int[-1, 0]
    assert abs(found - finer) <= 1.1 * result.error_estimate["delta_e_int"]


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


@pytest.mark.filterwarnings("ignore:the accuracy is not met:tribo.TriboWarning")
def test_weak_coupling():
    """Works that are tiny against all energies have small errors relative to their own scale."""
    scene = changed("A", 40.0, Coulomb(1e-8), gap=0.3)
    rough, fine = (simulate(scene, accuracy=accuracy) for accuracy in (1e-6, 1e-11))
    works = ("w1", "w2", "w1_ps", "w2_ps", "w", "delta_e_int")
    scale = max(np.max(np.abs(fine["upper"][w])) for w in works)
    assert 0.0 < scale < 1e-8
    for work in works:
        assert np.max(np.abs(rough["upper"][work] - fine["upper"][work])) <= 1e-6 * scale


# A scene, the arguments of its run, and the final status.
STOPS = {
    "bobs at one place": (changed("A", start=0.0), {}, "BobsCoincide"),
    "bobs at one place, own step": (changed("A", start=0.0), {"step": 0.1}, "BobsCoincide"),
    "head on": (side_by_side(Forced()), {}, "StepUnderflow"),
    "head on, roughly": (side_by_side(Forced()), {"accuracy": 1e-2}, "StepUnderflow"),
    "head on and free": (side_by_side(Free()), {}, "StepUnderflow"),
    "head on, own step": (side_by_side(Forced()), {"step": 0.001}, "EncounterJumped"),
    "head on and free, own step": (side_by_side(Free()), {"step": 0.001}, "EncounterJumped"),
    "no value": (changed("A", potential=Broken(0.2, 1.0)), {}, "NotFinite"),
    "no value at the start": (changed("A", potential=Broken(0.2, 20.0)), {}, "NotFinite"),
    "no value, own step": (changed("A", potential=Broken(0.2, 1.0)), {"step": 0.01}, "NotFinite"),
    "a step too long": (changed("A"), {"step": 30.0}, "EncounterJumped"),
    "a step too short": (changed("A"), {"step": 1e-30}, "StepUnderflow"),
}


@pytest.mark.parametrize("name", STOPS)
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
@pytest.mark.parametrize("name", ABSURD)
def test_no_run_hangs(name):
    """A run ends after few steps: complete, with a named status, or refused."""
    scene = changed("A", 10.0, start=-1.0)
    upper, lower = scene.surfaces
    try:
        result = simulate(replace(scene, surfaces=(replace(upper, **ABSURD[name]), lower)))
    except InputError:
        return
    assert result.status in MEANINGS


def test_contact_far_out_of_reach_does_not_hang():
    """Before a contact of short range its force may be 1e-300 or less."""
    for x in (10.0, 100.0):
        scene = changed("A", 60.0 + x / 0.5, Morse(1.0, 20.0, 0.3), start=-x, gap=0.25)
        result = simulate(scene, accuracy=1e-6)
        assert result["upper"].delta_e_int[-1, 0] == pytest.approx(0.298908, abs=1e-6)
