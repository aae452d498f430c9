"""The keys of a page set what the same keys of --set set."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import InputError
from tribo.live_pages.controls import controls_of
from tribo.live_pages.inputs import INPUTS
from tribo.live_pages.keys import Key, keys_of, numbers_at
from tribo.live_pages.source import check
from tribo.model.parameters import value_of, with_values

SCENE = tribo.paper.scene("A")
OTHER = tribo.paper.scene("E")
KEYS = keys_of(SCENE)
CUT = replace(SCENE, interactions=(tribo.LennardJones(0.3, 1.0).with_cutoff(2.5),))


@pytest.mark.parametrize("scene", [SCENE, CUT, tribo.paper.scene("E")])
def test_each_key(scene):
    """A value of a key, as a page sets it, gives the numbers of the scene with that value."""
    before, keys = numbers_at(scene), keys_of(scene)
    assert len(keys) > 25
    for key in keys:
        value = key.value + 0.0625 * (abs(key.value) or 1.0)
        numbers = before.copy()
        for part in key.parts:
            numbers[part.place] = part.factor * value + part.constant
        wanted = numbers_at(with_values(scene, {key.key: value}))
        assert numbers == pytest.approx(wanted, rel=1e-14, abs=1e-15), key


def test_every_number_has_a_key():
    """But for those that say what kind a surface is, and the observer's velocity."""
    reached = {part.place for key in keys_of(SCENE) for part in key.parts}
    of_choices = {
        place
        for choice in controls_of(SCENE, None, KEYS).choices
        for each in choice.words.values()
        for place, _ in each
    }
    left = set(range(numbers_at(SCENE).size)) - reached - of_choices
    assert len(left) == 10 and max(left) < INPUTS  # facing, rest, height, ends; the observer


def test_usual_controls():
    keys = [control.key for control in controls_of(SCENE, None, KEYS).shown]
    assert keys[:3] == ["interaction.strength", "upper.bob.1", "upper.velocity"]
    assert keys[-2:] == ["upper.drive", "duration"]
    assert "lower.velocity" in [each.key for each in controls_of(OTHER, None, keys_of(OTHER)).shown]


def test_given_controls(tmp_path):
    given = {"title": "Titel", "upper.velocity": {"range": [0.1, 1.0], "label": "Tempo"}}
    controls = controls_of(SCENE, given, KEYS)
    (shown,) = controls.shown
    assert (shown.low, shown.high, shown.label, shown.value) == (0.1, 1.0, "Tempo", 0.5)
    assert controls.words == {"title": "Titel"}
    assert controls_of(SCENE, given | {"panel": "Energy"}, KEYS).words["panel"] == "Energy"
    file = tmp_path / "controls.toml"
    file.write_text('title = "Titel"\n["upper.velocity"]\nrange = [0.1, 1.0]\nlabel = "Tempo"\n')
    assert controls_of(SCENE, file, KEYS) == controls


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"upper.speed": None}, "controls.upper.speed: has no control"),
        ({"upper.velocity": [1.0, 1.0]}, "a range whose first number is the lower one"),
        ({"upper.asperite.m1": [-1.0, 1.0]}, "must be positive"),
        ({"upper.velocity": 3.0}, "must be a range"),
        (3, "controls: must be a mapping"),
        ({"panel": "Heat"}, "controls.panel: must be one of End value, Energy"),
        ({"title": 5}, "controls.title: must be text in quotes, got 5"),
        ({"titel": "x"}, 'controls.titel: has no control: .*did you mean "title"?'),
        ({"upper.velocty": None}, 'did you mean "upper.velocity"?'),
        (
            {"upper": {"velocity": [0.1, 1.0]}},
            'quotes in a TOML file, as "upper.velocity"',
        ),
        (
            {"upper": {"velocity": {"label": "v"}}},
            'in a TOML file, as "upper.velocity"',
        ),
        ({"interaction": {"strength": [0.1, 1.0]}}, 'file, as "interaction.strength"'),
        ({"upper.velocity": [2.0, 3.0]}, r"contains the scene's value 0.5, got \[2.0, 3.0\]"),
    ],
)
def test_wrong_controls(given, problem):
    with pytest.raises(InputError, match=problem):
        controls_of(SCENE, given, KEYS)


def test_one_of_two_numbers():
    """Keys as upper.bob.1 set one of two numbers, in --set and everywhere."""
    moved = with_values(SCENE, {"upper.bob.1": 0.5, "upper.velocity.0": 0.25, "lower.bob.0": 1.0})
    assert moved.surfaces[0].bob == (-10.0, 0.5) and moved.surfaces[0].velocity == (0.25, 0.0)
    assert moved.surfaces[1].bob == (1.0, 0.0)
    assert value_of(moved, "upper.bob.1") == 0.5
    assert with_values(SCENE, {"*.bob.1": 0.5}).surfaces[1].bob == (0.0, 0.5)
    both = {"upper.bob": (0.0, 0.0), "upper.bob.1": 1.0}
    with pytest.raises(InputError, match=r"upper\.bob\.1: cannot go with upper\.bob"):
        with_values(SCENE, both)
    with pytest.raises(InputError, match="must be a number"):
        with_values(SCENE, {"upper.bob.1": "high"})
    grid = tribo.sweep(replace(SCENE, duration=1.0), {"upper.bob.1": [0.2, 0.4]}, keep=["upper.w1"])
    assert grid.sizes["upper.bob.1"] == 2


ELASTIC = {"shape": (4, 1), "spacing": (3.0, 3.0), "elastic": tribo.Elastic(1.0, 0.3)}
PULLED = tribo.Pulled(stiffness=1.0, speed=tribo.Schedule([[0.0, 0.0], [5.0, 0.5]]))
SHAKEN = tribo.Moved(speed=(0.5765, tribo.Schedule.sine(mean=0.0, amplitude=0.1, period=2.0)))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"shape": (20, 10), "spacing": (3.0, 3.0)}, "it has 201 asperites"),
        ({"langevin": tribo.Langevin(gamma=0.1)}, "it has langevin"),
        ({"langevin": tribo.Langevin(gamma=0.1, on="swing")}, "it has swing langevin"),
        (ELASTIC | {"drive": tribo.Free(load=0.0)}, "it has elastic body"),
    ],
)
def test_what_cannot_go_in(change, reason):
    """A sentence says why, and what to do."""
    upper, lower = SCENE.surfaces
    scene = replace(SCENE, surfaces=(replace(upper, **change), lower))
    with pytest.raises(InputError) as caught:
        check(scene)
    assert reason in str(caught.value)
    assert "--slider" in str(caught.value) and "tribo play" in str(caught.value)


@pytest.mark.parametrize(
    "change",
    [
        {"bath": tribo.Bath(masses=[0.1], frequencies=[1.0])},
        {"asperite": tribo.Asperite(kappa=np.inf)},
        {"drive": PULLED},
        {"drive": replace(PULLED, block=True, tilt="free", load=0.1), "shape": (2, 1)},
        {"drive": SHAKEN, "velocity": (0.5765, 0.0)},
    ],
)
def test_what_can_go_in(change):
    upper, lower = SCENE.surfaces
    change = change | ({"spacing": (3.0, 0.0)} if "shape" in change else {})
    check(replace(SCENE, surfaces=(replace(upper, **change), lower)))


def test_usual_sliders_set_what_surfaces_have():
    """One slider sets all surfaces, or the one that has the number; numbers of drives have some."""
    upper, lower = SCENE.surfaces
    rigid = replace(lower, asperite=tribo.Asperite(kappa=np.inf))
    scene = replace(SCENE, surfaces=(replace(upper, drive=PULLED), rigid))
    names = ("upper.asperite.m1", "lower.asperite.m1", "upper.asperite.kappa")
    keys = [Key(key, 1.0, ()) for key in (*names, "upper.drive.stiffness")]
    found = [each.key for each in controls_of(scene, None, keys, has_choices=False).shown]
    assert found == ["upper.asperite.kappa", "*.asperite.m1", "upper.drive.stiffness"]
    with pytest.raises(InputError, match=r"controls\.\*\.asperite\.kappa"):
        controls_of(scene, {"*.asperite.kappa": None}, keys, has_choices=False)


def test_arrays():
    """Tables of points can go in, alone and in sums."""
    table = tribo.potentials.tabulated(tribo.Morse(0.3, 1.5, 1.0).energy, 0.3, 6.0, 1e-6)
    for potential in (table, tribo.Coulomb(0.2) + table):
        check(replace(SCENE, interactions=(potential,)))
