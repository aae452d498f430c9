"""The ledger closes: every identity between its entries, at every recorded time.

No tolerance here is chosen: each side of an identity may be off by what the run itself says its
entries may be off by.
"""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import simpson

from support.laws import EXTERNAL, identities, tables
from support.strategies import (
    REST,
    all_scenes,
    asperites,
    assert_within,
    bar,
    coulombs,
    dyadic,
    forced,
    lattice_scenes,
    open_scenes,
    potentials,
    run,
    scenes,
)
from tribo import Initial, Interaction, Output, Scene, Surface


@given(all_scenes())
def test_ledger_closes(scene):
    """Works and pseudoworks are changes of energy: of asperites, of surfaces and of the whole."""
    result = run(scene)
    for law, names, one, other in identities(table for _, table in tables(result)):
        assert_within(bar(result, *names), one, other, law)


@given(all_scenes())
def test_work_on_a_surface_is_that_of_its_external_forces(scene):
    """W is the sum of the works of all forces on the asperites but the internal one."""
    result = run(scene)
    for surface in scene.surfaces:
        table = result[surface.name]
        names = [name for name in EXTERNAL if name in table]
        work = sum(np.sum(table[name], axis=1) for name in names)
        bound = surface.count * bar(result, *names) + bar(result, "W")
        assert_within(bound, table["W"], work, f"W of {surface.name}")


@given(scenes() | lattice_scenes())
def test_energy_of_the_system_is_all_there_is(scene):
    """The system's energy is that of its surfaces and of their contact."""
    result = run(scene)
    contact, blocks = result.system["contact_energy"], result.ledger.blocks.values()
    energy = sum(block["delta_K"] + block["delta_E_int"] for block in blocks)
    bound = len(blocks) * bar(result, "delta_K", "delta_E_int")
    bound += bar(result, "total_energy_change") + 2.0 * bar(result, "contact_energy")
    change = result.system["total_energy_change"]
    assert_within(bound, change, energy + contact - contact[0], "total_energy_change")


@given(open_scenes())
def test_heat_is_friction_times_slip_squared(scene):
    """A reservoir at temperature 0 takes the integral of gamma (v_bar - u)^2, or gamma omega^2."""
    result = run(replace(scene, output=Output(samples=513)))
    for surface in scene.surfaces:
        table, langevin = result[surface.name], surface.langevin
        u = surface.velocity if langevin.velocity is None else langevin.velocity
        arm = surface.asperite.for_each(surface.count)["l2"] * table["omega"]
        slip_x = table["vx_cm"] - arm * np.cos(table["theta"]) - u[0]
        slip_y = table["vy_cm"] - arm * np.sin(table["theta"]) - u[1]
        on_bar = langevin.on == "bar"
        rate = langevin.gamma * (slip_x**2 + slip_y**2 if on_bar else table["omega"] ** 2)
        fine, coarse = simpson(rate, result.t, axis=0), simpson(rate[::2], result.t[::2], axis=0)
        bound = bar(result, "heat") + np.max(np.abs(fine - coarse))
        assert_within(bound, table["heat"][-1], fine, f"heat of {surface.name}")


# Of forced surfaces whose bars do not turn, and whose asperites all swing.
SWINGS_ALONE = {"bars": ("clamped",), "turning": False, "kappas": ("finite",)}


@given(scenes(drive=forced(), potential=coulombs(), **SWINGS_ALONE))
def test_forced_sliding_shares_the_work(scene):
    """The forces on bob and bar work about the centre of mass as their arms: l1 to l2.

    Drive forced without load, bars clamped at rest: w1 - w1_ps = (l1 / length) delta_e_int, and
    likewise for w2; their pseudoworks cancel.
    """
    result = run(scene)
    for surface in scene.surfaces:
        table = result[surface.name]
        m1, m2 = np.asarray(surface.asperite.m1), np.asarray(surface.asperite.m2)
        for work, share in (("w1", m2 / (m1 + m2)), ("w2", m1 / (m1 + m2))):
            about = table[work] - table[f"{work}_ps"]
            bound = bar(result, work, f"{work}_ps", "delta_e_int")
            assert_within(bound, about, share * table["delta_e_int"], f"{work} - {work}_ps")
        bound = bar(result, "w1_ps", "w2_ps")
        assert_within(bound, table["w1_ps"], -table["w2_ps"], "w1_ps = -w2_ps")


def seen_from(scene, ux, uy):
    """The scene as an observer who moves at (-ux, -uy) sees it."""
    return replace(
        scene,
        surfaces=tuple(
            replace(surface, velocity=(surface.velocity[0] + ux, surface.velocity[1] + uy))
            for surface in scene.surfaces
        ),
    )


@given(scenes(drive=forced(), potential=coulombs()))
def test_forced_pseudowork_is_velocity_times_impulse(scene):
    """w1_ps = v . J, with the impulse J as two observers in motion measure it."""
    result = run(scene)
    along_x, along_y = run(seen_from(scene, 1.0, 0.0)), run(seen_from(scene, 0.0, 1.0))
    for surface in scene.surfaces:
        vx, vy = surface.velocity
        rest, x, y = (r[surface.name]["w1_ps"] for r in (result, along_x, along_y))
        bound = bar(result, "w1_ps") * (1.0 + abs(vx) + abs(vy))
        bound += abs(vx) * bar(along_x, "w1_ps") + abs(vy) * bar(along_y, "w1_ps")
        assert_within(bound, rest, vx * (x - rest) + vy * (y - rest), "w1_ps = v . J")


@given(
    potential=potentials(),
    asperite=asperites(1),
    bars=st.sampled_from(["clamped", "free"]),
    place=st.tuples(dyadic(-3.0, -1.0), dyadic(0.5, 1.0)),
    start=st.tuples(*[dyadic(-0.4, 0.4)] * 4),
)
def test_identical_asperites_stay_mirror_images(potential, asperite, bars, place, start):
    """Two identical asperites in forced sliding: Theta - pi = theta, and equal prices."""
    swing, *others = start

    def surface(name, facing, bob, velocity):
        initial = Initial(REST[facing] + swing, *others)
        return Surface(name, facing, bob, velocity, bars=bars, asperite=asperite, initial=initial)

    upper = surface("upper", "down", place, (1.0, 0.0))
    lower = surface("lower", "up", (0.0, 0.0), (0.0, 0.0))
    result = run(Scene((upper, lower), (Interaction(potential),), 5.0, output=Output(samples=33)))
    one, other = result["upper"], result["lower"]
    assert_within(2.0 * bar(result, "theta"), one.theta + np.pi, other.theta, "theta")
    for name in ("phi", "omega", "nu", "delta_e_int"):
        assert_within(2.0 * bar(result, name), one[name], other[name], name)
    for name in ("w1", "w2"):
        about = [table[name] - table[f"{name}_ps"] for table in (one, other)]
        assert_within(2.0 * bar(result, name, f"{name}_ps"), *about, f"{name} - {name}_ps")
    assert_within(2.0 * bar(result, "wL", "wR"), one.wL + one.wR, other.wL + other.wR, "ends")
