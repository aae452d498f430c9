"""Methods that a user adds: they run, are predicted, searched and shown as built-in ones."""

import re
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support import page_diffs
from tribo import InputError
from tribo.integrators.methods import METHODS

HEUN = {"a": [[], [1 / 3], [0, 2 / 3]], "b": [1 / 4, 0, 3 / 4]}  # of order 3
# M. Suzuki, Phys. Lett. A 146 (1990) 319: five leapfrog steps of order 4.
P = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
SUZUKI = [P, P, 1.0 - 4.0 * P, P, P]
# P. Bogacki, L. F. Shampine, Appl. Math. Lett. 2 (1989) 321: orders 3 and 2.
BOGACKI = {
    "a": [[], [1 / 2], [0, 3 / 4], [2 / 9, 1 / 3, 4 / 9]],
    "b": [2 / 9, 1 / 3, 4 / 9, 0],
    "embedded": [7 / 24, 1 / 4, 1 / 3, 1 / 8],
}
OWN = {"heun-3": (3, HEUN), "suzuki-4": (4, {"weights": SUZUKI}), "bogacki-3": (3, BOGACKI)}


@pytest.fixture(autouse=True)
def own_methods():
    """All of them, for the time of a test."""
    for name, (order, coefficients) in OWN.items():
        tribo.add_method(name, order, **coefficients)
    yield
    for name in OWN:
        del METHODS[name]


def scene() -> tribo.Scene:
    """Case A of the paper around the encounter."""
    case = replace(tribo.paper.scene("A"), duration=4.0, output=tribo.Output(samples=3))
    upper, lower = case.surfaces
    return replace(case, surfaces=(replace(upper, bob=(-2.0, 0.0)), lower))


@pytest.mark.parametrize("name", ["heun-3", "suzuki-4"])
def test_errors_fall_with_the_order(name):
    """Of the motion and of the ledger, with two steps."""
    order, _ = OWN[name]
    exact = tribo.simulate(scene(), accuracy=1e-11)
    runs = [tribo.simulate(scene(), method=name, step=step) for step in (0.02, 0.01)]
    for quantity in ("theta", "w1"):
        wanted = exact["upper"][quantity][-1, 0]
        one, other = (abs(run["upper"][quantity][-1, 0] - wanted) for run in runs)
        assert np.log2(one / other) == pytest.approx(order, abs=0.4)


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("progress", [True, False])
def test_an_accuracy_is_searched(name, progress, capsys):
    """With a bar, which needs a cost, and without."""
    result = tribo.simulate(scene(), method=name, accuracy=1e-5, progress=progress)
    exact = tribo.simulate(scene(), accuracy=1e-11)
    assert result.met and result.method == name
    error = abs(result["upper"].w1[-1, 0] - exact["upper"].w1[-1, 0])
    assert error <= result.error_estimate["w1"]


def test_a_run_is_predicted():
    """From the step, which counts the stages."""
    given = replace(scene(), numerics=tribo.Numerics(method="heun-3", step=0.01))
    explained = tribo.explain(given)
    assert explained.method == "heun-3"
    assert explained.predicted.force_evaluations == tribo.simulate(given).cost.force_evaluations


def test_members_run_in_lanes():
    """Each has the bits of its single run."""
    vary = {"upper.theta": [0.0, 0.1, 0.2]}
    how = {"method": "suzuki-4", "step": 0.01}
    ends = replace(scene(), output=tribo.Output(samples=2))  # as members, which keep their ends
    members = tribo.ensemble(ends, 3, vary=vary, keep=["upper.w1"], **how)
    surfaces = tuple(_with_theta(surface) for surface in ends.surfaces)
    alone = tribo.simulate(replace(ends, surfaces=surfaces), **how)
    assert float(members["upper.w1"].values[2].ravel()[-1]) == alone["upper"].w1[-1, 0]


def _with_theta(surface: tribo.Surface) -> tribo.Surface:
    initial = tribo.Initial(theta=0.2) if surface.name == "upper" else surface.initial
    return replace(surface, initial=initial)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"name": "heun-3", "order": 4, "weights": SUZUKI}, "name: is that of another method"),
        ({"name": "mine", "order": 4, **HEUN}, "order: must be 3, that of these coefficients"),
        ({"name": "mine", "order": 2, "a": [[1.0]], "b": [1.0]}, "a[0]: must be 0 weights"),
        ({"name": "mine", "order": 4, "weights": [1.0]}, "weights: must be numbers with a sum of"),
        ({"name": "mine", "order": 2, "a": [[]]}, "b: is missing"),
        ({"name": "My own", "order": 1, "a": [[]], "b": [1.0]}, "name: must be lower-case"),
    ],
)
def test_what_is_no_method_is_refused(given, said):
    """By one sentence."""
    with pytest.raises(InputError, match=re.escape(said)):
        tribo.add_method(**given)


def test_a_method_that_another_process_lacks_is_refused():
    """By the names of those that there are."""
    with pytest.raises(InputError, match=r'^method: must be "midpoint" or "rk4"'):
        tribo.simulate(scene(), method="another", step=0.01)


def test_the_page_shows_a_method_as_it_is_in_two_files(tmp_path):
    """Without the diff of the page the method is gone; with it, the sources are these."""
    files = page_diffs.files("a_method")
    assert len(files) == 2
    page_diffs.applied("a_method", tmp_path, reverse=True)
    without = (tmp_path / "src/tribo/integrators/methods.py").read_text(encoding="utf-8")
    assert "kahan-li-6" in without and "kahan-li-8" not in without
    page_diffs.changed("a_method", tmp_path)
    for file in files:
        assert (tmp_path / file).read_bytes() == (page_diffs.ROOT / file).read_bytes()
