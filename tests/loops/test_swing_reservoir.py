"""Langevin reservoirs on the swing: exact decay, work and heat, equipartition."""

import numpy as np
import pytest

import tribo
from tribo import Asperite, DrivenBars, Forced, Free, Initial, Langevin, Output, Scene, Surface

ASPERITE = Asperite().for_each(1)
# Moment of inertia of the default asperite's swing: about the centre of mass, and about the bar.
ABOUT_CM, ABOUT_BAR = ASPERITE["inertia"][0], 1.0 * 2.0**2
DRIVES = [(Forced(), ABOUT_CM), (Free(), ABOUT_CM), (DrivenBars(), ABOUT_BAR)]


@pytest.mark.parametrize(("drive", "inertia"), DRIVES[1:])
def test_decay_is_exact(drive, inertia):
    """Without a torsion spring omega decays exponentially; verlet keeps that to round-off."""
    surface = Surface(
        "one",
        asperite=Asperite(kappa=0.0),
        velocity=(0.5, 0.0),
        drive=drive,
        initial=Initial(omega=2.0),
        langevin=Langevin(0.7, on="swing"),
    )
    scene = Scene([surface], [], 5.0, output=Output(samples=11))
    result = tribo.simulate(scene, method="verlet", step=0.5)
    table = result["one"]
    omega = 2.0 * np.exp(-0.7 / inertia * result.t)
    assert table.omega[:, 0] == pytest.approx(omega, rel=1e-13, abs=0.0)
    lost = 0.5 * inertia * (2.0**2 - omega**2)
    assert table.heat[:, 0] == pytest.approx(lost, abs=1e-13)
    assert np.array_equal(table.heat, -table.w_T)
    assert np.max(np.abs(table.w_T_ps)) == 0.0
    if isinstance(drive, DrivenBars):  # each takes a loop of its own
        other = tribo.simulate(scene, accuracy=1e-10)
        assert other["one"].heat[:, 0] == pytest.approx(lost, abs=1e-9)


@pytest.mark.parametrize("method", ["rkn8", "kahan-li-6"])
def test_methods_refuse(method):
    """As they refuse a reservoir on the bars."""
    surface = Surface("one", langevin=Langevin(0.7, on="swing"))
    with pytest.raises(tribo.InputError, match="method"):
        tribo.simulate(Scene([surface], [], 1.0), method=method)


TEMPERATURE = 0.3


@pytest.mark.parametrize(("drive", "inertia"), [DRIVES[0], DRIVES[2]])
def test_equipartition(drive, inertia):
    """<inertia omega^2> = <kappa twist^2> = T, of which e_int holds its own inertia's part.

    Asperites are independent, which gives the standard error.
    """
    surface = Surface(
        "one",
        shape=(1000, 1),
        spacing=(5.0, 0.0),
        drive=drive,
        langevin=Langevin(2.0, TEMPERATURE, on="swing"),
    )
    output = Output(times=np.arange(20.0, 121.0))
    result = tribo.simulate(Scene([surface], [], 120.0, output=output), method="verlet", step=0.1)
    omega, twist, inside = (result["one"][key][1:] for key in ("omega", "theta", "delta_e_int"))
    kinetic, torsion = inertia * omega**2, 2.0 * twist**2
    held = 0.5 * (1.0 + ABOUT_CM / inertia)
    for energy, mean in ((kinetic, 1.0), (torsion, 1.0), (inside, held)):
        each = energy.mean(axis=0) / TEMPERATURE
        error = each.std() / np.sqrt(each.size)
        assert error < 0.02
        assert each.mean() == pytest.approx(mean, abs=4.0 * error)
    # The reservoir gave all of the energy: what is not in e_int is in the motion of the masses.
    given = result["one"].w_T + result["one"].w2
    energy = result["one"].delta_e_int + result["one"].delta_k_trans
    assert np.max(np.abs(given + result["one"].wL + result["one"].wR - energy)) < 1e-10


def test_noise_acts_on_the_swing_alone():
    """Bars of a forced surface do not feel it: centres of mass keep their uniform motion."""
    surface = Surface("one", velocity=(0.5, 0.0), langevin=Langevin(2.0, TEMPERATURE, on="swing"))
    table = tribo.simulate(Scene([surface], [], 5.0), method="verlet", step=0.1)["one"]
    assert np.ptp(table.vx_cm) == 0.0 and np.ptp(table.theta) > 0.1
