"""The module of a page gives the bits of tribo.simulate, and the quantities of its ledger."""

import json
import os
import subprocess
import sys

import pytest

import tribo
from support import live_comparison
from tribo.live_pages import compile
from tribo.live_pages.compile import GENERIC
from tribo.live_pages.link import Reader, number
from tribo.plugins import sources
from tribo.potentials import BUILT_IN

# Largest difference of a quantity in units of its largest value: rounding of sums.
ROUNDING = 1e-13


def compared(*names, scenes):
    """What the program of the comparison prints, on a generic processor."""
    command = [sys.executable, live_comparison.__file__, str(scenes), *names]
    environment = os.environ | GENERIC | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


# To compile a module takes half a minute: two are compared here, and the others are slow tests.
@pytest.mark.thorough
@pytest.mark.parametrize("name", list(live_comparison.POTENTIALS))
def test_bits(name):
    """All bits of the record, and all quantities to rounding, of random pairs and drives."""
    runs = compared(name, scenes=3)
    assert len(runs) == 3
    for run in runs:
        assert run["status"] == [0, "completed"], run
        assert run["same"], run
        assert run["compared"] > 70
        assert run["worst"] < ROUNDING, run
        # With the page's own settings, which no search has found.
        assert run["own_code"] == 0 and run["own_excess"] <= 1.0, run


def test_every_built_in_is_compared():
    """No formula is left out; cutoffs, sums and a user's class are compared too."""
    classes = {type(potential).__name__ for potential in live_comparison.POTENTIALS.values()}
    assert {each.__name__ for each in BUILT_IN.values()} <= classes
    assert {"Own", "Sum", "Switched", "ForceShifted", "Shifted", "Truncated"} <= classes


@pytest.mark.parametrize("value", [0, 1, 127, 128, 300, 2**32 - 1])
def test_numbers_of_the_binary_format(value):
    assert Reader(number(value)).number() == value


def test_a_process_reads_classes_that_were_loaded_here(tmp_path):
    """Of a file and of an expression, whose modules have names of this process."""
    path = tmp_path / "own.py"
    path.write_text(
        "import tribo\nclass Own(tribo.Potential):\n    A: float\n"
        "    def energy(self, r):\n        return self.A / r\n"
    )
    own = sources.module_in_file(path).Own(0.5)
    given = own + tribo.potentials.expression("A*exp(-r)", A=0.25)
    path.unlink()
    program = (
        "from tribo.live_pages.compile import given_to_process\n"
        "print(given_to_process().energy(2.0))"
    )
    content = compile.for_process(given)
    done = subprocess.run(
        [sys.executable, "-c", program], input=content, capture_output=True, check=False
    )
    assert float(done.stdout) == given.energy(2.0), done.stderr.decode()
