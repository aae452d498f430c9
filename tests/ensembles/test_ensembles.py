"""Ensembles: means against closed forms, coverage of intervals, independence of members."""

import json
import tomllib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest
from scipy import stats

import tribo
from support.scene_tables import scene_from
from tribo import (
    Asperite,
    Coulomb,
    Initial,
    InputError,
    Langevin,
    Output,
    Roughness,
    Scene,
    Surface,
    ensemble,
    plotting,
)
from tribo.accuracy.plan import Plan
from tribo.ensembles import batches
from tribo.ensembles.dataset import COUNTS
from tribo.ensembles.figure import mean_band
from tribo.ensembles.means import FIRST_STAGE
from tribo.results.averages import interval, members_needed

TEMPERATURE = 0.3
LIGHT = Asperite(m2=0.5)


def warm(count=2, temperature=TEMPERATURE, **settings):
    """Asperites on reservoirs, without contact; after a time of 20 they are in equilibrium.

    With light bars and that friction the slowest motion decays as exp(-0.3 t).
    """
    surface = Surface(
        "upper",
        shape=(count, 1),
        spacing=(5.0, 0.0),
        asperite=LIGHT,
        langevin=Langevin(0.6, temperature),
        **settings,
    )
    return Scene((surface,), (), 20.0, output=Output(samples=3), seed=3)


def meeting(**settings):
    """Two rough rows in contact, without noise."""
    row = {"shape": (3, 1), "spacing": (1.5, 0.0), "heights": Roughness(0.1)}
    upper = Surface("upper", bob=(-1.0, 0.5), velocity=(0.5, 0.01), **row)
    lower = Surface("lower", facing="up", **row)
    return Scene((upper, lower), Coulomb(0.2), 4.0, output=Output(samples=5), **settings)


STEP = {"method": "verlet", "step": 0.05}


def series(data):
    """The members' own series, as one array."""
    names = [name for name in data.data_vars if data[name].dims == ("member", "time")]
    return np.array([data[name].values for name in names])


# --- means ---------------------------------------------------------------------------------------


def test_equipartition():
    """From a cold start: T for the motion as a whole, T/2 for each of the other quadratic terms.

    N asperites have 2 N momenta of centres of mass, N of swings, and N springs.
    """
    data = ensemble(warm(), 400, seed=1)
    for name, degrees in (("upper.delta_K", 2), ("total_energy_change", 8)):
        wanted = 0.5 * degrees * TEMPERATURE
        mean, half = (float(data[f"{name}_{end}"][-1]) for end in ("mean", "half_width"))
        assert half < 0.15 * wanted
        assert mean == pytest.approx(wanted, abs=2.0 * half)
        # The interval is as wide as the energy of so many degrees, a gamma distribution, says.
        sigma = TEMPERATURE * np.sqrt(0.5 * degrees / 400)
        assert half == pytest.approx(1.96 * sigma, rel=0.25)


def test_lost_energy():
    """At T = 0 each asperite loses what its swing was given: kappa theta^2 / 2 + I omega^2 / 2."""
    given = {"upper.theta": stats.norm(0.0, 0.2), "upper.omega": stats.uniform(-0.3, 0.6)}
    data = ensemble(warm(temperature=0.0), 200, given, **STEP)
    each = LIGHT.for_each(1)
    kappa, inertia = each["kappa"][0], each["inertia"][0]
    for spread, key in ((0.2, "upper.theta"), (0.6 / np.sqrt(12.0), "upper.omega")):
        assert data[key].shape == (200, 2)
        assert np.std(data[key]) == pytest.approx(spread, rel=0.12)
        assert abs(np.corrcoef(data[key].values.T)[0, 1]) < 0.25
    energy = 0.5 * (kappa * data["upper.theta"] ** 2 + inertia * data["upper.omega"] ** 2)
    lost = data["total_energy_change"][:, -1] + energy.sum("upper_asperite")
    assert np.abs(lost).max() < 1e-3 * energy.max()
    expected = -2 * 0.5 * (kappa * 0.2**2 + inertia * 0.6**2 / 12.0)
    mean, half = (float(data[f"total_energy_change_{x}"][-1]) for x in ("mean", "half_width"))
    assert mean == pytest.approx(expected, abs=2.0 * half)


def test_means_are_of_the_members():
    """The mean over the members, and Student's interval, as in SciPy."""
    data = ensemble(meeting(), 9, {"upper.theta": stats.norm(0.0, 0.1)}, **STEP)
    values = data["upper.W"].values[:, -1]
    low, high = stats.t.interval(0.95, 8, np.mean(values), stats.sem(values))
    mean, half = float(data["upper.W_mean"][-1]), float(data["upper.W_half_width"][-1])
    np.testing.assert_allclose([mean - half, mean + half], [low, high], rtol=1e-12)


# --- intervals -----------------------------------------------------------------------------------


def bounds(repetitions):
    """Counts of covering 95 % intervals in that many, with a probability of 0.9999."""
    return stats.binom.interval(0.9999, repetitions, 0.95)


def covered(values, truth, first=None):
    """Whether the interval contains the true mean."""
    found = interval(values, first)
    return abs(float(found.mean) - truth) <= float(found.half_width)


def test_intervals_of_runs_cover_the_truth():
    """In 200 ensembles of six: the internal energy of 20 asperites, nearly normal, is known."""
    scene = replace(warm(20), output=Output(times=(0.0, 20.0)))
    values = ensemble(scene, 1200, seed=5, step=0.1)["upper.delta_E_int"].values[:, -1]
    truth = (4 * 20 - 2) * 0.5 * TEMPERATURE
    right = sum(covered(part, truth) for part in values.reshape(200, 6))
    low, high = bounds(200)
    assert low <= right <= high


def test_two_stages_cover_and_are_narrow_enough():
    """Stein's rule on normal values of which the first few decide how many there are."""
    rng = np.random.default_rng(1)
    right, narrow = 0, 0
    for _ in range(4000):
        values = rng.normal(0.3, 1.0, 2000)
        n = int(members_needed(values[:5], 0.5))
        assert 5 <= n < 2000
        right += covered(values[:n], 0.3, 5)
        narrow += float(interval(values[:n], 5).half_width) <= 0.5
    low, high = bounds(4000)
    assert low <= right <= high
    assert narrow == 4000


def test_half_width_determines_the_number():
    """The number is by Stein's rule, and the half-width at most the one asked for."""
    scene, wanted = warm(), {"upper.delta_E_int": 0.05, "applied_work": 0.1}
    data = ensemble(scene, half_width=wanted, seed=2, step=0.1)
    first = data.isel(member=slice(0, FIRST_STAGE))
    totals = ("upper.W", "upper.W_ps", "upper.delta_K", "upper.delta_E_int", "applied_work")
    scale = max(
        float(np.abs(run.ledger.series(name)[0]).max())
        for seed in first["seed"].values.tolist()
        for run in [tribo.simulate(replace(scene, seed=seed), step=0.1)]
        for name in (*totals, "total_energy_change")
    )
    needed = [members_needed(first[name].values, x * scale) for name, x in wanted.items()]
    assert data.sizes["member"] == max(needed) > FIRST_STAGE
    for name, x in wanted.items():
        assert float(data[f"{name}_half_width"].max()) <= x * scale
    assert "Stein" in data.attrs["notes"]


# --- members -------------------------------------------------------------------------------------


def test_members_do_not_depend_on_how_many_there_are():
    """Nor on other varied quantities; another seed gives others."""
    vary = {"upper.theta": stats.norm(0.0, 0.1)}
    few, many = (ensemble(warm(), n, vary, seed=4, step=0.1) for n in (3, 7))
    np.testing.assert_array_equal(series(few), series(many)[:, :3])
    more = ensemble(warm(), 3, {"upper.omega": stats.norm()} | vary, seed=4, step=0.1)
    np.testing.assert_array_equal(more["upper.theta"], few["upper.theta"])
    np.testing.assert_array_equal(more["seed"], few["seed"])
    both = ensemble(warm(), 3, {"upper.omega": vary["upper.theta"]} | vary, step=0.1)
    assert not np.any(both["upper.theta"].values == both["upper.omega"].values)
    other = ensemble(warm(), 3, vary, seed=5, step=0.1)
    assert not np.any(other["upper.theta"].values == few["upper.theta"].values)
    assert not np.any(other["upper.W"][:, 1:].values == few["upper.W"][:, 1:].values)
    assert len(np.unique(many["seed"])) == 7


def test_a_member_is_a_run():
    """Of the scene with the member's values and seed, to round-off, and the scene's heights."""
    vary = {
        "upper.velocity": np.array([[0.4, 0.0], [0.5, -0.02]]),
        "lower.theta": np.pi + np.array([[0.1, 0.0, -0.1], [0.0, 0.2, 0.0]]),
    }
    scene = meeting(seed=8)
    lower = replace(scene.surfaces[1], langevin=Langevin(0.5, 0.1))
    scene = replace(scene, surfaces=(scene.surfaces[0], lower))
    data = ensemble(scene, 2, vary, step=0.05)
    kept = scene_from(tomllib.loads(data.attrs["scene"]))
    for k in range(2):
        upper, lower = kept.surfaces
        upper = replace(upper, velocity=tuple(vary["upper.velocity"][k]))
        lower = replace(lower, initial=Initial(theta=vary["lower.theta"][k]))
        one = tribo.simulate(
            replace(kept, surfaces=(upper, lower), seed=int(data["seed"][k])), step=0.05
        )
        for name, wanted in (
            ("upper.W", one["upper"].W),
            ("contact_energy", one.system["contact_energy"]),
            ("upper.w2", one["upper"].w2.sum(axis=1)),
            ("lower.heat", one["lower"].heat.sum(axis=1)),
        ):
            np.testing.assert_allclose(data[name][k], wanted, rtol=1e-11, atol=1e-12)
    for own, all_ in zip(kept.surfaces, scene.surfaces, strict=True):
        drawn = all_.resting_bobs(seed=[8, scene.surfaces.index(all_), 0])
        np.testing.assert_array_equal(own.resting_bobs(), drawn)


def test_thermal_starts():
    """A warm bath starts differently in each member, about the bars of that member.

    A theta that is not given follows phi, in a member as in a scene.
    """
    bath = tribo.Bath(masses=[0.2, 0.1], frequencies=[0.8, 2.0], temperature=0.2)
    upper = Surface("upper", bars="free", bath=bath)
    scene = Scene((upper,), (), 4.0, output=Output(samples=5))
    data = ensemble(scene, 3, {"upper.phi": [0.1, 0.1, 0.4]}, **STEP)
    for k, phi in enumerate(data["upper.phi"].values[:, 0]):
        turned = replace(upper, initial=Initial(phi=float(phi)))
        own = replace(scene, surfaces=(turned,), seed=int(data["seed"][k]))
        one = tribo.simulate(own, **STEP)["upper"]
        for name, wanted in (("delta_E_int", one.delta_E_int), ("w_int", one.w_int.sum(axis=1))):
            np.testing.assert_allclose(data[f"upper.{name}"][k], wanted, rtol=1e-11, atol=1e-12)
    assert np.all(data["upper.w_int"][0, 1:].values != data["upper.w_int"][1, 1:].values)


def test_one_number_of_a_velocity_is_its_x_component():
    """The y component stays the scene's."""
    data = ensemble(meeting(), 2, {"upper.velocity": [0.3, 0.4]}, **STEP)
    np.testing.assert_array_equal(data["upper.velocity"], [[0.3, 0.01], [0.4, 0.01]])
    drawn = ensemble(meeting(), 3, {"upper.velocity": stats.uniform(0.3, 0.2)}, **STEP)
    assert drawn["upper.velocity"].shape == (3, 2)
    assert np.all((drawn["upper.velocity"][:, 0] > 0.3) & (drawn["upper.velocity"][:, 0] < 0.5))


def test_members_of_a_planned_scene():
    """Members are within the bound on their errors of a loop over runs at a finer accuracy."""
    starts = [0.1, -0.2, 0.3]
    data = ensemble(meeting(), 3, {"upper.theta": starts})
    exact = tribo.prepare(meeting(), accuracy=1e-11)
    for k, theta in enumerate(starts):
        run = exact.run({"upper.theta": theta})
        for name in ("W", "w2"):
            series = run["upper"][name].reshape(5, -1).sum(axis=1)
            bound = float(data[f"upper.{name}_error"])
            assert np.abs(data[f"upper.{name}"][k] - series).max() <= bound
            assert bound <= 3 * 1e-8 * np.abs(run["upper"].w2).max()
    assert json.loads(data.attrs["step"]) is None
    assert "upper.W_bias" not in data


def test_every_engine_gives_the_same_bits():
    """New processes, which load a plug-in of the scene; and an engine that only has map."""
    scene = meeting()
    vary = {"upper.theta": stats.norm(0.0, 0.1), "upper.velocity": stats.uniform(0.3, 0.2)}

    class Mapper:
        map = staticmethod(map)

    told = []
    here = ensemble(scene, 40, vary, progress=told.append, **STEP)
    assert told[-1] == 40
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        for engine in (pool, Mapper()):
            there = ensemble(scene, 40, vary, engine=engine, **STEP)
            assert there.drop_attrs().identical(here.drop_attrs())


# --- honesty -------------------------------------------------------------------------------------


def test_bias_of_a_step():
    """Errors of order two: a step and its half are 3/4 of a step's own error apart."""
    scene, starts = meeting(), np.linspace(-0.3, 0.3, 20)
    data = ensemble(scene, 20, {"upper.theta": starts}, method="verlet", step=0.2)
    exact = ensemble(scene, 20, {"upper.theta": starts})
    off = (data["upper.W"] - exact["upper.W"]).values[:FIRST_STAGE].mean(axis=0)
    np.testing.assert_allclose(data["upper.W_bias"][1:], 0.75 * off[1:], rtol=0.05)
    assert float(data["upper.W_bias_half_width"][-1]) > 0.0


def test_members_that_stop_early_are_in_no_mean():
    """They keep their place and their status, and a note gives their number."""
    scene = meeting()
    speeds = np.array([0.5, 400.0, 0.4])
    data = ensemble(scene, 3, {"upper.velocity": speeds}, method="verlet", step=0.1)
    assert data["status"].values.tolist() == ["completed", "EncounterJumped", "completed"]
    alone = ensemble(scene, 2, {"upper.velocity": speeds[::2]}, method="verlet", step=0.1)
    for end in ("mean", "half_width", "bias"):
        np.testing.assert_array_equal(data[f"upper.W_{end}"], alone[f"upper.W_{end}"])
    assert np.isnan(data["upper.W"][1, -1])
    assert "1 of 3 members stopped early (EncounterJumped)" in data.attrs["notes"]
    with pytest.raises(InputError, match="1 of 3 members"):
        ensemble(scene, 3, {"upper.velocity": speeds * [1, 1, 800]}, method="verlet", step=0.1)


def test_series_too_long_to_hold(monkeypatch):
    """Surfaces as wholes keep theirs; sums over asperites are refused."""
    whole = ensemble(warm(), 3, step=0.1)
    monkeypatch.setattr("tribo.ledger.sinks.SERIES_BYTES", 0)
    data = ensemble(warm(), 3, step=0.1)
    np.testing.assert_allclose(data["upper.W_mean"], whole["upper.W_mean"], atol=1e-12)
    assert "upper.heat" in whole and "upper.heat" not in data
    assert "only the first and the last sample are kept" in data.attrs["notes"]
    with pytest.raises(InputError, match="give fewer samples"):
        ensemble(warm(), half_width={"upper.heat": 1.0}, step=0.1)


def test_an_interrupt_keeps_what_is_complete(monkeypatch):
    """At least two members; fewer have no mean."""
    monkeypatch.setattr(batches, "CHUNK", 1)

    def stop(at):
        def progress(done):
            if done >= at:
                raise KeyboardInterrupt

        return progress

    with pytest.raises(KeyboardInterrupt) as caught:
        ensemble(warm(), 50, step=0.1, progress=stop(5))
    data = caught.value.result
    assert data.attrs["status"] == "Interrupted" and data.sizes["member"] == 8
    whole = ensemble(warm(), 8, step=0.1)
    np.testing.assert_array_equal(data["upper.W_mean"], whole["upper.W_mean"])
    with pytest.raises(KeyboardInterrupt):
        ensemble(warm(), 50, step=0.1, progress=stop(1))


def test_an_interrupt_while_settings_are_checked(monkeypatch):
    """The means are complete, but not the check."""

    def interrupted(plan):
        raise KeyboardInterrupt

    monkeypatch.setattr(Plan, "at_half_step", interrupted)
    with pytest.raises(KeyboardInterrupt) as caught:
        ensemble(warm(), 5, step=0.1)
    data = caught.value.result
    assert data.attrs["status"] == "Interrupted" and data.sizes["member"] == 5
    assert "upper.W_bias" not in data and np.all(np.isfinite(data["upper.W_mean"]))


def test_a_file_keeps_it(tmp_path):
    """NetCDF, with all variables and attributes."""
    import xarray

    data = ensemble(warm(), 3, {"upper.theta": [0.1, 0.2, 0.3]}, step=0.1)
    data.to_netcdf(tmp_path / "means.nc")
    assert xarray.load_dataset(tmp_path / "means.nc").equals(data)
    assert scene_from(tomllib.loads(data.attrs["scene"])).count == 2
    assert json.loads(data.attrs["step"]) == 0.1


def test_units_and_names():
    """Every variable and coordinate has a long name; every number has units."""
    data = ensemble(meeting(), 3, {"upper.theta": [0.1, 0.2, 0.3], "upper.velocity": [0.4] * 3})
    data = data.drop_vars(["member", "seed", "status", "axis", *COUNTS])
    for name, variable in data.variables.items():
        assert variable.attrs["long_name"] and variable.attrs["units"], name
    expected = {"upper.W_half_width": "energy", "upper.theta": "rad", "time": "time"}
    expected |= {"upper.velocity": "length time^-1", "upper.w2_error": "energy"}
    for name, units in expected.items():
        assert data[name].attrs["units"] == units
    assert data["upper.w2_mean"].long_name == "mean of: work of the drive, all asperites"


def test_further_series():
    """Those of the surfaces as wholes that the scene's output asks for have means, too."""
    scene = warm(springs=tribo.Springs(2.0))
    scene = replace(scene, output=Output(samples=3, series=("forces", "energies")))
    data = ensemble(scene, members=3, seed=2, step=0.05)
    alone = tribo.simulate(replace(scene, seed=int(data.seed[1])), step=0.05)
    for name in ("friction_force", "e_springs"):
        expected = alone.ledger.of("upper")[name]
        assert data[f"upper.{name}"].values[1].tobytes() == expected.tobytes()
    assert data["upper.e_springs_mean"].units == "energy"
    assert data["upper.e_springs"].values[:, -1].min() > 0.0


def test_figure(tmp_path):
    """Members, mean and interval; a quantity without a mean is refused."""
    data = ensemble(warm(), 4, step=0.1)
    ax = mean_band(data, "upper.W")
    *members, mean = ax.get_lines()
    for line, values in zip(members, data["upper.W"].values, strict=True):
        np.testing.assert_array_equal(line.get_ydata(), values)
    np.testing.assert_array_equal(mean.get_ydata(), data["upper.W_mean"])
    assert plotting.save(ax, str(tmp_path / "W.png")).stat().st_size > 5000
    with pytest.raises(InputError, match=r"name: must be one of upper\.W, .* got 'upper\.theta'"):
        mean_band(data, "upper.theta")


# --- refusals ------------------------------------------------------------------------------------

THETA = {"upper.theta": stats.norm(0.0, 0.1)}


@pytest.mark.parametrize(
    ("settings", "field", "words"),
    [
        ({"vary": THETA}, "members", "is missing"),
        ({"vary": THETA, "members": 1}, "members", "at least 2"),
        ({"members": 4, "vary": {}}, "vary", "all members would be the same"),
        ({"members": 4, "vary": [1]}, "vary", "must map names"),
        (
            {"members": 4, "vary": {"upper.tetha": [1.0]}},
            "vary.upper.tetha",
            "the velocity of a surface",
        ),
        ({"members": 4, "vary": {"top.velocity": [1.0]}}, "vary.top.velocity", "of a surface"),
        ({"members": 4, "vary": {"upper.phi": [1.0] * 4}}, "vary.upper.phi", "clamped"),
        ({"members": 4, "vary": {"upper.theta": 0.1}}, "vary.upper.theta", "a distribution"),
        (
            {"members": 4, "vary": {"upper.theta": [0.1] * 3}},
            "vary.upper.theta",
            "4 members, got 3",
        ),
        (
            {"members": 2, "vary": {"upper.theta": np.ones((2, 2))}},
            "vary.upper.theta",
            "(members, 3",
        ),
        ({"members": 2, "vary": {"upper.theta": [0.1, np.nan]}}, "vary.upper.theta", "finite"),
        (
            {"members": 2, "vary": {"upper.theta": ["a", "b"]}},
            "vary.upper.theta",
            "must be numbers",
        ),
        (
            {"members": 2, "vary": {"upper.velocity": stats.multivariate_normal([0.0] * 3)}},
            "vary.upper.velocity",
            "must draw 1 or 2 numbers, got 3",
        ),
        ({"members": 2, "vary": THETA, "seed": -1}, "seed", "an integer"),
        ({"members": 2, "vary": THETA, "engine": 3}, "engine", "submit or map"),
        ({"vary": THETA, "half_width": 1e-2}, "half_width", "must map quantities"),
        ({"vary": THETA, "half_width": {"upper.phi": 1.0}}, "half_width", "one of"),
        ({"vary": THETA, "half_width": {"upper.W": 0.0}}, "half_width.upper.W", "positive"),
        (
            {"members": 20, "vary": THETA, "half_width": {"upper.W": 1e-4}, **STEP},
            "half_width.upper.W",
            "members by the spread of the first 16, and at most 20 are allowed",
        ),
        ({"members": 2, "vary": THETA, "method": "verlet"}, "step", "is missing"),
    ],
)
def test_refusals(settings, field, words):
    """Each names its field and the problem."""
    with pytest.raises(InputError) as error:
        ensemble(meeting(), **settings)
    assert error.value.field == field
    assert words in error.value.problem


def test_chaos_takes_a_step():
    """If no accuracy of single runs can be kept, a step is required; noise has its own."""
    row = {"shape": (6, 1), "spacing": (1.1, 0.0), "asperite": Asperite(kappa=0.5)}
    start = Initial(theta=(0.0, 0.02, -0.01, 0.03, 0.01, -0.02))
    upper = Surface("upper", bob=(0.0, 0.9), velocity=(0.8, 0.0), initial=start, **row)
    jones = tribo.LennardJones(0.3, 1.0).with_cutoff(2.5)
    lower = Surface("lower", facing="up", **row)
    box = {"periodic": {"x": 6.6}, "output": Output(samples=9)}
    with pytest.raises(InputError, match=r"out of reach.*give a method and a step"):
        ensemble(Scene((upper, lower), jones, 60.0, **box), 4, {"upper.theta": stats.norm(0, 0.1)})
    assert (
        json.loads(ensemble(warm(), 2).attrs["step"]) == tribo.prepare(warm()).settings.setting.step
    )


def test_noise_points_to_ensembles():
    """The refusal of an accuracy with thermal noise names ensembles."""
    with pytest.raises(InputError, match=r"average over runs, as tribo\.ensemble does"):
        tribo.simulate(warm(), accuracy=1e-3)
