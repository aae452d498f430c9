"""Scene files: a loaded scene equals the saved one, and missing keys have their defaults."""

import codecs
import copy
import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

import tribo
from support.scene_tables import scene_from
from support.strategies import scenes
from tribo import Coulomb, Interaction, LennardJones, Morse, Numerics, Output, Scene, Surface
from tribo.layout.layout import lay_out

# The example of the contract: as short as it can be, and with every default written out.
SHORT = """
duration = 40.0
[interaction]
potential = "coulomb"
strength = 0.2
[[surface]]
name = "upper"
bob = [-10.0, 0.0]
velocity = [0.5, 0.0]
[[surface]]
name = "lower"
facing = "up"
"""
LONG = """
title = ""
duration = 40.0
seed = 0
[[interaction]]
between = ["upper", "lower"]
potential = "coulomb"
strength = 0.2
[[surface]]
name = "upper"
facing = "down"
bob = [-10.0, 0.0]
velocity = [0.5, 0.0]
shape = [1, 1]
spacing = [0.0, 0.0]
depth = 0.0
drive = "forced"
bars = "clamped"
springs = { stiffness = 0.0 }
bath = { oscillators = [] }
[surface.asperite]
m1 = 1.0
m2 = 2.0
kappa = 2.0
length = 2.0
bar_length = 3.0
i2 = 5.0
charge = 1.0
[[surface]]
name = "lower"
facing = "up"
bob = [0.0, 0.0]
[output]
samples = 401
"""


def again(scene, folder=None):
    """The scene written and read."""
    if folder is None:
        return scene_from(tomllib.loads(scene.to_toml()))
    scene.save(folder / "scene.toml")
    return tribo.load_scene(folder / "scene.toml")


def assert_same_layout(one, other):
    """Both scenes give kernels the same bits."""
    one = lay_out(one)
    other = lay_out(other)
    assert one.asperites.tobytes() == other.asperites.tobytes()
    assert one.model.surfaces.tobytes() == other.model.surfaces.tobytes()
    assert np.array_equal(one.start, other.start)
    assert (one.coordinates, one.accounts) == (other.coordinates, other.accounts)


def test_defaults():
    """A short file is the long one with all defaults written out."""
    short, long = (scene_from(tomllib.loads(text)) for text in (SHORT, LONG))
    assert_same_layout(short, long)
    short = short.to_table()
    long = long.to_table()
    assert long["interaction"][0].pop("between") == ["upper", "lower"]
    assert short == long


def test_defaults_are_those_of_python():
    """The same names and the same defaults in a file and in Python."""
    surfaces = (
        Surface("upper", bob=(-10.0, 0.0), velocity=(0.5, 0.0)),
        Surface("lower", facing="up"),
    )
    scene = Scene(surfaces, Coulomb(0.2), 40.0)
    assert scene.to_table() == scene_from(tomllib.loads(SHORT)).to_table()


@given(scenes(), st.integers(0, 2**40))
def test_round_trip(scene, seed):
    """Saving and loading keeps every part of a scene to the last bit."""
    scene = replace(scene, seed=seed, title='A "title", with = signs\nand lines')
    loaded = again(scene)
    assert loaded == scene and hash(loaded) == hash(scene)
    assert replace(loaded, seed=seed + 1) != scene
    assert loaded.to_table() == scene.to_table()
    assert_same_layout(loaded, scene)


SCENES = {
    "times": {"output": Output(times=(0.0, 0.1, 1.0 / 3.0))},
    "samples": {"output": Output(samples=7)},
    "accuracy": {"numerics": Numerics(accuracy=1e-5)},
    "step": {"numerics": Numerics(method="midpoint", step=0.1)},
    "morse": {"interactions": Morse(1.0, 2.0, 0.3)},
    "lennard-jones": {"interactions": LennardJones(1.0, 0.1)},
    "between": {"interactions": [Interaction(Coulomb(0.1), between=("lower", "upper"))]},
    "no interaction": {"interactions": []},
}
# Any other value a surface may have in a file.
SURFACES = {
    "positions": {"positions": [[0.0, 0.1, 0.2], [1.0, 0.0, 0.0]]},
    "heights": {"shape": [2, 1], "heights": [0.1, -0.1]},
    "drawn heights": {"shape": [3, 1], "heights": {"rms": 0.1, "seed": 3}},
    "rigid": {"drive": {"kind": "free", "rigid": True}},
    "loaded": {"drive": {"kind": "forced", "load": 0.4}},
    "pulled": {"drive": {"kind": "pulled", "stiffness": 1.5, "speed": -0.1, "load": 0.0}},
    "springs": {"shape": [3, 1], "springs": {"stiffness": 1.5, "wrap": True}},
    "springs along": {"shape": [2, 2], "springs": {"stiffness": [1.5, 0.5]}},
    "bath": {"bath": {"oscillators": [{"mass": 0.1, "frequency": 2.0}], "temperature": 0.1}},
    "drude": {"bath": {"spectrum": "drude", "gamma": 0.1, "cutoff": 2.0, "n": 3}},
    "langevin": {"langevin": {"gamma": 0.1, "temperature": 0.2}},
    "driven bars": {"drive": "bars"},
    "damped swing": {"langevin": {"gamma": 0.1, "temperature": 0.2, "on": "swing"}},
    "rigid asperites": {"asperite": {"kappa": math.inf}},
    "each rigid": {"shape": [2, 1], "asperite": {"kappa": [math.inf, math.inf]}},
    "free bars": {"bars": "free", "initial": {"phi": 0.1, "nu": [0.1]}},
    "swing": {"initial": {"swing": 0.25, "omega": -0.5}},
    "each": {"shape": [2, 1], "asperite": {"m1": [1.0, 0.1 + 0.2], "charge": [1, -1]}},
}
ENDS = {"cutoff": 2.5}, {"cutoff": 2.5, "at_cutoff": "shift"}, {"cutoff": 2.5, "switch_from": 1.0}


@pytest.mark.parametrize("name", SCENES)
def test_round_trip_of_a_scene(tmp_path, name):
    """Saving and loading keeps each setting of a scene."""
    plain = scene_from(tomllib.loads(SHORT))
    scene = replace(plain, **SCENES[name])
    assert again(scene, tmp_path) == scene != plain
    assert again(scene, tmp_path).to_table() == scene.to_table()
    assert again(scene, tmp_path).output == scene.output
    assert again(scene, tmp_path).numerics == scene.numerics


@pytest.mark.parametrize("name", SURFACES)
def test_round_trip_of_a_surface(tmp_path, name):
    """Saving and loading keeps each setting of a surface."""
    table = tomllib.loads(SHORT)
    table["surface"][1] |= copy.deepcopy(SURFACES[name])
    scene = scene_from(table)
    assert again(scene, tmp_path).to_table() == scene.to_table()
    assert_same_layout(again(scene, tmp_path), scene)
    plain = scene_from(tomllib.loads(SHORT))
    assert again(scene, tmp_path) == scene != plain
    assert scene.to_table()["surface"][1] != plain.to_table()["surface"][1]


@pytest.mark.parametrize("end", ENDS, ids=str)
def test_round_trip_of_a_cutoff(tmp_path, end):
    """Saving and loading keeps each kind of cutoff."""
    table = tomllib.loads(SHORT)
    table["interaction"] |= end
    scene = scene_from(table)
    assert again(scene, tmp_path).to_table() == scene.to_table()
    assert again(scene, tmp_path) == scene
    assert {"cutoff", "at_cutoff"} <= set(scene.to_table()["interaction"][0])


def test_round_trip_of_a_field_and_a_box(tmp_path):
    """Periodic scenes, and fields that move."""
    table = tomllib.loads(SHORT)
    table["interaction"]["cutoff"] = 2.5
    table["periodic"] = {"z": 30.0}
    table["field"] = [
        {
            "kind": "corrugation",
            "on": ["lower"],
            "amplitude": 0.1,
            "period": 0.7,
            "velocity": [0.5, 0.0],
        }
    ]
    scene = scene_from(table)
    assert again(scene, tmp_path).to_table() == scene.to_table()
    assert scene.periodic.x is None and scene.periodic.z == 30.0


def test_one_number_per_asperite():
    """A list in a file becomes an array in the scene; a number applies to all asperites."""
    table = tomllib.loads(SHORT)
    table["surface"][1] |= {"shape": [2, 1], "spacing": [1.0, 0.0]}
    table["surface"][1]["asperite"] = {"m1": [1.0, 3.0], "kappa": 4}
    table["surface"][1]["initial"] = {"theta": [3.0, 3.5]}
    scene = scene_from(table)
    assert np.array_equal(scene.surfaces[1].asperite.m1, [1.0, 3.0])
    layout = lay_out(scene)
    assert np.array_equal(layout.asperites.mass, [3.0, 3.0, 5.0])
    assert np.array_equal(layout.asperites.kappa, [2.0, 4.0, 4.0])
    assert np.array_equal(layout.start[1:3], np.array([3.0, 3.5]) - np.pi)


def test_swing_counts_from_the_rest_angle():
    """It has one meaning for both facings, and starts what theta = rest + swing starts."""
    table = tomllib.loads(SHORT)
    for surface in table["surface"]:
        surface["initial"] = {"swing": 0.25}
    scene = scene_from(table)
    assert np.array_equal(lay_out(scene).start[:2], [0.25, 0.25])
    assert scene.to_table()["surface"][1]["initial"] == {"swing": 0.25}
    for surface, theta in zip(table["surface"], (0.25, np.pi + 0.25), strict=True):
        surface["initial"] = {"theta": theta}
    assert np.allclose(lay_out(scene_from(table)).start[:2], 0.25, rtol=0.0, atol=1e-15)


PLUGIN = """
from typing import NamedTuple
class Own(NamedTuple):
    s: float
    n: float = 1.0
    def energy(self, r): return self.s / r**self.n
"""


def test_plugin_lies_beside_the_file(tmp_path, monkeypatch):
    """The path of a plug-in is relative to the scene file's folder, not the working directory."""
    (tmp_path / "scenes" / "own").mkdir(parents=True)
    (tmp_path / "scenes" / "own" / "own.py").write_text(PLUGIN)
    table = tomllib.loads(SHORT)
    table["interaction"] = {"potential": "own/own.py:Own", "s": 2}
    path = tmp_path / "scenes" / "scene.toml"
    path.write_text(tomli_w.dumps(table))
    for place in (tmp_path, tmp_path / "scenes"):
        monkeypatch.chdir(place)
        scene = tribo.load_scene(path.relative_to(place))
        potential = scene.interactions[0].potential
        assert tuple(potential) == (2.0, 1.0) and type(potential).__name__ == "Own"
    scene.save(tmp_path / "saved.toml")
    saved = tribo.load_scene(tmp_path / "saved.toml")
    assert type(saved.interactions[0].potential) is type(potential)
    assert saved.to_table() == scene.to_table() and saved == scene


def test_file_is_replaced_or_left_alone(tmp_path):
    """Saving writes UTF-8; a failure leaves no file."""
    scene = replace(scene_from(tomllib.loads(SHORT)), title="Gleitreibung — µ")
    path = tmp_path / "scene.toml"
    scene.save(path)
    assert tomllib.loads(path.read_text(encoding="utf-8"))["title"] == "Gleitreibung — µ"
    with pytest.raises(tribo.InputError, match="must be in a folder"):
        scene.save(tmp_path / "nowhere" / "scene.toml")
    assert [p.name for p in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.thorough
def test_short_text_and_file(tmp_path):
    """Defaults are written on request alone; what is printed of a scene fits on a line."""
    scene = tribo.paper.scene("D")
    for defaults in (False, True):
        path = tmp_path / f"{defaults}.toml"
        scene.save(path, defaults=defaults)
        assert tribo.load_scene(path) == scene
        assert ("accuracy" in path.read_text() or "samples" in path.read_text()) == defaults
    assert len(repr(scene)) < 120 and "upper (1), lower (1), Coulomb" in repr(scene)
    assert repr(scene.surfaces[0]).startswith("<Surface 'upper': 1 asperite facing down, free")
    assert len(repr(tribo.explain(scene))) < 200


def test_files_that_begin_with_a_mark(tmp_path):
    """Notepad writes one before UTF-8: in scene files and in plug-ins, whose force is derived."""
    plugin = "import tribo\nclass Own(tribo.Potential):\n    s: float\n"
    plugin += "    def energy(self, r):\n        return self.s / r\n"
    (tmp_path / "own.py").write_bytes(codecs.BOM_UTF8 + plugin.encode())
    scene = 'title = "µ"\nduration = 1.0\ninteraction = { potential = "own.py:Own", s = 0.2 }\n'
    scene += 'surface = [{ name = "upper" }, { name = "lower", facing = "up" }]\n'
    (tmp_path / "scene.toml").write_bytes(codecs.BOM_UTF8 + scene.encode())
    found = tribo.load_scene(tmp_path / "scene.toml")
    (interaction,) = found.interactions
    assert found.title == "µ" and interaction.potential.force(2.0) == 0.2 / 4.0
    assert type(interaction.potential).force.__qualname__ == "force"  # from the formula
    # The same in this process after an edit.
    (tmp_path / "own.py").write_text(plugin.replace("/ r", "/ r**2"))
    (interaction,) = tribo.load_scene(tmp_path / "scene.toml").interactions
    assert interaction.potential.force(2.0) == pytest.approx(0.4 / 8.0, abs=1e-16)
    assert type(interaction.potential).force.__qualname__ == "force"
