"""The module of a page with a row or grid gives the bits of tribo.simulate."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tribo
from support import lattice_comparison
from support.pages import ARGUMENTS, CHROMIUM, held
from tribo import live_pages
from tribo.layout.layout import lay_out
from tribo.ledger.guards import MOST_PASSED, facing
from tribo.live_pages.compile import GENERIC
from tribo.model.parameters import with_values
from tribo.viewer.contents import PLACES

NODE = shutil.which("node")
STATUS = Path(live_pages.__file__).parent / "parts" / "status.js"
# Largest difference of a quantity in units of its largest value, and of a number that follows from
# keys: rounding.
ROUNDING = 1e-13
# Most bytes of the page of three on three.
LARGEST = 300_000


@pytest.mark.thorough
@pytest.mark.parametrize("name", lattice_comparison.SCENES)
def test_bits(name):
    """All bits of the samples, all quantities to rounding, and all keys changed at once."""
    command = [sys.executable, lattice_comparison.__file__, name]
    environment = os.environ | GENERIC | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    run = json.loads(done.stdout)
    assert run["codes"] == [0, 0] and run["status"] == "completed", run
    assert run["same"] and run["short"], run
    assert run["compared"] > 60
    assert run["worst"] < ROUNDING, run
    assert run["alike"] and run["apart"] < ROUNDING and len(run["keys"]) > 25, run


def page_of(folder, **output):
    scene = replace(lattice_comparison.rows(), output=tribo.Output(**output), duration=20.0)
    return scene, scene.to_live_html(folder / "rows.html")


@pytest.mark.thorough
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_in_a_browser(tmp_path):
    """Numbers are those of Python to the errors that the page says; sliders change them."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs tribo[browser]")
    scene, page = page_of(tmp_path, samples=101)
    assert page.stat().st_size < LARGEST
    assert [each["count"] for each in held(page)["surfaces"]] == [3, 3]
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        tab = browser.new_page(viewport={"width": 1366, "height": 768})
        problems = []
        tab.on("console", lambda message: problems.append(message.text))
        tab.on("pageerror", lambda error: problems.append(str(error)))
        tab.goto(page.as_uri() + "#upper.velocity=0.4")
        tab.wait_for_function("window.tribo")
        for values in ({}, {"upper.velocity": 0.6, "*.asperite.m1": 1.5}):
            check_run(tab, scene, {"upper.velocity": 0.4} | values)
        tab.evaluate("tribo.set({'upper.velocity': 0.3})")
        assert "upper.velocity=0.3" in tab.url
        assert "Work of friction" in tab.locator("[data-part=status]").inner_text()
        assert tab.get_by_role("tab", name="Many starts").count() == 0
        for name in ("Energy", "Numbers", "Files", "End value"):
            tab.get_by_role("tab", name=name).click()
            tab.wait_for_timeout(50)
        tab.wait_for_selector("[data-part=end][aria-busy=false]", timeout=60_000)
        assert problems == []


@pytest.mark.skipif(NODE is None, reason="needs node")
def test_a_page_says_when_surfaces_have_passed():
    """By the rule of runs, which stop there: at their last sample, and not before."""
    row = {"shape": (3, 1), "spacing": (1.5, 0.0)}
    drive = tribo.Pulled(stiffness=1.0, speed=0.1, load=0.4)
    upper = tribo.Surface("upper", bob=(0.4, 1.2), drive=drive, **row)
    lower = tribo.Surface("lower", facing="up", drive="bars", **row)
    output = tribo.Output(samples=401)
    scene = tribo.Scene((upper, lower), tribo.Gaussian(0.1, 0.5), 60.0, output=output)
    with pytest.warns(tribo.TriboWarning, match="PassedThrough"):
        result = tribo.simulate(scene, method="verlet", step=0.01, progress=False)
    assert result.status == "PassedThrough"
    source = {"facing": facing(lay_out(scene)), "mostPassed": MOST_PASSED}
    for end, found in ((result.t.size, [result.t[-1], "upper"]), (result.t.size - 1, None)):
        surfaces = [
            {
                "name": surface.name,
                "facing": surface.facing,
                "count": surface.count,
                "places": [np.ravel(result[surface.name][each][:end]).tolist() for each in PLACES],
            }
            for surface in scene.surfaces
        ]
        run = {"times": result.t[:end].tolist(), "surfaces": surfaces}
        program = (
            f"const PLACES = {json.dumps(PLACES)};\n{STATUS.read_text()}\n"
            f"const run = {json.dumps(run)};\n"
            "for (const each of run.surfaces) "
            "each.places = each.places.map((values) => Float64Array.from(values));\n"
            f"const found = passage({json.dumps(source)}, run);\n"
            "console.log(JSON.stringify(found && [found.t, found.name]));"
        )
        done = subprocess.run(
            [NODE, "-"], input=program, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr[-500:]
        assert json.loads(done.stdout) == found


def check_run(tab, scene, values):
    """A run of the page and one of Python differ by less than both errors."""
    end, errors, status = tab.evaluate(
        "(values) => { const r = tribo.run(values); return [r.end, r.errors, r.status] }", values
    )
    assert status == "completed"
    result = tribo.simulate(with_values(scene, values), accuracy=1e-7, progress=False)
    for surface in ("upper", "lower"):
        for name in ("w1", "w1_ps", "w2", "delta_e_int", "delta_k_trans"):
            want = result[surface][name][-1].sum()
            allowed = errors[surface][name] + 3.0 * result.error_estimate[name]
            assert abs(end[surface][name] - want) <= allowed, (surface, name)
