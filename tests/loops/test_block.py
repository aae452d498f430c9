"""Blocks, whose bars are one rigid body: equations, ledger, methods, reservoirs, refusals."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tribo
from support.laws import largest_gaps, tables
from support.rough_block import COUNT, PENDULUMS, RIGID, rough_block
from support.transformations import boosted, reflected, translated
from tribo import (
    Asperite,
    Corrugation,
    Coulomb,
    Custom,
    DrivenBars,
    Ends,
    Field,
    Forced,
    Free,
    Initial,
    InputError,
    Interaction,
    Langevin,
    Morse,
    Output,
    Periodic,
    Pulled,
    Pushed,
    Scene,
    Springs,
    Surface,
)
from tribo.export import to_lammps

PULL = {"stiffness": 0.8, "speed": 0.5, "load": 1.5, "block": True}
SWINGING = Initial(theta=tuple(np.random.default_rng(3).uniform(-0.4, 0.4, COUNT)), omega=0.3)


def scene(asperite=PENDULUMS, drive=None, **settings):
    """The rough block without tilt, pulled unless it has another drive."""
    return rough_block(asperite, drive or Pulled(**PULL), **settings)


def bars(result, name="block"):
    """Displacements and velocities of the bars from those at the start, (4, times, asperites)."""
    table = result[name]
    arm = np.hypot(table["x_bar"][0] - table["x_cm"][0], table["y_bar"][0] - table["y_cm"][0])
    tx, ty = np.cos(table["theta"]), np.sin(table["theta"])
    vx = table["vx_cm"] - arm * table["omega"] * tx
    vy = table["vy_cm"] - arm * table["omega"] * ty
    x, y = table["x_bar"], table["y_bar"]
    return np.array([x - x[0], y - y[0], vx, vy])


# --- equations -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("drive", "settings"),
    [
        (Forced, {}),
        (Free, {}),
        (Free, {"load": 0.03}),
        (Pulled, {"stiffness": 0.5, "speed": 0.4, "load": 0.02}),
        (Pushed, {"force": (0.01, -0.02)}),
    ],
)
@pytest.mark.parametrize("kappa", [1.0, math.inf])
def test_one_on_one_is_the_pair(drive, settings, kappa):
    """Through the equations of the block: motion, works and pseudoworks to 1e-12."""

    def pair(**block):
        lower = Surface("lower", facing="up", drive=Free(**block), asperite=Asperite(kappa=kappa))
        upper = Surface(
            "upper",
            bob=(-3.0, 1.0),
            velocity=(0.4, 0.0),
            drive=drive(**settings, **block),
            asperite=Asperite(m1=1.3, m2=2.0, kappa=kappa),
        )
        return Scene((upper, lower), Coulomb(0.2), 16.0)

    alone, block = (
        tribo.simulate(one, method="gauss-radau-15", accuracy=1e-10)
        for one in (pair(), pair(block=True))
    )
    assert "block" in block.scene.effects
    assert "block" not in alone.scene.effects
    for (_, one), (_, other) in zip(tables(alone), tables(block), strict=True):
        for name in one:
            assert np.max(np.abs(one[name] - other[name])) <= 1e-12, name
    assert np.max(np.abs(block["upper"].w_int)) <= 1e-12


def test_motion_of_pendulums_on_a_block_is_that_of_constrained_points():
    """The reference solves for the forces of the constraint itself, with a dense matrix."""
    given = scene(initial=SWINGING, drive=Pulled(**PULL, stiffness_y=0.6, damping=0.1))
    result = tribo.simulate(given, method="gauss-radau-15", accuracy=1e-9)
    block = given.surfaces[0]
    each = block.each
    length, kappa = each["length"], each["kappa"]
    mass, inertia, l1, l2 = (each[name] for name in ("mass", "inertia", "l1", "l2"))
    table = given.surfaces[1]
    sites = table.resting_bobs()[:, :2]
    rod, stiff = table.each["length"][0], table.each["kappa"][0]
    turning = table.each["m1"][0] * rod**2
    pivots = sites - [0.0, rod]
    start = block.resting_bobs()[:, :2].copy()
    start[:, 1] += length  # the bars
    n = COUNT
    swing0 = block.initial_swing

    def rates(t, state):
        x, y, theta, below, vx, vy, omega, spin = state.reshape(8, n)
        t_x, t_y = np.cos(theta), np.sin(theta)
        bobs = np.array([x + l1 * t_y, y - l1 * t_x]).T
        others = pivots + rod * np.array([-np.sin(below), np.cos(below)]).T
        apart = bobs[:, None] - others[None]
        force = 0.1 * apart / np.linalg.norm(apart, axis=2)[:, :, None] ** 3
        f1 = force.sum(axis=1)
        on_table = -force.sum(axis=0)
        bar_x = x[0] - l2[0] * t_y[0] - start[0, 0]
        bar_y = y[0] + l2[0] * t_x[0] - start[0, 1]
        bar_vx = vx[0] - l2[0] * omega[0] * t_x[0]
        drive_x = (0.8 * (0.5 * t - bar_x) + 0.1 * (0.5 - bar_vx)) / n
        drive_y = (-1.5 - 0.6 * bar_y) / n
        # Unknowns: x'', y'', theta'' of each, force of the constraint on each bar, R''.
        matrix = np.zeros((5 * n + 2, 5 * n + 2))
        right = np.zeros(5 * n + 2)
        for i in range(n):
            ix, iy, it, cx, cy = (k * n + i for k in range(5))
            matrix[ix, ix] = matrix[iy, iy] = mass[i]
            matrix[ix, cx] = matrix[iy, cy] = -1.0
            right[ix] = f1[i, 0] + drive_x
            right[iy] = f1[i, 1] + drive_y
            matrix[it, it] = inertia[i]
            matrix[it, cx], matrix[it, cy] = l2[i] * t_x[i], l2[i] * t_y[i]
            right[it] = l1[i] * (t_x[i] * f1[i, 0] + t_y[i] * f1[i, 1])
            right[it] -= l2[i] * (t_x[i] * drive_x + t_y[i] * drive_y) + kappa[i] * theta[i]
            matrix[cx, ix], matrix[cx, it], matrix[cx, 5 * n] = 1.0, -l2[i] * t_x[i], -1.0
            right[cx] = -l2[i] * omega[i] ** 2 * t_y[i]
            matrix[cy, iy], matrix[cy, it], matrix[cy, 5 * n + 1] = 1.0, -l2[i] * t_y[i], -1.0
            right[cy] = l2[i] * omega[i] ** 2 * t_x[i]
        matrix[5 * n, 3 * n : 4 * n] = matrix[5 * n + 1, 4 * n : 5 * n] = 1.0
        found = np.linalg.solve(matrix, right)[: 3 * n].reshape(3, n)
        torque = -rod * (np.cos(below) * on_table[:, 0] + np.sin(below) * on_table[:, 1])
        torque -= stiff * below
        return np.concatenate([vx, vy, omega, spin, *found, torque / turning])

    centre = start + np.array([l2 * np.sin(swing0), -l2 * np.cos(swing0)]).T
    rate = 0.3 * l2
    y0 = [*centre.T, swing0, np.zeros(n)]
    y0 += [0.4 + rate * np.cos(swing0), rate * np.sin(swing0), np.full(n, 0.3), np.zeros(n)]
    run = solve_ivp(rates, (0, 6), np.concatenate(y0), "DOP853", rtol=1e-11, atol=1e-12)
    x, y, theta, below, *_ = run.y[:, -1].reshape(8, n)
    for name, expected in (("x_cm", x), ("y_cm", y), ("theta", theta)):
        assert np.max(np.abs(result["block"][name][-1] - expected)) <= 1e-7, name
    swung = result["table"]["theta"][-1] - math.pi
    assert np.max(np.abs(swung - below)) <= 1e-7


@pytest.mark.parametrize("method", ["dop853", "gauss-radau-15", "gauss-8", "rk4"])
def test_bars_of_pendulums_move_as_one(method):
    """To round-off, by every method that takes them."""
    how = {"accuracy": 1e-6} if method in ("dop853", "gauss-radau-15") else {"step": 0.05}
    result = tribo.simulate(scene(initial=SWINGING), method=method, **how)
    assert np.max(np.ptp(bars(result), axis=2)) <= 1e-13
    assert np.ptp(bars(result)[1]) > 0.01


def test_rigid_asperites_follow_the_sum_of_forces_with_every_method():
    """M R'' = F: all methods agree within their errors, verlet to order two."""
    found = {}
    for method in ("dop853", "rkn8", "gauss-radau-15", "kahan-li-6", "blanes-moan-6"):
        result = tribo.simulate(scene(RIGID), method=method, accuracy=1e-8)
        assert np.max(np.ptp(bars(result), axis=2)) <= 1e-14
        found[method] = result["block"]["x_bar"][-1, 0]
    assert np.ptp(list(found.values())) <= 1e-7
    exact = found["gauss-radau-15"]
    errors = [
        tribo.simulate(scene(RIGID), method="verlet", step=step)["block"]["x_bar"][-1, 0] - exact
        for step in (0.02, 0.01)
    ]
    assert 3.8 < errors[0] / errors[1] < 4.2


# --- ledger --------------------------------------------------------------------------------------

FIELD = Field(Corrugation(0.3, 1.3), on=("block",), velocity=(0.2, 0.0))
KINDS = {
    "pulled pendulums": scene(initial=SWINGING),
    "damped pendulums": scene(
        drive=Pulled(**PULL, stiffness_y=0.6, damping=0.3, damping_y=0.2),
        langevin=Langevin(0.1),
        initial=SWINGING,
    ),
    "forced pendulums": scene(drive=Forced(block=True), initial=SWINGING),
    "free rigid asperites": scene(RIGID, Free(block=True, load=1.0), springs=Springs(2.0)),
    "pushed": scene(drive=Pushed(force=(0.2, -0.5), rate=(0.1, 0.0), block=True)),
    "in a field": replace(scene(RIGID), fields=(FIELD,)),
    "two blocks": scene(below={"drive": Free(block=True), "langevin": Langevin(0.1)}),
    "in a box": replace(
        scene(below={"drive": Free(block=True)}, duration=3.0),
        interactions=(
            Interaction(Morse(0.3, 1.5, 0.8).with_cutoff(2.5, "switch"), ("block", "table")),
            Interaction(Morse(0.1, 1.5, 0.8).with_cutoff(2.5, "switch"), ("block", "block")),
        ),
        periodic=Periodic(x=10.0),
    ),
}


@pytest.mark.parametrize("name", KINDS)
def test_ledger_closes_and_the_constraint_does_no_work(name):
    """Every identity holds; on the whole block the constraint's forces, work and power vanish."""
    result = tribo.simulate(KINDS[name], method="gauss-radau-15", accuracy=1e-9)
    for law, gap in largest_gaps(result).items():
        assert gap <= 1e-8, law
    for surface in result.scene.surfaces:
        if not surface.drive.block:
            continue
        own = result[surface.name]
        assert np.max(np.abs(own["f_block_x"])) > 1e-3
        for axis in "xy":
            assert np.max(np.abs(own[f"f_block_{axis}"].sum(axis=1))) <= 1e-12
        if name != "in a box":  # where contact within a block is part of the internal work
            assert np.max(np.abs(own.w_int)) > 1e-4
            assert np.max(np.abs(own.w_int.sum(axis=1))) <= 1e-9
        if surface.asperite.is_rigid:
            assert np.max(np.abs(own.w_int_ps.sum(axis=1))) <= 1e-9
        # The surface's pseudowork is that of external forces alone, whose sum has no constraint.
        gap = own.W_ps - own.delta_K
        assert np.max(np.abs(gap)) <= 1e-9


@pytest.mark.parametrize("name", ["free rigid asperites", "in a field"])
def test_verlet_closes_the_ledger_to_round_off(name):
    result = tribo.simulate(KINDS[name], method="verlet", step=0.02)
    for law, gap in largest_gaps(result).items():
        if law not in ("W = delta(K + E_int)", "applied work = change of energy"):
            assert gap <= 1e-12, law
    assert np.max(np.abs(result["block"].w_int.sum(axis=1))) <= 1e-12


@pytest.mark.parametrize("ledger", ["surfaces", "none"])
def test_sums_and_motion_are_those_of_the_whole_ledger(ledger):
    whole = KINDS["two blocks"]
    short = replace(whole, output=Output(samples=13, ledger=ledger))
    one, other = (tribo.simulate(s, method="dop853", accuracy=1e-7) for s in (whole, short))
    if ledger == "surfaces":
        for name in ("W", "W_ps", "delta_K", "delta_E_int"):
            assert np.allclose(one["block"][name], other["block"][name], rtol=0, atol=1e-6)
        for name in ("w1", "w2", "w_int"):
            sums = np.sum(one["block"][name], axis=1)
            assert np.allclose(sums, np.ravel(other["block"][name]), rtol=0, atol=1e-6)
    gap = one["block"]["x_bar"][-1] - other["block"]["x_bar"][-1]
    assert np.max(np.abs(gap)) <= 1e-6


def test_isolated_blocks_keep_momentum_and_energy():
    """Two free blocks of pendulums, and no outside force along x."""
    free = scene(drive=Free(block=True), below={"drive": Free(block=True)}, initial=SWINGING)
    result = tribo.simulate(free, method="gauss-radau-15", accuracy=1e-10)
    momentum = sum(
        np.sum(surface.each["mass"] * result[surface.name]["vx_cm"], axis=1)
        for surface in free.surfaces
    )
    assert np.max(np.abs(momentum - momentum[0])) <= 1e-10
    change = result.system["total_energy_change"] - result.system["applied_work"]
    assert np.max(np.abs(change)) <= 1e-9


@pytest.mark.parametrize("name", ["damped pendulums", "in a field"])
@pytest.mark.parametrize(
    "transform", [lambda s: translated(s, (2.0, 0.5)), lambda s: boosted(s, (0.7, 0.2)), reflected]
)
def test_frames_do_not_matter(name, transform):
    given = KINDS[name]
    if name == "damped pendulums":  # springs along y are fixed in the laboratory
        given = scene(drive=Pulled(**PULL, damping=0.3), langevin=Langevin(0.1), initial=SWINGING)
    one, other = (
        tribo.simulate(s, method="gauss-radau-15", accuracy=1e-9) for s in (given, transform(given))
    )
    for quantity in ("delta_e_int", "omega"):
        a, b = one["block"][quantity], other["block"][quantity]
        sign = -1.0 if quantity == "omega" and transform is reflected else 1.0
        assert np.max(np.abs(a - sign * b)) <= 1e-7
    heat = [r["block"]["W"] - r["block"]["W_ps"] for r in (one, other)]
    assert np.max(np.abs(heat[0] - heat[1])) <= 1e-7


# --- drives --------------------------------------------------------------------------------------


class Cantilever(NamedTuple):
    """A spring with damping, as a user's own drive of the whole block."""

    stiffness: float
    damping: float
    anchor: float

    drives_along_x = True

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        pull = self.stiffness * (self.anchor + 0.5 * t - x) + self.damping * (0.5 - vx)
        return pull, -1.5


def test_own_drive_acts_once_on_the_whole_block():
    """It sees the mean of the bars' places; its force is shared."""
    own = Custom(force=Cantilever(0.8, 0.3, 0.1 + 0.9 * 4.5), block=True)
    built_in = Pulled(**PULL, damping=0.3)
    one, other = (
        tribo.simulate(scene(drive=drive, initial=SWINGING), method="dop853", accuracy=1e-8)
        for drive in (own, built_in)
    )
    for name in ("x_bar", "y_bar", "theta", "w2"):
        assert np.max(np.abs(one["block"][name] - other["block"][name])) <= 1e-6, name


def test_own_drive_with_rigid_asperites_by_verlet():
    own = Custom(force=Cantilever(0.8, 0.3, 0.1 + 0.9 * 4.5), block=True)
    one = tribo.simulate(scene(RIGID, own), method="verlet", step=0.002)
    other = tribo.simulate(scene(RIGID, Pulled(**PULL, damping=0.3)), accuracy=1e-8)
    assert np.max(np.abs(one["block"]["x_bar"] - other["block"]["x_bar"])) <= 1e-4


def test_damped_cantilever_on_many_tips_is_one_oscillator():
    """Far from contact: x'' = -k x - c x' with the mass of the block, critical, over, under."""
    mass = float(np.sum(RIGID.for_each(COUNT)["mass"]))
    k = 2.0
    critical = 2.0 * math.sqrt(k * mass)
    for ratio in (0.3, 1.0, 2.0):
        drive = Pulled(stiffness=k, speed=0.0, damping=ratio * critical, load=0.0, block=True)
        alone = scene(RIGID, drive, velocity=(0.6, 0.0))
        alone = replace(alone, surfaces=alone.surfaces[:1], interactions=(), duration=9.0)
        result = tribo.simulate(alone, accuracy=1e-9)
        w = math.sqrt(k / mass)
        root = np.emath.sqrt(ratio**2 - 1.0)
        t = result.t
        if ratio == 1.0:
            expected = 0.6 * t * np.exp(-w * t)
        else:
            expected = np.real(0.6 * np.exp(-ratio * w * t) * np.sinh(w * root * t) / (w * root))
        moved = result["block"]["x_bar"][:, 0] - result["block"]["x_bar"][0, 0]
        assert np.max(np.abs(moved - expected)) <= 1e-8


# --- reservoirs, continuation, threads -----------------------------------------------------------


def test_noise_gives_a_block_the_temperature_of_one_body():
    """Kinetic energy of the whole is T / 2 along each axis, that of its springs too."""
    temperature, gamma = 0.5, 0.4
    reservoir = Langevin(gamma, temperature)
    drive = Pulled(stiffness=3.0, speed=0.0, stiffness_y=4.0, load=0.0, block=True)
    alone = scene(RIGID, drive, velocity=(0.0, 0.0), langevin=reservoir)
    output = Output(samples=10_001, ledger="none")
    alone = replace(
        alone, surfaces=alone.surfaces[:1], interactions=(), duration=2e4, output=output
    )
    result = tribo.simulate(alone, method="verlet", step=0.2)
    mass = float(np.sum(RIGID.for_each(COUNT)["mass"]))
    for name, stiffness in (("vx_cm", mass), ("vy_cm", mass), ("x_cm", 3.0), ("y_cm", 4.0)):
        series = result["block"][name][:, 0]
        assert abs(np.var(series) * stiffness / temperature - 1.0) <= 0.08, name


def test_noise_closes_the_ledger_and_keeps_bars_together():
    cold = scene(RIGID, langevin=Langevin(0.3, 0.4))
    result = tribo.simulate(cold, method="verlet", step=0.01)
    assert np.max(np.ptp(bars(result), axis=2)) <= 1e-14
    for law, gap in largest_gaps(result).items():
        if law not in ("W = delta(K + E_int)", "applied work = change of energy"):
            assert gap <= 1e-12, law
    quiet = scene(RIGID, langevin=Langevin(0.3))
    one = tribo.simulate(quiet, method="verlet", step=0.004)
    other = tribo.simulate(quiet, method="dop853", accuracy=1e-8)
    for name in ("x_bar", "w_T", "w_int"):
        assert np.max(np.abs(one["block"][name] - other["block"][name])) <= 1e-4, name


@pytest.mark.parametrize(
    ("given", "numerics"),
    [
        (KINDS["pulled pendulums"], {"method": "rk4", "step": 0.05}),
        (scene(RIGID, langevin=Langevin(0.3, 0.4)), {"method": "verlet", "step": 0.01}),
    ],
)
def test_continues_from_a_state_bit_for_bit(given, numerics, tmp_path):
    whole = tribo.simulate(given, **numerics)
    first = tribo.simulate(replace(given, duration=3.0, output=Output(samples=7)), **numerics)
    first.save(tmp_path / "first.nc")
    state = tribo.load_result(tmp_path / "first.nc").state()
    rest = tribo.simulate(given, start=state, **numerics)
    for name in ("x_bar", "theta"):
        assert np.array_equal(rest["block"][name][-1], whole["block"][name][-1])


def test_state_of_other_scenes_must_have_joined_bars():
    light = PULL | {"load": 0.1}
    apart = tribo.simulate(scene(drive=Pulled(**light | {"block": False}), duration=2.0))
    with pytest.raises(InputError, match="block = true joins them"):
        tribo.simulate(scene(duration=3.0), start=apart.state())
    joined = tribo.simulate(scene(duration=2.0), accuracy=1e-6)
    longer = scene(drive=Pulled(**PULL | {"load": 2.0}), duration=3.0)
    result = tribo.simulate(longer, start=joined.state(), accuracy=1e-6)
    assert np.max(np.ptp(bars(result), axis=2)) <= 1e-12
    gap = result["block"]["x_bar"][0] - joined["block"]["x_bar"][-1]
    assert np.max(np.abs(gap)) <= 1e-12


def test_threads_do_not_change_bits():
    """Of a grid whose steps threads share."""
    grid = {"shape": (40, 40), "spacing": (1.1, 1.1)}
    heights = np.random.default_rng(0).uniform(0.0, 0.3, 1600)
    asperite = Asperite(kappa=math.inf)
    drive = Pulled(stiffness=2.0, speed=0.3, load=40.0, block=True)
    surfaces = (
        Surface("block", bob=(0.2, 0.9), heights=heights, asperite=asperite, drive=drive, **grid),
        Surface("table", facing="up", asperite=asperite, **grid),
    )
    contact = Morse(0.3, 1.5, 0.8).with_cutoff(2.5)
    given = Scene(surfaces, contact, 0.5, output=Output(samples=2, ledger="surfaces"))
    one, two = (
        tribo.simulate(given, method="verlet", step=0.01, threads=count) for count in (1, 2)
    )
    for name in ("x_bar", "y_bar"):
        assert np.array_equal(one["block"][name], two["block"][name])
    assert np.array_equal(one["block"].W, two["block"].W)


def test_members_are_single_runs():
    given = replace(scene(), output=Output(samples=2))
    keys = {"block.drive.load": [1.0, 1.5, 2.0]}
    members = tribo.sweep(given, keys, keep=["block.x_bar"], accuracy=1e-6)
    for k, load in enumerate(keys["block.drive.load"]):
        alone = scene(drive=Pulled(**PULL | {"load": load}))
        alone = tribo.simulate(replace(alone, output=Output(samples=2)), accuracy=1e-6)
        end = members["block.x_bar"].values[k].ravel()
        assert np.max(np.abs(end - alone["block"]["x_bar"][-1])) <= 1e-5


def test_equilibrium_balances_the_load():
    """`relax` finds where the sum of contact forces carries the load."""
    still = scene(drive=Pulled(**PULL | {"speed": 0.0}), velocity=(0.0, 0.0))
    state = tribo.relax(still)
    result = tribo.simulate(still, start=state, method="dop853", accuracy=1e-8)
    assert np.ptp(bars(result)[:2]) <= 1e-6
    assert abs(np.sum(result["block"]["f1_y"][0]) - PULL["load"]) <= 1e-6


class Flat(NamedTuple):
    """A flat wall below y = 0, whose force is that of Hertz at each tip."""

    stiffness: float

    def energy_at(self, x, y):
        return 0.4 * self.stiffness * max(-y, 0.0) ** 2.5

    def force_at(self, x, y):
        return 0.0, self.stiffness * max(-y, 0.0) ** 1.5


def test_rough_block_carries_its_load_as_greenwood_and_williamson_say():
    """Exponential heights of mean s: n = N exp(-d / s), load = k Gamma(5/2) s^(3/2) n.

    The heights are quantiles, and the block is critically damped until it stands.
    """
    count, mean, k = 400, 0.2, 50.0
    heights = mean * np.log(1.0 - (np.arange(count) + 0.5) / count)  # the tallest reach down
    load = 600.0  # on a hundred tips: of few, the tallest decide
    expected = load / (k * math.gamma(2.5) * mean**1.5)
    height = mean * math.log(count / expected)
    drive = Pulled(stiffness=1.0, speed=0.0, load=load, damping_y=400.0, block=True)
    block = Surface(
        "block",
        bob=(0.0, height),
        shape=(count, 1),
        spacing=(1.0, 0.0),
        heights=heights,
        asperite=Asperite(kappa=math.inf),
        drive=drive,
    )
    wall = Field(Flat(k), on=("block",))
    output = Output(samples=2, series=("forces",))
    given = Scene((block,), (), 40.0, fields=(wall,), output=output)
    result = tribo.simulate(given, accuracy=1e-6)
    own = result["block"]
    assert abs(np.sum(own["f_field_y"][-1]) - load) <= 2e-4 * load
    assert np.ptp(own["y_bob"][-1] - heights) <= 1e-12
    separation = float(np.mean(own["y_bob"][-1] - heights))
    contacts = np.count_nonzero(own["f_field_y"][-1] > 0.0)
    assert abs(contacts - count * math.exp(-separation / mean)) <= 2.0
    assert abs(separation - height) <= 0.02 * mean
    assert abs(contacts - expected) <= 0.02 * expected + 1.0


# --- files and refusals --------------------------------------------------------------------------


def test_files_keep_the_block(tmp_path):
    for drive in (Pulled(**PULL, damping=0.2), Free(block=True), Forced(block=True, load=1.0)):
        given = scene(drive=drive)
        given.save(tmp_path / "scene.toml")
        assert tribo.load_scene(tmp_path / "scene.toml") == given
    assert "stiffness_y" not in scene(drive=Pulled(stiffness=1.0, speed=0.0)).to_toml()


def test_rigid_is_deprecated():
    with pytest.warns(DeprecationWarning, match="block = True"):
        Free(rigid=True)
    lower = {"shape": (2, 1), "spacing": (1.0, 0.0), "drive": {"kind": "free", "rigid": True}}
    given = Scene([Surface("a", **lower), Surface("b", bob=(0.0, -3.0))], Coulomb(0.1), 1.0)
    result = tribo.simulate(given, accuracy=1e-4)
    assert any("block = True" in note for note in result.notes)


def bad(problem, **settings):
    return pytest.param(settings, problem, id=problem)


class Twist(NamedTuple):
    strength: float

    def end_forces(self, t, phi, nu, twist):
        return 0.0, self.strength * twist, 0.0, 0.0


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        bad("bars: must be", bars="free"),
        bad('bars: must be "clamped"', bars=Ends(Twist(1.0))),
        bad("bath", bath={"masses": [1.0], "frequencies": [1.0]}),
        bad("langevin.temperature", langevin=Langevin(0.1, 0.2)),
        bad("initial.temperature", initial=Initial(temperature=0.1)),
        bad("set bob", initial=Initial(x=0.1)),
        bad("set velocity", initial=Initial(vy=0.1)),
        bad("beside drive.damping_y", drive=Pulled(**PULL, damping_y=1.0), velocity=(0.0, 0.1)),
        bad("turned", springs=Springs(1.0, turned=0.1)),
    ],
)
def test_what_a_block_cannot_go_with(settings, problem):
    with pytest.raises(InputError, match=problem):
        scene(**settings)


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (lambda: Pulled(stiffness=1.0, speed=0.0, damping=1.0), "needs block = true"),
        (lambda: Pulled(stiffness=1.0, speed=0.0, block=True, damping_y=1.0), "needs a load"),
        (lambda: DrivenBars(block=True), "move as one anyway"),
        (lambda: Free(rigid=True, block=True), "cannot go with block"),
        (lambda: Free(block=1), "true or false"),
    ],
)
def test_drives_that_are_refused(make, problem):
    with pytest.raises(InputError, match=problem):
        make()


@pytest.mark.parametrize("method", ["verlet", "kahan-li-8", "rkn8"])
def test_methods_that_cannot_take_pendulums_say_what_can(method):
    with pytest.raises(InputError, match="pendulums"):
        tribo.simulate(scene(), method=method)


def test_lammps_is_refused(tmp_path):
    with pytest.raises(InputError, match="LAMMPS"):
        to_lammps(scene(RIGID), tmp_path)
