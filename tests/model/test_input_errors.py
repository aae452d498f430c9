"""Invalid input: one sentence that names the field, exit status 2, and no file written."""

import copy
import math
import re
import warnings
from datetime import date
from typing import NamedTuple

import numpy as np
import pytest
import tomli_w
import xarray
from hypothesis import example, given
from hypothesis import strategies as st

import tribo
from support.command import main
from tribo import (
    Asperite,
    Coulomb,
    Custom,
    DrivenBars,
    Ends,
    Forced,
    Free,
    Initial,
    InputError,
    Interaction,
    Langevin,
    Morse,
    Numerics,
    Output,
    Pulled,
    Scene,
    Surface,
)
from tribo.layout.layout import lay_out
from tribo.model.scene_file import scene_from
from tribo.validation import one_of

REMOVED = object()
HUGE = 10**400  # TOML has such numbers, floats have not

# A scene with every key of a scene file, so that the tests can replace any of them.
VALID = {
    "title": "valid",
    "duration": 1.0,
    "seed": 0,
    "periodic": {"x": 50.0, "z": 50.0},
    "interaction": [
        {
            "potential": "morse",
            "D": 1.0,
            "alpha": 2.0,
            "r0": 0.3,
            "cutoff": 3.0,
            "at_cutoff": "switch",
            "switch_from": 2.0,
            "between": ["upper", "lower"],
        }
    ],
    "field": [
        {
            "kind": "corrugation",
            "on": ["upper"],
            "amplitude": 0.1,
            "period": 2.0,
            "origin": [0.0, 0.0],
            "velocity": [0.0, 0.0],
        }
    ],
    "surface": [
        {
            "name": "upper",
            "facing": "down",
            "bob": [-3.0, 0.0],
            "velocity": [0.5, 0.0],
            "shape": [2, 1],
            "spacing": [1.0, 0.0],
            "depth": 0.0,
            "heights": [0.0, 0.1],
            "drive": {"kind": "pulled", "stiffness": 1.0, "speed": 0.1, "load": 0.2},
            "bars": "free",
            "springs": {"stiffness": 1.0, "wrap": False},
            "bath": {
                "oscillators": [{"mass": 0.1, "frequency": 2.0}],
                "torsional": [{"inertia": 0.1, "frequency": 2.0}],
                "temperature": 0.0,
            },
            "langevin": {"gamma": 0.1, "temperature": 0.0},
            "asperite": {
                "m1": 1.0,
                "m2": [2.0, 2.5],
                "kappa": 2.0,
                "length": 2.0,
                "bar_length": 3.0,
                "i2": 5.0,
                "charge": 1.0,
            },
            "initial": {"theta": 0.1, "phi": 0.0, "omega": [0.0, 0.1], "nu": 0.0},
        },
        {
            "name": "lower",
            "facing": "up",
            "positions": [[0.0, -0.5, 0.0], [1.0, -0.5, 0.0]],
            "drive": {"kind": "free", "rigid": True},
            "springs": {"stiffness": 1.0, "pairs": [[0, 1]], "turned": 0.1},
            "bath": {"spectrum": "drude", "gamma": 0.1, "cutoff": 2.0, "n": 3},
            "langevin": {"gamma": 0.1, "velocity": [0.0, 0.0]},
        },
        {
            "name": "rough",
            "bob": [0.0, 9.0],
            "shape": [8, 1],
            "spacing": [1.0, 0.0],
            "heights": {"rms": 0.1, "hurst": 0.8, "shortest": 2.0, "longest": 8.0, "seed": 1},
        },
    ],
    "output": {"samples": 11},
    "numerics": {"accuracy": 1e-6},
}


def steps(path):
    """The keys and indices along a path as messages write it: ``surface[0].asperite.m1``."""
    return [int(key) if key.isdigit() else key for key in re.findall(r"[^.\[\]]+", path)]


def changed(*changes):
    """The valid scene with some of its values replaced, by path."""
    table = copy.deepcopy(VALID)
    for path, value in changes:
        *way, last = steps(path)
        place = table
        for key in way:
            place = place[key]
        if value is REMOVED:
            del place[last]
        else:
            place[last] = value
    return table


def paths(value, path=""):
    """Every path in a nested table."""
    items = []
    if isinstance(value, dict):
        items = [(f"{path}.{key}".lstrip("."), item) for key, item in value.items()]
    elif isinstance(value, list):
        items = [(f"{path}[{i}]", item) for i, item in enumerate(value)]
    for where, item in items:
        yield where
        yield from paths(item, where)


# The most characters of a message, but for the name of a folder.
TWO_LINES = 200


def message(folder, capsys, source, *options):
    """The message of ``tribo run`` for an invalid scene file; checks that no file is written."""
    file = folder / "scene.toml"
    file.write_bytes(source if isinstance(source, bytes) else tomli_w.dumps(source).encode())
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    status = main(["run", str(file), *(options or ("--out", str(folder / "out.nc")))])
    printed = capsys.readouterr()
    assert status == 2
    assert printed.out == ""
    assert {path: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before
    assert printed.err.startswith("tribo: ") and printed.err.count("\n") == 1, printed.err
    assert len(printed.err.replace(str(folder), "")) <= TWO_LINES, printed.err
    return printed.err.removeprefix("tribo: ").rstrip("\n")


def test_a_message_quotes_some_of_many_names():
    """As many as fit in a line, and how many there are."""
    with pytest.raises(InputError, match=r"\.\.\. \(1000 in all\), got 'x'$") as error:
        one_of("name", "x", [f"surface{k}.friction_force" for k in range(1000)])
    assert len(str(error.value)) <= TWO_LINES
    with pytest.raises(InputError, match=r"^name: must be one of a, b, got 'x'$"):
        one_of("name", "x", ("a", "b"))


# The path of a key, an invalid value, and the beginning of the message; then the field of the
# message if it is another one, or inside the value.
WRONG = [
    # unknown keys at every level, with a hint
    ("durations", 1.0, 'is not a known key; did you mean "duration"?'),
    ("xyz", 1.0, "is not a known key; known here: title, duration"),
    ("line\nbreak", 1.0, "is not a known key", "'line\\nbreak'"),
    ("output.sample", 3, 'is not a known key; did you mean "samples"?'),
    ("numerics.stepp", 3, 'is not a known key; did you mean "step"?'),
    ("periodic.y", 3.0, "is not a known key"),
    ("interaction[0].d", 3.0, "is not a known key"),
    ("interaction[0].cut_off", 3.0, "is not a known key"),
    ("field[0].ampltude", 3.0, 'is not a known key; did you mean "amplitude"?'),
    ("surface[0].bobs", 3.0, 'is not a known key; did you mean "bob"?'),
    ("surface[0].asperite.M1", 1.0, "is not a known key; known here: m1, m2"),
    ("surface[0].initial.thet", 1.0, 'is not a known key; did you mean "theta"?'),
    ("surface[0].drive.sped", 1.0, 'is not a known key; did you mean "speed"?'),
    ("surface[0].springs.rap", 1.0, 'is not a known key; did you mean "wrap"?'),
    ("surface[0].bath.xyz", 1.0, "is not a known key"),
    ("surface[0].bath.oscillators[0].xyz", 1.0, "is not a known key"),
    ("surface[0].langevin.gama", 1.0, 'is not a known key; did you mean "gamma"?'),
    # missing keys
    ("duration", REMOVED, "is missing"),
    ("surface", REMOVED, "is missing"),
    ("surface", [], "is missing"),
    ("surface[0].name", REMOVED, "is missing"),
    ("surface[0].drive.kind", REMOVED, "is missing"),
    ("surface[0].drive.stiffness", REMOVED, "is missing"),
    ("surface[0].langevin.gamma", REMOVED, "is missing"),
    ("surface[0].bath.oscillators[0].mass", REMOVED, "is missing"),
    ("interaction[0].potential", REMOVED, "is missing"),
    ("interaction[0].alpha", REMOVED, "is missing"),
    ("interaction[0].cutoff", REMOVED, "needs a cutoff", "interaction[0].at_cutoff"),
    ("field[0].kind", REMOVED, "is missing"),
    ("field[0].on", REMOVED, "is missing"),
    ("field[0].period", REMOVED, "is missing"),
    # the wrong type
    ("title", 5, "must be text, got 5"),
    ("duration", True, "must be a number [time], got True"),
    ("duration", "1", "must be a number [time], got '1'"),
    ("duration", [1.0], "must be a number [time], got [1.0]"),
    ("duration", {"t": 1.0}, "must be a number [time], got {'t': 1.0}"),
    ("duration", date(2020, 1, 1), "must be a number [time], got datetime.date(2020, 1, 1)"),
    ("duration", "long " * 100, "must be a number [time], got 'long long long long long long"),
    ("seed", 1.0, "must be an integer of at least 0, got 1.0"),
    ("seed", -1, "must be an integer of at least 0, got -1"),
    ("seed", True, "must be an integer of at least 0, got True"),
    ("surface", 5, "must be [[surface]] tables"),
    ("surface", {"name": "a"}, "must be [[surface]] tables"),
    ("surface[0]", 5, "must be a table, got 5"),
    ("surface[0].asperite", 5, "must be a table, got 5"),
    ("surface[0].asperite.m1", "1", "must be a number [mass], got '1'"),
    ("surface[0].asperite.m1", False, "must be a number [mass], got False"),
    ("surface[0].asperite.m1", [[1.0], 1.0], "must be a number [mass], got [1.0]", "[0]"),
    ("surface[0].asperite.m1", {}, "must be a number [mass], got {}"),
    ("surface[0].initial", [1], "must be a table, got [1]"),
    ("surface[0].initial.theta", "up", "must be a number [rad], got 'up'"),
    ("surface[0].bob", 3.0, "must be 2 numbers [length], got 3.0"),
    ("surface[0].bob", "ab", "must be 2 numbers [length], got 'ab'"),
    ("surface[0].velocity", [0.5, True], "must be a number [length / time], got True", "[1]"),
    ("surface[0].shape", [2.0, 1], "must be an integer of at least 1, got 2.0", "[0]"),
    ("surface[0].facing", "left", 'must be "down" or "up", got \'left\''),
    ("surface[0].facing", 5, 'must be "down" or "up", got 5'),
    ("surface[0].bars", "bent", 'must be "clamped" or "free", got \'bent\''),
    (
        "surface[0].drive",
        "pushed",
        'must be "forced" or "free" or "pulled" or "push" or "bars" or "moved", got',
    ),
    ("surface[0].drive", "pulled", "is missing", "surface[0].drive.stiffness"),
    ("surface[0].drive", 5, "must be a table, got 5"),
    (
        "surface[0].drive.kind",
        5,
        'must be "forced" or "free" or "pulled" or "push" or "bars" or "moved", got 5',
    ),
    ("surface[0].drive", {"kind": "bars", "load": 0.1}, "cannot go with driven bars", ".load"),
    ("surface[0].drive", {"kind": "bars", "rigid": True}, "cannot go with kind", ".rigid"),
    ("surface[0].drive", "bars", 'must be "swing" where drive = "bars"', "surface[0].langevin.on"),
    ("surface[0].langevin.on", "rod", 'must be "bar" or "swing", got \'rod\''),
    (
        "surface[1].langevin.on",
        "swing",
        'cannot go with on = "swing"',
        "surface[1].langevin.velocity",
    ),
    ("surface[0].drive.load", "x", "must be a number [force], got 'x'"),
    ("surface[0].drive.rigid", True, "is not a known key"),
    ("surface[0].drive", {"kind": "free", "rigid": 1}, "must be true or false, got 1", ".rigid"),
    ("surface[0].springs", 1.0, "must be a table, got 1.0"),
    ("surface[0].springs.wrap", 1, "must be true or false, got 1"),
    ("surface[0].bath", [], "must be a table, got []"),
    ("surface[0].bath.oscillators", 5, "must be a list"),
    ("surface[0].langevin", 5, "must be a table, got 5"),
    ("interaction", 5, "must be a table, got 5"),
    ("interaction[0]", 5, "must be a table, got 5"),
    ("interaction[0].potential", 5, "must be a name, got 5"),
    ("interaction[0].D", True, "must be a number, got True"),
    ("field", {}, "must be [[field]] tables, one for each field"),
    ("field[0]", 5, "must be a table, got 5"),
    ("field[0].on", "upper", "must be a list of names of surfaces, got 'upper'"),
    ("field[0].on", ["upper", "upper"], "must be each surface once; a field acts once on each"),
    ("field[0].on", [], "must be a list of names of surfaces, got []"),
    ("field[0].on", [5], "must be one of the surfaces upper, lower, rough, got 5"),
    ("output", 5, "must be a table, got 5"),
    ("numerics", 5, "must be a table, got 5"),
    ("periodic", 5, "must be a table, got 5"),
    # plug-ins of other kinds
    ("surface[0].drive", {"kind": "own.py:Own"}, "there is no file", ".kind"),
    ("surface[0].bars", {"ends": "own.py:Own"}, "there is no file", ".ends"),
    ("surface[0].bars", {}, "is missing", ".ends"),
    ("field[0].kind", "own.py:Own", "there is no file"),
    # numbers that are not finite, or out of range
    ("duration", math.nan, "must be a finite number [time], got nan"),
    ("duration", math.inf, "must be a finite number [time], got inf"),
    ("duration", HUGE, "must be at most 1e+100 in magnitude, got 1000000000000"),
    ("duration", 0, "must be positive [time], got 0"),
    ("duration", -1.5, "must be positive [time], got -1.5"),
    ("surface[0].asperite.m1", -1, "must be positive [mass], got -1"),
    ("surface[0].asperite.m1", [1.0, 0.0], "must be positive [mass], got 0.0", "[1]"),
    ("surface[0].asperite.m1", HUGE, "must be at most 1e+100 in magnitude, got 1000000"),
    ("surface[0].asperite.m2", 0, "must be positive [mass], got 0"),
    ("surface[0].asperite.m2", math.inf, "must be a finite number [mass], got inf"),
    ("surface[0].asperite.length", 0.0, "must be positive [length], got 0.0"),
    ("surface[0].asperite.bar_length", -3, "must be positive [length], got -3"),
    ("surface[0].asperite.i2", -5, "must be positive [mass length^2], got -5"),
    ("surface[0].asperite.kappa", -2, "must not be negative [torque / rad], got -2"),
    ("surface[0].asperite.kappa", -math.inf, "must be a finite number [torque / rad], got -inf"),
    ("surface[0].asperite.kappa", [math.inf, 2.0], "must be inf for all asperites of a surface"),
    ("surface[0].asperite.kappa", math.inf, "must be finite where bars are not clamped, got inf"),
    ("surface[0].asperite.charge", math.nan, "must be a finite number [charge], got nan"),
    (
        "surface[0].initial.omega",
        [0.0, math.nan],
        "must be a finite number [rad / time], got nan",
        "[1]",
    ),
    ("surface[0].bob", [math.nan, 0.0], "must be a finite number [length], got nan", "[0]"),
    ("surface[0].depth", math.inf, "must be a finite number [length], got inf"),
    ("surface[0].shape", [0, 1], "must be an integer of at least 1, got 0", "[0]"),
    ("surface[0].shape", [2**62, 4], "must be at most"),
    ("surface[0].drive.stiffness", -1.0, "must not be negative [force / length], got -1.0"),
    ("surface[0].springs.stiffness", -1.0, "must not be negative [force / length], got -1.0"),
    ("surface[0].bath.oscillators[0].mass", 0, "must be positive [mass], got 0"),
    ("surface[0].bath.temperature", -1, "must not be negative [energy], got -1"),
    ("surface[0].langevin.gamma", -1, "must not be negative [mass / time], got -1"),
    ("surface[1].bath.n", 0, "must be an integer of at least 1, got 0"),
    ("surface[1].bath.n", 2**62, "must be an integer of at most 10000000, got"),
    ("surface[1].springs.pairs", [[0, 0]], "must be two different asperites, got [0, 0]", "[0]"),
    ("surface[1].springs.pairs", [[0, 2]], "must be indices from 0 to 1, got (0, 2)", "[0]"),
    ("surface[1].springs.pairs", 5, "must be"),
    ("surface[1].springs.pairs", [[0, 1], [1, 0]], "must be a pair not listed before, got", "[1]"),
    ("surface[2].heights.rms", -0.1, "must not be negative [length], got -0.1"),
    ("surface[2].heights.hurst", 1.5, "must be between 0 and 1, both excluded, got 1.5"),
    (
        "surface[2].heights.longest",
        9.0,
        "must be at most the surface's side, 8.0 [length], got 9.0",
    ),
    ("interaction[0].alpha", math.nan, "must be a finite number, got nan"),
    ("interaction[0].cutoff", 0.0, "must be positive [length], got 0.0"),
    ("interaction[0].cutoff", 30.0, "must be at most half of periodic.x = 50"),
    ("interaction[0].switch_from", 3.5, "must be below the cutoff"),
    (
        "interaction[0].at_cutoff",
        "cut",
        'must be "switch" or "truncate" or "shift" or "force-shift"',
    ),
    ("interaction[0].at_cutoff", "shift", "cannot go with", "interaction[0].switch_from"),
    ("field[0].period", 0.0, "must be positive [length], got 0.0"),
    ("periodic.x", -20.0, "must be positive [length], got -20.0"),
    # lists of the wrong size
    ("surface[0].bob", [1.0], "must be 2 numbers [length], got 1"),
    ("surface[0].shape", [2], "must be 2 numbers, got 1"),
    ("surface[0].heights", [0.1], "must be 2 numbers [length], got 1"),
    (
        "surface[0].asperite.m2",
        [1.0],
        "must be one number or an array of size 2, got size 1",
    ),
    ("surface[0].asperite.m2", [], "must be one number or an array of size 2, got size 0"),
    (
        "surface[0].initial.nu",
        [1.0] * 3,
        "must be one number or an array of size 2, got size 3",
    ),
    ("surface[1].positions", [], "must be a list of [x, y, z] [length], got []"),
    ("surface[1].positions", 5, "must be a list of [x, y, z] [length], got 5"),
    ("surface[1].positions", [[0, 0]], "must be 3 numbers [length], got 2", "[0]"),
    ("field[0].origin", [0.0], "must be 2 numbers [length], got 1"),
    # names
    ("surface[0].name", 5, "must be a word"),
    ("surface[0].name", "", "must be a word"),
    ("surface[0].name", "a.b", "must be a word"),
    ("surface[0].name", "a/b", "must be a word"),
    ("surface[0].name", "a\nb", "must be a word"),
    ("surface[1].name", "upper", '"upper" is the name of another surface; give each name once'),
    ("interaction[0].potential", "mose", "'mose' is not a known name; did you mean"),
    ("interaction[0].potential", "zzzz", 'must be "coulomb", "yukawa"'),
    (
        "interaction[0].between",
        ["upper", "middle"],
        "must be one of the surfaces upper, lower, rough, got",
    ),
    ("interaction[0].between", ["upper"], "must be the names of two surfaces, got ['upper']"),
    ("interaction[0].between", "upper", "must be the names of two surfaces, got 'upper'"),
    ("interaction[0].between", [], "must be the names of two surfaces, got []"),
    ("field[0].on", ["middle"], "must be one of the surfaces upper, lower, rough, got"),
    ("field[0].kind", "corugation", 'must be "corrugation"'),
    # one or the other
    ("surface[0].initial.swing", 0.1, "cannot go with theta; give one or the other"),
    ("surface[1].bath.oscillators", [], "cannot go with spectrum; give one or the other"),
    ("surface[1].bob", [1.0, 0.0], "cannot go with positions; give one or the other"),
    ("surface[1].shape", [2, 1], "cannot go with positions; give one or the other"),
    ("surface[1].depth", 1.0, "cannot go with positions; give one or the other"),
    # times
    ("output.samples", 1, "must be an integer of at least 2, got 1"),
    ("output.samples", 5.0, "must be an integer of at least 2, got 5.0"),
    ("output.samples", 10**15, "must be an integer of at most 10000000, got 1000000000000000"),
    ("output.times", 0.5, "must be a list of numbers [time], got 0.5"),
    ("output.times", [], "must be increasing, from 0 or later [time], got []"),
    ("output.times", [0.5, 0.5], "must be increasing, from 0 or later [time], got [0.5, 0.5]"),
    ("output.times", [0.5, 0.2], "must be increasing, from 0 or later [time], got [0.5, 0.2]"),
    ("output.times", [-0.1, 0.2], "must be increasing, from 0 or later [time], got [-0.1, 0.2]"),
    ("output.times", [0.5, math.nan], "must be a finite number [time], got nan", "[1]"),
    ("output.times", [0.5, 2.0], "must end by the duration 1.0, got 2.0"),
    # numerics
    ("numerics.accuracy", 0, "must be positive, got 0"),
    ("numerics.accuracy", 1e-30, "must be from 1e-13 to 0.1, got 1e-30"),
    ("numerics.accuracy", 1, "must be from 1e-13 to 0.1, got 1"),
    ("numerics.accuracy", "fine", "must be a number, got 'fine'"),
    ("numerics", {"method": "euler"}, 'must be "midpoint" or "rk4" or', ".method"),
    ("numerics", {"method": 5}, "must be", ".method"),
    ("numerics", {"method": ""}, "must be", ".method"),
    ("numerics", {"method": "dop853", "step": 0.1}, "cannot go with dop853", ".step"),
    ("numerics", {"method": "midpoint"}, "is missing", ".step"),
    ("numerics", {"step": 0.1, "accuracy": 1e-3}, "cannot go with a step", ".accuracy"),
    ("numerics", {"step": -0.1}, "must be positive [time], got -0.1", ".step"),
]


@pytest.mark.parametrize("case", WRONG, ids=lambda case: f"{case[0]}={case[1]!r:.20}")
def test_wrong_value_in_a_scene_file(tmp_path, capsys, case):
    """The message names the field as the file does, and the problem."""
    path, value, problem, *inner = case
    field = "".join(inner)
    if not field or field[0] in "[.":
        field = path + field
    assert message(tmp_path, capsys, changed((path, value))).startswith(f"{field}: {problem}")


def test_the_valid_scene_is_valid():
    """The scene from which these tests start is valid."""
    lay_out(scene_from(changed()))


def test_two_interactions_for_one_pair(tmp_path, capsys):
    """A second interaction of a pair is refused, by name or by default."""
    again = {"potential": "coulomb", "strength": 1.0}
    for between in ({}, {"between": ["lower", "upper"]}):
        table = changed(("interaction", [*VALID["interaction"], again | between]))
        said = message(tmp_path, capsys, table)
        assert said.startswith(
            "interaction[1].between: ('upper', 'lower') have another interaction"
        )


ENERGY = "def energy(self, r): return self.s / r"


def own(*lines):
    """The text of a plug-in file: a NamedTuple with these lines in it."""
    return "\n    ".join(["from typing import NamedTuple\nclass Own(NamedTuple):", *lines, ""])


# The text of a plug-in file (None: no file), and the beginning of the message.
PLUGINS = {
    "no file": (None, "there is no file {path}"),
    "a syntax error": ("class Own(", "{path} cannot be loaded (SyntaxError: "),
    "an error when run": ("1 / 0", "{path} cannot be loaded (ZeroDivisionError: division by zero)"),
    "no such import": ("import nowhere", "{path} cannot be loaded (ModuleNotFoundError: "),
    "an exit": ("raise SystemExit(3)", "{path} cannot be loaded (SystemExit: 3)"),
    "a null byte": ("\0", "{path} cannot be loaded ("),
    "another class": ("class Other: pass", "{path} defines no Own"),
    "a function": ("def Own(): pass", "Own must be a NamedTuple whose fields are numbers"),
    "a number": ("Own = 5", "5 must be a NamedTuple whose fields are numbers"),
    "a plain class": ("class Own: s = 1.0", "Own must be a NamedTuple whose fields are numbers"),
    "no field": (own(ENERGY), "Own has no parameters; give it at least one field"),
    "no energy": (own("s: float"), "Own has no method energy(self, r)"),
    "a number as energy": (own("s: float", "energy: float = 1.0"), "Own has no method energy("),
    "energy that does not compile": (own("s: float", ENERGY.replace("self.s", "self.no")), ""),
}


@pytest.mark.parametrize("kind", PLUGINS)
def test_plugin_that_cannot_be_used(tmp_path, capsys, kind):
    """A plug-in that cannot be used is an input error of the scene that names it."""
    source, problem = PLUGINS[kind]
    path = tmp_path / "own.py"
    if source is not None:
        path.write_text(source)
    table = changed(("interaction", [{"potential": "own.py:Own", "s": 1.0}]), ("periodic", {}))
    field = "interaction[0].potential"
    said = message(tmp_path, capsys, table)
    assert said.startswith(f"{field}: {problem.format(path=path)}")


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ("n: str = 'a'", "interaction[0].n: must be a number, got 'a'"),
        ("n: float", "interaction[0].n: is missing"),
        ("n: float = float('nan')", "interaction[0].n: must be a finite number, got nan"),
    ],
)
def test_plugin_with_another_parameter(tmp_path, capsys, more, sentence):
    """Parameters of plug-ins are checked like all others, their defaults too."""
    (tmp_path / "own.py").write_text(own("s: float", more, ENERGY))
    table = changed(("interaction", [{"potential": "own.py:Own", "s": 1.0}]))
    assert message(tmp_path, capsys, table) == sentence


NAMES = ["own.py:", "own.py", ":Own", "a\0b.py:Own", "own.py:Own.x", ".py:", "/.py:A", "x" * 9999]


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_invalid_name_of_a_plugin(tmp_path, name):
    """For any invalid name of a plug-in, the message is about that field."""
    (tmp_path / "own.py").write_text("class Own: pass")
    table = changed(("interaction", [{"potential": name, "s": 1.0}]))
    with pytest.raises(InputError, match=r"^interaction\[0\]\.potential: "):
        scene_from(table, tmp_path)


# The content of a scene file, and the beginning of the message.
FILES = {
    "not TOML": (b"duration = = 1", "{path}: is not valid TOML: Invalid value (at line 1, column"),
    "a key twice": (b"duration = 1\nduration = 2\n", "{path}: is not valid TOML: Cannot overwrite"),
    "not UTF-8": (b"title = '\xff\xfe'", "{path}: is not a text file in UTF-8"),
    "too deep": (b"a = " + b"[" * 100_000, "{path}: is not valid TOML: "),
    "too long a number": (b"duration = " + b"1" * 5000, "{path}: is not valid TOML: "),
    "nothing": (b"", "duration: is missing"),
}


@pytest.mark.parametrize("kind", FILES)
def test_file_that_is_not_a_scene(tmp_path, capsys, kind):
    """The message names a file that cannot be read as TOML."""
    source, sentence = FILES[kind]
    said = message(tmp_path, capsys, source)
    expected = sentence.format(path=tmp_path / "scene.toml")
    assert said.startswith(expected)


# A wrong line of a scene file, and how the message ends.
LINES = {
    "duration = 40,0": "'duration = 40,0'; write decimals with a point, as 0.5",
    "duration = 1.000,5  # long": "; write decimals with a point, as 0.5",
    "duration = 40 s": "'duration = 40 s'; write the number without its unit",
    "duration = .2": "; write a digit before the point, as 0.5",
    "duration = 40.": "; write a digit after the point, as 1.0",
    "duration: 40.0": "; write KEY = VALUE",
    "duration = 40.0;": "; leave out the semicolon at the end",
    "duration =": "; write a value behind =",
    "title = sliding": "'title = sliding'; write words in quotes, as \"coulomb\"",
    "title = \u201csliding\u201d": '; write straight quotes, as "coulomb"',
    "periodic = {x = \u22125.0}": "; write the minus as a hyphen, -",
    "periodic.x = True": "; write true, false, inf and nan in small letters",
    "seed = 1\nseed = 2": "'seed = 2'; write each key once",
    "[surface]\n[surface]": "'[surface]'; write [[surface]] for each surface",
    "[surface]\n[[surface]]": "'[[surface]]'; write [[surface]] for the first too",
    "[output": "'[output'; close the brackets of a heading, as [output] and [[surface]]",
    "[output.x]\n[output.x]": "'[output.x]'; write each table once",
    "// a comment": "'// a comment'; begin a comment with #",
    "duration = 1.0 seed = 2": "'duration = 1.0 seed = 2'; write each key in a line of its own",
    "[output]\n[output]": "'[output]'; write each table once",
}


@pytest.mark.parametrize("line", LINES)
def test_lines_that_are_not_toml(tmp_path, capsys, line):
    """The message quotes the line and says what to write."""
    said = message(tmp_path, capsys, f"# A scene.\n{line}\n".encode())
    assert "scene.toml: is not valid TOML: " in said and said.endswith(LINES[line])


def test_a_class_may_have_a_duration(tmp_path, capsys):
    """Its field is no duration of the scene that stands at a wrong place."""
    text = b'[[interaction]]\npotential = "own.py:Own"\nduration = 2.0\n[[surface]]\nname = "a"\n'
    assert message(tmp_path, capsys, text).startswith("duration: is missing")


def test_a_duration_below_a_table(tmp_path, capsys):
    said = message(tmp_path, capsys, b'[[surface]]\nname = "upper"\nduration = 40.0\n')
    place = "must stand above the first table, as duration = 40.0; it stands under [[surface]]"
    assert said == f"duration: {place}"


def test_missing_file(tmp_path, capsys):
    """A missing file and a folder are refused."""
    for path, why in ((tmp_path / "no.toml", "No such file"), (tmp_path, "Is a directory")):
        assert main(["run", str(path)]) == 2
        assert capsys.readouterr().err.startswith(f"tribo: {path}: cannot be read ({why}")


def test_files_that_are_meant(tmp_path, capsys):
    """A file with a similar name is named; the file of a run is no scene."""
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(changed()))
    assert main(["run", str(tmp_path / "scene.tml")]) == 2
    assert capsys.readouterr().err.endswith(f'; did you mean "{tmp_path / "scene.toml"}"?\n')
    (tmp_path / "run.nc").write_bytes(b"\x89HDF\xff")
    assert main(["live", str(tmp_path / "run.nc")]) == 2
    assert "is a NetCDF file, and a scene file is needed; " in capsys.readouterr().err


def test_place_that_cannot_be_written(tmp_path, capsys):
    """The place of --out is checked before the run."""
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    places = {
        "nowhere/out.nc": f"--out: must be in a folder that exists, got {tmp_path}/nowhere",
        "file/out.nc": f"--out: must be in a folder that exists, got {tmp_path}/file",
        "folder": f"--out: must be the name of a file, got the folder {tmp_path}/folder",
    }
    for place, sentence in places.items():
        said = message(tmp_path, capsys, changed(), "--out", str(tmp_path / place))
        assert said == sentence


def pair(**settings):
    """Two surfaces that interact; some of the scene's settings replaced."""
    surfaces = (Surface("upper", bob=(-3.0, 0.0), velocity=(0.5, 0.0)), Surface("lower", "up"))
    given = {"surfaces": surfaces, "interactions": Coulomb(0.2), "duration": 1.0}
    return Scene(**(given | settings))


def surface(**settings):
    """A surface with some of its settings replaced."""
    return Surface(**({"name": "a"} | settings))


def coulomb(**settings):
    """An interaction with some settings."""
    return Interaction(Coulomb(1.0), **settings)


def simulated(**settings):
    """The pair simulated with these settings."""
    return tribo.simulate(pair(), **settings)


# A function, its arguments, and the beginning of the message.
CALLS = [
    (Asperite, {"m1": -1}, "m1: must be positive [mass], got -1"),
    (Asperite, {"m1": None}, "m1: must be a number [mass], got None"),
    (Asperite, {"m1": 1j}, "m1: must be a number [mass], got 1j"),
    (Asperite, {"m1": {1.0}}, "m1: must be a number [mass], got {1.0}"),
    (Asperite, {"m1": HUGE}, "m1: must be at most 1e+100 in magnitude, got 10000"),
    (Asperite, {"m1": 10**5000}, "m1: must be at most 1e+100 in magnitude, got an integer of"),
    (Asperite, {"m1": [1.0, HUGE]}, "m1[1]: must be at most 1e+100 in magnitude, got 1000"),
    (Asperite, {"m1": np.ones((2, 2))}, "m1[0]: must be a number [mass], got array([1., 1.])"),
    (Asperite, {"m1": np.array([1.0, np.nan])}, "m1[1]: must be a finite number [mass], got nan"),
    (Asperite, {"m1": np.array([1.0, 1e300])}, "m1[1]: must be at most 1e+100 in magnitude"),
    (Asperite, {"m1": np.array([True])}, "m1[0]: must be a number [mass], got"),
    (Asperite, {"m1": np.array("one")}, "m1: must be a number [mass], got"),
    (Initial, {"theta": "up"}, "theta: must be a number [rad], got 'up'"),
    (Initial, {"theta": 0.1, "swing": 0.1}, "swing: cannot go with theta; give one or the other"),
    (Forced, {"load": "heavy"}, "load: must be a number [force], got 'heavy'"),
    (Free, {"rigid": "yes"}, "rigid: must be true or false, got 'yes'"),
    (Pulled, {"stiffness": -1}, "stiffness: must not be negative [force / length], got -1"),
    (surface, {"name": None}, "name: must be a word"),
    (surface, {"shape": np.array(2)}, "shape: must be 2 numbers, got array(2)"),
    (
        surface,
        {"positions": np.array(1.0)},
        "positions: must be a list of [x, y, z] [length], got",
    ),
    (surface, {"asperite": {"m": 1}}, 'asperite.m: is not a known key; did you mean "m2"?'),
    (
        surface,
        {"asperite": Asperite(m1=[1, 1])},
        "asperite.m1: must be one number or an array of size 1",
    ),
    (surface, {"initial": 0.1}, "initial: must be a table, got 0.1"),
    (surface, {"drive": Coulomb(1.0)}, "drive: must be a table, got Coulomb(strength=1.0)"),
    (surface, {"drive": [1]}, "drive: must be a table, got [1]"),
    (surface, {"springs": 5}, "springs: must be a table, got 5"),
    (surface, {"bath": 5}, "bath: must be a table, got 5"),
    (surface, {"langevin": 5}, "langevin: must be a table, got 5"),
    (
        Interaction,
        {"potential": "coulomb"},
        "potential: must be a potential, of a class that derives from tribo.Potential",
    ),
    (Interaction, {"potential": Coulomb}, "potential: "),
    (Interaction, {"potential": Coulomb("x")}, "strength: must be a number, got 'x'"),
    (Interaction, {"potential": Morse(1.0, 2.0, math.nan)}, "r0: must be a finite number, got n"),
    (coulomb, {"between": 5}, "between: must be the names of two surfaces, got 5"),
    (coulomb, {"between": ("a",)}, "between: must be the names of two surfaces, got ('a',)"),
    (Output, {"samples": "many"}, "samples: must be an integer of at least 2, got 'many'"),
    (Output, {"times": 5}, "times: must be a list of numbers [time], got 5"),
    (Numerics, {"method": 0}, "method: must be"),
    (pair, {"surfaces": ()}, "surface: is missing; give at least one surface"),
    (pair, {"surfaces": Surface("a")}, "surface: is missing; give at least one surface"),
    (pair, {"surfaces": ["a"]}, "surface[0]: must be a tribo.Surface, got 'a'"),
    (
        pair,
        {"interactions": None},
        "interaction: must be a potential or a list of potentials,",
    ),
    (
        pair,
        {"interactions": [5]},
        "potential: must be a potential, of a class that derives from tribo.Potential",
    ),
    (pair, {"duration": None}, "duration: must be a number [time], got None"),
    (pair, {"duration": 5e-324}, "duration: must be at least 1e-100 [time], got 5e-324"),
    (pair, {"title": None}, "title: must be text, got None"),
    (pair, {"output": 5}, "output: must be a table, got 5"),
    (pair, {"numerics": 1e-3}, "numerics: must be a table, got 0.001"),
    (pair, {"periodic": 5}, "periodic: must be a table, got 5"),
    (pair, {"fields": 5}, "field: must be a list of fields, got 5"),
    (
        pair().save,
        {"path": "/nowhere/at/all.toml"},
        "/nowhere/at/all.toml: must be in a",
    ),
    (tribo.prepare, {"scene": 5}, "scene: must be a tribo.Scene, got 5"),
    (tribo.load_scene, {"path": 5}, "path: must be the name of a file, got 5"),
    (tribo.load_scene, {"path": "a\0b"}, "path: must be the name of a file, got 'a\\x00b'"),
    (simulated, {"accuracy": 0}, "accuracy: must be positive, got 0"),
    (simulated, {"accuracy": False}, "accuracy: must be a number, got False"),
    (simulated, {"accuracy": -1e-3}, "accuracy: must be positive, got -0.001"),
    (simulated, {"accuracy": 1.0}, "accuracy: must be from 1e-13 to 0.1, got 1.0"),
    (simulated, {"accuracy": "high"}, "accuracy: must be a number, got 'high'"),
    (simulated, {"method": "euler"}, 'method: must be "midpoint" or "rk4" or'),
    (simulated, {"method": ""}, "method: must be"),
    (simulated, {"method": 5}, "method: must be"),
    (simulated, {"step": 0.0}, "step: must be positive, got 0.0"),
    (simulated, {"step": "x"}, "step: must be a number, got 'x'"),
    (simulated, {"method": "dop853", "step": 0.1}, "step: cannot go with dop853, which chooses"),
    (simulated, {"method": "midpoint"}, "step: is missing; midpoint takes equal steps"),
    (simulated, {"step": 0.1, "accuracy": 1e-3}, "accuracy: cannot go with a step"),
]


@pytest.mark.parametrize(("call", "given", "sentence"), CALLS)
def test_wrong_value_in_python(call, given, sentence):
    """Constructors and functions raise the same errors as scene files."""
    with pytest.raises(InputError) as caught:
        call(**given)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(sentence)


@pytest.mark.parametrize("kind", [np.float32, np.int8, np.longdouble, np.array, xarray.DataArray])
def test_numbers_of_other_libraries(kind):
    """They become numbers of Python, without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        duration = pair(duration=kind(3)).duration
    assert type(duration) is float and duration == 3.0


RIGID = {"asperite": Asperite(kappa=math.inf)}


class Turn(NamedTuple):
    """A force on the left end of a bar."""

    strength: float

    def end_forces(self, t, phi, nu, twist):
        """Along x."""
        return self.strength, 0.0, 0.0, 0.0


REFUSED = [
    ({"drive": DrivenBars(), "bars": Ends(Turn(0.1))}, "bars: cannot be forces of the user's own"),
    ({"drive": "bars", "langevin": Langevin(0.1)}, 'langevin.on: must be "swing" where drive ='),
    (RIGID | {"bars": "free"}, "asperite.kappa: must be finite where bars are not clamped"),
    (
        RIGID | {"bars": Ends(Turn(0.1))},
        "asperite.kappa: must be finite where bars are not clamped",
    ),
    (RIGID | {"initial": Initial(omega=0.1)}, "initial.omega: must be zero where asperite.kappa ="),
    (RIGID | {"initial": Initial(nu=0.1)}, "initial.nu: must be zero where asperite.kappa ="),
    (RIGID | {"langevin": Langevin(0.1, on="swing")}, 'langevin.on: must be "bar" where'),
]


@pytest.mark.parametrize(("settings", "sentence"), REFUSED)
def test_effects_that_exclude_each_other(settings, sentence):
    """One sentence, which names the setting to change."""
    with pytest.raises(InputError) as caught:
        Surface("a", **settings)
    assert str(caught.value).startswith(sentence)


def test_effects_that_go_together():
    """Zero damping is none, rigid asperites may turn once and for all and stand on driven bars."""
    Surface("a", drive="bars", langevin=Langevin(0.0))
    Surface("a", drive="bars", bars="free", langevin=Langevin(0.1, on="swing"))
    start = Initial(theta=0.3, phi=0.2, omega=0.0, nu=0.0)
    Surface("a", drive="bars", initial=start, **RIGID)
    with pytest.raises(InputError, match="load: cannot go with driven bars"):
        DrivenBars(load=0.1)
    with pytest.raises(InputError, match='velocity: cannot go with on = "swing"'):
        Langevin(0.1, velocity=(0.0, 0.0), on="swing")
    scene = Scene([Surface("a", **RIGID)], [], 1.0)
    with pytest.raises(InputError, match=r"a\.omega: cannot be changed where asperite.kappa = inf"):
        scene.initial_value("a.omega")
    assert scene.initial_value("a.theta")[1] == "theta"


@pytest.mark.parametrize("drive", [Forced, Free, Pulled, DrivenBars, Custom])
def test_drives_take_keywords_only(drive):
    """A number without its name would be the load; the message lists the names."""
    with pytest.raises(TypeError, match=rf"^{drive.__name__} takes keywords only: .*load=\.\.\."):
        drive(0.5)


STARTS = [
    ({"upper": 1.0}, "upper: must name a surface and one of theta, phi, omega, nu, swing, x,"),
    ({"middle.theta": 1.0}, "middle.theta: must name a surface and one of theta, phi, omega,"),
    ({"upper.length": 1.0}, "upper.length: must name a surface and one of theta, phi, omega,"),
    ({"upper.swing": [1.0, 2.0]}, "upper.swing: has 2 values for 1 asperites"),
    ({"upper.theta": [1.0, 2.0]}, "upper.theta: has 2 values for 1 asperites"),
    ({"upper.theta": []}, "upper.theta: has 0 values for 1 asperites"),
    ({"upper.theta": "x"}, "upper.theta: must be a number, got 'x'"),
    ({"upper.theta": None}, "upper.theta: must be a number, got None"),
    ({"upper.theta": True}, "upper.theta: must be a number, got True"),
    ({"upper.theta": math.nan}, "upper.theta: must be a finite number, got nan"),
    ({"upper.theta": HUGE}, "upper.theta: must be at most 1e+100 in magnitude, got 100000"),
    (
        {"upper.phi": 0.1},
        "upper.phi: cannot be changed where bars are clamped; prepare another scene",
    ),
    (
        {"upper.theta": 0.1, "upper.swing": 0.1},
        "upper.swing: cannot go with upper.theta; give one or the other",
    ),
    ({5: 1.0}, "5: must name a surface"),
    (5, ""),
    (["upper.theta"], ""),
]


def test_wrong_start_of_a_prepared_run():
    """Invalid keys and sizes of new initial values are refused and change nothing."""
    simulation = tribo.prepare(pair(), accuracy=1e-3)
    before = simulation.run(estimate=False)
    for start, sentence in STARTS:
        with pytest.raises(InputError) as caught:
            simulation.run(start)
        assert str(caught.value).startswith(sentence)
    after = simulation.run(estimate=False)
    assert np.array_equal(after["upper"].theta, before["upper"].theta)
    swung = simulation.run({"lower.swing": 0.1, "upper.swing": 0.2}, estimate=False)
    assert swung["lower"].theta[0, 0] == pytest.approx(math.pi + 0.1, rel=1e-15, abs=0.0)
    assert swung["upper"].theta[0, 0] == pytest.approx(0.2, rel=1e-15, abs=0.0)


NUMBERS = st.one_of(
    st.integers(-3, 40),
    st.sampled_from([HUGE, -HUGE, 2**63, -(2**63)]),
    st.floats(width=32),
    st.sampled_from([1e-320, 1e-300, 1e300, -1e300, 5e99]),
)
WORDS = st.text(max_size=5) | st.sampled_from(["upper", "lower", "free", "coulomb", "x.py:Y"])
LEAVES = NUMBERS | st.booleans() | WORDS | st.dates()
KEYS = st.sampled_from(["kind", "m1", "theta", "rms", "spectrum", "x", "name", "stiffness"])
NESTED = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=6,
)


def is_a_scene_or_refused(table):
    """Any table gives a scene that can be laid out, or an InputError."""
    try:
        scene = scene_from(table)
    except InputError as error:
        assert "\n" not in str(error)
        return
    with np.errstate(all="ignore"):
        lay_out(scene)


def with_marks(path):
    """A path; a number of a list beside another one is tried by a thorough test."""
    marks = [pytest.mark.thorough] * bool(re.search(r"\[[1-9]\]$", path))
    return pytest.param(path, marks=marks)


@pytest.mark.parametrize("path", [*map(with_marks, paths(VALID))])
@given(value=NESTED)
@example(value=[])
@example(value={})
@example(value=[[]])
@example(value=[HUGE, HUGE])
@example(value=[True, False])
@example(value={"kind": ["x.py:Y"]})
@example(value=["\n", "x.py:Y"])
def test_any_value_in_the_place_of_any_other(path, value):
    """Numbers of all sizes, words, lists and tables where something else should be."""
    is_a_scene_or_refused(changed((path, value)))


@given(st.recursive(LEAVES, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
def test_any_table(table):
    """Any nested value, table or not."""
    is_a_scene_or_refused(table)


SETTINGS = {
    Asperite: list(Asperite.__dataclass_fields__),
    Initial: list(Initial.__dataclass_fields__),
    surface: list(Surface.__dataclass_fields__),
    coulomb: ["between"],
    Output: ["samples", "times"],
    Numerics: ["accuracy", "method", "step"],
    pair: list(Scene.__dataclass_fields__),
}
ODD = st.sampled_from([None, object(), 1j, b"x", {1}, np.array(1.0), Coulomb(1.0), Coulomb])


@pytest.mark.parametrize("call", SETTINGS, ids=lambda call: call.__name__)
@given(data=st.data())
def test_any_value_in_python(call, data):
    """Constructors raise InputError, and nothing else, for values of any type."""
    name = data.draw(st.sampled_from(SETTINGS[call]))
    value = data.draw(NESTED | ODD | st.lists(st.floats()).map(np.array))
    try:
        call(**{name: value})
    except InputError as error:
        assert "\n" not in str(error)
