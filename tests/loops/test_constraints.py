"""Driven bars and rigid asperites: what follows from their constraints, limits, known models."""

import math
from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import (
    Asperite,
    Bath,
    Corrugation,
    DrivenBars,
    Field,
    Forced,
    Free,
    Initial,
    Langevin,
    Morse,
    Output,
    Pulled,
    Scene,
    Springs,
    Surface,
)

BOND = Morse(D=0.1, alpha=2.0, r0=0.5)
ROW = {"shape": (3, 1), "spacing": (1.1, 0.0), "springs": Springs(1.0)}


def slide(upper, lower, duration=10.0):
    """A row of three that passes over a row of three; each is given as settings."""
    surfaces = (
        Surface("upper", **{"bob": (-4.0, 0.6), "velocity": (0.5, 0.0)} | ROW | upper),
        Surface("lower", facing="up", **ROW | lower),
    )
    return Scene(surfaces, BOND, duration, output=Output(samples=21))


# --- driven bars ---------------------------------------------------------------------------------

DRIVEN = {"drive": DrivenBars(), "initial": Initial(swing=(0.2, 0.0, -0.1), omega=0.3)}


@pytest.mark.parametrize(
    ("extra", "numerics"),
    [({}, {"method": "dop853"}), ({"bars": "free"}, {"method": "verlet", "step": 0.02})],
)
def test_driven_bars_move_uniformly_and_stand_without_work(extra, numerics):
    """To round-off, whatever springs and warm baths do; forces work on bars that move only."""
    bath = Bath(masses=[0.2], frequencies=[2.0], temperature=0.1)
    scene = slide(DRIVEN | extra, DRIVEN | extra | {"bath": bath})
    result = tribo.simulate(scene, **numerics)
    for surface in scene.surfaces:
        table = result[surface.name]
        for axis, speed in zip("xy", surface.velocity, strict=True):
            path = table[f"{axis}_bar"] - speed * result.t[:, None]
            assert np.max(np.abs(path - path[0])) <= 1e-14
        offset = table["x_bob"] - table["x_bar"] - 2.0 * np.sin(table["theta"])
        assert np.max(np.abs(offset)) <= 1e-14
    assert np.max(np.abs(result["lower"].w2)) == 0.0
    assert np.max(np.abs(result["upper"].w2)) > 0.1
    assert np.max(np.abs(result["lower"].w2_ps)) > 0.1
    assert np.max(np.abs(result["lower"].w_int)) <= 1e-14
    assert np.max(np.abs(result["lower"].w_int_ps)) > 1e-3


def test_work_of_the_reaction_is_velocity_times_impulse():
    """Seen by observers who move with either surface; f2 depends on omega^2."""
    scene = slide(DRIVEN, DRIVEN)
    along = replace(
        scene,
        surfaces=tuple(
            replace(s, velocity=(s.velocity[0] - 0.5, s.velocity[1])) for s in scene.surfaces
        ),
    )
    one, other = (tribo.simulate(s, accuracy=1e-9) for s in (scene, along))
    assert np.max(np.abs(other["upper"].w2)) == 0.0
    impulse = (one["upper"].w2_ps - other["upper"].w2_ps) / 0.5
    assert one["upper"].w2 == pytest.approx(0.5 * impulse, abs=1e-7)
    assert other["lower"].w2 == pytest.approx(
        -(one["lower"].w2_ps - other["lower"].w2_ps), abs=1e-7
    )


@pytest.mark.slow
def test_driven_bars_are_heavy_bars():
    """A forced bar that is too heavy to be moved leads the same pendulum."""

    def swings(drive, m2):
        lower = {"drive": DrivenBars(), "springs": None}
        upper = {"drive": drive, "springs": None, "initial": Initial(omega=-0.3)}
        result = tribo.simulate(slide(upper | {"asperite": Asperite(m2=m2)}, lower))
        return result["upper"].theta

    assert swings(DrivenBars(), 2.0) == pytest.approx(swings(DrivenBars(), 7.0), abs=1e-7)
    assert swings(DrivenBars(), 2.0) == pytest.approx(swings(Forced(), 1e9), abs=1e-7)


def test_driven_bars_from_other_angles():
    """A prepared run from other angles is the scene with those angles."""
    scene = slide(DRIVEN, DRIVEN)
    start = replace(scene.surfaces[0].initial, swing=(-0.3, 0.1, 0.4))
    other = replace(scene, surfaces=(replace(scene.surfaces[0], initial=start), scene.surfaces[1]))
    one = tribo.prepare(scene, method="verlet", step=0.01).run({"upper.swing": (-0.3, 0.1, 0.4)})
    other = tribo.simulate(other, method="verlet", step=0.01)
    for surface in ("upper", "lower"):
        for name, values in other[surface].items():
            assert np.array_equal(one[surface][name], values), name


def test_driven_bars_continue():
    """From the state at half time, to the bits of the whole run."""
    scene = slide(DRIVEN, {"drive": DrivenBars(), "bars": "free"})
    half = replace(scene, duration=5.0, output=Output(samples=11))
    whole = tribo.simulate(scene, method="verlet", step=0.01)
    state = tribo.simulate(half, method="verlet", step=0.01).state()
    rest = tribo.simulate(scene, start=state, method="verlet", step=0.01)
    for surface in ("upper", "lower"):
        for name, values in rest[surface].items():
            assert np.array_equal(values, whole[surface][name][10:]), name


def test_states_of_other_constraints_are_refused():
    """Coordinates of driven bars and rates of rigid asperites have another meaning."""
    scene = slide({"drive": Free(), "langevin": Langevin(0.1)}, {}, duration=1.0)
    state = tribo.simulate(scene, method="verlet", step=0.1).state()
    changes = {
        'in uniform motion, as drive = "bars" holds them': {
            "drive": DrivenBars(),
            "langevin": None,
        },
        "kappa": {"asperite": Asperite(kappa=math.inf)},
    }
    for sentence, change in changes.items():
        upper = replace(scene.surfaces[0], **change)
        later = replace(scene, surfaces=(upper, scene.surfaces[1]), duration=2.0)
        with pytest.raises(tribo.InputError, match=sentence):
            tribo.simulate(later, start=state, method="verlet", step=0.1)


def test_states_tell_the_motion_of_centres_of_mass():
    """On driven bars too: their displacement from the uniform motion, and its rate."""
    result = tribo.simulate(slide(DRIVEN, {}), method="verlet", step=0.01)
    table, place = result.state().surfaces["upper"], result["upper"]
    resting = np.array([-4.0, -2.9, -1.8]) + 5.0
    assert table["x"] == pytest.approx(place.x_cm[-1] - resting, abs=1e-14)
    assert table["y"] == pytest.approx(place.y_cm[-1] - (0.6 + 4.0 / 3.0), abs=1e-14)
    assert table["vx"] == pytest.approx(place.vx_cm[-1] - 0.5, abs=1e-14)


# --- rigid asperites -----------------------------------------------------------------------------


def stiffened(kappa):
    """Everything that is reported of a slow pass of a pair with one stiffness."""
    asperite = Asperite(kappa=kappa)
    upper = {"bob": (-4.0, 0.7), "asperite": asperite, "initial": Initial(swing=0.3, phi=0.3)}
    surfaces = (
        Surface("upper", velocity=(0.5, 0.0), drive=Pulled(stiffness=0.5, speed=0.5), **upper),
        Surface("lower", facing="up", asperite=asperite, drive=DrivenBars()),
    )
    result = tribo.simulate(Scene(surfaces, BOND, 16.0, output=Output(samples=33)), accuracy=1e-7)
    tables = [result["upper"], result["lower"]]
    return {(k, name): v for k, table in enumerate(tables) for name, v in table.items()}


@pytest.mark.slow
def test_rigid_is_the_limit_of_stiff():
    """Differences vanish with 1 / kappa; those that the fast swing makes, with its root."""
    rigid, hard, soft = (stiffened(kappa) for kappa in (math.inf, 1e5, 1e3))
    for quantity in rigid:
        far = np.max(np.abs(soft[quantity] - rigid[quantity]))
        near = np.max(np.abs(hard[quantity] - rigid[quantity]))
        if quantity[1] not in ("omega", "nu", "vx_cm", "vy_cm"):  # the fast swing's
            assert near <= 0.15 * far + 1e-7, quantity
    assert np.max(np.abs(rigid[0, "wL"])) > 1e-3
    assert np.max(np.abs(rigid[0, "delta_e_int"])) == 0.0
    assert np.array_equal(rigid[0, "theta"], np.full_like(rigid[0, "theta"], 0.3))


A, PERIOD = 0.2, 1.0
Q = 2.0 * np.pi / PERIOD
TIP = Asperite(m1=0.5, m2=0.5, kappa=math.inf)


def corrugated(surface, duration, samples):
    """A surface alone on a corrugation."""
    fields = [Field(Corrugation(A, PERIOD), on=["tip"])]
    return Scene([surface], [], duration, fields=fields, output=Output(samples=samples))


@pytest.mark.parametrize("eta", [pytest.param(0.7, marks=pytest.mark.slow), 2.5])
def test_prandtl_tomlinson(eta):
    """A slow tip is always in equilibrium: k (X - x) = A q sin q x; from eta = 1 on it jumps.

    The force reaches A q, and every jump costs the energy between the two equilibria.
    """
    k, speed = Q**2 * A / eta, 1e-3
    reservoir = Langevin(gamma=0.3 * math.sqrt(k), velocity=(0.0, 0.0))
    tip = Surface("tip", asperite=TIP, drive=Pulled(stiffness=k, speed=speed), langevin=reservoir)
    result = tribo.simulate(corrugated(tip, 3.0 * PERIOD / speed, 1201), accuracy=1e-5)
    x, stage = result["tip"].x_cm[:, 0], speed * result.t
    force, work = k * (stage - x), result["tip"].w2[:, 0]
    period = work[-1] - work[-401]
    if eta < 1.0:
        assert force == pytest.approx(A * Q * np.sin(Q * x), abs=0.01 * A * Q)
        assert abs(period) < 0.02 * A
    else:
        edge = np.arccos(-1.0 / eta) / Q
        from_edge = edge + A * Q / k * np.sin(Q * edge)
        after = np.linspace(PERIOD - edge, PERIOD + edge, 100_001)
        target = after[np.argmin(np.abs(k * (from_edge - after) - A * Q * np.sin(Q * after)))]
        energies = [0.5 * k * (from_edge - x) ** 2 - A * np.cos(Q * x) for x in (edge, target)]
        assert np.max(force) == pytest.approx(A * Q, rel=0.01)
        assert period == pytest.approx(energies[0] - energies[1], rel=0.05)
    assert np.max(np.abs(result["tip"].delta_e_int)) == 0.0


@pytest.mark.slow
def test_frenkel_kontorova():
    """A weak corrugation displaces a chain by its force over K + 2 k (1 - cos q a)."""
    n, spacing, pull, stiffness = 8, 0.625 * PERIOD, 20.0, 15.0  # 8 spacings are 5 periods
    chain = Surface(
        "tip",
        bob=(0.1, 0.0),
        shape=(n, 1),
        spacing=(spacing, 0.0),
        asperite=TIP,
        drive=Pulled(stiffness=pull, speed=0.0),
        springs=Springs(stiffness, wrap=True),
        langevin=Langevin(gamma=6.0),
    )
    scene = corrugated(chain, 40.0, 2)
    weak = Field(Corrugation(1e-4, PERIOD), on=["tip"])
    table = tribo.simulate(replace(scene, fields=[weak]), accuracy=1e-9)["tip"]
    place = 0.1 + spacing * np.arange(n)
    response = pull + 2.0 * stiffness * (1.0 - np.cos(Q * spacing))
    expected = -1e-4 * Q * np.sin(Q * place) / response
    assert table.x_cm[-1] - place == pytest.approx(expected, abs=2e-4 * np.max(np.abs(expected)))


def test_rigid_free_asperites_are_point_masses():
    """Two of them that collide: momentum and kinetic energy are those of points of mass M."""
    points = {"asperite": Asperite(kappa=math.inf), "drive": Free(), "springs": None}
    scene = slide(points | {"shape": (1, 1)}, points | {"shape": (1, 1)}, duration=40.0)
    result = tribo.simulate(scene, accuracy=1e-9)
    speeds = [result[name].vx_cm[:, 0] for name in ("upper", "lower")]
    assert np.sum(speeds, axis=0) == pytest.approx(0.5, abs=1e-9)
    kinetic = sum(result.ledger.blocks[name]["delta_K"] for name in ("upper", "lower"))
    contact = result.system["contact_energy"]
    assert kinetic == pytest.approx(contact[0] - contact, abs=1e-8)
    assert np.max(np.abs(contact)) > 0.05
