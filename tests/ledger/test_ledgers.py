"""Works of asperites, their sums, or none: the same motion, and no more is kept than asked for."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tribo
from support import ledgers
from support.package import SOURCE
from tribo import Explanation, paper
from tribo.explanation import Contact
from tribo.explanation.prediction import Predicted
from tribo.layout.layout import lay_out
from tribo.loops.pair_records import is_pair
from tribo.threads.shared_run import Threads

TESTS = Path(__file__).parents[1]


def test_all_effects_and_methods():
    """Sums are sums, and without a ledger nothing else changes; see support/ledgers.py."""
    path = os.pathsep.join([str(SOURCE.parent), str(TESTS)])
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "support.ledgers"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stdout) == (0, ""), run.stdout + run.stderr


def test_compiled():
    """Compiled kernels add up packs as uncompiled ones do."""
    scene = ledgers.SCENES["arms alike"]
    every, sums, none = (
        ledgers.run(scene, ledger, method="verlet", step=0.02)
        for ledger in ("asperites", "surfaces", "none")
    )
    assert list(ledgers.complaints(every, sums, none, exact=False)) == []


def encounter(ledger: str) -> tribo.Scene:
    """A case of the paper around the encounter."""
    scene = paper.scene("C")
    upper, lower = scene.surfaces
    surfaces = (replace(upper, bob=(-1.0, upper.bob[1])), lower)
    output = tribo.Output(samples=5, ledger=ledger)
    return replace(scene, surfaces=surfaces, duration=4.0, output=output)


@pytest.fixture(scope="module")
def results() -> dict[str, tribo.Result]:
    """The encounter with an accuracy, by ledger."""
    kinds = ("asperites", "surfaces", "none")
    return {kind: tribo.simulate(encounter(kind), accuracy=1e-8) for kind in kinds}


@pytest.mark.slow
def test_accuracy(results):
    """What is kept is within the estimates, by the general loop."""
    whole = results["asperites"]
    for kind in ("surfaces", "none"):
        result = results[kind]
        assert result.met
        assert not is_pair(lay_out(result.scene))
        for key, values in ledgers.tables(result).items():
            expected = ledgers.tables(whole)[key]
            expected = expected if expected.ndim == values.ndim else expected.sum(axis=1)
            bound = result.error_estimate[key[1]] + whole.error_estimate[key[1]]
            assert np.max(np.abs(values - expected)) <= bound, (kind, key)


def test_an_observable(results):
    """The accuracy of one can be asked for where it is kept."""
    scene = encounter("surfaces")
    result = tribo.simulate(scene, accuracy={"upper.w1": 1e-6})
    assert result.met
    bound = result.error_estimate["upper.w1"]
    assert abs(result["upper"].w1[-1] - results["asperites"]["upper"].w1[-1, 0]) <= bound
    with pytest.raises(tribo.InputError, match=r"accuracy\.upper\.W: is not kept; .*ledger"):
        tribo.simulate(encounter("none"), accuracy={"upper.W": 1e-6})


def test_works_that_are_not_kept(results):
    """They are named in one sentence, by table and by attribute."""
    none = results["none"]
    with pytest.raises(KeyError, match=r'"w1" is not kept; works need another output\.ledger'):
        none["upper"]["w1"]
    with pytest.raises(AttributeError, match=r"output\.ledger"):
        _ = none["upper"].W
    with pytest.raises(KeyError, match=r"output\.ledger"):
        none.system["applied_work"]
    with pytest.raises(AttributeError, match="no quantity 'w9'"):
        _ = none["upper"].w9
    with pytest.raises(tribo.InputError, match='ledger: must be "asperites" or "surfaces" or'):
        tribo.Output(ledger="all")


def test_text_and_curves(results):
    """The text says that there are no works; curves of single asperites' works are refused."""
    assert "upper: works are not kept, internal energy" in str(results["none"])
    assert "upper: work " in str(results["surfaces"])
    for kind in ("surfaces", "none"):
        with pytest.raises(
            tribo.InputError, match=r"output\.ledger: must be .asperites. for works"
        ):
            results[kind].plot.work("upper", 0)


def test_files_and_json(results, tmp_path):
    """Both hold what is kept, and the scene's file says what that is."""
    for kind, result in results.items():
        result.save(tmp_path / "result.nc")
        loaded = tribo.load_result(tmp_path / "result.nc")
        assert loaded.scene.output.ledger == kind
        one, other = ledgers.tables(result), ledgers.tables(loaded)
        assert one.keys() == other.keys()
        assert all(np.array_equal(values, other[key]) for key, values in one.items())
        end = json.loads(result.to_json())
        assert ("w1" in end["surfaces"]["upper"]) == (kind == "asperites")
        assert ("w1" in end["blocks"]["upper"]) == (kind == "surfaces")
        assert ("W" in end["blocks"]["upper"]) == (kind != "none")
        assert ("w1" in end["error_estimate"]) == (kind != "none")
    with pytest.raises(KeyError, match=r"output\.ledger"):
        loaded["upper"]["w1"]


def test_continued():
    """Works go on with the same ledger, and are counted from the state with another."""
    first = tribo.simulate(replace(encounter("surfaces"), duration=2.0), method="verlet", step=0.05)
    whole = tribo.simulate(encounter("surfaces"), method="verlet", step=0.05)
    same = tribo.simulate(encounter("surfaces"), method="verlet", step=0.05, start=first.state())
    assert same["upper"].w1[-1] == pytest.approx(whole["upper"].w1[-1], abs=1e-12)
    other = tribo.simulate(encounter("none"), method="verlet", step=0.05, start=first.state())
    assert other["upper"].theta[-1] == pytest.approx(whole["upper"].theta[-1], abs=1e-12)


def test_nothing_is_allocated():
    """Without a ledger there are no accounts; sums need eight of each kind at most."""
    scene = ledgers.SCENES["springs, baths and a moving field"]
    layouts = {
        kind: lay_out(replace(scene, output=tribo.Output(ledger=kind)))
        for kind in ("asperites", "surfaces", "none")
    }
    assert layouts["none"].accounts == layouts["none"].room[1] == 0
    assert layouts["none"].model.ledger is None
    assert layouts["surfaces"].accounts < layouts["asperites"].accounts
    larger = replace(scene.surfaces[0], shape=(40, 1), asperite=tribo.Asperite())
    larger = replace(scene, surfaces=(larger, scene.surfaces[1]))
    large = lay_out(replace(larger, output=tribo.Output(ledger="surfaces")))
    assert large.accounts <= layouts["surfaces"].accounts


def test_explained():
    """The text names a ledger that is not the default, and the JSON any."""
    for kind, line in (("surfaces", "sums of works"), ("none", "no works"), ("asperites", "")):
        scene = encounter(kind)
        bobs = Contact(0, False, "lanes", (), 0)
        cost = Predicted(1, 1.0, 1, "counted", None)
        how = ("verlet", "", Threads(1, ""), None, 0.1, True, cost, 0)
        found = Explanation(scene, {}, {}, {}, bobs, *how)
        assert (f"Ledger: {line}" in str(found)) == bool(line)
        assert json.loads(found.to_json())["ledger"] == kind
