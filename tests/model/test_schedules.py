"""Schedules: their values, their integrals, their keys, and what is refused."""

import tomllib

import numpy as np
import pytest
from scipy.integrate import quad

import tribo
from support.scene_tables import scene_from
from tribo.export.lammps_motion import _formula
from tribo.model.effects import Effect
from tribo.model.parameters import is_parameter, value_of, with_values

SCHEDULES = {
    "linear": tribo.Schedule([[1.0, 0.2], [3.0, 0.5], [4.0, -0.4]]),
    "jump": tribo.Schedule([[0.0, 1.0], [2.0, 2.0], [2.0, -1.0], [5.0, 0.0]]),
    "jump at the start": tribo.Schedule([[0.5, 1.0], [0.5, 2.0], [3.0, 2.5]]),
    "steps": tribo.Schedule([[0.0, 0.1], [2.0, -0.3], [4.5, 0.2]], kind="steps"),
    "sine": tribo.Schedule.sine(0.3, 0.7, 2.5, phase=0.4),
    "constant": tribo.Schedule([[2.0, 0.7]]),
}
TIMES = np.linspace(0.0, 7.0, 71) + 0.013


@pytest.mark.parametrize("name", SCHEDULES)
def test_integral(name):
    schedule = SCHEDULES[name]
    for t in (0.7, 2.0, 3.3, 6.5):
        points = [kink for kink in schedule.kinks if 0.0 < kink < t] or None
        area, _ = quad(schedule.at, 0.0, t, points=points, epsabs=1e-13)
        assert schedule.integral(t) == pytest.approx(area, abs=1e-11)


@pytest.mark.parametrize("name", SCHEDULES)
def test_pieces(name):
    """Between two kinks, the numbers for kernels give the value and the integral."""
    schedule = SCHEDULES[name]
    for t in TIMES:
        for piece, wanted in (
            (schedule.piece(t), schedule.at(t)),
            (schedule.integral_piece(t), schedule.integral(t)),
        ):
            u = t - piece.since
            value = piece.c0 + (piece.c1 + piece.c2 * u) * u
            value += piece.amplitude * np.sin(piece.frequency * u + piece.phase)
            assert value == pytest.approx(wanted, abs=1e-13)


@pytest.mark.parametrize("name", SCHEDULES)
def test_formula_for_lammps(name):
    schedule = SCHEDULES[name]
    for integral, wanted in ((False, schedule.at(TIMES)), (True, schedule.integral(TIMES))):
        formula = _formula(schedule, integral)
        found = [eval(formula, {"sin": np.sin, "time": t}) for t in TIMES.tolist()]
        np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_kinks_and_extremes():
    assert SCHEDULES["linear"].kinks == (1.0, 3.0, 4.0)
    assert SCHEDULES["jump"].kinks == (0.0, 2.0, 5.0)
    assert SCHEDULES["steps"].kinks == (2.0, 4.5)
    assert SCHEDULES["sine"].kinks == SCHEDULES["constant"].kinks == ()
    assert (SCHEDULES["jump"].low, SCHEDULES["jump"].high) == (-1.0, 2.0)
    assert SCHEDULES["jump"].jumps and not SCHEDULES["linear"].jumps
    assert SCHEDULES["jump"].at(2.0) == -1.0


def test_the_lowest_value_of_a_sine_with_a_negative_amplitude():
    """It is the mean less the size of the amplitude."""
    assert tribo.Schedule.sine(0.1, -0.2, 3.0).low == pytest.approx(-0.1)


def scene_of(drive, duration=8.0, **others):
    rigid = tribo.Asperite(m1=1.0, m2=2.0, kappa=np.inf)
    tip = tribo.Surface("tip", drive=drive, asperite=rigid, **others)
    return tribo.Scene([tip], [], duration=duration, output=tribo.Output(samples=9))


PULLED = scene_of(
    tribo.Pulled(
        stiffness=0.5, speed=[[0, 0.2], [3.3, 0.5]], load=tribo.Schedule.sine(1.0, 0.2, 3.0)
    ),
    langevin={"gamma": 1.0, "temperature": {"points": [[0, 0.1], [2, 0.3]], "kind": "steps"}},
)
PUSHED = scene_of(tribo.Pushed(force=[[[0, 0], [4, 1.0]], tribo.Schedule.sine(0.0, 0.1, 2.0)]))


@pytest.mark.parametrize("scene", [PULLED, PUSHED])
def test_file(scene):
    assert scene_from(tomllib.loads(scene.to_toml())) == scene
    assert Effect.SCHEDULE in scene.effects


def test_keys():
    for key, before, value in (
        ("tip.drive.speed.1.0", 3.3, 5.0),
        ("tip.drive.load.period", 3.0, 4.0),
        ("tip.langevin.temperature.1.1", 0.3, 0.5),
    ):
        assert is_parameter(PULLED, key)
        assert value_of(PULLED, key) == before
        assert value_of(with_values(PULLED, {key: value}), key) == value
    keys = {"tip.drive.force.0.1.1": 2.0, "tip.drive.force.1.amplitude": 0.3}
    x, y = with_values(PUSHED, keys).surfaces[0].drive.force
    assert (x.points[1][1], y.amplitude) == (2.0, 0.3)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"tip.drive.speed.2.0": 1.0}, "tip.drive.speed.2: must be below the number of points, 2"),
        ({"tip.drive.speed.x": 1.0}, "must be the number of a point"),
        ({"tip.drive.load.mass": 1.0}, "must be one of mean, amplitude, period, phase of a sine"),
        ({"tip.drive.speed.0.0": 9.0}, "must not be before the time of the point before"),
        ({"tip.drive.speed.0.0": 1.0, "tip.drive.speed": 2.0}, "cannot go with tip.drive.speed"),
    ],
)
def test_refused_keys(values, message):
    with pytest.raises(tribo.InputError, match=message):
        with_values(PULLED, values)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tribo.Schedule([[0, 1], [-1, 2]]), "must not be before the time of the point"),
        (lambda: tribo.Schedule([[0, 1], [0, 2], [0, 3]]), "two equal times make a step"),
        (lambda: tribo.Schedule([]), "must be a list of .t, value."),
        (lambda: tribo.Schedule([[0, 1]], "cubic"), 'must be "linear" or "steps"'),
        (lambda: tribo.Schedule.sine(1.0, 1.0, 0.0), "period: must be positive"),
        (
            lambda: tribo.Pulled(stiffness=1.0, speed=[[0, "a"]]),
            r"speed\[0\]\[1\]: must be a number",
        ),
        (lambda: tribo.Pulled(stiffness=1.0, speed={"mean": 1.0, "amplitude": 1.0}), "period"),
        (lambda: tribo.Langevin(1.0, [[0, 1.0], [1, -1.0]]), "temperature.*must not be negative"),
        (lambda: tribo.Langevin(1.0, tribo.Schedule.sine(1.0, 2.0, 1.0)), "must not be negative"),
        (lambda: tribo.Langevin(1.0, tribo.Schedule.sine(0.1, -0.2, 3.0)), "must not be negative"),
        (lambda: tribo.Pushed(force=[[0, 1], [2, 3]]), "each of which may be a schedule"),
        (
            lambda: tribo.Pushed(force=[[[0, 1]], 0.0], rate=[1, 0]),
            "must be zero beside a schedule",
        ),
        (
            lambda: tribo.Pulled(stiffness=1.0, position=tribo.Schedule([[0, 0], [1, 1]], "steps")),
            "must have no steps",
        ),
        (
            lambda: tribo.Pulled(stiffness=1.0, speed=1.0, position=[[0, 0]]),
            "cannot go with a speed",
        ),
    ],
)
def test_refused(make, message):
    with pytest.raises(tribo.InputError, match=message):
        make()
