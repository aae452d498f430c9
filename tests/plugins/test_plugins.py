"""Drives, ends and fields by plug-ins: they act as the built-in ones with the same formula."""

import inspect
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from tribo import Custom, Ends, InputError, load_scene, paper


class Opposed(NamedTuple):
    """f2 = -share f1 along x, -f1 along y: the forced drive for share = 1, the free one for 0."""

    share: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return -self.share * fx, -fy


class Spring(NamedTuple):
    """The pulled drive."""

    stiffness: float
    anchor: float
    speed: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return self.stiffness * (self.anchor + self.speed * t - x), -fy


class Held(NamedTuple):
    """The clamped bar's f_L = -f_R."""

    kappa: float
    bar_length: float

    def end_forces(self, t, phi, nu, twist):
        end = self.kappa * twist / self.bar_length
        return -end * np.sin(phi), end * np.cos(phi), end * np.sin(phi), -end * np.cos(phi)


class Waves(NamedTuple):
    """A corrugation without a force of its own."""

    amplitude: float
    period: float

    def energy_at(self, x, y):
        return -self.amplitude * np.cos(2.0 * np.pi * x / self.period)


def case(**upper) -> tribo.Scene:
    """The paper's case A around the encounter, with some of the upper surface changed."""
    scene = replace(paper.scene("A"), duration=12.0, output=tribo.Output(samples=4))
    return replace(
        scene,
        surfaces=(replace(scene.surfaces[0], bob=(-4.0, 0.0), **upper), scene.surfaces[1]),
    )


def assert_alike(own: tribo.Scene, built_in: tribo.Scene) -> None:
    """Every quantity of the two scenes agrees within their error estimates."""
    # The loop of dop853 compiles in half the time of that of gauss-radau-15.
    first = tribo.simulate(own, accuracy=1e-9, method="dop853")
    second = tribo.simulate(built_in, accuracy=1e-9)
    for name in ("upper", "lower"):
        for quantity, values in first[name].items():
            bound = first.error_estimate[quantity] + second.error_estimate[quantity]
            assert np.max(np.abs(values - second[name][quantity])) <= bound, (name, quantity)


@pytest.mark.slow
def test_a_forced_drive_of_ones_own():
    assert_alike(case(drive=Custom(force=Opposed(1.0))), case(drive=tribo.Forced()))


@pytest.mark.slow
def test_a_free_drive_of_ones_own():
    assert_alike(case(drive=Custom(force=Opposed(0.0))), case(drive=tribo.Free()))


@pytest.mark.slow
def test_a_pulled_drive_of_ones_own():
    own = Custom(force=Spring(0.5, -4.0, 0.4))
    assert_alike(case(drive=own), case(drive=tribo.Pulled(stiffness=0.5, speed=0.4)))


@pytest.mark.slow
def test_ends_of_ones_own():
    kicked = {"initial": tribo.Initial(theta=0.3, phi=0.1, omega=-0.2)}
    assert_alike(case(bars=Ends(Held(2.0, 3.0)), **kicked), case(bars="clamped", **kicked))


@pytest.mark.slow
def test_a_field_of_ones_own():
    own, built_in = (
        replace(case(), fields=[tribo.Field(waves, ["upper"])])
        for waves in (Waves(0.05, 1.3), tribo.Corrugation(0.05, 1.3))
    )
    assert_alike(own, built_in)


def test_what_depends_on_velocities_is_refused_by_splitting():
    scene = case(drive=Custom(force=Opposed(1.0)))
    with pytest.raises(InputError, match=r"^method: .*kahan-li-6"):
        tribo.simulate(scene, method="kahan-li-6", step=0.01)


HEAD = "from typing import NamedTuple\nimport numpy as np\n"
SCENE = """
duration = 12.0
[output]
samples = 4
[interaction]
potential = "coulomb"
strength = 0.2
[[field]]
kind = "own.py:Waves"
on = ["upper"]
amplitude = 0.05
period = 1.3
[[surface]]
name = "upper"
bob = [-4.0, 0.0]
velocity = [0.5, 0.0]
drive = {kind = "own.py:Opposed", share = 1.0}
bars = {ends = "own.py:Held", kappa = 2.0, bar_length = 3.0}
initial = {theta = 0.3, phi = 0.1, omega = -0.2}
[[surface]]
name = "lower"
facing = "up"
"""


def test_plugins_from_a_file(tmp_path):
    """A drive, ends and a field together act as the built-in ones.

    The path is relative to the scene file, and a saved scene finds the classes again.
    """
    sources = [inspect.getsource(kind) for kind in (Opposed, Held, Waves)]
    (tmp_path / "own.py").write_text(HEAD + "".join(sources))
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = load_scene(tmp_path / "scene.toml")
    scene.save(tmp_path / "again.toml")
    again = load_scene(tmp_path / "again.toml")
    assert again.surfaces[0].drive == scene.surfaces[0].drive
    assert again.surfaces[0].bars == scene.surfaces[0].bars
    assert again.fields == scene.fields
    built_in = case(initial=tribo.Initial(theta=0.3, phi=0.1, omega=-0.2))
    fields = [tribo.Field(tribo.Corrugation(0.05, 1.3), ["upper"])]
    assert_alike(again, replace(built_in, fields=fields))
