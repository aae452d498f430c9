"""Fields of a user's own that depend on time: motion, work, files, members, continuation."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tribo
from tribo import Asperite, Corrugation, Field, Free, InputError, Numerics, Output, Scene, Surface


class Wave(NamedTuple):
    """A standing wave with an amplitude that swings, by its energy alone."""

    amplitude: float
    rate: float

    def energy_at_time(self, t, x, y):
        return self.amplitude * (1.0 + 0.5 * np.sin(self.rate * t)) * np.cos(2.0 * x) + 0.1 * y


class WholeWave(NamedTuple):
    """The same with its derivatives."""

    amplitude: float
    rate: float

    def energy_at_time(self, t, x, y):
        return self.amplitude * (1.0 + 0.5 * np.sin(self.rate * t)) * np.cos(2.0 * x) + 0.1 * y

    def force_at_time(self, t, x, y):
        now = self.amplitude * (1.0 + 0.5 * np.sin(self.rate * t))
        return 2.0 * now * np.sin(2.0 * x), -0.1

    def power_at_time(self, t, x, y):
        return self.amplitude * 0.5 * self.rate * np.cos(self.rate * t) * np.cos(2.0 * x)


FILE = """
from typing import NamedTuple

import numpy as np


class Wave(NamedTuple):
    amplitude: float
    rate: float

    def energy_at_time(self, t, x, y):
        return self.amplitude * (1.0 + 0.5 * np.sin(self.rate * t)) * np.cos(2.0 * x) + 0.1 * y
"""
TOML = """
duration = 6.0
[[surface]]
name = "tip"
shape = [3, 1]
spacing = [0.7, 0.0]
bob = [0.3, 0.0]
velocity = [0.2, 0.0]
drive = "free"
asperite = { m1 = 1.2, m2 = 0.8, kappa = inf }
[[field]]
kind = "wave.py:Wave"
amplitude = 0.4
rate = 1.7
on = ["tip"]
velocity = [0.1, 0.0]
[output]
samples = 7
series = ["forces"]
"""
MASS = 2.0


def scene(wave=Wave, amplitude=0.4, **settings):
    tip = Surface(
        "tip",
        bob=(0.3, 0.0),
        shape=(3, 1),
        spacing=(0.7, 0.0),
        velocity=(0.2, 0.0),
        asperite=Asperite(m1=1.2, m2=0.8, kappa=math.inf),
        drive=Free(),
    )
    field = Field(wave(amplitude, 1.7), on=("tip",), velocity=(0.1, 0.0))
    output = Output(samples=7, series=("forces",))
    return Scene(
        **{
            "surfaces": (tip,),
            "interactions": (),
            "duration": 6.0,
            "output": output,
            "fields": (field,),
        }
        | settings
    )


def reference(x0, end=6.0, amplitude=0.4, begun=0.0, start=None, t0=0.0):
    """x and y, their velocities, and the work of the agent that moves and changes the field."""

    def rates(t, state):
        x, _, vx, vy, _ = state
        now = amplitude * (1.0 + 0.5 * np.sin(1.7 * (t - begun)))
        at = 2.0 * (x - 0.1 * t)
        force = 2.0 * now * np.sin(at)
        power = amplitude * 0.85 * np.cos(1.7 * (t - begun)) * np.cos(at) + 0.1 * force
        return [vx, vy, force / MASS, -0.1 / MASS, power]

    state = [x0, 0.0, 0.2, 0.0, 0.0] if start is None else start
    return solve_ivp(rates, (t0, end), state, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]


HOW = [
    {"method": "gauss-radau-15", "accuracy": 1e-9},
    {"method": "rkn8", "accuracy": 1e-9},
    {"method": "kahan-li-8", "step": 0.02},
]


@pytest.mark.parametrize("wave", [Wave, WholeWave])
@pytest.mark.parametrize("how", HOW, ids=lambda how: how["method"])
def test_motion_and_work_are_those_of_the_energy(wave, how):
    result = tribo.simulate(scene(wave), **how)
    assert not result.notes
    work = 0.0
    for k, x0 in enumerate((0.3, 1.0, 1.7)):
        x, y, vx, vy, done = reference(x0)
        work += done
        for name, wanted in (("x_cm", x), ("y_bob", y), ("vx_cm", vx), ("vy_cm", vy)):
            assert result["tip"][name][-1, k] == pytest.approx(wanted, abs=1e-7)
    assert result.system["applied_work"][-1] == pytest.approx(work, abs=1e-7)
    change = result.system["total_energy_change"] - result.system["applied_work"]
    assert np.max(np.abs(change)) <= 1e-8


def test_files_name_the_class(tmp_path):
    (tmp_path / "wave.py").write_text(FILE)
    (tmp_path / "scene.toml").write_text(TOML)
    given = tribo.load_scene(tmp_path / "scene.toml")
    found = tribo.simulate(given, accuracy=1e-9)
    wanted = tribo.simulate(scene(), accuracy=1e-9)
    assert np.max(np.abs(found["tip"]["x_cm"] - wanted["tip"]["x_cm"])) <= 1e-8
    given.save(tmp_path / "again.toml")
    assert tribo.load_scene(tmp_path / "again.toml") == given
    found.save(tmp_path / "result.nc")
    again = tribo.load_result(tmp_path / "result.nc")
    assert np.array_equal(again["tip"]["x_cm"], found["tip"]["x_cm"])


@pytest.mark.parametrize("how", HOW[1:], ids=lambda how: how["method"])
def test_members_and_points_are_single_runs(how):
    """Nine members, in lanes; and points of a sweep over numbers of the field."""
    own = replace(scene(), numerics=Numerics(**how), output=Output(samples=2))
    starts = np.linspace(0.0, 0.8, 9)
    keep = ["tip.x_cm", "applied_work"]
    data = tribo.ensemble(own, 9, {"tip.x": starts}, keep=keep, progress=False)
    for k in (0, 8):
        tip = replace(own.surfaces[0], initial={"x": starts[k]})
        alone = tribo.simulate(replace(own, surfaces=(tip,)))
        gap = data["tip.x_cm"].values[k] - alone["tip"]["x_cm"][-1]
        assert np.max(np.abs(gap)) <= 1e-7
        done = alone.system["applied_work"][-1]
        assert data["applied_work"].values.ravel()[k] == pytest.approx(done, abs=1e-7)
    points = tribo.sweep(own, {"field.amplitude": [0.2, 0.4]}, keep=["tip.x_cm"])
    for amplitude, found in zip((0.2, 0.4), points["tip.x_cm"].values, strict=True):
        assert found.ravel()[1] == pytest.approx(reference(1.0, amplitude=amplitude)[0], abs=1e-7)


def test_time_goes_on_from_a_state_and_begins_with_a_changed_field():
    how = HOW[0]
    first = tribo.simulate(scene(duration=2.5), **how)
    state = first.state()
    whole = tribo.simulate(scene(), **how)
    rest = tribo.simulate(scene(), start=state, **how)
    for name in ("x_cm", "w_field"):
        assert np.max(np.abs(rest["tip"][name][-1] - whole["tip"][name][-1])) <= 1e-8
    # The same field under another load of the scene goes on too.
    other = tribo.simulate(scene(periodic={"x": 50.0}), start=state, **how)
    assert np.max(np.abs(other["tip"]["x_cm"][-1] - whole["tip"]["x_cm"][-1])) <= 1e-8
    weaker = tribo.simulate(scene(amplitude=0.3), start=state, **how)
    x, y, vx, vy, _ = reference(1.0, end=2.5)
    wanted = reference(0, amplitude=0.3, begun=2.5, start=[x, y, vx, vy, 0.0], t0=2.5)
    assert weaker["tip"]["x_cm"][-1, 1] == pytest.approx(wanted[0], abs=1e-7)


def test_an_equal_step_run_continues_bit_for_bit():
    how = {"method": "kahan-li-8", "step": 0.02}
    whole = tribo.simulate(scene(), **how)
    first = tribo.simulate(scene(duration=3.0, output=Output(samples=4)), **how)
    rest = tribo.simulate(scene(), start=first.state(), **how)
    assert np.array_equal(rest["tip"]["x_cm"][-1], whole["tip"]["x_cm"][-1])


class Both(NamedTuple):
    strength: float

    def energy_at(self, x, y):
        return self.strength * x

    def energy_at_time(self, t, x, y):
        return self.strength * x * t


class Wrong(NamedTuple):
    """Its power is not that of its energy."""

    strength: float

    def energy_at_time(self, t, x, y):
        return self.strength * t * x * x

    def power_at_time(self, t, x, y):
        return 0.5 * self.strength * x * x


def test_two_energies_are_refused_and_a_wrong_power_is_noticed():
    with pytest.raises(InputError, match="not both"):
        Field(Both(1.0), on=("tip",))
    with pytest.warns(tribo.TriboWarning, match="budget does not close"):
        tribo.simulate(scene(fields=(Field(Wrong(0.3), on=("tip",)),)), accuracy=1e-6)
    assert Field(Corrugation(1.0, 1.0), on=("tip",)).changes is False
