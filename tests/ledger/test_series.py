"""Series on request: forces and energies against independent equations, sums and the ledger."""

import json
import math
import pickle
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support import reference
from support.continued import chain, pair
from support.everything import everything
from support.laws import raw_samples
from tribo.layout.layout import lay_out
from tribo.results.averages import mean_text

EVERY = ("forces", "energies", "oscillators")


def asking(scene, *series, **output):
    """The scene with further series."""
    return replace(scene, output=replace(scene.output, series=series, **output))


@pytest.fixture(scope="module")
def result():
    """A run with contact between and within, a field, a pull, a load, springs and a bath."""
    scene = everything(2.0, samples=201)
    fields = (replace(scene.fields[0], velocity=(0.0, 0.0)),)
    return tribo.simulate(
        asking(replace(scene, fields=fields), *EVERY), method="verlet", step=0.002
    )


def vectors(table, name):
    """x and y of a force, (2, times, asperites); zeros where there is none."""
    zero = np.zeros(table.theta.shape)
    return np.array([table.get(f"{name}_{axis}", zero) for axis in "xy"])


@pytest.mark.skipif(reference.compiler() is None, reason="there is no C compiler")
def test_forces_are_those_of_the_reference(result):
    """At every time, along the path of another program, whose steps have no error."""
    tables = [result["upper"], result["lower"]]
    expected = reference.solve(tomllib.loads(result.scene.to_toml())).forces
    for name in ("f1", "f2", "fL", "fR", "f_within", "f_field"):
        theirs = np.array([expected[f"{name}_{axis}"] for axis in "xy"])
        found = np.concatenate([vectors(table, name) for table in tables], axis=2)
        assert found == pytest.approx(theirs, abs=2e-6), name
        assert np.max(np.abs(theirs)) > 0.01, name
    theirs = np.array([expected[f"f_int_{axis}"] for axis in "xy"])
    inner = [vectors(table, "f_spring") + vectors(table, "f_bath") for table in tables]
    assert np.concatenate(inner, axis=2) == pytest.approx(theirs, abs=2e-6)


def test_forces_change_the_momentum(result):
    """Simpson's rule over the sum of all of them; the fastest bath moves by 1/60 turn a sample."""
    step = result.t[1] - result.t[0]
    for name, masses in (("upper", np.array([3.0, 3.5])), ("lower", 3.0)):
        table = result[name]
        names = {key[:-2] for key in table if key.startswith("f") and key.endswith("_x")}
        total = sum(vectors(table, key) for key in names)
        panels = step / 3.0 * (total[:, :-2:2] + 4.0 * total[:, 1:-1:2] + total[:, 2::2])
        impulse = np.cumsum(panels, axis=1)
        velocity = np.array([table.vx_cm, table.vy_cm])
        assert masses * (velocity[:, 2::2] - velocity[:, :1]) == pytest.approx(impulse, abs=2e-6)
        assert np.max(np.abs(impulse)) > 0.1
    assert np.max(np.abs(result["lower"].f_bath_x)) > 1e-3
    for name in ("upper", "lower"):
        table = result[name]
        forces = {"friction_force": ("f1", "f_field"), "pull_force": ("f2",)}
        if "field_force" in table:
            forces |= {"contact_force": ("f1",), "field_force": ("f_field",)}
        for whole, parts in forces.items():
            total = sum(vectors(table, part)[0].sum(axis=1) for part in parts)
            assert table[whole] == pytest.approx(total, abs=1e-14), (name, whole)
    assert "field_force" in result["upper"] and np.ptp(result["upper"].pull_force) > 0.0


def test_energies_close_against_the_ledger(result):
    """Their sum changes as the total energy does, to round-off, and each part as its account."""
    total = result.system["contact_energy"] + result.system["field_energy"]
    for surface in result.scene.surfaces:
        table = result[surface.name]
        parts = {key: table[key] for key in ("k_trans", "k_swing", "k_bar", "e_torsion")}
        total = total + sum(each.sum(axis=1) for each in parts.values())
        total = total + sum(table.get(f"e_{k}", 0.0) for k in ("springs", "within", "bath"))
        total = total + table.get("k_bath", 0.0)
        kappa, m1, m2, length = (surface.each[k] for k in ("kappa", "m1", "m2", "length"))
        twist, reduced = table.theta - surface.rest - table.phi, m1 * m2 / (m1 + m2)
        assert parts["e_torsion"] == pytest.approx(0.5 * kappa * twist**2, abs=1e-14)
        swinging = 0.5 * reduced * (length * table.omega) ** 2
        assert parts["k_swing"] == pytest.approx(swinging, abs=1e-14)
        moving = 0.5 * (m1 + m2) * (table.vx_cm**2 + table.vy_cm**2)
        assert parts["k_trans"] == pytest.approx(moving, abs=1e-14)
        internal = parts["k_swing"] + parts["k_bar"] + parts["e_torsion"]
        assert internal - internal[0] == pytest.approx(table.delta_e_int, abs=1e-13)
        translation = parts["k_trans"] - parts["k_trans"][0]
        assert translation == pytest.approx(table.delta_k_trans, abs=1e-13)
    change = result.system["total_energy_change"]
    assert total - total[0] == pytest.approx(change, abs=1e-13) and np.max(np.abs(change)) > 1.0
    lower = result["lower"]
    assert lower.heat_bath[0] == 0.0
    assert lower.heat_bath[-1] > 1e-3 and lower.k_bath[-1] != lower.e_bath[-1]


def test_names_follow_the_effects(result):
    """Forces and energies that a surface cannot have are no series, and none are by default."""
    upper, lower = result["upper"], result["lower"]
    assert "f_spring_x" in upper and "f_spring_x" not in lower and "f_T_x" not in upper
    assert "k_bath" in lower and "k_bath" not in upper and "e_within" not in lower
    plain = tribo.simulate(everything(1.0, samples=5), method="verlet", step=0.01)
    assert "f1_x" not in plain["upper"] and "field_energy" not in plain.system
    assert raw_samples(plain.ledger).baths.size == 0
    with pytest.raises(tribo.InputError, match=r'output\.series: does not contain "forces"'):
        plain.friction_force("upper")


def test_noise_has_means():
    """f_T is its impulse over the interval; the end alone says the same; runs continue."""
    scene = asking(chain((1.0, 2.0, 4.0)), *EVERY)
    how = {"method": "verlet", "step": 0.02}
    whole = tribo.simulate(scene, **how)
    upper = whole["upper"]
    names = [key[:-2] for key in upper if key.startswith("f") and key.endswith("_x")]
    assert np.all(np.isnan(upper.f_T_x[0])) and np.all(np.isfinite(upper.f_T_x[1:]))
    assert all(np.all(np.isfinite(vectors(upper, name))) for name in names if name != "f_T")
    accounts = raw_samples(whole.ledger).s[:, lay_out(scene).asperites.acc_thermal[:4]]
    mean = np.diff(accounts, axis=0) / np.diff(whole.t)[:, None]
    assert np.array_equal(upper.f_T_x[1:], mean)
    assert whole.end["surfaces"]["upper"]["f_T_x"] == upper.f_T_x[-1].tolist()
    half = tribo.simulate(asking(chain((1.0, 2.0))), **how)
    rest = tribo.simulate(scene, **how, start=half.state())
    for key in ("f_T_x", "f_bath_x", "f1_x", "k_bath", "heat_bath"):
        assert np.array_equal(rest["upper"][key][1:], upper[key][3:]), key
    assert np.all(np.isnan(rest["upper"].f_T_x[0]))  # not the mean since t = 0


def test_means_of_forces_begin_with_the_run_that_goes_on():
    """The first was the mean since t = 0, and averages took all for values at the samples."""
    reservoir = tribo.Langevin(1.0, 0.5, on="swing")
    upper = tribo.Surface(
        "upper", bob=(-2.0, 1.0), velocity=(0.5, 0.0), drive="bars", langevin=reservoir
    )
    lower = tribo.Surface("lower", facing="up", drive="bars", shape=(8, 1), spacing=(1.0, 0.0))
    output = tribo.Output(samples=9, series=("forces",))
    scene = tribo.Scene([upper, lower], tribo.Morse(0.5, 2.0, 1.0), 8.0, output=output)
    how = {"method": "verlet", "step": 0.01}
    half = replace(scene, duration=4.0, output=replace(output, samples=5))
    later = tribo.simulate(scene, start=tribo.simulate(half, **how).state(), **how)
    whole = tribo.simulate(scene, **how)
    pull = later["upper"].pull_force
    assert np.isnan(pull[0]) and np.array_equal(pull[1:], whole["upper"].pull_force[5:])
    impulse = (later["upper"].w2[-1, 0] - later["upper"].w2[0, 0]) / 0.5
    assert later.pull_force("upper").mean == pytest.approx(impulse / 4.0, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("ledger", ["surfaces", "none"])
def test_noise_without_impulses(ledger):
    """Without the ledger of asperites, only the forces with noise are left out."""
    scene, how = chain((1.0, 2.0)), {"method": "verlet", "step": 0.02}
    whole = tribo.simulate(asking(scene, "forces"), **how)["upper"]
    result = tribo.simulate(asking(scene, "forces", ledger=ledger), **how)
    forces = {key for key in whole if key.startswith("f") and key[-2:] in ("_x", "_y")}
    assert forces - set(result["upper"]) == {"f_T_x", "f_T_y"}
    for key in ("f1_x", "f2_x", "f_bath_x", "fL_x", "friction_force", "pull_force"):
        np.testing.assert_allclose(result["upper"][key], whole[key], rtol=1e-12, atol=1e-12)
    reservoir = tribo.Langevin(0.5, 0.1, on="swing")
    bars = replace(
        scene.surfaces[0], langevin=reservoir, drive=tribo.DrivenBars(), bath=tribo.Bath()
    )
    bars = replace(asking(scene, "forces", ledger=ledger), surfaces=(bars, scene.surfaces[1]))
    result = tribo.simulate(bars, **how)
    assert "friction_force" in result["upper"] and "f2_x" not in result["upper"]
    with pytest.raises(tribo.InputError, match=f'ledger: must be "asperites", got "{ledger}"'):
        result.pull_force("upper")


@pytest.mark.slow
def test_reactions_and_rigid_asperites():
    """f2 on driven bars and the ends of rigid asperites balance what acts on them."""
    surfaces = (
        tribo.Surface(
            "upper",
            bob=(-1.0, 0.7),
            velocity=(0.5, 0.0),
            drive=tribo.DrivenBars(),
            initial=tribo.Initial(swing=0.3, omega=-0.4),
        ),
        tribo.Surface(
            "lower", facing="up", drive=tribo.Free(), asperite=tribo.Asperite(kappa=math.inf)
        ),
    )
    output = tribo.Output(samples=201, series=EVERY)
    scene = tribo.Scene(surfaces, tribo.Morse(D=0.1, alpha=2.0, r0=0.5), 2.0, output=output)
    result = tribo.simulate(scene, method="verlet", step=0.002)
    for name in ("upper", "lower"):
        table = result[name]
        total = sum(vectors(table, force) for force in ("f1", "f2", "fL", "fR"))
        velocity = np.array([table.vx_cm, table.vy_cm])
        slope = np.gradient(velocity, result.t, axis=1)
        assert 3.0 * slope[:, 2:-2] == pytest.approx(total[:, 2:-2], abs=1e-3)
        assert np.max(np.abs(total)) > 0.05
    # The couple of the ends holds the pendulum against the forces on bob and bar.
    lower = result["lower"]
    torque = 3.0 * vectors(lower, "fR")[1]
    arm = np.array([lower.x_bob - lower.x_cm, lower.y_bob - lower.y_cm])
    force = vectors(lower, "f1")
    opposite = arm[0] * force[1] - arm[1] * force[0]
    bar = np.array([lower.x_bar - lower.x_cm, lower.y_bar - lower.y_cm])
    drive = vectors(lower, "f2")
    opposite = opposite + bar[0] * drive[1] - bar[1] * drive[0]
    assert torque == pytest.approx(-opposite, abs=1e-12) and np.max(np.abs(torque)) > 0.01


def test_friction_force(result, tmp_path):
    """Mean, interval and spread of it and of its parts, in the JSON and from a file."""
    found = result.friction_force("upper")
    force = result["upper"].friction_force
    assert found.spread == pytest.approx(np.std(force), rel=0.05)
    np.testing.assert_equal(found, tribo.time_average(result.t, force, 0.0))  # nan is nan
    parts = [result.friction_force("upper", part=part) for part in ("contact", "field")]
    contact = tribo.time_average(result.t, result["upper"].f1_x.sum(axis=1), 0.0)
    np.testing.assert_equal(parts[0], contact)
    assert parts[1].spread > 0.0
    assert sum(part.mean for part in parts) == pytest.approx(found.mean, abs=found.spread / 10)
    after = result.friction_force("upper", after=1.0)
    assert after.after == 1.0
    assert after.mean == pytest.approx(np.trapezoid(force[100:], result.t[100:]), abs=0.02)
    end = json.loads(result.to_json())
    assert end["friction_force"]["upper"]["mean"] == found.mean
    assert end["pull_force"]["upper"]["mean"] == result.pull_force("upper").mean
    assert end["blocks"]["upper"]["friction_force"] == force[-1]
    assert end["error_estimate"]["f1_x"] is None
    result.save(tmp_path / "result.nc")
    loaded = tribo.load_result(tmp_path / "result.nc")
    assert loaded.friction_force("upper")[0::2] == found[0::2]
    assert loaded.friction_force("upper", part="field")[0] == parts[1].mean
    assert loaded.pull_force("upper")[0] == result.pull_force("upper").mean
    assert np.array_equal(loaded["lower"].f_bath_y, result["lower"].f_bath_y)
    with pytest.raises(tribo.InputError, match='part: must be "contact" or "field"'):
        result.friction_force("upper", part="drive")
    drawn, average, _ = result.plot.friction_force("upper").get_lines()
    assert np.array_equal(drawn.get_ydata(), force)
    assert list(average.get_ydata()) == [found.mean] * 2
    assert average.get_label() == f"mean {found.mean:.4g}".replace("-", "\N{MINUS SIGN}")


@pytest.mark.parametrize(
    ("mean", "half_width", "shown"),
    [
        (-5.123, 1.52, "-5.1 ± 1.5"),
        (-0.1952, 0.197, "-0.20 ± 0.20"),
        (-4.589, 0.7, "-4.59 ± 0.70"),
        (0.98, 0.0996, "0.98 ± 0.10"),
        (63.39, 11.2, "63 ± 11"),
        (56789.0, 1234.0, "56800 ± 1200"),
        (-0.001, 0.2, "0.00 ± 0.20"),
        (1.23456e-7, 2e-9, "1.235e-07 ± 2.0e-09"),
        (1.23456789e7, 2e3, "1.23457e+07 ± 2.0e+03"),
        (1e-10, 2e-7, "0 ± 2.0e-07"),
        (0.1, 1e-18, "1.000000000000000e-01 ± 1.0e-18"),
        (1.23456, np.nan, "1.235"),
        (1.23456, 0.0, "1.235 ± 0"),
    ],
)
def test_means_end_where_their_half_widths_do(mean, half_width, shown):
    """Two digits of the half-width, and the mean to the same decimal place."""
    assert mean_text(mean, half_width, "±") == shown


def test_oscillators(result, tmp_path):
    """Displacements times stiffnesses are the force on each bar; files and pickles keep them."""
    found, bath = result.oscillators("lower"), result.scene.surfaces[1].bath
    assert found.shape == (201, 2, bath.masses.size, 2)
    stiffness = bath.masses * bath.frequencies**2
    force = np.einsum("m,tamx->xta", stiffness, found)
    assert force == pytest.approx(vectors(result["lower"], "f_bath"), rel=1e-12, abs=1e-14)
    assert np.abs(force).max() > 1e-3 and np.abs(found[0]).max() < 1e-16
    result.save(tmp_path / "result.nc")
    for copy in (tribo.load_result(tmp_path / "result.nc"), pickle.loads(pickle.dumps(result))):
        assert np.array_equal(copy.oscillators("lower"), found)
    with pytest.raises(tribo.InputError, match="upper: has no bath oscillators"):
        result.oscillators("upper")
    with pytest.raises(tribo.InputError, match='does not contain "oscillators"'):
        tribo.simulate(pair(), method="verlet", step=0.1).oscillators("upper")


def test_pairs_and_accuracies(tmp_path):
    """The loop for a pair reports them too; an accuracy of a force is refused."""
    scene = asking(replace(pair(), output=tribo.Output(samples=41)), *EVERY)
    result = tribo.simulate(scene, accuracy=1e-6)
    assert result.met and result["upper"].f1_x == pytest.approx(-result["lower"].f1_x, abs=1e-15)
    # The contact force is minus the slope of the contact energy along the path of the bobs.
    across = result["upper"].x_bob - result["lower"].x_bob
    along = result["upper"].y_bob - result["lower"].y_bob
    r = np.hypot(across, along)
    assert result["upper"].f1_x == pytest.approx(0.2 * across / r**3, rel=1e-12, abs=0.0)
    with pytest.raises(tribo.InputError, match=r"accuracy\.upper\.f1_x: is not a reported"):
        tribo.simulate(scene, accuracy={"upper.f1_x": 1e-3})
    scene.save(tmp_path / "scene.toml")
    assert tribo.load_scene(tmp_path / "scene.toml").output.series == EVERY
    with pytest.raises(
        tribo.InputError,
        match=r"series\[0\]: must be .forces. or .energies. or .contacts. or .own",
    ):
        tribo.Output(series=["force"])
    with pytest.raises(tribo.InputError, match="series: must be a list of words"):
        tribo.Output(series="forces")


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (3.0, -1.0)])
def test_heat_of_the_bath_of_a_bar_that_is_pushed_ever_harder(velocity):
    """One oscillator that lags: its energy about the motion of both, in any frame, is exact.

    The relative coordinate u has u'' = -W^2 u - r t / M, W^2 = w^2 (1 + m / M), from rest.
    """
    m, w, rate, duration = 0.7, 2.0, 0.4, 9.0
    rigid = tribo.Asperite(kappa=np.inf)
    mass = rigid.m1 + rigid.m2
    upper = tribo.Surface(
        "upper",
        bob=(20.0, 5.0),
        velocity=velocity,
        asperite=rigid,
        bath=tribo.Bath(masses=[m], frequencies=[w]),
        drive=tribo.Pushed(force=(0.0, 0.0), rate=(rate, 0.0)),
    )
    lower = tribo.Surface("lower", facing="up", asperite=rigid, velocity=velocity)
    output = tribo.Output(samples=31, series=["energies"])
    contact = tribo.LennardJones(0.1, 0.5).with_cutoff(1.0)
    scene = tribo.Scene((upper, lower), contact, duration, output=output)
    result = tribo.simulate(scene, accuracy=1e-9)
    assert result.met
    t, big = result.t, w * np.sqrt(1.0 + m / mass)
    u = -rate / (mass * big**2) * (t - np.sin(big * t) / big)
    du = -rate / (mass * big**2) * (1.0 - np.cos(big * t))
    lag = du * mass / (mass + m)
    heat = 0.5 * m * (lag**2 + w**2 * u**2)
    assert result["upper"].heat_bath == pytest.approx(heat, abs=1e-8)
    common = 0.5 * m * (0.5 * rate * t[-1] ** 2 / (mass + m)) ** 2
    assert heat[-1] < 0.2 * common  # in the frame of the start it would be the larger part


def test_the_work_of_a_stage_along_both_axes():
    """Springs along x and y and the load do all work on a block; the springs' part has no loss."""
    drive = tribo.Pulled(stiffness=5.0, stiffness_y=4.0, speed=0.1, load=0.1, block=True)
    tip = tribo.Surface(
        "tip",
        shape=(3, 1),
        spacing=(1.0, 0.0),
        asperite=tribo.Asperite(kappa=np.inf),
        drive=drive,
        langevin=tribo.Langevin(gamma=1.0),
    )
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"])
    output = tribo.Output(samples=401)
    scene = tribo.Scene([tip], [], 20.0, fields=[field], output=output)
    table = tribo.simulate(scene, method="rk4", step=0.01)["tip"]
    stored = table.e_pull - table.e_pull[0]
    load = -0.1 * (table.y_cm[:, 0] - table.y_cm[0, 0])
    works = np.sum(table.w2, axis=1)
    assert works == pytest.approx(table.stage_work - stored + load, abs=1e-6)
    assert np.ptp(table.y_cm) > 1e-3


def test_the_energy_of_a_stage_at_a_body_of_pendulums():
    """Springs hold the mean of the bars, whose height a swing changes; the budget closes."""
    drive = tribo.Pulled(stiffness=3.0, stiffness_y=4.0, speed=0.3, load=0.4, block=True)
    upper = tribo.Surface(
        "upper",
        bob=(0.3, 1.0),
        shape=(3, 1),
        spacing=(1.2, 1.2),
        drive=drive,
        asperite=tribo.Asperite(kappa=1.0),
        elastic={"modulus": 2.0, "poisson": 0.3},
        initial={"theta": 0.6},
    )
    periods = {"x": 3.6, "z": 1.2}
    output = tribo.Output(samples=101)
    scene = tribo.Scene((upper,), [], 2.0, periodic=periods, output=output)
    result = tribo.simulate(scene, method="dop853", accuracy=1e-8)
    table = result["upper"]
    load = -0.4 * np.mean(table.y_bar - table.y_bar[0], axis=1)
    total = result.system["total_energy_change"] + table.e_pull - table.e_pull[0]
    assert total == pytest.approx(table.stage_work + load, abs=1e-5)


def test_a_stiff_bath_moves_with_its_bar():
    """Its oscillator has kinetic energy, and takes up no heat."""
    surface = tribo.Surface(
        "s",
        asperite=tribo.Asperite(kappa=np.inf),
        drive=tribo.Pushed(force=(0.2, 0.0)),
        bath=tribo.Bath(masses=[0.5], frequencies=[200.0]),
    )
    output = tribo.Output(samples=11, series=["energies"])
    scene = tribo.Scene([surface], [], 5.0, output=output)
    table = tribo.simulate(scene, method="rk4", step=0.001)["s"]
    assert abs(table.heat_bath[-1]) < 1e-3 * table.k_bath[-1]


def test_the_kinetic_energy_of_a_bath_counts_both_axes():
    """1/2 m v^2 of an oscillator that starts with its bar, which moves along x and y."""
    surface = tribo.Surface(
        "s",
        asperite=tribo.Asperite(kappa=np.inf),
        velocity=(0.3, 0.4),
        bath=tribo.Bath(masses=[0.5], frequencies=[2.0]),
    )
    output = tribo.Output(samples=2, series=["energies"])
    result = tribo.simulate(tribo.Scene([surface], [], 1.0, output=output), accuracy=1e-6)
    assert result["s"].k_bath[0] == pytest.approx(0.5 * 0.5 * 0.5**2, rel=1e-12, abs=0.0)


def test_forces_on_a_driven_bar_change_its_momentum():
    """Contact and reaction along y, over time, are the change of the momentum of the swing."""
    start = {"theta": 1.0, "omega": 2.0}
    upper = tribo.Surface("upper", bob=(-1.0, 0.0), drive="bars", initial=start)
    lower = tribo.Surface("lower", facing="up", bob=(0.0, -1.0), drive="bars")
    output = tribo.Output(samples=801, series=["forces"])
    scene = tribo.Scene([upper, lower], tribo.Gaussian(0.2, 0.5), 2.0, output=output)
    result = tribo.simulate(scene, accuracy=1e-8)
    table = result["upper"]
    impulse = np.trapezoid((table.f1_y + table.f2_y)[:, 0], result.t)
    mass = scene.surfaces[0].each["mass"][0]
    change = mass * (table.vy_cm[-1, 0] - table.vy_cm[0, 0])
    assert abs(change) > 0.1
    assert impulse == pytest.approx(change, abs=1e-4)
