"""No clock decides a result: the same bits and the same refusals at any speed of the machine."""

import time
from dataclasses import replace

import pytest

import tribo
from support.hard_scenes import Well, changed, side_by_side
from support.laws import tables
from tribo import Coulomb, Forced, InputError, Langevin, LennardJones
from tribo.accuracy import search

CLOCKS = ("time", "perf_counter", "monotonic", "process_time", "thread_time")
# The runs below take about 1 ms: fast clocks show 100 s.
SLOWER, FASTER = 1e-5, 1e5


def outcome(scene, how):
    """Everything that prepared runs report but durations, or the refusal."""
    try:
        simulation = tribo.prepare(scene, **how)
        results = [simulation.compute_first(), simulation.compute()]
        results.append(simulation.compute(estimate=False))
    except InputError as error:
        return str(error)
    return [(simulation.method.name, *reported(result)) for result in results]


def reported(result):
    """Status, notes, counts, error estimates and the bits of every series of a result."""
    series = (values for _, table in tables(result) for values in table.values())
    bits = [values.tobytes() for values in (result.t, *series)]
    counts = (result.cost.steps, result.cost.force_evaluations)
    return result.status, result.met, result.notes, counts, result.error_estimate, bits


def run_clocks_at(monkeypatch, rate):
    """Let every clock of Python run at another rate."""
    for name in CLOCKS:
        for suffix, kind in (("", float), ("_ns", int)):
            clock = getattr(time, name + suffix)
            monkeypatch.setattr(
                time, name + suffix, lambda clock=clock, kind=kind: kind(rate * clock())
            )


def outcomes(monkeypatch, scene, how):
    """What happens at the usual rate, by slow clocks and by fast ones."""
    found = []
    for rate in (1.0, SLOWER, FASTER):
        with monkeypatch.context() as patch:
            run_clocks_at(patch, rate)
            found.append(outcome(scene, how))
    return found


def noisy():
    """Case A with a warm reservoir."""
    scene = changed("A")
    upper, lower = scene.surfaces
    return replace(scene, surfaces=(replace(upper, langevin=Langevin(0.1, 0.2)), lower))


SCENES = {
    "a pair": (changed("B", gap=0.0), {"accuracy": 1e-6}),
    "a hard core": (
        changed("A", potential=LennardJones(1.0, 0.1), speed=2.0),
        {"accuracy": 1e-6, "method": "dop853"},
    ),
    "an accuracy that is missed": (
        changed("A", potential=Well(100.0, 20.0, 0.3), gap=0.28),
        {"accuracy": 1e-13},
    ),
    "equal steps": (changed("A"), {"step": 0.01}),
    "a collision": (side_by_side(Forced()), {"step": 0.001}),
    "noise": (noisy(), {"step": 0.01}),
}


# The default set has a pair, a search that ends early, and equal steps.
SLOW = {"a hard core", "equal steps", "noise"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in SCENES]
)
def test_same_bits_by_any_clock(monkeypatch, name):
    """Series, counts, estimates and notes do not change."""
    usual, slow, fast = outcomes(monkeypatch, *SCENES[name])
    assert isinstance(usual, list)
    assert slow == usual
    assert fast == usual


def test_same_refusal_by_any_clock(monkeypatch):
    """A request out of reach is refused for what its runs would cost in evaluations."""
    monkeypatch.setattr(search, "LONG_RUN", 1e3)
    weak = changed("A", potential=Coulomb(1e-8), gap=0.3)  # its works amplify round-off
    usual, slow, fast = outcomes(monkeypatch, weak, {"accuracy": 1e-11})
    assert "out of reach" in usual
    assert slow == fast == usual
