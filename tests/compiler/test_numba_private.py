"""The two ways of compiling, and functions of other programs, which neither changes."""

import json
import os
import subprocess
import sys

import pytest

# Runs tribo, or compiles functions of its own and prints their results and types, in any order.
FOREIGN = """
import json
import math
import sys
from typing import Any, NamedTuple
import numpy as np
import numba

class Fields(NamedTuple):
    energy: float
    force: float
    range: float
    interval: int

class Method(NamedTuple):
    scale: float
    def energy(self, r):
        return self.scale / r

class Slot(NamedTuple):
    value: Any
    step: Any

def fields(item):
    return item.energy - item.range + item.force * item.interval
def method(item):
    return item.energy(2.0)
def where(x):
    return np.where(x > 1.0, x, 2.0)
def where_of_arrays(x):
    return np.where(np.arange(3.0) > x, 1.0, np.ones(3))
def choice_of_slots(x):
    return Slot(x, None) if x > 1.0 else Slot(2.0, 1)
def choice_of_numbers(x):
    return Slot(x, 1) if x > 1.0 else Slot(1, 2.0)
def list_of_tuples(x):
    return [Slot(x, 1.0), Slot(1.0, x)]
def operators(x):
    return x + 1, x - 1, x * 2, x / 3, x**2, x**0.5, -x, abs(x), x < 2, x >= 2, x // 2, x % 2
def functions(x):
    return math.exp(x), np.exp(x), np.sqrt(x), np.floor(x), np.maximum(x, 1), max(x, 1), min(x, 2)
def arrays(x):
    a = np.full((3, 4), x)
    a[-1, 1:3] = 2.0
    a[0, -1] += 1
    return a[1:].sum(), a[-1], a.size, a.shape, a.T[1]
def tuples(x):
    t = (x, 1, None)
    s = Slot(x, x)
    return t[0], t[1:], s[0], s[-1], len(s), s == Slot(x, x), s < Slot(x, 2.0)

def outcome(function, argument):
    compiled = numba.njit(function)
    try:
        value = compiled(argument)
    except Exception as error:
        return type(error).__name__
    return repr(value), [str(s.return_type) for s in compiled.nopython_signatures]

def outcomes():
    numbers = where, where_of_arrays, choice_of_slots, choice_of_numbers, list_of_tuples
    numbers += operators, functions, arrays, tuples
    found = {f.__name__: outcome(f, 1.5) for f in numbers}
    found["of whole numbers"] = {f.__name__: outcome(f, 2) for f in numbers}
    items = (fields, Fields(1.0, 2.0, 3.0, 4)), (method, Method(3.0))
    return found | {f.__name__: outcome(f, item) for f, item in items}

class Own(NamedTuple):
    scale: float
    def energy(self, r):
        return self.scale * np.where(r < 2.0, (2.0 - r) ** 3, 0.0)

def run_tribo():
    import tribo
    sides = tribo.Surface("upper", bob=(0.0, 1.0)), tribo.Surface("lower", facing="up")
    tribo.simulate(tribo.Scene(sides, Own(0.1), 0.1), accuracy=1e-3)

for step in sys.argv[1:]:
    run_tribo() if step == "tribo" else print(json.dumps(outcomes()))
"""


def run(folder, program, *arguments, **environment):
    """What a program prints in a new process, to both of its outputs."""
    path = folder / "program.py"
    path.write_text(program)
    names = os.environ | environment
    done = subprocess.run(
        [sys.executable, path, *arguments], env=names, capture_output=True, text=True
    )
    return done.stdout, done.stderr


@pytest.mark.parametrize("way", ["", "plain"])
def test_functions_of_other_programs_are_not_changed(tmp_path, way):
    """They have the same types and results without tribo, after its run, and before and after."""
    expected, error = run(tmp_path, FOREIGN, "functions")
    assert not error and "array(float64, 0d" in expected
    assert json.loads(expected)["method"] == "TypingError"
    assert run(tmp_path, FOREIGN, "tribo", "functions", TRIBO_NUMBA=way) == (expected, "")
    around = run(tmp_path, FOREIGN, "functions", "tribo", "functions", TRIBO_NUMBA=way)
    assert around == (2 * expected, "")


# Prints the way of compiling; another import of it is to warn no second time.
WAY = """
import numba
numba.__version__ = VERSION
from tribo.compiler.numba_private import NATIVE
import tribo.compiler.jit
print(NATIVE, tribo.compiler.jit.LINKED)
"""


def test_an_untested_version_takes_the_plain_way(tmp_path):
    """With one warning, of one sentence; not where the plain way is wanted."""
    program = WAY.replace("VERSION", '"0.99.1"')
    printed, warned = run(tmp_path, program, TRIBO_NUMBA="")
    assert printed == "False {}\n"
    assert warned.count("TriboWarning") == 1
    assert "numba 0.99.1 with llvmlite" in warned
    assert run(tmp_path, program, TRIBO_NUMBA="plain") == ("False {}\n", "")


def test_the_variable_has_one_value(tmp_path):
    """Any other is named."""
    _, error = run(tmp_path, "import tribo.compiler.jit", TRIBO_NUMBA="fast")
    assert 'TRIBO_NUMBA: must be "plain" or absent, got "fast"' in error


# Without the folder of compiled code, in which a page's module may be already.
LIVE = """
import tribo
scene = tribo.paper.scene("A")
try:
    tribo.to_live_html(scene, "page.html")
except tribo.InputError as error:
    print(error)
"""


def test_live_pages_need_a_tested_version(tmp_path):
    """In the plain way a sentence says so, where a module is not kept already."""
    printed, error = run(tmp_path, LIVE, TRIBO_NUMBA="plain", NUMBA_CACHE_DIR=str(tmp_path))
    assert printed == "numba: must be a version that tribo was tested with, for live pages\n", error
