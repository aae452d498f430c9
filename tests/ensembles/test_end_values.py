"""Ends of many members: the same bits as single runs, and no error beyond the accuracy."""

import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Initial, InputError, Output, ensemble, paper
from tribo.accuracy.levels import ToleranceScales, setting_at
from tribo.accuracy.plan import NEAR_ALONE
from tribo.ensembles import batches, checked_runs, runner
from tribo.ensembles.checked_runs import checked_plan
from tribo.ensembles.members import Variation
from tribo.integrators.tableaux import RKN8, RKN12
from tribo.kernels.status import CODE, PAUSED
from tribo.layout.initial_state import InitialState
from tribo.layout.own_numbers import member_numbers
from tribo.ledger.ledger import assemble
from tribo.loops.batch import MemberStarts
from tribo.loops.batch_pair import PairLanes, PairMembers, has_lanes
from tribo.model.parameters import with_values

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
    """Bit for bit, by the loop of single runs with the setting that the data set names.

    With a motion along y there is no other way than the collocation.
    """
    scene = scene_of(case)
    upper, lower = scene.surfaces
    scene = replace(scene, surfaces=(replace(upper, velocity=(upper.velocity[0], 1e-3)), lower))
    data = ensemble(scene, 100, STARTS, keep=KEEP)
    assert data.attrs["method"] == "gauss-radau-15"
    simulation = tribo.prepare(scene)
    names = ("upper.theta", "lower.theta")
    for member in (0, 7, 99):
        start = {name: float(data[name][member, 0]) for name in names}
        scales = ToleranceScales(*json.loads(data.attrs["scales"]))
        tolerance = setting_at(
            simulation.layout, simulation.method, scales, float(data["level"][member]), NEAR_ALONE
        )
        y = InitialState(simulation.layout)(start)
        run = simulation.integrator(tolerance, simulation.layout.times, y)
        ledger = tribo.ledger.ledger.assemble(simulation.layout, run.samples)
        assert run.steps == data["steps"][member]
        for name in KEEP:
            np.testing.assert_array_equal(data[name][member], ledger.series(name)[0][-1], name)


def starts_of(layout, swings):
    """Members that differ in the swing of the first asperite."""
    y = np.tile(layout.start, (swings.size, 1))
    y[:, 0] = swings
    return MemberStarts(y, np.zeros(swings.size, int))


@pytest.mark.parametrize("case", ["A", "C"])
@pytest.mark.parametrize("method", [RKN8, RKN12])
def test_members_in_lanes_alone(case, method):
    """The same bits in any lane and company; the last of the crowd fill no register."""
    simulation = tribo.prepare(scene_of(case))
    pair = simulation.integrator.pair
    assert has_lanes(pair)
    starts = starts_of(simulation.layout, np.linspace(-1.2, 0.4, 45))
    loop, tolerance = PairLanes(pair, method), simulation.plan.setting
    crowd = loop.run(tolerance, starts)
    assert np.all(crowd.counts[:, 0] == 0)
    for member in (0, 8, 17, 44):
        alone = loop.run(tolerance, starts.of_members(slice(member, member + 1)))
        together = crowd.samples.of_members(np.array([member]))
        np.testing.assert_array_equal(alone.samples.y, together.y)
        np.testing.assert_array_equal(alone.samples.s, together.s)
        np.testing.assert_array_equal(alone.counts[0], crowd.counts[member])


@pytest.mark.parametrize("case", ["A", "B", "C", "D"])
@pytest.mark.parametrize("method", [RKN8, RKN12])
def test_formulas_of_lanes_are_the_integrated_accounts(case, method):
    """Every quantity at the end, against the collocation, which integrates the accounts."""
    simulation = tribo.prepare(scene_of(case, 1e-11))
    layout, pair = simulation.layout, simulation.integrator.pair
    assert has_lanes(pair)
    starts = starts_of(layout, np.linspace(-0.3, 0.3, 9))
    tolerance = simulation.plan.setting
    found = PairLanes(pair, method).run(tolerance, starts)
    wanted = PairMembers(pair).run(tolerance, starts)
    ledgers = [assemble(layout, runs.samples) for runs in (found, wanted)]
    for name in KEEP:
        one, other = (ledger.series(name)[0][-9:] for ledger in ledgers)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("case", ["A", "C"])
def test_lanes_are_chosen(case):
    """Where they agree with the collocation they cost less."""
    assert ensemble(scene_of(case), 70, STARTS, keep=KEEP).attrs["method"] == "rkn8"


def test_neither_threads_nor_number_change_a_member():
    """Members of several chunks and blocks of draws."""
    scene = scene_of("A")
    many = ensemble(scene, 20_000, STARTS, keep=KEEP, threads=1)
    two = ensemble(scene, 20_000, STARTS, keep=KEEP, threads=2)
    few = ensemble(scene, 4096, STARTS, keep=KEEP)
    for name in [*KEEP, "level", "steps", "seed", *STARTS]:
        np.testing.assert_array_equal(many[name], two[name])
        np.testing.assert_array_equal(many[name][:4096], few[name])


def test_few_members_with_large_errors_are_found():
    """At the setting that the first 64 members allow, 1 % of these angles miss the accuracy."""
    keep = ["upper.omega", "upper.theta", "upper.w1"]
    starts = {"upper.theta": stats.norm(0.0, 0.1), "lower.theta": stats.norm(np.pi, 0.1)}
    ends = [ensemble(scene_of("A", a), 4096, starts, keep=keep, seed=3) for a in (1e-9, 1e-12)]
    angles, exact = (each["upper.theta_end"].values for each in ends)
    assert np.abs(angles - exact).max() < 1e-9


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
    """Members that are not in the sample swing a hundred times faster, and need finer settings."""
    scene = scene_of("A")
    rates = np.full(300, 0.0)
    rates[[151, 222]] = 3.0, -4.0
    data = ensemble(scene, 300, {"upper.omega": rates}, keep=KEEP)
    assert data["level"][151] < data["level"][0] or np.isnan(data["level"][151])
    exact = tribo.prepare(replace(scene, numerics=tribo.Numerics(accuracy=1e-11)))
    for member in (0, 151, 222):
        run = exact.run({"upper.omega": float(rates[member])})
        assert run.met
        error = np.abs(data["upper.w1"][member] - run["upper"].w1[-1]).max()
        assert data["status"][member] == "completed"
        assert error <= 1e-6 * scales_of(run)


def test_members_that_coincide_stop_by_name():
    """They have no values, and neither have they an effect on others."""
    scene = scene_of("A")
    upper, lower = scene.surfaces
    touching = replace(upper, bob=lower.bob, initial=Initial(theta=0.3))
    scene = replace(scene, surfaces=(touching, lower))
    swings = np.array([0.3, 0.0, 0.4, 0.5])
    data = ensemble(scene, 4, {"upper.theta": swings}, keep=["upper.w1"], method="gauss-radau-15")
    assert data["status"].values[1] == "BobsCoincide"
    assert np.isnan(data["upper.w1"][1]).all()
    assert np.isfinite(data["upper.w1"][[0, 2, 3]]).all()


def test_members_with_noise(monkeypatch):
    """Each is the run of the scene with its seed, whatever the threads and its company."""
    monkeypatch.setattr(batches, "CHUNK", 3)
    scene = replace(noisy_scene(), output=Output(samples=5))
    keep = ["upper.w_T", "upper.delta_e_int", "upper.delta_E_int", "total_energy_change"]
    vary = {"upper.theta": stats.norm(0.0, 0.1)}
    data = ensemble(scene, 8, vary, seed=3, step=0.05, keep=keep, at="samples", threads=2)
    assert data.attrs["own_numbers"] == "[]"
    for member in (0, 4, 7):
        theta, seed = data["upper.theta"][member].values, int(data["seed"][member])
        own = replace(scene.surfaces[0], initial=Initial(theta=theta))
        run = tribo.simulate(replace(scene, surfaces=(own,), seed=seed), step=0.05)
        alone = tribo.ensemble_member(data, member)
        for name in keep:
            np.testing.assert_array_equal(data[name][member], run.ledger.series(name)[0], name)
            np.testing.assert_array_equal(data[name][member], alone[name][0], name)


def test_members_with_a_step_stop_by_name():
    """As single runs do; the others have values."""
    scene = rows_of_two(bob=(0.0, 0.0))
    swings = np.array([[0.3, 0.2], [0.0, 0.2], [0.4, 0.1]])
    settings = {"method": "verlet", "step": 0.02, "keep": ["upper.w1"]}
    data = ensemble(scene, 3, {"upper.theta": swings}, **settings)
    assert data["status"].values.tolist() == ["completed", "BobsCoincide", "completed"]
    assert np.isnan(data["upper.w1"][1]).all()
    assert np.isfinite(data["upper.w1"][[0, 2]]).all()


# Starts of members of `rows_of_two`.
ROW_STARTS = {"upper.theta": stats.uniform(0.0, 0.2), "lower.omega": stats.norm(0.0, 0.1)}


def noisy_scene():
    """Three asperites with reservoirs, and baths that are drawn."""
    bath = tribo.Bath(masses=[0.1], frequencies=[2.0], temperature=0.3)
    warm = tribo.Surface("upper", shape=(3, 1), langevin=tribo.Langevin(0.6, 0.3), bath=bath)
    return tribo.Scene((warm,), (), 4.0)


def rows_of_two(**upper):
    """Two asperites over two."""
    row = {"shape": (2, 1), "spacing": (3.0, 0.0)}
    above = tribo.Surface("upper", **{"bob": (-1.0, 0.5), "velocity": (0.5, 0.0), **row, **upper})
    lower = tribo.Surface("lower", facing="up", **row)
    return tribo.Scene((above, lower), tribo.Coulomb(0.2), 4.0)


def test_other_scenes_and_engines():
    """Members of noisy scenes are runs of the member's scene; engines give the same bits."""
    scene = replace(noisy_scene(), output=Output(samples=5))
    (warm,) = scene.surfaces
    keep = ["upper.w_T", "upper.delta_E_int", "total_energy_change"]
    vary = {"upper.velocity": [0.1, 0.2, 0.3]}
    data = ensemble(scene, 3, vary, seed=3, step=0.05, keep=keep)
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        there = ensemble(scene, 3, vary, seed=3, step=0.05, keep=keep, engine=pool)
        batches = ensemble(scene, 3, seed=3, step=0.05, keep=keep, engine=pool)
        rows = ensemble(rows_of_two(), 70, ROW_STARTS, keep=["upper.w1"], engine=pool)
    here = ensemble(scene, 3, seed=3, step=0.05, keep=keep)
    for name in keep:
        np.testing.assert_array_equal(data[name], there[name])
        np.testing.assert_array_equal(here[name], batches[name])
    here = ensemble(rows_of_two(), 70, ROW_STARTS, keep=["upper.w1"])
    np.testing.assert_array_equal(here["upper.w1"], rows["upper.w1"])
    own = replace(warm, velocity=(0.3, 0.0))
    seed, ends = int(data["seed"][2]), Output(samples=2)
    run = tribo.simulate(replace(scene, surfaces=(own,), seed=seed, output=ends), step=0.05)
    np.testing.assert_array_equal(data["upper.w_T"][2], run["upper"].w_T[-1])
    np.testing.assert_array_equal(data["upper.delta_E_int"][2], run["upper"].delta_E_int[-1])
    assert data["upper.w_T"].dims == ("member", "upper_asperite")


def test_members_of_rows_alone(monkeypatch):
    """The same bits in any company, and to round-off those of a single run with its setting."""
    monkeypatch.setattr(batches, "CHUNK", 16)
    scene = rows_of_two()
    vary = ROW_STARTS
    keep = ["upper.w1", "lower.w2", "lower.delta_e_int", "upper.W", "contact_energy"]
    data = ensemble(scene, 100, vary, keep=keep, at="samples", threads=2)
    assert set(data["status"].values) == {"completed"}
    simulation = tribo.prepare(scene)
    scales = ToleranceScales(*json.loads(data.attrs["scales"]))
    for member in (0, 17, 99):
        alone = tribo.ensemble_member(data, member)
        start = {name: data[name][member].values for name in vary}
        setting = setting_at(
            simulation.layout, simulation.method, scales, float(data["level"][member]), NEAR_ALONE
        )
        y = InitialState(simulation.layout)(start)
        run = simulation.integrator(setting, simulation.layout.times, y)
        assert run.steps == data["steps"][member]
        for name in keep:
            values = assemble(simulation.layout, run.samples).series(name)[0]
            np.testing.assert_allclose(data[name][member], values, rtol=0.0, atol=1e-14)
            np.testing.assert_array_equal(data[name][member], alone[name][0], name)


def test_a_member_of_another_scene_gets_the_settings_it_needs():
    """A member that misses the accuracy with the plan's settings gets finer ones."""
    scene = rows_of_two()
    upper, lower = scene.surfaces
    data = ensemble(scene, 3, {"upper.omega": [0.0, 3.0, -5.0]}, keep=["upper.w1"])
    assert set(data["status"].values) == {"completed"}
    for member, omega in enumerate([0.0, 3.0, -5.0]):
        surface = replace(upper, initial=Initial(omega=omega))
        run = tribo.simulate(replace(scene, surfaces=(surface, lower)), accuracy=1e-10)
        error = np.abs(data["upper.w1"][member] - run["upper"].w1[-1]).max()
        assert error <= 1e-6 * scales_of(run)


def test_a_data_set_of_ends_is_a_file(tmp_path):
    """Whole, with the starts as coordinates."""
    data = ensemble(scene_of("A"), 70, STARTS, keep=["upper.theta", "upper.w1"])
    data.to_netcdf(tmp_path / "ends.nc")
    import xarray

    with xarray.open_dataset(tmp_path / "ends.nc") as again:
        assert again["upper.theta_end"].dims == ("member", "upper_asperite")
        np.testing.assert_array_equal(again["upper.theta"], data["upper.theta"])
        np.testing.assert_array_equal(again["upper.theta_end"], data["upper.theta_end"])
    assert np.isfinite(data["error"][: checked_runs.SAMPLE]).all()
    assert float(data["error"].max()) <= 1e-6


def test_an_interrupt_keeps_the_members_that_are_complete(monkeypatch):
    """In whole chunks, of both kinds of scenes."""

    def stop(done):
        if done >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        ensemble(scene_of("A"), 20_000, STARTS, keep=["upper.w1"], progress=stop)
    data = caught.value.result
    assert data.attrs["status"] == "Interrupted"
    assert data.sizes["member"] == batches.CHUNK
    monkeypatch.setattr(batches, "CHUNK", 8)
    with pytest.raises(KeyboardInterrupt) as caught:
        ensemble(noisy_scene(), 20, step=0.05, keep=["upper.w_T"], progress=stop)
    data = caught.value.result
    assert data.sizes["member"] == 8


@pytest.mark.parametrize(
    ("settings", "field", "words"),
    [
        ({"keep": "upper.w1"}, "keep", "must be a list of quantities"),
        ({"keep": []}, "keep", "must be a list of quantities"),
        ({"keep": ["w1"]}, "keep.w1", "must be a quantity of a surface"),
        ({"keep": ["upper.w9"]}, "keep.upper.w9", "must be a quantity of a surface"),
        ({"keep": ["upper.wfriction"]}, "keep.upper.wfriction", 'is it "upper.friction_work"'),
        ({"keep": ["upper.w1"], "threads": 0}, "threads", "at least 1"),
        ({"keep": ["upper.w1"], "half_width": {"upper.W": 0.1}}, "half_width", "cannot go with"),
    ],
)
def test_refusals(settings, field, words):
    """By the name of the argument."""
    with pytest.raises(InputError, match=words) as refused:
        ensemble(scene_of("A"), 3, STARTS, **settings)
    assert refused.value.field == field


def test_one_search(monkeypatch):
    """Members of a pair find their settings; its own run needs none, unless rounding matters."""

    def search(*arguments):
        raise AssertionError("a search")

    few = partial(ensemble, scene_of("A"), 40, STARTS, keep=["upper.w1"])
    with monkeypatch.context() as context:
        context.setattr("tribo.accuracy.plan.find_settings", search)
        assert (few(accuracy=1e-7)["status"] == "completed").all()
        # Small errors that grow take levels far below the accuracy.
        context.setattr(runner, "checked_plan", lambda *a: checked_plan(*a)._replace(level=1e-9))
        with pytest.raises(AssertionError, match="a search"):
            few(accuracy=1e-7)
    with pytest.raises(InputError, match=r"out of reach.*give a method and a step"):
        few(accuracy=1e-13)


NUMBERS = {
    "upper.velocity": stats.uniform(0.4, 0.2),
    "upper.asperite.m1": stats.uniform(0.8, 0.4),
    "upper.asperite.length": stats.uniform(1.8, 0.4),
    "lower.asperite.kappa": stats.uniform(1.5, 1.0),
    "lower.asperite.charge": stats.uniform(0.5, 1.0),
    "interaction.strength": stats.uniform(0.1, 0.1),
    "upper.theta": stats.uniform(0.0, 0.2),
}


@pytest.mark.parametrize("case", ["A", "C"])
def test_numbers_of_their_own(case):
    """Members in lanes have the values of single runs of their scenes, alone the same bits."""
    scene = scene_of(case)
    data = ensemble(scene, 300, NUMBERS, keep=KEEP, threads=2)
    assert data.attrs["method"].startswith("rkn")
    assert set(data["status"].values) == {"completed"}
    assert np.isfinite(data["error"][:64]).all()
    assert float(data["error"].max()) <= 1e-6
    few = ensemble(scene, 70, NUMBERS, keep=KEEP, threads=1)
    variation = Variation(scene, NUMBERS, 0)
    for member in (0, 33, 69):
        alone = tribo.ensemble_member(data, member)
        own = variation.members(np.array([member])).scene(0, scene, with_start=True)
        run = tribo.simulate(own, accuracy=1e-10)
        for name in KEEP:
            np.testing.assert_array_equal(data[name][member], alone[name][0], name)
            np.testing.assert_array_equal(data[name][member], few[name][member], name)
            error = np.abs(data[name][member] - run.ledger.series(name)[0][-1]).max()
            assert error <= 1e-6 * scales_of(run), name


def test_own_numbers_in_lanes():
    """Those of the scene change no bit; a member that moves along y needs another loop."""
    simulation = tribo.prepare(scene_of("A"))
    layout, pair, tolerance = simulation.layout, simulation.integrator.pair, simulation.plan.setting
    starts = starts_of(layout, np.linspace(-1.2, 0.4, 11))
    usual = PairLanes(pair, RKN8).run(tolerance, starts)
    own = PairLanes(pair, RKN8, own_numbers=True)
    speeds = np.tile(simulation.scene.surfaces[0].velocity, (11, 1))
    numbers = member_numbers(layout, 11, {"upper.velocity": speeds})
    same = own.run(tolerance, starts._replace(numbers=numbers))
    np.testing.assert_array_equal(same.samples.y, usual.samples.y)
    np.testing.assert_array_equal(same.counts, usual.counts)
    speeds[4, 1] = 1e-3
    numbers = member_numbers(layout, 11, {"upper.velocity": speeds})
    moved = own.run(tolerance, starts._replace(numbers=numbers))
    assert np.flatnonzero(moved.counts[:, CODE] == PAUSED).tolist() == [4]


def test_own_numbers_that_need_finer_settings():
    """A member that is in no sample, far from all others, is detected."""
    scene = scene_of("A")
    strengths = np.full(300, 0.2)
    strengths[[151, 222]] = 1e-6, 40.0
    data = ensemble(scene, 300, {"interaction.strength": strengths}, keep=KEEP)
    for member in (0, 151, 222):
        assert data["status"][member] == "completed"
        one = with_values(scene, {"interaction.strength": float(strengths[member])})
        run = tribo.simulate(one, accuracy=1e-10)
        for name in ("upper.w1", "lower.delta_e_int"):
            error = np.abs(data[name][member] - run.ledger.series(name)[0][-1]).max()
            assert error <= 1e-6 * scales_of(run), (member, name)
    assert np.isfinite(data["error"][151]) or np.isnan(data["level"][151])


def test_numbers_of_their_own_over_time():
    """At all times, with motion along y."""
    scene = replace(paper.scene("A"), output=Output(samples=5))
    vary = {"upper.velocity": [[0.5, 0.01], [0.4, -0.02]], "lower.asperite.m2": [2.0, 2.5]}
    data = ensemble(scene, 2, vary, keep=["upper.w2", "upper.W", "lower.x_cm"], at="samples")
    run = tribo.simulate(
        Variation(scene, vary, 0).members(np.arange(2)).scene(1, scene), accuracy=1e-10
    )
    for name in ("upper.w2", "upper.W", "lower.x_cm"):
        error = np.abs(data[name][1] - run.ledger.series(name)[0]).max()
        assert error <= 1e-6 * scales_of(run), name


def test_parameters_by_dotted_keys():
    """A member is the run of the scene with its numbers."""
    scene = scene_of("A")
    vary = {
        "upper.asperite.kappa": stats.uniform(1.0, 0.5),
        "interaction.strength": [0.2, 0.15, 0.1],
        "upper.theta": [0.0, 0.1, 0.2],
    }
    data = ensemble(scene, 3, vary, keep=["upper.w1", "lower.delta_e_int"])
    assert data["upper.asperite.kappa"].dims == ("member",)
    assert len(set(data["upper.asperite.kappa"].values.tolist())) == 3
    upper, lower = scene.surfaces
    for member in range(3):
        kappa = float(data["upper.asperite.kappa"][member])
        asperite = replace(upper.asperite, kappa=kappa)
        start = Initial(theta=vary["upper.theta"][member])
        own = replace(upper, asperite=asperite, initial=start)
        (contact,) = scene.interactions
        strong = replace(contact, potential=tribo.Coulomb(vary["interaction.strength"][member]))
        one = replace(scene, surfaces=(own, lower), interactions=(strong,))
        run = tribo.simulate(one, accuracy=1e-10)
        for name in ("upper.w1", "lower.delta_e_int"):
            error = np.abs(data[name][member] - run.ledger.series(name)[0][-1]).max()
            assert error <= 1e-6 * scales_of(run)
    with pytest.raises(InputError, match=r"kappa.*must not be negative"):
        ensemble(scene, 2, {"upper.asperite.kappa": [1.0, -1.0]}, keep=["upper.w1"])
    with pytest.raises(InputError, match="number of the scene"):
        ensemble(scene, 3, {"upper.asperite.colour": [1.0, 2.0, 3.0]}, keep=["upper.w1"])
