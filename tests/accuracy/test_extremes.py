"""Scales, first steps and bounds that scenes far from the usual ones need."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.hard_scenes import changed, simulate, stopped
from tribo.accuracy.levels import (
    FLOOR,
    fine_level,
    first_guess,
    tolerance_scales,
    tolerances,
)
from tribo.accuracy.roundoff import rounding_of_terms
from tribo.integrators.methods import METHODS
from tribo.layout.layout import lay_out
from tribo.ledger.motion import Motion
from tribo.ledger.samples import Samples
from tribo.loops.integrate import first_step_at
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting

METHOD = METHODS["gauss-radau-15"]


def rounded(layout, sample):
    """The rounding of the terms of a run that is one sample."""
    return rounding_of_terms(layout, Motion(layout, layout.together, sample), 1)


def scales_of(scene):
    """The scales of tolerances, as a first run measures them."""
    layout = lay_out(scene)
    setting = Setting(tolerance=tolerances(layout, first_guess(layout), 1e-6, 0.5))
    return tolerance_scales(layout, Integrator(layout, METHOD)(setting, layout.times).samples)


def test_speeds_of_long_rods_are_measured():
    """A pendulum of a length of 1e4 that starts almost at rest."""
    pendulum = tribo.Asperite(m1=1e-8, kappa=1.0, length=1e4)
    start = tribo.Initial(theta=0.1, omega=1e-9)
    upper = tribo.Surface("upper", asperite=pendulum, initial=start)
    assert scales_of(tribo.Scene((upper,), (), 10.0)).velocity == pytest.approx(1e3, rel=1e-2)


def test_a_bar_that_turns_says_nothing_about_its_pendulum():
    """The tolerance of omega is not made from nu, which may be 1e10 times as large."""
    heavy = tribo.Asperite(m1=1e10, m2=1e10, kappa=1.0, length=1e2)
    upper = tribo.Surface("upper", asperite=heavy, bars="free", initial=tribo.Initial(nu=0.3))
    found = scales_of(tribo.Scene((upper,), (), 2.0))
    assert found.rate > 0.2 and found.spin < 1e-10


def test_works_below_round_off_are_no_scale():
    """A soft pendulum alone: the forces that hold it do works of 1e-20 of its energy."""
    soft = tribo.Asperite(kappa=1e-20)
    upper = tribo.Surface("upper", asperite=soft, initial=tribo.Initial(theta=0.1))
    assert tribo.simulate(tribo.Scene((upper,), (), 10.0)).met


def test_a_duration_in_which_nothing_happens():
    """Errors are relative to the energy of contact, not to works of 1e-31; angles are exact."""
    result = simulate(replace(changed("A"), duration=1e-30))
    assert result.status == "completed" and result.met
    assert result.error_estimate["theta"] < 1e-8


def test_no_two_settings_begin_with_the_same_step():
    """Neither do runs at the finest tolerances, where the coarse ones are still coarser."""
    layout = lay_out(changed("A"))
    coarse, fine = (
        tolerances(layout, first_guess(layout), level, 0.5)
        for level in (FLOOR / fine_level(METHOD), FLOOR)
    )
    assert coarse.level > 5.0 * fine.level and fine.level == pytest.approx(FLOOR, rel=1e-6, abs=0.0)
    assert first_step_at(fine, 1.0, 15) < 0.9 * first_step_at(coarse, 1.0, 15) < 0.9
    tuned = tribo.prepare(changed("A"), accuracy=1e-13).plan.tuned
    assert tuned.coarse.tolerance.level > tuned.fine.tolerance.level


def test_tolerances_below_rounding_fall_with_the_level():
    """Else coarse and fine runs took the same steps, and did not differ by their error."""
    layout = lay_out(changed("A"))
    scales = replace(
        first_guess(layout), lost_angle=1e-9, lost_rate=1e-9, lost_speed=1e-9, lost_energy=1e-9
    )
    coarse, fine = (tolerances(layout, scales, level, 0.5) for level in (1e-12, 1e-13))
    assert np.all(coarse.y < 1e-9)
    assert np.all(fine.y < 0.6 * coarse.y) and np.all(fine.s < 0.6 * coarse.s)


def test_a_scene_may_bound_its_evaluations(tmp_path):
    """By max_evaluations, in the file too; the message names it where equal steps exceed it."""
    numerics = tribo.Numerics(max_evaluations=1e3)
    scene = replace(changed("A", duration=1e5), numerics=numerics)
    scene.save(tmp_path / "scene.toml")
    result = stopped("NoProgress", tribo.load_scene(tmp_path / "scene.toml"))
    assert "stopped at t" in " ".join(result.notes)
    assert result.cost.force_evaluations < 2e5
    with pytest.raises(tribo.InputError, match=r"more than 1e\+03; .* max_evaluations"):
        tribo.simulate(scene, accuracy=1e-8, method="rk4")
    for wrong in (0.0, -1.0, np.nan, "many"):
        with pytest.raises(tribo.InputError, match="max_evaluations: must be"):
            tribo.Numerics(max_evaluations=wrong)


def test_an_unresolved_step_is_refused_unless_allowed(tmp_path):
    """By the argument or in the file; then it is noted."""
    stiff = tribo.Surface("upper", asperite=tribo.Asperite(kappa=1e4))
    scene = tribo.Scene((stiff,), (), 1.0, output=tribo.Output(samples=2))
    how = {"method": "verlet", "step": 0.1}
    with pytest.raises(tribo.InputError, match=r"step: must be at most .* allow_unresolved"):
        tribo.simulate(scene, **how)
    result = tribo.simulate(scene, **how, allow_unresolved=True)
    assert "of the right angle" in " ".join(result.notes)
    result.scene.save(tmp_path / "scene.toml")
    again = tribo.load_scene(tmp_path / "scene.toml")
    assert again.numerics.allow_unresolved
    assert tribo.simulate(again, **how).notes == result.notes
    with pytest.raises(tribo.InputError, match="allow_unresolved: must be true or false"):
        tribo.simulate(scene, **how, allow_unresolved=1)


def test_field_energies_are_rounded_with_the_places_of_bobs():
    """At the end of a rod of 1e9 periods, the phase of a corrugation is known to 1e-6 only."""
    found = []
    for length in (1.0, 1e9):
        rod = tribo.Asperite(m1=1.0, m2=1.0, length=length)
        wave = tribo.Field(tribo.Corrugation(1.0, 1.0), on=["upper"])
        scene = tribo.Scene((tribo.Surface("upper", asperite=rod),), (), 1.0, fields=(wave,))
        layout = lay_out(scene)
        sample = Samples.at_zero(layout)
        sample = replace(sample, field=np.ones(1))
        found.append(rounded(layout, sample)["total_energy_change"])
    assert found[1] == pytest.approx(7.0 * np.finfo(float).eps * 2.0 * np.pi * 1e9, rel=0.1)
    assert found[0] < 1e-7 * found[1]


def test_contact_energies_are_rounded_with_the_places_of_bobs():
    """Also for potentials without a length of their own."""
    found = []
    for length in (1.0, 1e6):
        rod = tribo.Asperite(length=length)
        upper = tribo.Surface("upper", bob=(0.0, 0.5), asperite=rod)
        lower = tribo.Surface("lower", facing="up", asperite=rod)
        layout = lay_out(tribo.Scene((upper, lower), tribo.Coulomb(0.2), 1.0))
        sample = Samples.at_zero(layout)
        sample = replace(sample, contact=np.array([0.4]))
        found.append(rounded(layout, sample)["contact_energy"])
    assert found[1] > 1e5 * found[0] > 0.0


def test_increments_below_the_rounding_of_a_rate():
    """A soft torsion changes the rate of a heavy bar by less than its rounding in every step.

    All runs then have the same bits, so that their differences show nothing of what is lost.
    """
    kappa, i2, nu, end = 1e-12, 2.4, -0.028, 1.0
    upper = tribo.Surface(
        "upper",
        bars="free",
        asperite=tribo.Asperite(m1=1.0, m2=2.0, kappa=kappa, i2=i2),
        initial=tribo.Initial(nu=nu),
    )
    scene = tribo.Scene((upper,), (), end)
    result = tribo.simulate(scene, accuracy=1e-7, method="verlet", progress=False)
    lost = 0.5 * kappa / i2 * abs(nu) * end**2
    error = abs(result["upper"].nu[-1, 0] - nu)
    assert error < 0.5 * lost  # nothing has changed
    assert lost - error <= result.error_estimate["nu"] <= 1e-7 * abs(nu)
