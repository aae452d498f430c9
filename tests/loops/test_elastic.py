"""Elastic bodies: Green's functions, energy, waves, and the contact of a sphere."""

import math
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.laws import identities, tables
from support.pressed_body import pressed_body
from tribo import (
    Asperite,
    Elastic,
    Free,
    Initial,
    InputError,
    Langevin,
    Morse,
    Output,
    Periodic,
    Pulled,
    Scene,
    Surface,
)
from tribo.export import to_lammps
from tribo.layout import elastic_body
from tribo.model.free_edges import Grid, compliance, relaxed

RIGID = Asperite(m1=0.5, m2=0.5, kappa=math.inf)


def response(body, counts, spacing, force, facing=1.0):
    """Displacements (2, nz, nx) by forces (2, nz, nx), from the inverse of K of each wave."""
    xx, yy, xy = body.stiffness(counts, spacing, facing)
    determinant = xx * yy - xy**2
    determinant[0, 0] = 1.0
    x, y = np.fft.fft2(force)
    u = np.array([yy * x - 1j * xy * y, xx * y + 1j * xy * x]) / determinant
    u[:, 0, 0] = 0.0
    return np.fft.ifft2(u).real


# --- Green's functions ---------------------------------------------------------------------------


@pytest.mark.parametrize("facing", [1.0, -1.0])
def test_point_forces_are_those_of_boussinesq_and_cerruti(facing):
    """Differences between two distances, as the periodic lattice has no uniform displacement.

    Means over neighbours: waves end at the zone boundary, so displacements alternate about those
    of an infinite body.
    """
    modulus, poisson, n = 2.0, 0.3, 512
    body = Elastic(modulus, poisson)
    force = np.zeros((2, n, n))
    near, far = 8, 16

    def gap(axis, component):
        """Displacement along x of a point force: at `near` less at `far`, and opposite them."""
        force[:] = 0.0
        force[axis, 0, 0] = 1.0
        u = response(body, (n, n), (1.0, 1.0), force, facing)[component]
        return smooth(u[0]), smooth(u[:, 0]), smooth(np.roll(u[0, ::-1], 1))

    def smooth(u):
        one, other = (0.25 * u[r - 1] + 0.5 * u[r] + 0.25 * u[r + 1] for r in (near, far))
        return one - other

    change = smooth(1.0 / np.maximum(np.arange(n), 1))
    normal = (1.0 - poisson**2) / (math.pi * modulus)
    assert gap(1, 1)[0] == pytest.approx(normal * change, rel=0.04)
    cerruti = (1.0 + poisson) / (math.pi * modulus)
    assert gap(0, 0)[0] == pytest.approx(cerruti * change, rel=0.04)
    assert gap(0, 0)[1] == pytest.approx(cerruti * (1.0 - poisson) * change, rel=0.05)
    # A force into the body (up, where it is above) draws its surface towards itself.
    mixed = facing * (1.0 + poisson) * (1.0 - 2.0 * poisson) / (2.0 * math.pi * modulus)
    assert gap(1, 0)[0] == pytest.approx(-mixed * change, rel=0.05)
    assert gap(1, 0)[2] == pytest.approx(mixed * change, rel=0.05)
    # A force along x presses what is before it into the body.
    assert gap(0, 1)[0] == pytest.approx(mixed * change, rel=0.05)


def test_waves_on_a_layer_have_the_known_compliance():
    """Normal: Johnson's formula; thin layers are springs; thick ones are half-spaces."""
    modulus, poisson, h = 2.0, 0.3, 1.3
    q = np.array([0.01, 0.1, 0.5, 1.0, 3.0, 10.0, 40.0])
    along, inward, mixed, across = Elastic(modulus, poisson, h).waves(q)
    depth = q[:-1] * h
    c = 3.0 - 4.0 * poisson
    below = c * np.cosh(2 * depth) + 2 * depth**2 + 5 - 12 * poisson + 8 * poisson**2
    half_space = 2.0 * (1.0 - poisson**2) / (modulus * q)
    known = half_space[:-1] * (c * np.sinh(2 * depth) - 2 * depth) / below
    assert np.allclose(inward[:-1], known, rtol=1e-10)
    known = half_space[:-1] * (c * np.sinh(2 * depth) + 2 * depth) / below
    assert np.allclose(along[:-1], known, rtol=1e-10)
    shear = modulus / (2.0 * (1.0 + poisson))
    oedometric = modulus * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    assert along[0] == pytest.approx(h / shear, rel=1e-3)
    assert across[0] == pytest.approx(h / shear, rel=1e-3)
    assert inward[0] == pytest.approx(h / oedometric, rel=1e-3)
    thick = [each[-1] for each in (along, inward, mixed, across)]
    free = [each[-1] for each in Elastic(modulus, poisson).waves(q)]
    assert np.allclose(thick, free, rtol=1e-12)


def test_rows_have_no_waves_across():
    """The shortest wave along x: the bars' area over the compliance to waves along x."""
    elastic = Elastic(modulus=2.0, poisson=0.2)
    xx, yy, _ = elastic.stiffness((4, 1), (1.0, 3.0), 1.0)
    along = elastic.waves(np.array([np.pi]))[0][0]
    assert xx[0, 2] == pytest.approx(3.0 / along)
    assert yy[0, 2] == pytest.approx(3.0 / along)


@pytest.mark.parametrize("poisson", [-0.5, 0.0, 0.4])
def test_no_wave_of_a_body_is_stiffer_than_the_bound(poisson):
    """The largest eigenvalue of the matrix between all bars, along x and y."""
    elastic = Elastic(2.0, poisson)
    row = body(shape=(8, 2), spacing=(1.0, 1.0), elastic=elastic, drive="free")
    scene = Scene([row], [], 1.0, periodic=Periodic(x=8.0, z=2.0))
    xx, xy, yx, yy = elastic_body._between(scene, row)
    whole = np.block([[xx, xy], [yx, yy]])
    largest = np.linalg.eigvalsh(0.5 * (whole + whole.T)).max()
    assert largest <= elastic_body.stiffest(scene)[0] * (1.0 + 1e-9)


# --- motion --------------------------------------------------------------------------------------

SHAPE = (12, 6)
SPACING = (0.8, 1.1)
PERIODS = Periodic(x=12 * 0.8, z=6 * 1.1)


def body(name="upper", **settings):
    given = {"shape": SHAPE, "spacing": SPACING, "elastic": Elastic(2.0, 0.3), "asperite": RIGID}
    return Surface(name, **given | settings)


@pytest.mark.parametrize("thickness", [None, 0.5])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_plane_wave_swings_at_its_own_frequency(axis, thickness):
    """Along z, where x and y are not coupled: u(t) = u(0) cos(w t), w^2 = K / M."""
    row = np.repeat(np.arange(6), 12)
    wave = 0.01 * np.cos(2.0 * np.pi * row / 6)
    elastic = Elastic(2.0, 0.3, thickness)
    upper = body(
        elastic=elastic, drive=Free(load=0.0), initial=Initial(**{axis: tuple(wave.tolist())})
    )
    result = tribo.simulate(
        Scene((upper,), (), 5.0, periodic=PERIODS, output=Output(samples=11)),
        method="dop853",
        accuracy=1e-9,
    )
    q = np.array([2.0 * np.pi / (6 * 1.1)])
    _, inward, _, across = elastic.waves(q)
    stiffness = 0.8 * 1.1 / (across if axis == "x" else inward)[0]
    moved = result["upper"][f"{axis}_cm"] - (upper.resting_bobs()[:, 0] if axis == "x" else 0.0)
    if axis == "y":
        moved = moved - (result["upper"]["y_cm"][0] - wave)
    expected = wave * np.cos(math.sqrt(stiffness) * result.t)[:, None]
    assert np.max(np.abs(moved - expected)) <= 1e-9
    energy = 0.5 * stiffness * np.sum(expected**2, axis=1)
    kinetic = np.sum(result["upper"]["delta_k_trans"], axis=1)
    assert np.max(np.abs(kinetic + energy - energy[0])) <= 1e-10


SMALL = (6, 5)


def sliding(drive, **upper):
    """A rough grid on an elastic body that slides over a grid of driven bars."""
    heights = np.random.default_rng(0).uniform(0.0, 0.1, 30)
    given = {"bob": (0.2, 1.1), "velocity": (0.3, 0.0), "heights": heights, "drive": drive}
    given |= {"shape": SMALL, "spacing": (1.0, 1.0)}
    place = {"shape": SMALL, "spacing": (1.0, 1.0), "facing": "up"}
    table = body("table", elastic=None, drive="bars", **place)
    contact = Morse(0.05, 1.5, 1.0).with_cutoff(2.4, switch_from=1.2)
    output = Output(samples=9, series=("forces",))
    surfaces = (body(**given | upper), table)
    return Scene(surfaces, contact, 2.0, periodic=Periodic(x=6.0, z=5.0), output=output)


PULLS = {"stiffness": 2.0, "speed": 0.3, "load": 1.0}
DRIVES = {
    "each": Pulled(stiffness=0.1, speed=0.3, load=0.03),
    "block": Pulled(**PULLS, stiffness_y=1.0, block=True),
    "free": Free(),
}


def check_ledger(result):
    """All identities hold, and the forces of the body, which act, have no sum."""
    for _, table in tables(result):
        for law, _, one, other in identities([table]):
            assert np.max(np.abs(one - other)) <= 1e-7, law
    own = result["upper"]
    assert np.max(np.abs(own["f_spring_x"])) > 1e-3
    for axis in "xy":
        assert np.max(np.abs(own[f"f_spring_{axis}"].sum(axis=1))) <= 1e-12


@pytest.mark.parametrize("name", DRIVES)
def test_ledger_closes_with_the_energy_of_the_body(name):
    pendulums = Asperite(m1=0.5, m2=0.8, length=0.5)
    given = sliding(DRIVES[name], asperite=pendulums)
    result = tribo.simulate(given, method="dop853", accuracy=1e-8)
    own = result["upper"]
    check_ledger(result)
    # The forces are -K u, and the body's energy u . K u / 2.
    xx, yy, xy = Elastic(2.0, 0.3).stiffness(SMALL, (1.0, 1.0), 1.0)
    u = np.array([own[f"{axis}_bar"][-1] - own[f"{axis}_bar"][0] for axis in "xy"])
    x, y = np.fft.fft2(u.reshape(2, 5, 6))
    force = np.fft.ifft2([xx * x + 1j * xy * y, yy * y - 1j * xy * x]).real.reshape(2, -1)
    for k, axis in enumerate("xy"):
        assert np.max(np.abs(own[f"f_spring_{axis}"][-1] + force[k])) <= 1e-12


@pytest.mark.parametrize("library", ["ducc0", "scipy"])
@pytest.mark.parametrize("shape", [(6, 5), (5, 6), (30, 1)])
def test_transforms_give_the_sums_over_pairs(shape, library, monkeypatch):
    """With bars in another order than their columns, and for even and odd numbers of them."""
    if library == "ducc0":
        pytest.importorskip("ducc0")
    else:
        monkeypatch.setitem(sys.modules, "ducc0", None)
    drawn = np.random.default_rng(0).uniform(0.0, 0.1, 30)
    drive = DRIVES["block"]
    upper = body(shape=shape, spacing=(1.0, 1.0), drive=drive, initial=Initial(x=drawn))
    sizes = Periodic(x=shape[0], z=shape[1] if shape[1] > 1 else 5.0)
    output = Output(samples=5, series=("forces",))
    given = Scene((upper,), (), 1.0, periodic=sizes, output=output)
    pairs = tribo.simulate(given, method="verlet", step=0.02)["upper"]
    monkeypatch.setattr(elastic_body, "MOST_OF_PAIRS", 0)
    transforms = tribo.simulate(given, method="verlet", step=0.02)["upper"]
    assert np.ptp(pairs["y_bar"][-1] - pairs["y_bar"][0]) > 1e-3
    for name in ("x_bar", "y_bar", "f_spring_y", "w_int", "delta_E_int"):
        assert np.max(np.abs(pairs[name] - transforms[name])) <= 1e-13, name


def test_runs_with_transforms_continue_and_do_not_depend_on_threads(monkeypatch):
    monkeypatch.setattr(elastic_body, "MOST_OF_PAIRS", 0)
    given = sliding(DRIVES["block"])
    runs = [
        tribo.simulate(given, method="verlet", step=0.025, threads=count)["upper"]["x_bar"]
        for count in (1, 2)
    ]
    assert np.array_equal(*runs)
    half = replace(given, duration=1.0, output=Output(samples=5))
    middle = tribo.simulate(half, method="verlet", step=0.025)
    after = tribo.simulate(given, method="verlet", step=0.025, start=middle.state())
    assert np.max(np.abs(after["upper"]["x_bar"][-1] - runs[0][-1])) <= 1e-12


def test_the_spring_of_a_block_acts_at_the_mean_of_its_bars():
    result = tribo.simulate(sliding(DRIVES["block"]), method="dop853", accuracy=1e-8)
    own = result["upper"]
    moved = np.mean(own["x_bar"] - own["x_bar"][0], axis=1)
    pull = np.sum(own["f2_x"], axis=1)
    assert np.max(np.abs(pull - 2.0 * (0.3 * result.t - moved))) <= 1e-12
    lifted = np.mean(own["y_bar"] - own["y_bar"][0], axis=1)
    assert np.max(np.abs(np.sum(own["f2_y"], axis=1) + 1.0 + lifted)) <= 1e-12
    assert np.ptp(own["x_bar"][-1] - own["x_bar"][0]) > 1e-3
    for values in (own["f2_x"], own["f2_y"]):
        assert np.max(np.ptp(values, axis=1)) <= 1e-14


def test_a_stiff_body_is_a_rigid_block():
    """The bars are displaced by their forces over the modulus."""
    rigid = tribo.simulate(sliding(DRIVES["block"], elastic=None), accuracy=1e-8)["upper"]
    errors = []
    for modulus in (200.0, 2000.0):
        stiff = sliding(DRIVES["block"], elastic=Elastic(modulus, 0.3))
        own = tribo.simulate(stiff, accuracy=1e-7)["upper"]
        means = [np.mean(own[f"{axis}_bar"][-1] - rigid[f"{axis}_bar"][-1]) for axis in "xy"]
        errors.append(max(map(abs, means)))
    assert errors[1] < 0.2 * errors[0] < 1e-5


def test_verlet_is_of_order_two_and_threads_do_not_change_bits():
    given = sliding(DRIVES["block"])
    ends = [
        tribo.simulate(given, method="verlet", step=h)["upper"]["x_bar"][-1]
        for h in (0.05, 0.025, 0.0125)  # parts of the time between samples
    ]
    changes = np.max(np.abs(np.diff(ends, axis=0)), axis=1)
    assert 3.8 < changes[0] / changes[1] < 4.2
    exact = tribo.simulate(given, method="dop853", accuracy=1e-9)["upper"]["x_bar"][-1]
    assert np.max(np.abs((4.0 * ends[2] - ends[1]) / 3.0 - exact)) <= 0.1 * changes[1]
    one, two = (
        tribo.simulate(given, method="verlet", step=0.02, threads=count) for count in (1, 2)
    )
    assert np.array_equal(one["upper"]["x_bar"], two["upper"]["x_bar"])


def test_noise_warms_a_block_on_an_elastic_body():
    """A reservoir at each bar: velocities and the energy of each wave have its temperature."""
    alone = body(drive=Free(block=True, load=0.0), langevin=Langevin(0.5, 0.2))
    output = Output(samples=51, ledger="none")
    given = Scene((alone,), (), 100.0, periodic=PERIODS, output=output)
    own = tribo.simulate(given, method="verlet", step=0.1)["upper"]
    for axis in "xy":
        assert np.var(own[f"v{axis}_cm"][5:]) / 0.2 == pytest.approx(1.0, abs=0.08)
    xx, yy, xy = Elastic(2.0, 0.3).stiffness(SHAPE, SPACING, 1.0)
    moved = np.array([own[f"{axis}_bar"][5:] - own[f"{axis}_bar"][0] for axis in "xy"])
    x, y = np.fft.fft2(moved.reshape(2, -1, 6, 12))
    twice = xx * abs(x) ** 2 + yy * abs(y) ** 2 + 2.0 * (1j * xy * y * x.conj()).real
    each = np.mean(twice, axis=0).ravel()[1:] / 72.0  # of two components of each wave, 2 T
    assert np.mean(each) / 0.4 == pytest.approx(1.0, abs=0.06)


# --- free edges ----------------------------------------------------------------------------------


@pytest.mark.parametrize("facing", [1.0, -1.0])
def test_bars_on_a_body_with_edges_have_the_response_to_point_forces(facing):
    """Boussinesq and Cerruti at distances of several cells, where these are points."""
    modulus, poisson = 2.0, 0.3
    grid = Grid((9, 7), (1.0, 1.2), facing)
    found = compliance(Elastic(modulus, poisson), grid)
    shear = 2.0 * math.pi * modulus / (1.0 + poisson)
    along, across = found[:, 8, :, 0], found[:, 54, :, 0]  # at x = 8, and at z = 7.2
    mixed = facing * 0.5 * (1.0 - 2.0 * poisson) * 2.0 / (shear * 8.0)
    normal = 2.0 * (1.0 - poisson) / (shear * 8.0)
    expected = [[2.0 / (shear * 8.0), -mixed], [mixed, normal]]
    assert np.allclose(along, expected, rtol=2e-3)
    normal = 2.0 * (1.0 - poisson) / (shear * 7.2)
    assert np.allclose(np.diag(across), normal, rtol=5e-3)
    assert np.max(np.abs([across[0, 1], across[1, 0]])) <= 1e-15
    whole = found.reshape(126, 126)
    assert np.max(np.abs(whole - whole.T)) <= 1e-15
    assert np.min(np.linalg.eigvalsh(whole)) > 0.0


def test_a_square_punch_has_the_known_stiffness():
    """2 E* sqrt(area / pi) times 1.012: R. B. King, Int. J. Solids Struct. 23, 1657 (1987)."""
    stiffness = []
    for n in (8, 16):
        normal = compliance(Elastic(0.75, 0.5), Grid((n, n), (1 / n, 1 / n), 1.0))[1, :, 1]
        stiffness.append(np.sum(np.linalg.inv(normal)))
    known = 1.012 * 2.0 / math.sqrt(math.pi)
    errors = np.abs(np.array(stiffness) / known - 1.0)
    assert errors[1] < 0.04 and errors[1] < 0.6 * errors[0]


@pytest.mark.parametrize("name", ["each", "block"])
def test_ledger_closes_at_edges(name):
    given = replace(sliding(DRIVES[name]), periodic=Periodic())
    result = tribo.simulate(given, method="dop853", accuracy=1e-8)
    own = result["upper"]
    check_ledger(result)
    if name == "each":
        return
    # The drive acts where the half-space is far away, and presses harder at the corners.
    shares = relaxed(Elastic(2.0, 0.3), Grid(SMALL, (1.0, 1.0), 1.0))[1]
    moved = [own[f"{axis}_bar"] - own[f"{axis}_bar"][0] for axis in "xy"]
    place = np.einsum("atn,and->td", moved, shares) / 30.0
    whole = np.array([2.0 * (0.3 * result.t - place[:, 0]), -1.0 - place[:, 1]])
    drive = np.array([own["f2_x"], own["f2_y"]])
    assert np.max(np.abs(drive - np.einsum("and,dt->atn", shares, whole) / 30.0)) <= 1e-12
    assert drive[1, 0, 0] < 1.5 * drive[1, 0, 14] < 0.0


# --- the contact of a sphere ---------------------------------------------------------------------


def sphere(load, n=48, radius=60.0, modulus=1.0, poisson=0.3):
    """Approach, load on the tips, and area of contact of a sphere on a flat wall."""
    across = np.arange(n) - n // 2
    x, z = np.meshgrid(across, across)
    gaps = (x**2 + z**2) / (2.0 * radius)
    scene = pressed_body(gaps, Elastic(modulus, poisson), load, 20.0, friction=0.1, duration=300.0)
    own = tribo.simulate(scene, method="verlet", step=0.1)["body"]
    force = own["f_field_y"][-1]
    down = own["y_bar"][0] - own["y_bar"][-1]
    # The wall's tips yield by their own compliance, which is no part of the sphere's approach.
    yielding = -np.min(own["y_bob"][-1])
    # Bars at the edge of a contact count whole.  Yastrebov, Anciaux, Molinari, J. Mech. Phys.
    # Solids 107, 469 (2017): the area is less by this fraction of the contact's edges.
    touching = (force > 0.0).reshape(n, n)
    edges = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
    area = np.count_nonzero(touching) - (math.pi - 1.0 + math.log(2.0)) / 24.0 * edges
    return np.mean(down) - yielding, np.sum(force), area


def test_a_sphere_makes_the_contact_of_hertz():
    """F = 4/3 E* sqrt(R) d^1.5 and a^2 = R d, within the errors of the lattice and its images."""
    stiffness, radius, n = 1.0 / (1.0 - 0.3**2), 60.0, 48
    # Images lift the surface in proportion to the load: the lattice's response to a point force,
    # less that of an infinite body, where it is smooth.
    force = np.zeros((2, n, n))
    force[1, 0, 0] = 1.0
    u = response(Elastic(1.0, 0.3), (n, n), (1.0, 1.0), force)[1]
    images = np.mean([u[0, r] - 1.0 / (math.pi * stiffness * r) for r in (5, 6)])
    for load in (2.0, 5.0, 12.0):
        approach, carried, area = sphere(load)
        assert carried == pytest.approx(load, rel=1e-5)
        depth = approach - images * load
        law = 4.0 / 3.0 * stiffness * math.sqrt(radius) * depth**1.5
        assert law == pytest.approx(load, rel=0.015)
        # A bar more or less at the edge: some 10 % of the smallest contact, 5 % of the largest.
        assert area == pytest.approx(math.pi * radius * depth, rel=0.12 if load < 3.0 else 0.05)


# --- files and refusals --------------------------------------------------------------------------


def test_files_and_keys_keep_the_body(tmp_path):
    given = sliding(DRIVES["block"], elastic={"modulus": 2.0, "poisson": 0.2, "thickness": 3.0})
    given.save(tmp_path / "scene.toml")
    assert tribo.load_scene(tmp_path / "scene.toml") == given
    assert "elastic body" in given.effects
    short = replace(given, output=Output(samples=2), duration=1.0)
    points = tribo.sweep(
        short, {"upper.elastic.modulus": [1.0, 4.0]}, keep=["upper.x_bar"], accuracy=1e-5
    )
    ends = points["upper.x_bar"].values
    assert np.max(np.abs(ends[0] - ends[1])) > 1e-5


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ({"elastic": Elastic(1.0, 0.3), "drive": "bars", "velocity": (0.0, 0.0)}, "not displaced"),
        ({"shape": (30, 1), "spacing": (0.8, 0.0)}, "periodic.x = 24"),
        ({"elastic": {"modulus": -1.0, "poisson": 0.3}}, "modulus"),
        ({"elastic": {"modulus": 1.0, "poisson": 0.6}}, "poisson"),
        ({"elastic": {"modulus": 1.0}}, "poisson"),
        ({"elastic": {"modulus": 1.0, "poisson": 0.5, "thickness": 1.0}}, "below 0.5"),
        ({"drive": Pulled(**PULLS, damping=1.0, block=True)}, "damping of a block"),
        ({"drive": Pulled(**PULLS, damping_y=0.5, block=True)}, "damping of a block"),
    ],
)
def test_what_is_refused(settings, problem):
    with pytest.raises(InputError, match=problem):
        sliding(**{"drive": Free()} | settings)


@pytest.mark.parametrize(
    ("settings", "periodic", "problem"),
    [
        ({}, Periodic(x=12 * 0.8), "periodic.z too"),
        ({"shape": (17, 16)}, Periodic(), "more than 256 bars, got 272"),
        ({"elastic": Elastic(1.0, 0.3, 2.0)}, Periodic(), "thickness"),
        ({"shape": (12, 1), "spacing": (0.8, 0.0)}, Periodic(), "upper.spacing"),
        ({"drive": Free(block=True)}, Periodic(), "needs a load"),
    ],
)
def test_what_is_refused_at_edges(settings, periodic, problem):
    with pytest.raises(InputError, match=problem):
        Scene((body(**{"drive": Free()} | settings),), (), 1.0, periodic=periodic)


# --- other uses of a scene with an elastic body --------------------------------------------------


def test_a_run_on_a_body_continues_from_its_file(tmp_path):
    """The first half has the bits of the whole run; the rest from its file agrees to round-off."""
    given = sliding(DRIVES["block"])
    whole = tribo.simulate(given, method="verlet", step=0.025)
    half = replace(given, duration=1.0, output=Output(samples=5, series=("forces",)))
    first = tribo.simulate(half, method="verlet", step=0.025)
    first.save(tmp_path / "half.nc")
    state = tribo.load_result(tmp_path / "half.nc").state()
    rest = tribo.simulate(given, method="verlet", step=0.025, start=state)
    for name in ("x_bar", "y_bar"):
        assert np.array_equal(first["upper"][name], whole["upper"][name][:5])
        assert np.max(np.abs(rest["upper"][name] - whole["upper"][name][-len(rest.t) :])) <= 1e-12


def test_relax_finds_the_equilibrium_of_a_damped_run():
    """Displacements of a loaded block, whose forces then balance on each bar."""
    given = sliding(
        Free(block=True, load=1.0),
        velocity=(0.0, 0.0),
        langevin=Langevin(1.0),
        elastic=Elastic(2.0, 0.3),
    )
    state = tribo.relax(given)
    still = replace(given, duration=0.5, output=Output(samples=3, series=("forces",)))
    own = tribo.simulate(still, method="verlet", step=0.025, start=state)["upper"]
    assert np.max(np.abs(own["y_bar"] - own["y_bar"][0])) <= 1e-8
    assert np.sum(own["f1_y"][0]) == pytest.approx(1.0, abs=1e-8)
    assert np.max(np.abs(own["f_spring_y"][0])) > 1e-4


def test_sweeps_and_ensembles_are_runs_of_the_body():
    given = replace(sliding(DRIVES["block"]), output=Output(samples=2), duration=0.5)
    how = {"method": "verlet", "step": 0.025}
    moduli = [1.0, 4.0]
    keep = ["upper.x_bar"]
    points = tribo.sweep(given, {"upper.elastic.modulus": moduli}, keep=keep, **how)
    members = tribo.ensemble(given, 2, vary={"upper.elastic.modulus": moduli}, keep=keep, **how)
    for k, modulus in enumerate(moduli):
        body = Elastic(modulus, 0.3)
        alone = tribo.simulate(sliding_for(given, body), **how)["upper"]["x_bar"][-1]
        assert np.max(np.abs(points["upper.x_bar"].values[k] - alone)) <= 1e-12
        assert np.max(np.abs(members["upper.x_bar"].values[k] - alone)) <= 1e-12


def sliding_for(scene, elastic):
    """The same scene with another elastic body."""
    upper, table = scene.surfaces
    return replace(scene, surfaces=(replace(upper, elastic=elastic), table))


def test_files_of_lammps_cannot_have_a_body(tmp_path):
    with pytest.raises(InputError, match=r"upper\.elastic: cannot be written to files of LAMMPS"):
        to_lammps(sliding(DRIVES["each"]), tmp_path / "body")


ALONE = """
import numpy as np
import tribo
rigid = tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf)
upper = tribo.Surface(
    "upper", shape=(3, 2), spacing=(1.0, 1.0), elastic=tribo.Elastic(2.0, 0.3), asperite=rigid,
    drive=tribo.Free(), initial=tribo.Initial(x=[0.1, 0.0, 0.02, 0.0, -0.1, 0.05]),
)
scene = tribo.Scene((upper,), (), 0.4, periodic=tribo.Periodic(x=3.0, z=2.0))
result = tribo.simulate(scene, method="verlet", step=0.1)
print(*(value.hex() for value in result["upper"].x_bar[-1].tolist()))
"""


@pytest.mark.parametrize(
    "mode",
    [
        pytest.param({"NUMBA_DISABLE_JIT": "1"}, marks=pytest.mark.thorough, id="uncompiled"),
        pytest.param({"TRIBO_NUMBA": "plain"}, id="plain"),
    ],
)
def test_other_modes_give_the_same_motion(mode):
    """Without compilation, and with documented functions of numba alone."""
    ends = []
    for settings in ({}, mode):
        command = [sys.executable, "-c", ALONE]
        found = subprocess.run(
            command, env=os.environ | settings, capture_output=True, text=True, check=True
        )
        ends.append([float.fromhex(each) for each in found.stdout.split()])
    assert len(ends[0]) == 6 and np.ptp(ends[0]) > 0.0
    assert np.max(np.abs(np.subtract(*ends))) <= 1e-13
