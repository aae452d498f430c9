"""Values of a scene by dotted keys: each gives the scene whose file has that value."""

from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.scene_tables import scene_from
from tribo import InputError
from tribo.model.parameters import is_parameter, value_of, with_values

BASE = {
    "duration": 4.0,
    "interaction": {"potential": "coulomb", "strength": 0.2, "cutoff": 4.0},
    "field": [{"kind": "corrugation", "amplitude": 0.1, "period": 2.0, "on": ["upper"]}],
    "surface": [
        {
            "name": "upper",
            "bob": [-1.0, 0.0],
            "velocity": [0.5, 0.1],
            "shape": [2, 1],
            "spacing": [3.0, 0.0],
            "drive": {"kind": "pulled", "stiffness": 2.0, "speed": 0.5},
            "langevin": {"gamma": 0.2},
            "bath": {"spectrum": "drude", "gamma": 0.3, "cutoff": 2.0, "n": 4},
            "initial": {"theta": 0.2},
        },
        {"name": "lower", "facing": "up"},
    ],
}


def changed(path, value):
    """The scene of BASE with another value in its table."""
    table = scene_from(BASE).to_table()
    place = table
    for name in path[:-1]:
        place = place[name] if not isinstance(place, dict) else place.setdefault(name, {})
    place[path[-1]] = value
    return scene_from(table)


@pytest.mark.parametrize(
    ("key", "value", "path"),
    [
        ("duration", 5.0, ["duration"]),
        ("seed", 3, ["seed"]),
        ("interaction.strength", 0.4, ["interaction", 0, "strength"]),
        ("interaction.at_cutoff", "switch", ["interaction", 0, "at_cutoff"]),
        ("field.amplitude", 0.7, ["field", 0, "amplitude"]),
        ("field.velocity", [0.1, 0.0], ["field", 0, "velocity"]),
        ("upper.velocity", [0.7, 0.2], ["surface", 0, "velocity"]),
        ("upper.theta", [0.3, 0.4], ["surface", 0, "initial", "theta"]),
        ("upper.omega", 0.4, ["surface", 0, "initial", "omega"]),
        ("lower.swing", 0.4, ["surface", 1, "initial", "swing"]),
        ("upper.asperite.kappa", [1.0, 3.0], ["surface", 0, "asperite", "kappa"]),
        ("upper.drive.load", 0.4, ["surface", 0, "drive", "load"]),
        ("upper.drive.speed", 0.9, ["surface", 0, "drive", "speed"]),
        ("lower.drive.kind", "free", ["surface", 1, "drive", "kind"]),
        ("upper.langevin.temperature", 0.1, ["surface", 0, "langevin", "temperature"]),
        ("lower.langevin.gamma", 0.1, ["surface", 1, "langevin", "gamma"]),
        ("upper.bath.n", 7, ["surface", 0, "bath", "n"]),
        ("upper.bath.temperature", 0.1, ["surface", 0, "bath", "temperature"]),
        ("upper.springs.stiffness", 0.6, ["surface", 0, "springs", "stiffness"]),
        ("upper.bob", [-2.0, 0.5], ["surface", 0, "bob"]),
        ("upper.shape", [3, 1], ["surface", 0, "shape"]),
        ("upper.initial.theta", 0.4, ["surface", 0, "initial", "theta"]),
        ("upper.drive", "free", ["surface", 0, "drive"]),
        ("lower.bars", "free", ["surface", 1, "bars"]),
        ("output.samples", 11, ["output", "samples"]),
        ("numerics.accuracy", 1e-6, ["numerics", "accuracy"]),
        ("periodic.x", 40.0, ["periodic", "x"]),
        ("title", "other", ["title"]),
    ],
)
def test_value_of_a_file(key, value, path):
    """The scene is that of the file with the value, and not the one before."""
    scene = scene_from(BASE)
    found = with_values(scene, {key: value}).to_table()
    assert found == changed(path, value).to_table()
    unchanged = key == "interaction.at_cutoff"
    assert (found == scene.to_table()) == unchanged


def test_all_surfaces_and_other_potentials():
    """A star means all surfaces; another potential keeps the parameters that both have."""
    scene = scene_from(BASE)
    found = with_values(scene, {"*.asperite.m1": 2.0, "lower.asperite.m1": 3.0})
    assert [surface.asperite.m1 for surface in found.surfaces] == [2.0, 3.0]
    values = {"interaction.potential": "yukawa", "interaction.screening": 0.5}
    found = with_values(scene, values).interactions[0].potential
    assert found == tribo.Yukawa(0.2, 0.5).with_cutoff(4.0)
    shifted = with_values(scene, {"interaction.at_cutoff": "shift"})
    found = with_values(shifted, values).interactions[0].potential
    assert found == tribo.Yukawa(0.2, 0.5).with_cutoff(4.0, "shift")
    with pytest.raises(InputError, match=r"interaction\.D: is missing; needed too: alpha, r0$"):
        with_values(scene, {"interaction.potential": "morse"})
    values = {"upper.drive": "free", "upper.drive.load": 0.3}
    assert with_values(scene, values).surfaces[0].drive == tribo.Free(load=0.3)
    assert value_of(scene, "upper.drive") == "pulled"
    assert (
        value_of(scene, "interaction.strength") == 0.2 and value_of(scene, "upper.velocity") == 0.5
    )
    assert value_of(scene, "upper.theta") == 0.2 and value_of(scene, "duration") == 4.0


def test_several_values():
    """Values of one part are set together; one number of a velocity is its x component."""
    scene = with_values(
        scene_from(BASE),
        {
            "upper.velocity": np.float64(0.9),
            "upper.swing": 0.1,
            "interaction.cutoff": 2.0,
            "interaction.strength": 0.1,
        },
    )
    upper = scene.surfaces[0]
    assert upper.velocity == (0.9, 0.1)
    assert upper.initial.theta is None and upper.initial.swing == 0.1
    potential = scene.interactions[0].potential
    assert (potential.potential.strength, potential.cutoff) == (0.1, 2.0)
    assert potential.switch_from == pytest.approx(1.8)


def test_a_number_of_samples_takes_the_place_of_times():
    """Times of a scene would contradict another number of samples."""
    scene = tribo.Scene([tribo.Surface("s")], [], 4.0, output=tribo.Output(times=(0.0, 1.0, 4.0)))
    times = with_values(scene, {"output.samples": 11}).times
    assert times == pytest.approx(np.linspace(0.0, 4.0, 11))


class Brake(NamedTuple):
    """A drag."""

    drag: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """The force."""
        return -self.drag * vx, -fy


@pytest.mark.parametrize("name", ["field", "interaction"])
def test_a_surface_with_the_name_of_a_part(name):
    """Its keys are those of the part, which the scene may not have: in a sentence."""
    scene = tribo.Scene((tribo.Surface(name), tribo.Surface("lower", facing="up")), (), 1.0)
    for key in (f"{name}.theta", "*.theta"):
        with pytest.raises(InputError, match=f"needs one {name}, and the scene has 0"):
            with_values(scene, {key: 0.1})


def test_values_of_plug_ins():
    """Plug-ins that no file could name have theirs too."""
    surface = tribo.Surface("block", drive=tribo.Custom(force=Brake(0.1)))
    scene = tribo.Scene((surface,), (), 1.0)
    assert is_parameter(scene, "block.drive.drag") and is_parameter(scene, "block.drive.load")
    drive = with_values(scene, {"block.drive.drag": 0.5, "block.drive.load": 2.0}).surfaces[0].drive
    assert (drive.force, drive.load) == (Brake(0.5), 2.0)


@pytest.mark.parametrize(
    ("key", "value", "field", "problem"),
    [
        ("speed", 1.0, "speed", "is not a known key"),
        ("uper.theta", 1.0, "uper.theta", 'did you mean "upper.theta"?'),
        ("upper.tetha", 1.0, "upper.tetha", 'did you mean "theta"?'),
        ("uper.speed", 1.0, "uper.speed", 'did you mean "upper.drive.speed"?'),
        ("m1", 1.0, "m1", 'did you mean "upper.asperite.m1" or "lower.asperite.m1"?'),
        ("samples", 9, "samples", 'did you mean "output.samples"?'),
        ("xyz", 9, "xyz", "known here: duration"),
        ("upper.asperite.mass", 1.0, "upper.asperite.mass", "is not a known key"),
        ("upper.m1", 1.0, "upper.m1", 'did you mean "upper.asperite.m1"?'),
        ("upper.asperite.kappa", -1.0, "upper.asperite.kappa", "must not be negative"),
        ("upper.drive.load", "heavy", "upper.drive.load", "must be a number"),
        ("lower.drive.stiffness", 1.0, "lower.drive.stiffness", "is not a known key"),
        ("lower.langevin.temperature", 1.0, "lower.langevin.gamma", "is missing"),
        ("lower.bath.gamma", 1.0, "lower.bath.spectrum", "is missing"),
        ("interaction.strenght", 1.0, "interaction.strenght", 'did you mean "strength"?'),
        ("interaction.cutoff", -1.0, "interaction.cutoff", "must be positive"),
        ("interaction.strength", "0.2eV", "interaction.strength", "must be a number"),
        ("upper.asperite.kappa.1", 1.0, "upper.asperite.kappa.1", "the surfaces are"),
        ("field.period", -1.0, "field.period", "must be positive"),
        ("duration", -1.0, "duration", "must be positive"),
    ],
)
def test_refusals(key, value, field, problem):
    """A wrong key or value is named, with what would do."""
    with pytest.raises(InputError) as caught:
        with_values(scene_from(BASE), {key: value})
    assert caught.value.field == field and problem in caught.value.problem


def test_hints_at_one_of_two_reservoirs():
    """Keys of the part that is named, and not the temperature of the start."""
    reservoirs = [{"gamma": 0.1, "on": "bar"}, {"gamma": 0.5, "on": "swing"}]
    scene = tribo.Scene((tribo.Surface("block", langevin=reservoirs),), (), 1.0)
    hint = 'known key; did you mean "block.langevin.bar.temperature" or "block.langevin.swing.t'
    with pytest.raises(InputError, match=hint):
        with_values(scene, {"block.langevin.temperature": 0.1})
    with pytest.raises(InputError, match=r"known here: block\.langevin\.bar\.gamma, block\.l"):
        with_values(scene, {"block.langevin.xyz": 0.1})


def test_the_only_interaction():
    """Without an interaction its keys are refused."""
    scene = tribo.Scene((tribo.Surface("one"),), (), 1.0)
    with pytest.raises(InputError, match="needs one interaction, and the scene has 0"):
        with_values(scene, {"interaction.strength": 1.0})
