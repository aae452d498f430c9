"""Keys that may stand together, tables as parts of scenes, numbers inside potentials by key."""

import tomllib

import pytest

import tribo
from support.command import main
from support.scene_tables import scene_from
from tribo import InputError
from tribo.model.binding import bound, check_arguments
from tribo.model.parameters import is_parameter, value_of, with_values
from tribo.sliders import sliders_of

PAIR = tribo.paper.scene("A")


def test_a_key_of_one_surface_comes_before_that_of_all():
    """In any order; a value that is given twice, or to no surface, is refused."""
    for keys in (("*.asperite.m1", "lower.asperite.m1"), ("lower.asperite.m1", "*.asperite.m1")):
        values = {key: 3.0 if key[0] == "l" else 2.0 for key in keys}
        found = with_values(PAIR, values).surfaces
        assert [surface.asperite.m1 for surface in found] == [2.0, 3.0]
    assert bound(PAIR, {"*.initial.theta": 0.1}) == {"upper.theta": 0.1, "lower.theta": 0.1}
    with pytest.raises(InputError, match=r"^upper\.initial\.theta: is given twice"):
        bound(PAIR, {"upper.theta": 0.1, "upper.initial.theta": 0.2})
    with pytest.raises(InputError, match=r"^\*\.theta: has no effect"):
        bound(PAIR, {"*.theta": 0.1, "upper.theta": 0.1, "lower.theta": 0.1})


@pytest.mark.parametrize(
    "keys",
    [
        ("upper.swing", "upper.theta"),
        ("upper.swing_state", "upper.theta"),
        ("*.swing_state", "lower.swing"),
        ("*.swing_state", "lower.omega"),
        ("*.swing_state", "upper.temperature"),
    ],
)
def test_keys_that_exclude_each_other(keys):
    """One of them would have no effect."""
    one, other = ({key: tribo.Canonical(0.1) if "state" in key else [0.1]} for key in keys)
    with pytest.raises(InputError, match=f"cannot go with {keys[1]}; give one or the other"):
        tribo.ensemble(PAIR, 1, one | other)
    with pytest.raises(InputError, match="cannot go with"):
        tribo.sweep(PAIR, other, 2, one)


@pytest.mark.parametrize(
    ("key", "argument"),
    [
        ("numerics.step", "step"),
        ("numerics.step", "accuracy"),
        ("numerics.accuracy", "step"),
        ("numerics.method", "method"),
        ("numerics.allow_unresolved", "allow_unresolved"),
        ("output.keep", "keep"),
        ("output.samples", "samples"),
    ],
)
def test_settings_beside_arguments(key, argument):
    """Of a key and of the table of its part; other arguments go with it."""
    part, _, name = key.partition(".")
    for values in ({key: 1.0}, {part: {name: 1.0}}):
        with pytest.raises(InputError, match=f"^{key}: cannot go with {argument}"):
            check_arguments(values, {argument: "given"})
        check_arguments(values, {argument: None, "allow_unresolved": False})


def test_the_same_refusals_of_commands_and_sliders(tmp_path, capsys):
    """Each caller names the key."""
    path = tmp_path / "a.toml"
    PAIR.save(path)
    refused = {
        ("run", "--set", "numerics.step=0.1", "--step", "0.2"): "--set numerics.step: cannot go",
        ("run", "--set", "output.samples=5", "--samples", "7"): "--set output.samples: cannot go",
        ("ensemble", "--set", "upper.theta=0.1", "--vary", "upper.theta=normal(0,1)"): "is set too",
        ("ensemble", "--set", "upper.theta=0.1", "--vary", "*.swing_state=canonical(0.1)"): (
            "cannot go with upper.theta"
        ),
        ("sweep", "--set", "numerics.step=0.1,0.2", "--step", "0.2"): "--set numerics.step: cannot",
        ("view", "--slider", "upper.theta=0:1", "--slider", "upper.swing=0:1"): "cannot go with",
    }
    for (command, *options), message in refused.items():
        assert main([command, str(path), *options]) == 2
        assert message in capsys.readouterr().err
    with pytest.raises(InputError, match=r"upper\.swing: cannot go with upper\.theta"):
        sliders_of(PAIR, {"upper.theta": (0.0, 1.0), "upper.swing": (0.0, 1.0)})


def test_parts_of_scenes_as_tables():
    """A mapping with the keys of the file is the object that it describes, in Python and by key."""
    field = {"kind": "corrugation", "amplitude": 0.1, "period": 1.0, "on": ["row"]}
    contact = {"potential": "coulomb", "strength": 0.2, "cutoff": 3.0, "between": ["row", "row"]}
    settings = {"output": {"samples": 3}, "numerics": {"accuracy": 1e-5}, "periodic": {"x": 30.0}}
    row = tribo.Surface("row", asperite={"kappa": 4.0}, initial={"swing": 0.1}, shape=(3, 1))
    found = tribo.Scene([row], contact, 2.0, fields=field, **settings)
    objects = tribo.Surface(
        "row", asperite=tribo.Asperite(kappa=4.0), initial=tribo.Initial(swing=0.1), shape=(3, 1)
    )
    assert found == tribo.Scene(
        [objects],
        [tribo.Interaction(tribo.Coulomb(0.2).with_cutoff(3.0), ("row", "row"))],
        2.0,
        fields=[tribo.Field(tribo.Corrugation(0.1, 1.0), ["row"])],
        output=tribo.Output(samples=3),
        numerics=tribo.Numerics(accuracy=1e-5),
        periodic=tribo.Periodic(x=30.0),
    )
    bare = tribo.Scene([tribo.Surface("row", shape=(3, 1))], (), 2.0)
    tables = {"row.asperite": {"kappa": 9.0}, "row.initial": {"swing": 0.1}, **settings}
    tables |= {"row.asperite.kappa": 4.0, "interaction": contact, "field": field}
    assert with_values(bare, tables) == found
    for wrong in ({"asperite": {"kapa": 1.0}}, {"initial": {"swin": 1.0}}):
        with pytest.raises(InputError, match="is not a known key; did you mean"):
            tribo.Surface("row", **wrong)


LJ = tribo.LennardJones(0.2, 1.0)
SUM = LJ.with_cutoff(2.5, "shift") + tribo.Coulomb(0.1) + tribo.Morse(0.2, 0.4, 1.0)


@pytest.mark.parametrize(
    ("potential", "key", "expected"),
    [
        (2.0 * LJ, "factor", lambda x: x * LJ),
        (2.0 * LJ, "of.epsilon", lambda x: 2.0 * tribo.LennardJones(x, 1.0)),
        (LJ + tribo.Coulomb(0.1), "second.strength", lambda x: LJ + tribo.Coulomb(x)),
        (
            (LJ + tribo.Coulomb(0.1)).with_cutoff(4.0, "shift"),
            "first.epsilon",
            lambda x: (tribo.LennardJones(x, 1.0) + tribo.Coulomb(0.1)).with_cutoff(4.0, "shift"),
        ),
        (
            (0.5 * SUM).with_cutoff(4.0),
            "of.first.cutoff",
            lambda x: (0.5 * (LJ.with_cutoff(x, "shift") + SUM.second)).with_cutoff(4.0),
        ),
        (
            SUM,
            "second.second.D",
            lambda x: LJ.with_cutoff(2.5, "shift") + tribo.Coulomb(0.1) + tribo.Morse(x, 0.4, 1.0),
        ),
    ],
)
def test_numbers_inside_potentials(potential, key, expected):
    """They are set, found and saved; the rest of the potential stays."""
    scene = tribo.Scene(PAIR.surfaces, potential, 2.0)
    key = f"interaction.{key}"
    found = with_values(scene, {key: 1.7})
    (interaction,) = found.interactions
    assert repr(interaction.potential) == repr(expected(1.7))
    assert is_parameter(scene, key) and value_of(found, key) == 1.7
    assert scene_from(tomllib.loads(found.to_toml())) == found
    assert found != scene
    for wrong, problem in (
        ("interaction.third.D", "is not a known key"),
        (key + "D", "not a known"),
    ):
        with pytest.raises(InputError, match=problem):
            with_values(scene, {wrong: 1.0})
