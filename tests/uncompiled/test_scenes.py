"""Short scenes by each method, against an independent solver and the laws of the ledger."""

from contextlib import nullcontext

import numpy as np
import pytest

from support import inactive, ledgers
from support.uncompiled.ledger import (
    ALL,
    NO_REFERENCE,
    compare,
    ends,
    limit_of_steps,
    lowered,
    simulate,
    solution,
)
from support.uncompiled.pair import registers_as_arrays
from support.uncompiled.scenes import PAIRS

LISTS = {"layout.contacts.UNLISTED_PAIRS": 0}


def thorough(*values):
    """A case without which the sample of mutants is tried: these take half of the time of all."""
    return pytest.param(*values, marks=pytest.mark.thorough)


@pytest.mark.parametrize(
    ("scene", "step"),
    [
        *((s, 0.05) for s in ("slid", "pulled", "lattice", "open", "twisting", "held")),
        *((s, 0.05) for s in ("swinging", "waves")),
        thorough("by hand", 0.05),
        thorough("pushed", 0.1),
        thorough("rows", 0.02),
    ],
)
def test_midpoint(scene, step):
    """The limit of small steps agrees with the solution."""
    compare(limit_of_steps(scene, "midpoint", step, 2), solution(scene), 1e-3)


@pytest.mark.parametrize(
    ("scene", "step", "tolerance"),
    [
        ("pushed", 0.1, 1e-5),
        ("open", 0.05, 1e-5),  # its identities are exact
        ("held", 0.05, 1e-3),
        ("swinging", 0.05, 1e-3),
    ],
)
def test_verlet(scene, step, tolerance):
    """The limit of small steps agrees with the solution."""
    compare(limit_of_steps(scene, "verlet", step, 2), solution(scene), tolerance)


@pytest.mark.parametrize("method", [thorough("midpoint"), "verlet"])
def test_listed_pairs(method):
    """With neighbour lists for few bobs."""
    with lowered(LISTS):
        compare(limit_of_steps("rows", method, 0.02, 2), solution("rows"), 1e-3)


@pytest.mark.parametrize("scene", ["slid", "pulled", "lattice", "twisting", "loaded"])
def test_kahan_li_6(scene):
    """The limit of small steps agrees with the solution."""
    compare(limit_of_steps(scene, "kahan-li-6", 0.25, 6), solution(scene), 1e-5)


def test_gauss_8():
    """The limit of small steps agrees with the solution."""
    compare(limit_of_steps("slid", "gauss-8", 0.25, 8), solution("slid"), 1e-6)


@pytest.mark.parametrize(
    "limits",
    [
        pytest.param({}, id="whole"),
        pytest.param(
            {"ledger.sinks.SERIES_BYTES": 0, "ledger.sinks.PORTION_BYTES": 0}, id="streamed"
        ),
        pytest.param({"layout.span.SPAN_SIZE": 1}, id="batches"),
    ],
)
def test_rk4(limits):
    """The limit of small steps agrees with the solution, in whatever parts the ledger is made."""
    with lowered(limits):
        compare(limit_of_steps("slid", "rk4", 0.1, 4), solution("slid"), 1e-4)


ADAPTIVE = ("dop853", "rkn8", "rkn12", "gauss-radau-15")


@pytest.mark.parametrize("method", [thorough(method) for method in ADAPTIVE])
def test_accuracy(method):
    """A run to an accuracy agrees with the solution."""
    compare(ends(simulate(ALL["slid"], method=method, accuracy=1e-8)), solution("slid"), 1e-7)


@pytest.mark.parametrize("scene", ["forced on free", "free on free"])
def test_pair(scene):
    """The loop for one asperite on one, with arrays in place of registers."""
    with registers_as_arrays():
        run = simulate(ALL[scene], method="gauss-radau-15", accuracy=1e-8)
    compare(ends(run), solution(scene), 1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "scene", "most"),
    [
        pytest.param("dop853", "slid", 2450, id="test_accuracy[dop853]"),
        pytest.param("rkn8", "slid", 2740, id="test_accuracy[rkn8]"),
        pytest.param("rkn12", "slid", 1780, id="test_accuracy[rkn12]"),
        pytest.param("gauss-radau-15", "slid", 2470, id="test_accuracy[gauss-radau-15]"),
        pytest.param("gauss-radau-15", "forced on free", 2230, id="test_pair[forced on free]"),
        pytest.param("gauss-radau-15", "free on free", 2190, id="test_pair[free on free]"),
    ],
)
def test_cost(method, scene, most):
    """A run to an accuracy agrees with the solution, and costs no more than it should.

    The bounds on evaluations, those of the error's estimate included, are a tenth above the cost
    when they were set: a mutant of step control or of a prediction changes no result, but makes
    more and shorter steps.  The names are those of tests that reach the same functions.
    """
    slowly = f"{scene}, slowly"
    with registers_as_arrays() if scene in PAIRS else nullcontext():
        run = simulate(ALL[slowly], method=method, accuracy=1e-7)
    assert run.cost.force_evaluations <= most
    compare(ends(run), solution(slowly), 3e-7)


@pytest.mark.parametrize(
    ("scene", "method", "order"),
    [
        thorough("damped", "verlet", 2),
        ("damped twice", "verlet", 2),
        ("block", "rk4", 4),
        ("tilting", "rk4", 4),
    ],
)
def test_two_methods(scene, method, order):
    """The limits of two methods for small steps agree, where no independent solution exists."""
    one = list(limit_of_steps(scene, method, 0.05, order))
    other = list(limit_of_steps(scene, "midpoint", 0.05, 2))
    compare([*one, *other], NO_REFERENCE, 1e-3)
    for (place, values), (_, others) in zip(one, other, strict=True):
        for name in values:
            assert np.allclose(values[name], others[name], 0.0, 1e-3), f"{place}: {name}"


@pytest.mark.parametrize(
    ("scene", "method"),
    [
        *((s, "verlet") for s in ("arms alike", "pulled and loaded", "driven bars")),
        *((s, "verlet") for s in ("rigid asperites", "reservoirs")),
        ("springs, baths and a moving field", "verlet"),
        ("springs, baths and a moving field", "midpoint"),
    ],
)
def test_ledgers(scene, method):
    """What runs with different ledgers keep is the same."""
    assert ledgers.wrong_with(scene, method) == []


@pytest.mark.thorough
def test_inactive_asperites():
    """Those that are not stepped, in a short run, and how that is decided."""
    with lowered(LISTS | {"layout.contacts.MARGIN": 2}):
        turning = inactive.crossing((2.1,), 24, 2)
        assert inactive.check_paths(turning) == ""
        assert inactive.check(inactive.crossing((2.1,), 24, 2, "clamped", 7.5)) == ""


@pytest.mark.parametrize("method", ["midpoint", "verlet"])
def test_bars_that_stand(method):
    """Driven bars at rest receive no work, though their pendulums swing."""
    upper, lower = ALL["held"]["surface"]
    initial = upper["initial"] | {"nu": 0.0}
    upper = upper | {"velocity": [0.0, 0.0], "initial": initial}
    table = ALL["held"] | {"surface": [upper, lower | {"velocity": [0.3, 0.0]}]}
    works = simulate(table, method=method, step=0.05)[upper["name"]]
    assert np.max(np.abs(works["w1"])) > 1e-3
    for name in ("w2", "wL", "wR"):
        assert np.max(np.abs(works[name])) <= 1e-14, name
