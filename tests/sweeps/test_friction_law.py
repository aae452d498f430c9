"""Friction laws in one call: against runs by hand, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Asperite, Corrugation, Field, InputError, Langevin, Output, Pulled, Scene, Surface
from tribo.sweeps.figure import law_lines
from tribo.sweeps.friction_law import _total_load


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
    assert data.attrs["intervals"] == "members"
    axes = law_lines(data)
    assert axes.get_xlabel() == "temperature" and "tip" in axes.get_ylabel()


def test_intervals_over_surfaces():
    """Members of a surface are no further surfaces: only the means of these are independent."""
    row = {"shape": (6, 1), "spacing": (1.0, 0.0)}
    upper = Surface(
        "upper",
        bob=(0.0, 1.1),
        heights={"rms": 0.1},
        drive=Pulled(stiffness=1.0, speed=0.5, load=0.2),
        langevin=Langevin(1.0, 0.001),
        **row,
    )
    lower = Surface("lower", facing="up", drive="bars", **row)
    rough = Scene(
        (upper, lower),
        tribo.LennardJones(0.1, 1.0).with_cutoff(2.0),
        10.0,
        periodic={"x": 6.0},
        output=Output(samples=41, run_in=2.0),
    )
    how = {"members": 5, "progress": False, "surface": "upper"}
    data = tribo.friction_law(rough, temperatures=[0.001], seeds=[1, 2, 3], **how)
    keys = {"upper.langevin.temperature": [0.001], "seed": [1, 2, 3]}
    own = tribo.sweep(rough, keys, 5, keep=["upper.friction_force"], progress=False)
    means = np.mean(-own["upper.friction_force"].values, axis=-1)  # (temperatures, seeds)
    assert np.ptp(means) > 1e-3
    assert np.allclose(data["friction"], np.mean(means, axis=-1))
    half_width = stats.t.ppf(0.975, 2) * stats.sem(means, axis=-1)
    assert np.allclose(data["friction_half_width"], half_width)
    assert data.attrs["intervals"] == "seeds" and data["completed"].values.tolist() == [15]


def test_the_load_of_a_block_is_that_of_all_its_asperites():
    """One load presses the block, however many asperites carry it; else each has its own."""
    for block, load in ((True, 0.4), (False, 1.2)):
        drive = Pulled(stiffness=1.0, speed=1.0, load=0.4, block=block)
        row = {"shape": (3, 1), "spacing": (1.0, 0.0), "asperite": Asperite(kappa=np.inf)}
        assert float(_total_load(Surface("s", drive=drive, **row), {}, 1)) == pytest.approx(load)


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
