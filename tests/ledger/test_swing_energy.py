"""The energy of swings in the frame of their bars, and the work against friction."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import paper


def scene_with(drive):
    """Case A with other starts, on a table whose bars stand."""
    upper, lower = paper.scene("A").surfaces
    upper = replace(upper, drive=drive, initial=tribo.Initial(swing=0.4, omega=-0.2))
    lower = replace(lower, drive=tribo.DrivenBars(), initial=tribo.Initial(omega=0.3))
    return replace(paper.scene("A"), surfaces=(upper, lower))


@pytest.mark.parametrize("drive", [tribo.DrivenBars(), tribo.Forced(), tribo.Free()])
def test_swing_energies(drive):
    """From angles and rates by hand: about the bar where it is driven, else about the centre."""
    scene = scene_with(drive)
    result = tribo.simulate(scene, accuracy=1e-9)
    for surface in scene.surfaces:
        series, a = result[surface.name], surface.asperite
        driven = isinstance(surface.drive, tribo.DrivenBars)
        inertia = a.m1 * a.length**2 * (1.0 if driven else a.m2 / (a.m1 + a.m2))
        twist = series.theta - surface.rest
        energy = 0.5 * inertia * series.omega**2 + 0.5 * a.kappa * twist**2
        np.testing.assert_allclose(series.swing_energy, energy, rtol=1e-13)
        if not driven:
            change = series.swing_energy - series.swing_energy[0]
            np.testing.assert_allclose(change, series.delta_e_int, atol=1e-13)
    assert 0.0 < result.error_estimate["swing_energy"] < 1e-9


def test_work_against_friction_is_what_driven_bars_give():
    """It becomes swing energy and contact energy; both surfaces' bars stand or move uniformly."""
    result = tribo.simulate(scene_with(tribo.DrivenBars()), accuracy=1e-10)
    upper, lower = result["upper"], result["lower"]
    stored = upper.swing_energy[:, 0] + lower.swing_energy[:, 0] + result.system.contact_energy
    error = result.error_estimate
    bound = 2.0 * (error["swing_energy"] + error["contact_energy"] + error["friction_work"])
    assert np.max(np.abs(upper.friction_work - (stored - stored[0]))) <= bound
    assert np.all(lower.friction_work == 0.0) and np.max(upper.friction_work) > 0.1


def test_work_against_friction_of_rows():
    """Minus the works of contact in the laboratory less those in the frame of the surface."""
    row = {"shape": (3, 1), "spacing": (2.5, 0.0)}
    upper = tribo.Surface("upper", bob=(-9.0, 0.0), velocity=(0.5, 0.1), **row)
    lower = tribo.Surface("lower", facing="up", velocity=(-0.2, 0.0), **row)
    scene = tribo.Scene((upper, lower), tribo.Gaussian(0.2, 0.5), 6.0)
    still = replace(upper, velocity=(0.0, 0.0)), replace(lower, velocity=(-0.7, -0.1))
    for ledger in ("asperites", "surfaces"):
        output = tribo.Output(samples=7, ledger=ledger)
        here, there = (
            tribo.simulate(replace(scene, surfaces=s, output=output), accuracy=1e-9)
            for s in (scene.surfaces, still)
        )
        work, own = (np.reshape(r["upper"].w1, (7, -1)).sum(axis=1) for r in (here, there))
        friction = here["upper"].friction_work
        np.testing.assert_allclose(friction, own - work, atol=1e-8)
        assert np.max(np.abs(friction)) > 1e-3
        assert np.max(np.abs(there["upper"].friction_work)) == 0.0
