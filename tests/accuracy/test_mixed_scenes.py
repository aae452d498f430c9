"""The judge of benchmarks/crossed_scenes.py: right scenes pass, and a planted error is seen."""

import numpy as np
import pytest

import tribo
from support import reference
from support.mixed import solver
from support.mixed.comparison import ACCURACY, Findings, compare
from support.mixed.draw import STRUCTURES, drawn
from support.mixed.judge import judged
from support.mixed.noise import WARM
from support.random_scenes import random_scene
from support.scene_tables import scene_from


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [1, 2, 4])
def test_right_scenes(seed):
    """A pair of asperites, by itself, and its potential."""
    findings = judged(seed, ["pair"], ["run", "potentials"])
    assert findings.verdict == "right", findings.found


@pytest.mark.slow
@pytest.mark.parametrize("kind", STRUCTURES)
def test_right_scenes_of_every_kind(kind):
    """Continued in the same scene, from what the first run recorded, with oscillators too."""
    findings = judged(3, [kind], ["state"])
    assert findings.checks == ["state, same"]
    assert findings.verdict == "right", findings.found


@pytest.mark.slow
@pytest.mark.parametrize("kind", WARM)
def test_right_noise_of_every_kind(kind):
    """Temperatures at two points of a sweep, or the mean force of a load."""
    findings = judged(0, [kind])
    assert findings.checks and findings.verdict == "right", findings.found


def test_a_planted_error_is_silent():
    """A run of another scene, by a hundredth of one number."""
    scene = drawn(0, "pair")
    table = scene.copy()
    result = tribo.simulate(scene_from(table), method="rkn8", accuracy=ACCURACY)
    found = Findings(0, "pair")
    assert compare(found, "run", result, scene.table)
    wrong = scene.copy()
    wrong["interaction"][0]["strength"] *= 1.01
    assert not compare(found, "run", result, wrong)
    assert found.verdict == "silent"


@pytest.mark.skipif(reference.compiler() is None, reason="there is no C compiler")
def test_two_solvers_agree():
    """The second solution and the reference in C share no code."""
    table = random_scene(1, "morse")
    truth = reference.solve(table, precision="long double")
    found = solver.solve(table, truth.t)
    for name, series in truth.surfaces.items():
        for quantity, values in (series | truth.blocks[name]).items():
            np.testing.assert_allclose(found[name][quantity], values, atol=1e-5, err_msg=quantity)
    for quantity, values in truth.system.items():
        np.testing.assert_allclose(found["system"][quantity], values, atol=1e-5)
