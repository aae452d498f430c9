"""Friction laws in one call: against runs by hand, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Asperite, Corrugation, Field, InputError, Langevin, Output, Pulled, Scene, Surface
from tribo.sweeps.figure import law_lines


def tip(speed=0.2, duration=20.0, **drive):
    """A damped tip that is pulled over a corrugation."""
    surface = Surface(
        "tip",
        drive=Pulled(stiffness=0.5, speed=speed, **drive),
        asperite=Asperite(kappa=100.0),
        langevin=Langevin(1.0, 0.0),
    )
    field = Field(Corrugation(0.1, 1.0), on=("tip",))
    return Scene((surface,), (), duration, fields=(field,), output=Output(samples=201))


def test_each_point_is_a_run():
    """Equal distances at all speeds, a quarter of them run-in; friction resists, so it is > 0."""
    speeds = [-0.2, -0.5]
    data = tribo.friction_law(
        tip(load=0.3), speeds=speeds, distance=8.0, step=0.02, method="verlet"
    )
    assert data["friction"].dims == ("speed",)
    for k, speed in enumerate(speeds):
        duration = 8.0 / abs(speed)
        scene = tip(speed, duration, load=0.3)
        output = replace(scene.output, series=("forces",), run_in=0.25 * duration)
        result = tribo.simulate(replace(scene, output=output), step=0.02, method="verlet")
        average = result.friction_force("tip")
        assert average.mean > 0.0  # against a slide to negative x
        assert data["friction"].values[k] == pytest.approx(average.mean, rel=1e-9)
        expected = average.half_width
        assert data["friction_half_width"].values[k] == pytest.approx(
            expected, rel=1e-9, nan_ok=True
        )
        coefficient = data["friction_coefficient"].values[k]
        assert coefficient == pytest.approx(average.mean / 0.3, rel=1e-9)
    assert data["completed"].values.tolist() == [1, 1]


def test_means_over_members():
    """Of temperatures and speeds: Student's intervals over the members of a sweep."""
    how = {"members": 4, "seed": 3, "progress": False}
    data = tribo.friction_law(tip(), speeds=[0.2], temperatures=[0.01, 0.02], **how)
    assert data["friction"].dims == ("speed", "temperature")
    keys = {"tip.drive.speed": [0.2], "tip.langevin.temperature": [0.01, 0.02]}
    own = tribo.sweep(tip(), keys, keep=["tip.friction_force"], **how)
    friction = -own["tip.friction_force"].values
    half_width = stats.t.ppf(0.975, 3) * stats.sem(friction, axis=-1)
    assert np.allclose(data["friction"], np.mean(friction, axis=-1))
    assert np.allclose(data["friction_half_width"], half_width)
    assert data.attrs["intervals"] == "members and seeds"
    axes = law_lines(data)
    assert axes.get_xlabel() == "temperature" and "tip" in axes.get_ylabel()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "loads: is missing; give"),
        ({"loads": [0.1]}, "loads: need a surface whose drive has a load"),
        ({"speeds": [0.1, 0.0]}, "all positive or all negative"),
        ({"speeds": [0.1, -0.1]}, "all positive or all negative"),
        ({"temperatures": [-1.0]}, r"temperatures\[0\]"),
        ({"temperatures": [0.1], "distance": 1.0}, "distance: needs speeds"),
        ({"speeds": [0.1], "keep": ["tip.W"]}, "keep: cannot be given"),
        ({"speeds": [0.1], "surface": "top"}, "surface: must be one of tip"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(InputError, match=message):
        tribo.friction_law(tip(), **arguments)
