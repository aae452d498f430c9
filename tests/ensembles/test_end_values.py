"""Ends of many members: the same bits as single runs, and no error beyond the accuracy."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Output, ensemble, paper
from tribo.ensembles import pair_runs
from tribo.run.initial_state import InitialState

KEEP = [f"{s}.{q}" for s in ("upper", "lower") for q in ("w1", "w2", "delta_e_int", "omega")]
KEEP += ["upper.W", "contact_energy", "total_energy_change"]
STARTS = {"upper.theta": stats.uniform(0.0, 0.2), "lower.theta": stats.norm(np.pi, 0.01)}


def scene_of(case, accuracy=1e-6):
    """A case of the paper with start and end alone."""
    numerics = tribo.Numerics(accuracy=accuracy)
    return replace(paper.scene(case), numerics=numerics, output=Output(samples=2))


def scales_of(result):
    """The scale of energies of a run."""
    tables = result.ledger.surfaces.values()
    names = [n for t in tables for n in t if n.startswith(("w", "delta_"))]
    return max(float(np.abs(t[n]).max()) for t in tables for n in names)


@pytest.mark.parametrize("case", ["A", "C"])
def test_members_are_single_runs(case):
    """Bit for bit, by the loop of single runs with the setting that the data set names."""
    scene = scene_of(case)
    data = ensemble(scene, 100, STARTS, keep=KEEP)
    simulation = tribo.prepare(scene)
    names = ("upper.theta", "lower.theta")
    for member in (0, 7, 99):
        start = {name: float(data[name][member, 0]) for name in names}
        scales = tribo.accuracy.scales.ToleranceScales(*json.loads(data.attrs["scales"]))
        tolerance = pair_runs.tolerance_at(simulation, scales, float(data["level"][member]))
        y = InitialState(simulation.layout)(start)
        run = simulation.integrator(tolerance, simulation.layout.times, y)
        ledger = tribo.run.ledger.assemble(simulation.layout, run.samples)
        assert run.steps == data["steps"][member]
        for name in KEEP:
            np.testing.assert_array_equal(data[name][member], ledger.series(name)[0][-1], name)


def test_neither_threads_nor_number_change_a_member():
    """Members of several chunks and blocks of draws."""
    scene = scene_of("A")
    many = ensemble(scene, 5000, STARTS, keep=KEEP, threads=1)
    two = ensemble(scene, 5000, STARTS, keep=KEEP, threads=2)
    few = ensemble(scene, 300, STARTS, keep=KEEP)
    for name in [*KEEP, "level", "steps", "seed", *STARTS]:
        np.testing.assert_array_equal(many[name], two[name])
        np.testing.assert_array_equal(many[name][:300], few[name])


@pytest.mark.parametrize("accuracy", [1e-6, 1e-10])
@pytest.mark.parametrize("case", ["A", "B", "C", "D"])
def test_errors_are_within_the_accuracy(case, accuracy):
    """Against runs of single members at a finer accuracy."""
    data = ensemble(scene_of(case, accuracy), 200, STARTS, keep=KEEP)
    assert set(data["status"].values) == {"completed"}
    exact = tribo.prepare(scene_of(case, 1e-2 * accuracy))
    for member in range(0, 200, 9):
        start = {name: float(data[name][member, 0]) for name in STARTS}
        run = exact.run(start)
        scale = scales_of(run)
        for name in KEEP:
            if not name.endswith("omega"):
                error = np.abs(data[name][member] - run.ledger.series(name)[0][-1]).max()
                assert error <= accuracy * scale, name


def test_closer_members_than_those_of_the_sample_are_refined():
    """Members behind the first ones swing a hundred times faster, and need finer settings."""
    scene = scene_of("A")
    rates = np.full(300, 0.0)
    rates[[150, 222]] = 3.0, -4.0
    data = ensemble(scene, 300, {"upper.omega": rates}, keep=KEEP)
    assert data["level"][150] < data["level"][0] or np.isnan(data["level"][150])
    exact = tribo.prepare(replace(scene, numerics=tribo.Numerics(accuracy=1e-11)))
    for member in (0, 150, 222):
        run = exact.run({"upper.omega": float(rates[member])})
        assert run.met
        error = np.abs(data["upper.w1"][member] - run["upper"].w1[-1]).max()
        assert data["status"][member] == "completed"
        assert error <= 1e-6 * scales_of(run)
