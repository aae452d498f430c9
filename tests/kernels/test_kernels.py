"""Compiled kernels give the same numbers as their source when Python runs it."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

import tribo
from support.everything import everything
from tribo import Free, Output
from tribo.paper import scene as case

TESTS = Path(__file__).parents[1]
ROUND_OFF = 1e-12  # relative to the largest value of a quantity


def rows():
    """Two rows with everything, pressed together; the lower one is rigid."""
    scene = everything(1.0, samples=5)
    upper, lower = scene.surfaces
    return replace(scene, surfaces=(upper, replace(lower, drive=Free(rigid=True))))


def encounter(letter):
    """A case of the paper from shortly before the bobs pass to shortly after."""
    scene = case(letter)
    upper, lower = scene.surfaces
    surfaces = (replace(upper, bob=(-1.0, upper.bob[1])), lower)
    return replace(scene, surfaces=surfaces, duration=2.0, output=Output(times=(1.0, 2.0)))


SCENES = {
    "A": encounter("A"),
    "C": encounter("C"),
    "rows": rows(),
}
HOW = {
    "midpoint": {"method": "midpoint", "step": 0.05},
    "dop853": {"method": "dop853", "accuracy": 1e-6},
    "rkn12": {"method": "rkn12", "accuracy": 1e-6},
    "gauss-radau-15": {"method": "gauss-radau-15", "accuracy": 1e-6},
    "gauss-8": {"method": "gauss-8", "step": 0.1},
    "verlet": {"method": "verlet", "step": 0.05},
}

# Of the same file as another method above, and of the same potential as another scene.
ALIKE = {"gauss-8", "C"}

UNCOMPILED = f"""
import sys
sys.path[:0] = {[os.path.dirname(__file__), str(TESTS)]!r}
import numpy as np
from numba import config
from test_kernels import HOW, SCENES, series
assert config.DISABLE_JIT
np.savez(sys.argv[1], **series(*sys.argv[2:]))
"""


def series(scene, how):
    """Every series of a run, by names that a file can have."""
    with mock.patch("tribo.loops.select.has_pair_loop", return_value=False):
        result = tribo.simulate(SCENES[scene], **HOW[how])
    assert result.status == "completed"
    system = {f"system-{key}": values for key, values in result.system.items()}
    return system | {
        f"{name}-{key}": values
        for name in result.ledger.surfaces
        for key, values in result[name].items()
    }


def others_slow(names):
    """Parameters, of which those like others are in the slow set."""
    return [pytest.param(name, marks=[pytest.mark.slow] * (name in ALIKE)) for name in names]


@pytest.mark.parametrize("how", others_slow(HOW))
@pytest.mark.parametrize("scene", others_slow(SCENES))
def test_compiled_is_as_written(tmp_path, scene, how):
    """Every quantity at every sample, as a process that compiles nothing finds it."""
    file = tmp_path / "written.npz"
    subprocess.run(
        [sys.executable, "-c", UNCOMPILED, str(file), scene, how],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        check=True,
    )
    written = dict(np.load(file))
    compiled = series(scene, how)
    assert set(compiled) == set(written)
    for name, values in compiled.items():
        bound = ROUND_OFF * max(1.0, np.max(np.abs(values)))
        worst = np.max(np.abs(values - written[name]))
        assert worst <= bound, f"{name} differs by {worst:.1e}"
