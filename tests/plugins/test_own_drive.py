"""What the class of a user's drive declares of its force, and the page on drives."""

import os
import re
import subprocess
import sys
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support import page_diffs
from tribo import InputError


class Opposed(NamedTuple):
    """The forced drive, where the share is 1."""

    share: float

    cancels_x = True
    cancels_y = True
    depends_on_velocity = False

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return -self.share * fx, -fy


class Spring(NamedTuple):
    """The pulled drive."""

    stiffness: float
    anchor: float
    speed: float

    cancels_y = True
    depends_on_velocity = False
    drives_along_x = True

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return self.stiffness * (self.anchor + self.speed * t - x), -fy


def scene(drive) -> tribo.Scene:
    """A pair, whose upper asperite passes the lower one."""
    upper = tribo.Surface("upper", bob=(-3.0, 1.0), velocity=(0.5, 0.0), drive=drive)
    lower = tribo.Surface("lower", facing="up")
    return tribo.Scene((upper, lower), tribo.Coulomb(0.2), 8.0, output=tribo.Output(samples=5))


PAIRS = {
    "forced": (Opposed(1.0), tribo.Forced()),
    "pulled": (Spring(0.5, -3.0, 0.4), tribo.Pulled(stiffness=0.5, speed=0.4)),
}


@pytest.mark.parametrize("name", PAIRS)
def test_a_drive_that_declares_its_force_is_laid_out_as_the_built_in_one(name):
    """The same degrees of freedom; what it cancels cannot be displaced."""
    own, built_in = (scene(d) for d in (tribo.Custom(force=PAIRS[name][0]), PAIRS[name][1]))
    upper, other = own.surfaces[0], built_in.surfaces[0]
    assert own.slides_along_x(upper) == built_in.slides_along_x(other)
    assert own.slides_along_y(upper) == built_in.slides_along_y(other)
    with pytest.raises(InputError, match=r"initial\.y: cannot be given, as the drive holds"):
        tribo.Scene([tribo.Surface("a", drive=upper.drive, initial=tribo.Initial(y=0.1))], [], 1.0)


@pytest.mark.parametrize("name", PAIRS)
def test_it_runs_by_a_method_of_positions(name):
    """With the works of the built-in drive, by Nystrom and by composition."""
    own, built_in = (scene(d) for d in (tribo.Custom(force=PAIRS[name][0]), PAIRS[name][1]))
    exact = tribo.simulate(built_in, accuracy=1e-10)
    for method in ("rkn8", "kahan-li-6"):
        result = tribo.simulate(own, method=method, accuracy=1e-7)
        for quantity in ("x_cm", "y_cm", "theta", "w1", "w2", "w2_ps"):
            error = np.max(np.abs(result["upper"][quantity] - exact["upper"][quantity]))
            assert error <= result.error_estimate[quantity] + exact.error_estimate[quantity]
        change, work = (result.ledger.system[k] for k in ("total_energy_change", "applied_work"))
        assert np.max(np.abs(change - work)) < 1e-6


@pytest.mark.thorough
def test_members_run_with_the_bits_of_single_runs():
    """In the lanes of a method of positions."""
    own = scene(tribo.Custom(force=PAIRS["pulled"][0]))
    values = [0.0, 0.1, 0.2]
    vary, how = {"upper.theta": values}, {"method": "rkn8", "accuracy": 1e-6}
    members = tribo.ensemble(own, 3, vary=vary, keep=["upper.w2"], **how)
    assert np.all(np.isfinite(members["upper.w2"].values))


def test_a_position_only_flag_is_needed_for_methods_of_positions():
    """Without it the drive may depend on velocities."""
    silent = type("Silent", (Spring,), {"depends_on_velocity": True})
    with pytest.raises(InputError, match="needs forces that depend on positions only"):
        tribo.prepare(scene(tribo.Custom(force=silent(0.5, -3.0, 0.4))), method="rkn8")


def with_flags(**flags):
    """The spring with other flags."""
    return type("Mine", (Spring,), flags)(0.5, -3.0, 0.4)


@pytest.mark.parametrize(
    ("drive", "said"),
    [
        (with_flags(cancels_x=True), "force.cancels_x: is declared, but force_on_bar gives gx ="),
        (with_flags(cancels_y=1), "force.cancels_y: must be true or false, got 1"),
        (
            with_flags(cancel_x=True),
            'force.cancel_x: is not a known flag; did you mean "cancels_x"',
        ),
        (Opposed(0.5), "force.cancels_x: is declared, but force_on_bar gives gx = -0.45 where"),
    ],
)
def test_flags_that_are_wrong_are_refused(drive, said):
    """Where the drive is made."""
    with pytest.raises(InputError, match=re.escape(said)):
        tribo.Custom(force=drive)


def test_a_force_that_depends_on_velocities_against_its_flag_is_refused():
    """By a call with another velocity."""

    def damped(self, t, x, y, vx, vy, fx, fy):
        return -self.stiffness * vx, -fy

    with pytest.raises(InputError, match="another force at another velocity"):
        tribo.Custom(force=with_flags(force_on_bar=damped))


DASHPOT = """
import numpy as np, tribo
drive = tribo.Dashpot(damping=1.5, speed=0.4)
tip = tribo.Surface("tip", drive=drive, asperite=tribo.Asperite(m1=1.0, m2=2.0, kappa=np.inf))
scene = tribo.Scene([tip], [], duration=3.0)
scene.save("scene.toml")
assert tribo.load_scene("scene.toml") == scene and not scene.slides_along_y(tip)
if RUN:
    tip = tribo.simulate(scene)["tip"]
    velocity = tip["vx_cm"][-1, 0]
    assert abs(velocity - 0.4 * (1.0 - np.exp(-1.5))) < 1e-7
    assert abs(tip.w2[-1, 0] - 1.5 * velocity**2) < 1e-7
    points = tribo.sweep(scene, {"tip.drive.damping": [0.5, 1.5]}, keep=["tip.vx_cm"])
    assert abs(float(points["tip.vx_cm"][1, 0]) - velocity) < 1e-7
"""


@pytest.mark.parametrize("run", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_drive_of_the_page(tmp_path, run):
    """Three files, of which the diff applies, give a drive of scene files, runs and sweeps."""
    assert len(page_diffs.files("a_drive")) == 3
    sources = page_diffs.applied("a_drive", tmp_path)
    environment = os.environ | {"PYTHONPATH": str(sources)}
    program = DASHPOT.replace("RUN", str(run))
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env=environment, check=True)


def test_a_load_that_changes_is_kept_in_files(tmp_path):
    """Of a drive of one's own, as of all others."""
    file = tmp_path / "brake.py"
    file.write_text(
        "from typing import NamedTuple\n"
        "class Brake(NamedTuple):\n"
        "    drag: float\n"
        "    def force_on_bar(self, t, x, y, vx, vy, fx, fy):\n"
        "        return -self.drag * vx, -fy\n"
    )
    load = {"mean": 0.3, "amplitude": 0.1, "period": 2.0, "phase": 0.0}
    drive = {"kind": f"{file}:Brake", "drag": 0.1, "load": load}
    own = tribo.Scene((tribo.Surface("tip", drive=drive),), (), 1.0)
    own.save(tmp_path / "scene.toml")
    again = tribo.load_scene(tmp_path / "scene.toml")
    assert again.surfaces[0].drive.load == own.surfaces[0].drive.load
    assert again.to_toml() == own.to_toml() and "amplitude" in own.to_toml()
    result = tribo.simulate(again, method="rk4", step=0.05)
    result.save(tmp_path / "run.nc")
    assert tribo.load_result(tmp_path / "run.nc").status == "completed"
