"""The scales of tolerances and of errors, and the rounding of differences of energies."""

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.hard_scenes import simulate
from tribo import paper
from tribo.accuracy.comparison import DIVERGED, DIVERGED_IN_CHAOS, estimate
from tribo.accuracy.extremes import Extremes
from tribo.accuracy.levels import first_guess, tolerance_scales
from tribo.accuracy.roundoff import rounding_of_terms
from tribo.accuracy.scales import ROLES, Scales, reported_scales, scale_of
from tribo.layout.layout import lay_out
from tribo.ledger import quantities
from tribo.ledger.ledger import assemble
from tribo.ledger.motion import Motion
from tribo.ledger.quantity import Quantity
from tribo.ledger.reported import reported

TURNING = {
    "a free bar": {"bars": "free", "initial": tribo.Initial(theta=0.4, phi=-0.7, nu=0.9)},
    "a clamped bar that turns": {"initial": tribo.Initial(theta=0.4, phi=1.5, nu=0.9)},
    "a clamped bar at rest": {},
}


def terms_of(layout, samples):
    """The rounding of terms in a run of one step."""
    return rounding_of_terms(layout, Motion(layout, layout.together, samples), 1)


def scene(bars: str) -> tribo.Scene:
    """Case A with another upper bar."""
    case = paper.scene("A")
    upper, lower = case.surfaces
    output = tribo.Output(samples=17)
    return replace(
        case, surfaces=(replace(upper, **TURNING[bars]), lower), duration=8.0, output=output
    )


@pytest.mark.parametrize("bars", TURNING)
def test_tolerance_scales_are_those_of_the_ledger(bars):
    """Rate, torsion and internal energy as the ledger of the same samples has them."""
    simulation = tribo.prepare(scene(bars), method="dop853", accuracy=1e-6)
    samples, layout = simulation.finest.samples, simulation.layout
    scales, books = tolerance_scales(layout, samples), assemble(layout, samples)
    assert scales.rate == reported_scales(layout, books).rate
    torsion = [
        np.max(np.abs(books.surfaces[s.name]["theta"] - s.rest - books.surfaces[s.name]["phi"]))
        for s in layout.scene.surfaces
    ]
    assert scales.twist == pytest.approx(max(torsion), rel=1e-14, abs=0.0)
    change = max(np.max(np.abs(series)) for series in books.series("delta_e_int"))
    works = max(np.max(np.abs(series)) for name in ("w1", "w2") for series in books.series(name))
    assert change <= scales.energy <= 3.0 * max(change, works)


@pytest.mark.parametrize("bars", TURNING)
def test_the_first_guess_of_the_rate(bars):
    """At least the rates of the scene's start, those of bars among them."""
    start = TURNING[bars].get("initial", tribo.Initial())
    assert first_guess(lay_out(scene(bars))).rate >= (start.nu or 0.0)


def pair(potential, duration, upper, lower=None, samples=11):
    """One asperite that slides over another."""
    surfaces = (tribo.Surface("upper", **upper), tribo.Surface("lower", facing="up", **lower or {}))
    return tribo.Scene(surfaces, potential, duration, output=tribo.Output(samples=samples))


STIFF = {
    "bob": (-20.0, 0.1),
    "velocity": (3.0, 0.0),
    "asperite": tribo.Asperite(kappa=5e4, m2=0.01),
}


@pytest.mark.parametrize("lower", [{}, {"asperite": STIFF["asperite"]}], ids=["soft", "stiff"])
@pytest.mark.parametrize("samples", [2, 401])
def test_a_stiff_pendulum_that_feels_no_force_yet(samples, lower):
    """Its works, 1e-59, are found to the accuracy in few steps; oscillations of a run are not."""
    scene = pair(tribo.Morse(1.0, 10.0, 0.5), 2.0, STIFF, lower, samples)
    result = simulate(scene, accuracy=1e-2)
    assert result.status == "completed" and result.met
    assert result.cost.force_evaluations < 1_000_000
    energy = tribo.Morse(1.0, 10.0, 0.5).energy(np.hypot(14.0, 0.1))
    assert result["upper"].w1_ps[-1, 0] == pytest.approx(energy, rel=1e-2)


SPINNING = {"initial": tribo.Initial(omega=100.0), "asperite": tribo.Asperite(kappa=0.0)}


def test_both_terms_of_a_difference_are_rounded():
    """A change of 1e-8 in an energy of 5e3 has the rounding of 5e3."""
    upper = {"bob": (-0.5, 0.5), "velocity": (1.0, 0.0), **SPINNING}
    lower = {"asperite": SPINNING["asperite"]}
    with pytest.warns(tribo.TriboWarning, match="accuracy is not met"):
        result = simulate(pair(tribo.Coulomb(1e-8), 1.0, upper, lower))
    table, bounds = result["upper"], result.error_estimate
    error = np.max(np.abs(table.delta_e_int - (table.w - table.w_ps)))  # the works are exact
    assert 1e-14 < error <= bounds["delta_e_int"] < 1e-9
    assert max(bounds["w"], bounds["w_ps"]) < 1e-16  # as requested of works of 1e-8
    change, block = result.system["total_energy_change"], result.ledger.blocks["upper"]
    off = np.max(np.abs(change - result.system["applied_work"]))
    assert 1e-14 < off <= bounds["total_energy_change"]
    assert np.max(np.abs(block["delta_E_int"] - table.delta_e_int[:, 0])) <= bounds["delta_E_int"]


def test_rounding_of_positions_moves_the_contact_energy():
    """By the force times the rounding of the distance from the origin."""
    case, steep = paper.scene("A"), tribo.Morse(1.0, 50.0, 0.5)
    upper, lower = case.surfaces
    far = replace(upper, bob=(-1e4, 0.0), velocity=(1e4, 0.0))
    near = replace(lower, bob=(0.0, -0.45))
    wanted = replace(case, surfaces=(far, near), interactions=steep, duration=1.0)
    simulation = tribo.prepare(replace(wanted, output=tribo.Output(samples=2)), accuracy=1e-4)
    result = simulation.first_result()
    table = result["upper"], result["lower"]
    apart = np.hypot(*(table[0][k][-1, 0] - table[1][k][-1, 0] for k in ("x_bob", "y_bob")))
    moved = abs(steep.force(apart)) * 1e4 * 2.0**-52
    samples = simulation.finest.samples
    assert terms_of(simulation.layout, samples)["contact_energy"] >= 0.1 * moved > 0.0


def test_rounding_of_terms_in_a_fast_frame():
    """Where a surface is fast, works are sums of large terms, which cancel for a forced one."""
    fast = {"velocity": (1e6, 0.0), "bob": (-0.5, 0.5)}
    scene = pair(tribo.Coulomb(0.2), 1.0, fast, {"velocity": (1e6 - 1.0, 0.0)})
    simulation = tribo.prepare(scene, accuracy=1e-4)
    samples, layout = simulation.finest.samples, simulation.layout
    terms = terms_of(layout, samples)
    work = np.max(np.abs(assemble(layout, samples).surfaces["upper"]["w1_ps"]))
    for name in ("w_ps", "W_ps", "w"):
        assert 2.0 < terms[name] / (np.finfo(float).eps * work) < 20.0


def test_diverged_runs_know_nothing():
    """Where one quantity differs by a part of its scale, each may be off by twice its own."""
    scales = Scales(rate=1.0, length=1.0, velocity=1.0, energy=2.0, total=2.0)

    def bounds(apart, diverged=DIVERGED, least=0.0):
        """Estimates of two energies, the first of which differs from the coarser run."""
        names, tops = ("contact_energy", "applied_work"), np.array([1.0, 1e-6])
        found = Extremes(names, tops, apart * tops, np.zeros(2), 0.0, 0.0, 0.0)
        return estimate(found, scales, False, least, diverged)

    assert bounds(10.0)["applied_work"] == pytest.approx(30.0)
    assert bounds(0.1)["applied_work"] == pytest.approx(4.0)
    assert bounds(1e-3)["applied_work"] == pytest.approx(6e-5, rel=1e-3)
    assert bounds(0.02)["applied_work"] == pytest.approx(1.2e-3, rel=1e-3)
    assert bounds(0.02, DIVERGED_IN_CHAOS)["applied_work"] == pytest.approx(4.0)
    assert bounds(1e-3, least=0.2)["applied_work"] == pytest.approx(4.4)


@pytest.mark.parametrize("bars", ["free", "clamped"])
def test_an_isolated_pendulum_keeps_an_accuracy(bars):
    """Where nothing does work, the round-off of an energy is not a scale."""
    upper = {"bob": (-0.5, 0.5), "bars": bars, "initial": tribo.Initial(theta=0.3)}
    assert simulate(pair(tribo.Coulomb(0.0), 5.0, upper), method="gauss-radau-15").met


@pytest.mark.parametrize("kappa", [0.0, 1.0])
@pytest.mark.parametrize("accuracy", [1e-6, 1e-10])
def test_a_surface_alone_keeps_an_accuracy(kappa, accuracy):
    """Nothing moves but all of the scene; its velocity, which is rounded, was relative to zero."""
    alone = tribo.Surface("upper", velocity=(0.5, 0.0), asperite=tribo.Asperite(kappa=kappa))
    result = tribo.simulate(tribo.Scene((alone,), (), 1.0), accuracy=accuracy)
    assert result.met and result.notes == ()
    assert result["upper"].vx_cm == pytest.approx(0.5, abs=0.0, rel=1e-15)


@pytest.mark.parametrize("kappa", [1.0, 100.0])
def test_a_surface_at_rest_in_a_field_keeps_an_accuracy(kappa):
    """Rates and velocities of round-off were relative to zero."""
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["upper"])
    upper = tribo.Surface("upper", drive="free", asperite=tribo.Asperite(kappa=kappa))
    scene = tribo.Scene((upper,), (), 3.0, fields=[field])
    result = tribo.simulate(scene, accuracy=1e-6)
    assert result.met and result.notes == ()
    assert np.max(np.abs(result["upper"].W)) < 1e-12


UNCOMPILED = """
import tribo
surfaces = tribo.Surface("upper"), tribo.Surface("lower", facing="up")
scene = tribo.Scene(surfaces, (), 1.0, output=tribo.Output(samples=2))
assert tribo.simulate(scene, method="midpoint", step=0.1).status == "completed"
"""


def test_no_interactions_in_plain_python():
    """No bob is on its way to an encounter, as in compiled code."""
    plain = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    subprocess.run([sys.executable, "-c", UNCOMPILED], env=plain, check=True)


def test_energies_of_a_surface_have_a_scale_of_their_own():
    """It is the largest of them, and at least that of asperites."""
    row = {"shape": (6, 1), "spacing": (20.0, 0.0)}
    upper = tribo.Surface("upper", bob=(-2.0, 0.0), velocity=(0.5, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    scene = tribo.Scene((upper, lower), tribo.Coulomb(0.2), 8.0, output=tribo.Output(samples=9))
    result = tribo.simulate(scene, method="verlet", step=0.01)
    scales = reported_scales(lay_out(scene), result.ledger)
    tables = [result["upper"], result["lower"], result.system]
    each, whole = (
        max(
            np.max(np.abs(series))
            for table in tables
            for name, series in table.items()
            if scale_of(name) == kind and name != "contact_energy"
        )
        for kind in ("energy", "total")
    )
    assert (scales.energy, scales.total) == (each, whole) and whole > 3.0 * each
    assert scales.of("upper.W") == scales.of("contact_energy") == scales.total
    assert scales.of("upper.w2") == scales.energy


@pytest.mark.parametrize(("strength", "is_noted"), [(1e-18, True), (1e-3, False)])
def test_works_below_the_rounding_of_energies(strength, is_noted):
    """A note says where spinning pendulums have far more energy than contact can change."""
    turning = {"bars": "free", "initial": tribo.Initial(omega=2.0)}
    upper = tribo.Surface("upper", bob=(-10.0, 0.0), velocity=(0.5, 0.0), **turning)
    lower = tribo.Surface("lower", facing="up", bars="free")
    result = tribo.simulate(tribo.Scene((upper, lower), tribo.Coulomb(strength), 4.0))
    assert any("no work exceeds" in note for note in result.notes) == is_noted


def test_a_further_quantity_changes_no_bound(monkeypatch):
    """One whose values are fifty times larger has a scale of its own."""
    upper = tribo.Surface("upper", bob=(-2.0, 1.0), velocity=(31.0, 0.0))
    lower = tribo.Surface("lower", facing="up", velocity=(30.0, 0.0))
    output = tribo.Output(samples=41)
    scene = tribo.Scene((upper, lower), tribo.Coulomb(1.0), 4.0, output=output)
    before = simulate(scene, accuracy=1e-6)
    further = Quantity(
        "energy", "kinetic energy", lambda group: group.each(lambda motion: motion.translation)
    )
    for table in (quantities.ASPERITE_QUANTITIES, quantities.QUANTITIES, quantities.EVERY_QUANTITY):
        monkeypatch.setitem(table, "k_lab", further)
    monkeypatch.setitem(ROLES, "k_lab", further.role)
    reported.cache_clear()
    try:
        after = simulate(scene, accuracy=1e-6)
        assert np.max(after["upper"].k_lab) > 50.0 * np.max(np.abs(after["upper"].w1))
        bounds = dict(after.error_estimate)
        assert 0.0 < bounds.pop("k_lab") < 1e-6 * np.max(after["upper"].k_lab)
        assert {name: before.error_estimate[name] for name in bounds} == bounds
        assert before.met and after.met and before.cost.steps == after.cost.steps
    finally:
        reported.cache_clear()


def test_scales_on_driven_bars_do_not_depend_on_the_unit_of_length():
    """Powers of two scale all numbers of a scene exactly, and with them what tolerances are of."""

    def scales(length):
        energy = length**2  # with masses and times of 1
        asperite = {"kappa": 2.0 * energy, "i2": energy}
        asperite |= {"length": 1.5 * length, "bar_length": 2.0 * length}
        langevin = {"gamma": 0.3 * energy, "temperature": 0.0, "on": "swing"}
        parts = {"asperite": asperite, "langevin": langevin, "drive": "bars"}
        place = {"bob": (0.0, 1.2 * length), "velocity": (0.5 * length, 0.0)}
        surfaces = [
            tribo.Surface("upper", **place, **parts),
            tribo.Surface("lower", facing="up", **parts),
        ]
        scene = tribo.Scene(surfaces, tribo.Morse(0.2 * energy, 2.0 / length, length), 6.0)
        prepared = tribo.prepare(scene, method="dop853", accuracy=1e-6)
        found = tolerance_scales(prepared.layout, prepared.plan.tuned.runs[-1].samples)
        return found.energy / energy, found.impulse / length, found.velocity / length, found.rate

    for length in (2.0**10, 2.0**-20):
        np.testing.assert_allclose(scales(length), scales(1.0), rtol=1e-4)


def test_steps_with_torsional_oscillators_do_not_depend_on_the_unit_of_length():
    """Their coordinates are angles, whose tolerances have no length."""

    def evaluations(length):
        energy = length**2  # with masses and times of 1
        asperite = {"kappa": 2.0 * energy, "i2": 5.0 * energy}
        asperite |= {"length": 2.0 * length, "bar_length": 3.0 * length}
        bath = tribo.Bath(inertias=[0.5 * energy], torsional_frequencies=[1.3])
        place = {"bob": (-4.0 * length, 0.9 * length), "velocity": (0.5 * length, 0.0)}
        surfaces = [
            tribo.Surface("upper", asperite=asperite, **place),
            tribo.Surface(
                "lower",
                facing="up",
                asperite=asperite,
                bars="free",
                bath=bath,
                initial={"phi": 0.1},
            ),
        ]
        scene = tribo.Scene(surfaces, tribo.Gaussian(0.3 * energy, 0.6 * length), 20.0)
        return tribo.simulate(scene, accuracy=1e-8).cost.force_evaluations

    assert evaluations(2.0**-30) == evaluations(1.0) == evaluations(2.0**20)
