"""Invalid potentials of a user: the message names the line and the reason."""

import re
from typing import NamedTuple

import pytest

import tribo
import tribo.potentials
from support.scene_tables import scene_from
from tribo import InputError
from tribo.potentials import as_potential
from tribo.potentials.potential import complete

HEAD = """import math
import numba
import scipy.special
from typing import NamedTuple
def helper(x):
    return 1.0 / x
@numba.njit
def compiled(x):
    return 1.0 / x
class Own(NamedTuple):
    s: float
"""
ENERGY = ["def energy(self, r):", "    return self.s / r"]

# The lines of the class, the line that the message names, and the reason.
FAULTS = {
    "an unknown name": (
        ["def energy(self, r):", "    x = self.s", "    return x / r + y"],
        "return x / r + y",
        "NameError: name 'y' is not defined",
    ),
    "an unknown parameter": (
        ["def energy(self, r):", "    return self.t / r"],
        "return self.t / r",
        "AttributeError: 'Own' object has no attribute 't'",
    ),
    "text": (
        ["def energy(self, r):", "    return 'a'"],
        "def energy(self, r):",
        "gives 'a' where a number is wanted",
    ),
    "nothing": (
        ["def energy(self, r):", "    self.s / r"],
        "def energy(self, r):",
        "gives None where a number is wanted",
    ),
    "two numbers": (
        ["def energy(self, r):", "    return self.s, r"],
        "def energy(self, r):",
        "gives (1.0, 1.0) where a number is wanted",
    ),
    "no r": (
        ["def energy(self):", "    return self.s"],
        "def energy(self):",
        "TypeError: Own.energy() takes 1 positional argument but 2 were given",
    ),
    "one argument too many": (
        ["def energy(self, r, charge):", "    return self.s"],
        "def energy(self, r, charge):",
        "TypeError: Own.energy() missing 1 required positional argument: 'charge'",
    ),
    "a function that is not compiled": (
        ["def energy(self, r):", "    return self.s * helper(r)"],
        "return self.s * helper(r)",
        "must be compiled too, by @numba.njit",
    ),
    "a library that is not compiled": (
        ["def energy(self, r):", "    return scipy.special.erf(r)"],
        "return scipy.special.erf(r)",
        "Unknown attribute 'erf' of type Module",
    ),
    "a statement that is not compiled": (
        [
            *("def energy(self, r):", "    try:", "        return self.s / r"),
            *("    except ValueError as error:", "        raise"),
        ],
        "except ValueError as error:",
        "Exception object cannot be stored into variable",
    ),
    "now text, now a number": (
        [
            "def energy(self, r):",
            "    if r > 5.0:",
            "        return 'far'",
            "    return self.s / r",
        ],
        "return 'far'",
        "Can't unify return type",
    ),
    "an energy that takes no complex numbers": (
        [
            *("def energy(self, r):", "    for _ in range(1):", "        u = math.exp(-r)"),
            "    return self.s * u",
        ],
        "u = math.exp(-r)",
        "without a force(self, ...) it is called with complex numbers",
    ),
    "a force that does not compile": (
        [*ENERGY, "def force(self, r):", "    return helper(r)"],
        "return helper(r)",
        "must be compiled too, by @numba.njit",
    ),
    "a range that is none": (
        [*ENERGY, "def range(self):", "    return self.end"],
        "return self.end",
        "AttributeError: 'Own' object has no attribute 'end'",
    ),
    "a feature that is none": (
        [*ENERGY, "def feature(self):", "    return self.s"],
        "def feature(self):",
        "gives 1.0 where 2 numbers are wanted",
    ),
    "constraints that are none": (
        [*ENERGY, "def constraints(self):", "    return self.s"],
        "def constraints(self):",
        "must return (parameter, whether its constraint is met, message) for each",
    ),
}


# Energies, and whether their source is differentiated.
ENERGIES = {
    "a quotient": (["return self.s / r"], True),
    "steps": (["x = self.s / r", "x = x * x - r", "y = 3.0", "return y * x**3 / (x - 7.0)"], True),
    "numpy": (["e = np.exp(-r) * np.sqrt(r + self.s)", "return e * np.tanh(e) - np.cos(r)"], True),
    "math": (["return self.s * math.log(1.0 + r) / math.cosh(r)"], True),
    "a comparison": (["return (r < 1.5) * (1.5 - r) ** 3 * self.s"], True),
    "constants and helpers of none": (["return -TWO * +r * np.pi * compiled(self.s)"], True),
    "np.where": (["return np.where(r < 1.5, (1.5 - r) ** 3, 0) * self.s"], True),
    "np.maximum": (["return self.s * np.maximum(1.5 - r, 0.0) ** 2.5"], True),
    "a root of a maximum": (["x = np.maximum(1.5 - r, 0.0)", "return x * x * np.sqrt(x)"], True),
    "max and min": (["return self.s * max(1.5 - r, 0.0) ** 3 - min(r, 2.0 + self.s) ** 2"], True),
    "if and return": (["if r < 1.5:", "    return self.s * (1.5 - r) ** 2.5", "return 0.0"], True),
    "if and assignments": (
        [
            *("x = r * r", "if r > 2.0:", "    x = 4.0", "    y = 1.0"),
            *("elif r > 1.0:", "    y = x * r", "else:", "    y = 1.0", "return x * y"),
        ],
        True,
    ),
    "a conditional expression": (["return (2.0 - r) ** 2 if r < 2.0 else 0.0"], True),
    "a power of r": (["return self.s**r + r**-self.s"], False),
    "a loop": (["u = 0.0", "for k in range(3):", "    u = u + r**k", "return u"], False),
    "a sum in place": (["u = self.s", "u += r", "return u * r"], False),
    "a function of ones own": (["return compiled(r)"], False),
    "a function without a rule": (["return np.arctan(r)"], False),
}


@pytest.mark.parametrize("name", ENERGIES)
def test_forces_of_energies_alone(tmp_path, name):
    """The force is minus the derivative, symbolic where the source is a formula."""
    lines, is_formula = ENERGIES[name]
    head = HEAD.replace("import numba", "import numba\nimport numpy as np\nTWO = 2.0")
    body = "".join(f"        {line}\n" for line in lines)
    (tmp_path / "own.py").write_text(head + "    def energy(self, r):\n" + body)
    own = scene("own.py:Own", tmp_path).interactions[0].potential
    assert (type(own).force.__module__ == "tribo.potentials.derivative") == is_formula
    for r in (0.4, 1.1, 2.7):
        if name == "a function of ones own":
            exact = 1.0 / r**2
        else:
            weights = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))
            h = 1e-3
            exact = (
                -sum(w * (own.energy(r + k * h) - own.energy(r - k * h)) for k, w in weights) / h
            )
        force = own.force(r)
        assert force == pytest.approx(exact, rel=1e-6, abs=1e-9)
        if not any(word in name for word in ("math", "max", "if", "np.", "condition", "compar")):
            step = -own.energy(r + 1e-100j).imag / 1e-100
            assert force == pytest.approx(step, rel=1e-13, abs=1e-14)


def test_a_class_with_a_force_alone_has_no_energy():
    class Own(tribo.Potential):
        s: float

        def force(self, r):
            return self.s / r**2

    with pytest.raises(InputError, match=r"Own has no method energy\(self, r\)"):
        as_potential(Own(0.3))


def test_a_source_that_was_edited_is_not_the_energy(tmp_path, monkeypatch):
    """A source that has changed since it was loaded is not differentiated."""
    import importlib
    import linecache

    head = "from typing import NamedTuple\nclass Own(NamedTuple):\n    s: float\n"
    path = tmp_path / "edited_since.py"
    path.write_text(head + "    def energy(self, r): return self.s / r\n")
    monkeypatch.syspath_prepend(tmp_path)
    module = importlib.import_module("edited_since")
    path.write_text(head + "    def energy(self, r): return self.s / r**2\n")
    linecache.checkcache()
    own = as_potential(module.Own(1.0))
    assert own.energy(2.0) == 0.5
    assert own.force(2.0) == pytest.approx(0.25, rel=1e-14, abs=0.0)
    assert type(own).force.__name__ == "_complex_step"


def scene(potential, tmp_path):
    """A scene file's table with the potential, as it is read."""
    table = {
        "duration": 0.2,
        "output": {"samples": 2},
        "numerics": {"method": "midpoint", "step": 0.1},
        "interaction": [{"potential": potential, "s": 1.0}],
        "surface": [{"name": "upper", "bob": [-3.0, 0.0]}, {"name": "lower", "facing": "up"}],
    }
    return scene_from(table, tmp_path)


# What fails in Python, in compilation and in other methods; the others are thorough.
DEFAULT = {
    *("an unknown name", "text", "a function that is not compiled"),
    *("a force that does not compile", "a range that is none", "constraints that are none"),
}


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param(fault, marks=[pytest.mark.thorough] * (fault not in DEFAULT))
        for fault in FAULTS
    ],
)
def test_a_plugin_that_fails(tmp_path, fault):
    """The field, the line, its text and the reason, in one sentence."""
    lines, line, reason = FAULTS[fault]
    path = tmp_path / "own.py"
    path.write_text(HEAD + "".join(f"    {text}\n" for text in lines))
    count = HEAD.count("\n") + 1 + [text.strip() for text in lines].index(line)
    with pytest.raises(InputError) as caught:
        tribo.simulate(scene("own.py:Own", tmp_path))
    said = str(caught.value)
    place = re.escape(f' fails in line {count} of {path}, "{line}": ')
    assert re.match(rf"interaction\[0\]\.potential: Own\.\w+{place}", said), said
    assert reason in said and "\n" not in said


def test_a_plugin_inside_a_cutoff(tmp_path):
    """A fault is found in a part of a combined potential."""
    (tmp_path / "own.py").write_text(HEAD + "    def energy(self, r): return helper(r)\n")
    own = scene("own.py:Own", tmp_path).interactions[0].potential
    inside = tribo.Coulomb(1.0) + own.with_cutoff(2.0)
    upper = tribo.Surface("upper", bob=(-3.0, 0.0))
    lower = tribo.Surface("lower", facing="up")
    with pytest.raises(InputError, match=r"Own\.energy fails in line 12 of .*own\.py"):
        tribo.simulate(tribo.Scene((upper, lower), inside, 1.0), method="midpoint", step=0.1)


class Broken(NamedTuple):
    """A field whose force has one component only is refused."""

    s: float

    def energy_at(self, x, y):
        return self.s * x

    def force_at(self, x, y):
        return self.s


def test_a_field_that_fails():
    """Other plug-ins are checked in the same way."""
    upper = tribo.Surface("upper")
    field = tribo.Field(Broken(1.0), on=["upper"])
    described = tribo.Scene((upper,), (), 1.0, fields=[field])
    with pytest.raises(InputError, match=r"^field\[0\]\.kind: Broken\.force_at fails in line \d+"):
        tribo.simulate(described, method="midpoint", step=0.1)


def test_constraints_of_a_user_potential(tmp_path):
    """A class may constrain its parameters; the message names the parameter."""
    (tmp_path / "own.py").write_text(
        HEAD + "    def energy(self, r): return compiled(r)\n"
        "    def constraints(self): return (('s', self.s > 2.0, 'must be above 2'),)\n"
    )
    with pytest.raises(InputError) as caught:
        scene("own.py:Own", tmp_path)
    assert str(caught.value) == "interaction[0].s: must be above 2, got 1.0"


class Plain(tribo.Potential):
    """A potential of one parameter."""

    s: float

    def energy(self, r):
        return self.s / r


class Unannotated(tribo.Potential):
    """A number that is no field."""

    h = 2.5

    def energy(self, r):
        return self.h / r


class Initialized(tribo.Potential):
    """A number that __init__ sets."""

    def __init__(self, h):
        self.h = h

    def energy(self, r):
        return self.h / r


@pytest.mark.parametrize(
    ("use", "words"),
    [
        (
            lambda: as_potential(Plain),
            r"must be an instance, Plain\(s=\.\.\.\), got the class Plain",
        ),
        (
            lambda: as_potential(Unannotated()),
            r"Unannotated has no parameters; .* as h: float = 2\.5 in the class$",
        ),
        (lambda: complete(Initialized), r"Initialized has no .* in the class instead of __init__$"),
    ],
)
def test_classes_without_fields_and_instances(use, words):
    """The message says what to write."""
    with pytest.raises(InputError, match="^potential: " + words):
        use()


def test_a_class_as_another_plug_in():
    """Fields, drives and forces on bars are instances too."""
    upper = tribo.Surface("upper")
    with pytest.raises(InputError, match="must be an instance, as Own"):
        tribo.Scene((upper,), (), 1.0, fields=[tribo.Field(Broken, on=["upper"])])
