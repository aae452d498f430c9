"""The changes that pages of the developers' section show do what the pages say.

Each is applied to a copy of the sources, which runs uncompiled in a process of its own.
"""

import os
import subprocess
import sys

import pytest

from support import page_diffs

SCENE = """
import numpy as np, tribo
upper = tribo.Surface("upper", bob=(-2.0, 1.0), velocity=(0.5, 0.1), drive=DRIVE)
lower = tribo.Surface("lower", facing="up")
output = tribo.Output(samples=9, series=["forces"])
scene = tribo.Scene([upper, lower], POTENTIAL, duration=0.4, output=output)
"""
POTENTIAL = """
scene.save("scene.toml")
assert 'potential = "kratzer"' in open("scene.toml").read()
assert tribo.load_scene("scene.toml") == scene
result = tribo.simulate(scene, method="rk4", step=0.05)
assert abs(result.system["total_energy_change"][-1] - result.system["applied_work"][-1]) < 1e-7
try:
    tribo.potentials.named("kratzer", D=0.2, re=-1.5)
except tribo.InputError as error:
    assert str(error) == "re: must be positive [length], got -1.5", error
"""
QUANTITY = """
result = tribo.simulate(scene, method="rk4", step=0.05)
series, t = result["upper"]["p_drive"][:, 0], result.t
work = np.sum(0.5 * np.diff(t) * (series[1:] + series[:-1]))
exact = result["upper"].w2[-1, 0]
assert abs(exact) > 1e-3 and abs(work - exact) < 1e-2 * abs(exact), (work, exact)
assert result.to_xarray()["upper.p_drive"].attrs["units"] == "energy time^-1"
"""
COMMAND = """
from tribo.commands.cli import main
scene.save("scene.toml")
assert main(["size", "scene.toml"]) == 0
"""
KRATZER = 'tribo.potentials.named("kratzer", D=0.2, re=1.5)'
PULLED = "tribo.Pulled(stiffness=0.5, speed=0.4)"
CHANGES = {
    "a_potential": (
        1,
        POTENTIAL,
        {"POTENTIAL": KRATZER},
    ),
    "a_quantity": (1, QUANTITY, {"DRIVE": PULLED}),
    "a_command": (2, COMMAND, {}),
}


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=[pytest.mark.thorough] * (page == "a_quantity")) for page in CHANGES],
)
def test_a_change_of_a_page(page, tmp_path):
    """In as many files as the page says."""
    files, program, given = CHANGES[page]
    assert len(page_diffs.files(page)) == files
    sources = page_diffs.applied(page, tmp_path)
    code = SCENE + program
    for word, value in ({"POTENTIAL": "tribo.Coulomb(0.2)", "DRIVE": '"free"'} | given).items():
        code = code.replace(word, value)
    environment = os.environ | {"PYTHONPATH": str(sources), "NUMBA_DISABLE_JIT": "1"}
    run = [sys.executable, "-c", code]
    found = subprocess.run(run, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    if page == "a_command":
        assert found.stdout == "upper: 1 asperites\nlower: 1 asperites\n"
