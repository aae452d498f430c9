"""Blocks that turn about z: equations, conservation, ledger, continuation, refusals."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj

import tribo
from support.laws import largest_gaps, tables
from support.rough_block import COUNT, PENDULUMS, RIGID, rough_block
from support.transformations import translated
from tribo import (
    Asperite,
    Corrugation,
    Coulomb,
    Custom,
    Field,
    Free,
    Initial,
    InputError,
    Langevin,
    Output,
    Pulled,
    Pushed,
    Scene,
    Springs,
    Surface,
)

FREE = {"block": True, "tilt": "free"}
PULL = {"stiffness": 0.8, "speed": 0.5, "load": 1.5} | FREE


def scene(asperite=PENDULUMS, drive=None, **settings):
    """The rough block with tilt, which it begins to turn; pulled unless it has another drive."""
    turning = {"initial": Initial(nu=0.05)}
    return rough_block(asperite, drive or Pulled(**PULL), **turning | settings)


# --- equations -----------------------------------------------------------------------------------


def test_one_asperite_that_tilts_is_one_with_a_free_bar():
    def pair(**upper):
        lower = Surface("lower", facing="up")
        asperite = Asperite(m1=1.3, m2=2.0, i2=0.7)
        bob = {"bob": (-3.0, 1.0), "velocity": (0.4, 0.0)}
        initial = Initial(nu=0.2)
        block = Surface("upper", **bob, asperite=asperite, initial=initial, **upper)
        return Scene((block, lower), Coulomb(0.2), 16.0)

    free = pair(bars="free", drive=Free(load=0.02))
    block = pair(drive=Free(load=0.02, **FREE))
    one, other = (
        tribo.simulate(each, method="gauss-radau-15", accuracy=1e-10) for each in (free, block)
    )
    assert "tilting block" in other.scene.effects
    assert np.ptp(other["upper"].phi) > 0.5
    for (_, a), (_, b) in zip(tables(one), tables(other), strict=True):
        for name in a:
            assert np.max(np.abs(a[name] - b[name])) <= 1e-11, name


class Couple(NamedTuple):
    """Forces along y, opposite on both sides of x = 0."""

    strength: float

    def energy_at(self, x, y):
        return -self.strength * y if x > 0.0 else self.strength * y

    def force_at(self, x, y):
        return 0.0, self.strength if x > 0.0 else -self.strength


def test_a_rigid_body_turns_under_a_torque_as_its_moment_of_inertia_says():
    """J chi'' = 2 f d cos chi from rest: chi = pi / 2 - 2 asin(k cd(w t)), k = sin(pi / 4).

    So it is until a bob crosses x = 0.
    """
    arm, force = 1.5, 0.4
    asperite = Asperite(m1=0.8, m2=1.7, i2=0.3, length=0.6, kappa=math.inf)
    block = Surface(
        "block",
        bob=(-arm, 0.0),
        shape=(2, 1),
        spacing=(2.0 * arm, 0.0),
        asperite=asperite,
        drive=Free(load=0.0, **FREE),
    )
    given = Scene((block,), (), 4.5, fields=(Field(Couple(force), on=("block",)),))
    result = tribo.simulate(given, method="gauss-radau-15", accuracy=1e-9)
    each = block.each
    reduced = each["m1"] * each["m2"] / (each["m1"] + each["m2"]) * each["length"] ** 2
    inertia = float(np.sum(each["mass"] * arm**2 + reduced + each["i2"]))
    root = math.sqrt(2.0 * force * arm / inertia)
    _, cn, dn, _ = ellipj(root * result.t, 0.5)
    expected = 0.5 * math.pi - 2.0 * np.arcsin(math.sqrt(0.5) * cn / dn)
    assert 0.9 < np.max(expected) < 1.25
    for k in range(2):
        assert np.max(np.abs(result["block"].phi[:, k] - expected)) <= 1e-8
        assert np.max(np.abs(result["block"].theta[:, k] - expected)) <= 1e-8
    middle = np.mean(result["block"]["x_cm"], axis=1)
    assert np.max(np.abs(middle - middle[0])) <= 1e-12


@pytest.mark.parametrize("asperite", [PENDULUMS, RIGID], ids=["pendulums", "rigid"])
def test_isolated_blocks_keep_momentum_angular_momentum_and_energy(asperite):
    drive = Free(load=0.0, **FREE)
    below = {"drive": drive, "initial": Initial(nu=-0.1), "asperite": Asperite(kappa=2.0)}
    result = tribo.simulate(
        scene(asperite, drive, below=below), method="gauss-radau-15", accuracy=1e-10
    )
    px = py = spin = 0.0
    for surface in result.scene.surfaces:
        table = result[surface.name]
        each = surface.each
        mass = each["mass"]
        px = px + np.sum(mass * table["vx_cm"], axis=1)
        py = py + np.sum(mass * table["vy_cm"], axis=1)
        orbital = mass * (table["x_cm"] * table["vy_cm"] - table["y_cm"] * table["vx_cm"])
        own = each["inertia"] * table["omega"] + each["i2"] * table["nu"]
        spin = spin + np.sum(orbital + own, axis=1)
    assert np.ptp(result["block"].phi) > 0.1
    for kept in (px, py, spin):
        assert np.ptp(kept) <= 1e-9
    change = result.system["total_energy_change"] - result.system["applied_work"]
    assert np.max(np.abs(change)) <= 1e-9


@pytest.mark.parametrize("rigid", [False, True])
def test_motion_is_that_of_points_on_a_body(rigid):
    """The reference has the masses as points, whose velocities are linear in those of the whole."""
    drive = Pulled(**PULL, stiffness_y=0.6, damping=0.3, damping_y=0.2)
    given = scene(RIGID if rigid else PENDULUMS, drive)
    result = tribo.simulate(given, method="gauss-radau-15", accuracy=1e-9)
    block, table = given.surfaces
    each, n = block.each, COUNT
    m1, m2, i2, length, kappa = (each[k] for k in ("m1", "m2", "i2", "length", "kappa"))
    kappa = np.where(np.isinf(kappa), 0.0, kappa)
    bars = block.resting_bobs()[:, :2] + np.array([np.zeros(n), length]).T
    centre = bars.mean(axis=0)
    arms = bars - centre
    rod, stiff = table.each["length"], table.each["kappa"]
    pivots = table.resting_bobs()[:, :2] - [0.0, rod[0]]
    turning = table.each["m1"] * rod**2

    def rates(t, state):
        q, v = np.split(state, 2)
        (x, y, chi), theta, below = q[:3], q[3 : 3 + n], q[3 + n :]
        if rigid:
            theta = np.full(n, chi)
        sin, cos = math.sin(chi), math.cos(chi)
        e = arms @ np.array([[cos, sin], [-sin, cos]])
        rods = length[:, None] * np.array([np.sin(theta), -np.cos(theta)]).T
        bobs = e + rods + [x, y]
        others = pivots + rod[:, None] * np.array([-np.sin(below), np.cos(below)]).T
        apart = bobs[:, None] - others[None]
        force = 0.1 * apart / np.linalg.norm(apart, axis=2)[:, :, None] ** 3
        f1, on_table = force.sum(axis=1), -force.sum(axis=0)
        # Jacobians of the bars and of the bobs, (n, 2, 3 + n).
        of_bars = np.zeros((n, 2, 3 + n))
        of_bars[:, 0, 0] = of_bars[:, 1, 1] = 1.0
        of_bars[:, 0, 2], of_bars[:, 1, 2] = -e[:, 1], e[:, 0]
        of_bobs = of_bars.copy()
        swings = np.full(n, 2) if rigid else 3 + np.arange(n)
        of_bobs[np.arange(n), 0, swings] -= rods[:, 1]
        of_bobs[np.arange(n), 1, swings] += rods[:, 0]
        omega = np.full(n, v[2]) if rigid else v[3 : 3 + n]
        inward = -(v[2] ** 2) * e
        inward_bobs = inward - (omega**2)[:, None] * rods
        matrix = np.einsum("n,nai,naj->ij", m2, of_bars, of_bars)
        matrix += np.einsum("n,nai,naj->ij", m1, of_bobs, of_bobs)
        matrix[2, 2] += np.sum(i2)
        right = np.einsum("nai,na->i", of_bobs, f1 - m1[:, None] * inward_bobs)
        right -= np.einsum("nai,na->i", of_bars, m2[:, None] * inward)
        right[0] += 0.8 * (0.5 * t - (x - centre[0])) + 0.3 * (0.5 - v[0])
        right[1] += -1.5 - 0.6 * (y - centre[1]) - 0.2 * v[1]
        spring = kappa * (theta - chi)
        right[2] += np.sum(spring)
        right[3:] -= spring
        if rigid:
            matrix[3:, 3:] = np.eye(n)
        torque = -rod * (np.cos(below) * on_table[:, 0] + np.sin(below) * on_table[:, 1])
        swung = (torque - stiff * below) / turning
        return np.concatenate([v, np.linalg.solve(matrix, right), swung])

    start = np.zeros(2 * (3 + 2 * n))
    start[:2] = centre
    start[3 + 2 * n : 6 + 2 * n] = 0.4, 0.0, 0.05
    run = solve_ivp(rates, (0, 6), start, "DOP853", rtol=1e-11, atol=1e-12)
    x, y, chi = run.y[:3, -1]
    own = result["block"]
    assert abs(np.mean(own["x_bar"][-1]) - x) <= 1e-7
    assert abs(np.mean(own["y_bar"][-1]) - y) <= 1e-7
    assert np.max(np.abs(own["phi"][-1] - chi)) <= 1e-7
    theta = np.full(n, chi) if rigid else run.y[3 : 3 + n, -1]
    assert np.max(np.abs(own["theta"][-1] - theta)) <= 1e-7
    below = result["table"]["theta"][-1] - math.pi
    assert np.max(np.abs(below - run.y[3 + n : 3 + 2 * n, -1])) <= 1e-7
    assert abs(chi) > 0.02


# --- ledger --------------------------------------------------------------------------------------

FIELD = Field(Corrugation(0.3, 1.3), on=("block",), velocity=(0.2, 0.0))


class Cantilever(NamedTuple):
    """A spring with damping, as a user's own drive of the whole block."""

    stiffness: float
    damping: float

    drives_along_x = True

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return self.stiffness * (4.0 + 0.5 * t - x) + self.damping * (0.5 - vx), -1.5


KINDS = {
    "pulled pendulums": scene(),
    "damped pendulums": scene(
        drive=Pulled(**PULL, stiffness_y=0.6, damping=0.3, damping_y=0.2),
        langevin=[Langevin(0.1), Langevin(0.2, on="swing")],
    ),
    "rigid, in a field": scene(RIGID, fields=(FIELD,), langevin=Langevin(0.1)),
    "pushed": scene(drive=Pushed(force=(0.2, -0.5), rate=(0.1, 0.0), **FREE)),
    "own drive": scene(drive=Custom(force=Cantilever(0.8, 0.3), **FREE)),
    "two blocks": scene(RIGID, below={"drive": Free(load=1.5, **FREE), "asperite": RIGID}),
}


@pytest.mark.parametrize("name", KINDS)
def test_ledger_closes_and_the_constraint_does_no_work(name):
    """Every identity holds; on the whole block the constraint's forces, work and power vanish."""
    result = tribo.simulate(KINDS[name], method="gauss-radau-15", accuracy=1e-9)
    for law, gap in largest_gaps(result).items():
        assert gap <= 1e-8, law
    own = result["block"]
    for axis in "xy":
        assert np.max(np.abs(own[f"f_block_{axis}"].sum(axis=1))) <= 1e-12
    assert np.max(np.abs(own.w_int.sum(axis=1))) <= 1e-9
    assert np.max(np.abs(own.w_int)) > 1e-4
    assert np.ptp(own.phi, axis=1).max() == 0.0
    assert not own.wL.any()


@pytest.mark.parametrize("method", ["dop853", "gauss-8", "rk4"])
def test_methods_agree_and_the_body_keeps_its_shape(method):
    how = {"accuracy": 1e-7} if method == "dop853" else {"step": 0.02}
    one = tribo.simulate(KINDS["pulled pendulums"], method=method, **how)
    other = tribo.simulate(KINDS["pulled pendulums"], method="gauss-radau-15", accuracy=1e-9)
    for name in ("x_bar", "y_bar", "theta", "phi"):
        assert np.max(np.abs(one["block"][name] - other["block"][name])) <= 2e-6, name
    x, y = one["block"]["x_bar"], one["block"]["y_bar"]
    apart = np.hypot(x - x[:, :1], y - y[:, :1])
    assert np.max(np.abs(apart - apart[0])) <= 1e-13


def test_place_of_the_scene_does_not_matter():
    one, other = (
        tribo.simulate(each, method="gauss-radau-15", accuracy=1e-9)
        for each in (scene(), translated(scene(), (20.0, -3.0)))
    )
    for name in ("phi", "w2", "w_int", "e_pull"):
        assert np.max(np.abs(one["block"][name] - other["block"][name])) <= 1e-7, name


def test_a_stage_does_the_work_of_its_spring():
    """The spring acts at the mean of the bars, whatever their tilt."""
    result = tribo.simulate(scene(RIGID), method="gauss-radau-15", accuracy=1e-9)
    own = result["block"]
    stretch = 0.5 * result.t - (own["x_bar"].mean(axis=1) - own["x_bar"][0].mean())
    energy = 0.5 * 0.8 * stretch**2
    assert np.max(np.abs(np.ravel(own["e_pull"]) - energy)) <= 1e-9
    assert np.max(np.abs(own["f2_x"].sum(axis=1) - 0.8 * stretch)) <= 1e-9


def test_members_and_points_are_single_runs():
    given = replace(scene(RIGID), output=Output(samples=2))
    loads = [1.0, 2.0]
    keep = ["block.x_bar", "block.phi"]
    points = tribo.sweep(given, {"block.drive.load": loads}, keep=keep, accuracy=1e-7)
    for k, load in enumerate(loads):
        alone = scene(RIGID, Pulled(**PULL | {"load": load}))
        alone = tribo.simulate(replace(alone, output=Output(samples=2)), accuracy=1e-7)
        for name in keep:
            gap = points[name].values[k].ravel() - alone["block"][name[6:]][-1]
            assert np.max(np.abs(gap)) <= 1e-6


def test_equilibrium_balances_forces_and_torques():
    still = scene(RIGID, Pulled(**PULL | {"speed": 0.0}), velocity=(0.0, 0.0), initial={})
    result = tribo.simulate(still, start=tribo.relax(still), method="dop853", accuracy=1e-8)
    own = result["block"]
    assert abs(np.sum(own["f1_y"][0]) - PULL["load"]) <= 1e-6
    lever = own["x_bob"][0] - own["x_bar"][0].mean(), own["y_bob"][0] - own["y_bar"][0].mean()
    assert abs(np.sum(lever[0] * own["f1_y"][0] - lever[1] * own["f1_x"][0])) <= 1e-6
    assert np.max(np.abs(own["phi"][-1] - own["phi"][0])) <= 1e-6


def test_continues_from_a_state(tmp_path):
    how = {"method": "rk4", "step": 0.05}
    for given in (scene(), scene(RIGID)):
        whole = tribo.simulate(given, **how)
        first = tribo.simulate(replace(given, duration=3.0, output=Output(samples=7)), **how)
        first.save(tmp_path / "first.nc")
        state = tribo.load_result(tmp_path / "first.nc").state()
        rest = tribo.simulate(given, start=state, **how)
        for name in ("x_bar", "theta", "phi", "w2"):
            assert np.array_equal(rest["block"][name][-1], whole["block"][name][-1])
        # Another load goes on from the tilt; a block that does not tilt cannot.
        drive = Pulled(**PULL | {"load": 2.0})
        heavier = replace(given.surfaces[0], drive=drive)
        other = replace(given, surfaces=(heavier, given.surfaces[1]))
        result = tribo.simulate(other, start=state, **how)
        for name in ("x_bob", "y_bob", "phi", "nu"):
            gap = result["block"][name][0] - first["block"][name][-1]
            assert np.max(np.abs(gap)) <= 1e-12, name
        stiff = replace(given.surfaces[0], drive=Pulled(**PULL | {"tilt": "fixed"}), initial={})
        with pytest.raises(InputError, match=r"displaced alike|do not turn"):
            tribo.simulate(replace(given, surfaces=(stiff, given.surfaces[1])), start=state, **how)


def test_clamped_bars_go_on_from_the_tilt():
    """At its angle and rate: those of the start are long past."""
    first = tribo.simulate(scene(), accuracy=1e-8)
    apart = Pulled(stiffness=PULL["stiffness"], speed=PULL["speed"], load=PULL["load"])
    upper, lower = first.scene.surfaces
    later = replace(first.scene, surfaces=(replace(upper, drive=apart), lower), duration=8.0)
    rest = tribo.simulate(later, start=first.state(), accuracy=1e-8)["block"]
    before = first["block"]
    assert abs(before.phi[-1, 0] - 0.05 * 6.0) > 0.1
    for name in ("phi", "nu", "theta", "x_bar", "y_bar"):
        np.testing.assert_allclose(rest[name][0], before[name][-1], atol=1e-12, err_msg=name)


# --- files and refusals --------------------------------------------------------------------------


def test_files_keep_the_tilt(tmp_path):
    for drive in (Pulled(**PULL), Free(load=1.0, **FREE), Pushed(force=(0.1, 0.0), **FREE)):
        given = scene(drive=drive)
        given.save(tmp_path / "scene.toml")
        assert 'tilt = "free"' in (tmp_path / "scene.toml").read_text()
        assert tribo.load_scene(tmp_path / "scene.toml") == given
    assert "tilt" not in scene(drive=Pulled(**PULL | {"tilt": "fixed"}), initial={}).to_toml()


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ({"drive": {"kind": "free", "tilt": "free", "load": 1.0}}, "needs block = true"),
        ({"drive": {"kind": "forced", "tilt": "free", "block": True}}, 'must be "fixed"'),
        ({"drive": {"kind": "free", "tilt": "free", "block": True}}, "needs a load"),
        ({"drive": {"kind": "free", "tilt": "wild", "block": True}}, "tilt"),
        ({"springs": Springs(1.0)}, "do not stretch"),
        ({"initial": Initial(phi=0.1)}, "must be 0"),
        ({"initial": Initial(nu=tuple(range(COUNT)))}, "must be one number"),
        ({"langevin": Langevin(0.1, 0.2)}, "langevin.temperature"),
        ({"asperite": RIGID, "langevin": Langevin(0.1, 0.2)}, "langevin.temperature"),
        ({"bars": "free"}, "clamped"),
    ],
)
def test_what_a_tilt_cannot_go_with(settings, problem):
    with pytest.raises(InputError, match=problem):
        scene(**settings)


@pytest.mark.parametrize("method", ["verlet", "rkn8"])
def test_methods_that_cannot_take_it_say_so(method):
    with pytest.raises(InputError, match="block that turn"):
        tribo.simulate(scene(RIGID), method=method)


@pytest.mark.parametrize("asperite", [RIGID, PENDULUMS])
def test_its_rate_is_swept_and_not_given_to_members(asperite):
    """All bobs have the velocities of the rotation, which a prepared scene does not turn."""
    given = scene(asperite)
    rates = [0.0, 0.05]
    with pytest.raises(InputError, match=r"block\.nu: cannot be changed where drive\.tilt"):
        tribo.ensemble(given, 2, {"block.nu": rates}, keep=["block.W"])
    found = tribo.sweep(given, {"block.nu": rates}, keep=["block.W"])["block.W"].values
    alone = [tribo.simulate(scene(asperite, initial=Initial(nu=rate))) for rate in rates]
    np.testing.assert_allclose(found, [each["block"].W[-1] for each in alone], atol=1e-7)


@pytest.mark.parametrize("count", [1, 3, 9])
def test_asperites_that_fill_a_pack_do_not_count(count):
    """Nor swing: pendulums of equal numbers share columns with those that fill their packs."""
    drive = Pushed(force=(0.3, -0.3), **FREE)
    heat = Langevin(0.2, on="swing")
    shape = {"shape": (count, 1), "heights": [0.0] * count}
    given = scene(Asperite(kappa=2.0), drive, langevin=heat, initial={}, **shape)
    each, whole = (
        tribo.simulate(replace(given, output=Output(samples=9, ledger=ledger)), accuracy=1e-9)
        for ledger in ("asperites", "surfaces")
    )
    for block in (each["block"], whole["block"]):
        np.testing.assert_allclose(block.W_ps, block.delta_K, atol=1e-12)
        np.testing.assert_allclose(block.W - block.W_ps, block.delta_E_int, atol=1e-12)
    heats = [np.sum(result["block"].heat[-1]) for result in (each, whole)]
    assert heats[0] == pytest.approx(heats[1], abs=1e-12) and heats[0] > 1e-3
