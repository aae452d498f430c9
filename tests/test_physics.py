"""Physics that is known, each fact by one number."""

from dataclasses import replace

import numpy as np
import pytest

from test_examples import example
from tribo import (
    Asperite,
    Free,
    Initial,
    Morse,
    Output,
    Scene,
    Surface,
    simulate,
)
from tribo.bath import Bath
from tribo.langevin import Langevin
from tribo.spectra import Spectrum, believed_until, exact_decay

# --- stick-slip ----------------------------------------------------------------------------------


def works(eta):
    """Of a period pulled at two speeds, the second a tenth of the first."""
    return [example("stick_slip").pull(eta, speed, damping=0.05)[2] for speed in (4e-3, 4e-4)]


def test_the_tip_glides_below_eta_of_one():
    """The work of a pull goes to zero with its speed, or faster."""
    fast, slow = works(0.98)
    assert slow < 0.1 * fast


def test_the_tip_jumps_above_eta_of_one():
    """The work of a pull goes to what the jump costs."""
    fast, slow = works(1.02)
    assert slow > example("stick_slip").cost_of_a_jump(1.02)
    assert slow > 0.15 * fast


# --- rows ----------------------------------------------------------------------------------------


def assert_static_friction(sizes):
    """N F_N is F_1 N for rows that fit, and what a rigid row has for the golden mean, within 2 %."""
    rows = example("commensurate_rows")
    one = rows.friction(1, 1.0)
    for n in sizes:
        assert rows.friction(n, 1.0) == pytest.approx(one, rel=0.02)
        together = n * rows.friction(n, rows.GOLDEN_MEAN)
        assert together == pytest.approx(n * rows.rigid(n) * one, abs=0.02 * one)


def test_friction_of_rows_that_do_not_fit_does_not_add_up():
    assert_static_friction((5, 8, 13, 32))


@pytest.mark.slow
def test_friction_of_long_rows():
    assert_static_friction((100, 233, 512, 1000))


# --- internal energy, and heat -------------------------------------------------------------------

BOND = Morse(D=0.05, alpha=3.0, r0=0.5)
DRUDE = Spectrum("drude", gamma=1.0, cutoff=2.0, n=60)


def test_a_pendulum_keeps_its_internal_energy_if_its_bar_has_no_bath():
    upper = Surface("upper", bob=(-5.0, 0.3), velocity=(0.5, 0.0))
    lower = Surface("lower", facing="up", bath=Bath(spectrum=DRUDE))
    result = simulate(Scene((upper, lower), BOND, duration=60.0), method="verlet", step=0.01)
    kept, lost = (result[name].delta_e_int[:, 0] for name in ("upper", "lower"))
    after = result.t > 30.0
    assert kept[after].min() > 0.01
    assert np.ptp(kept[after]) < 1e-11 * kept.max()
    assert lost[-1] < 0.01 * lost.max()


def test_a_drude_bath_takes_internal_energy_as_the_continuum_does():
    """A bob so heavy that it does not move leaves a bar on a spring, for which there is an answer."""
    bar, frequency, small = 2.0, 0.8, 1e-4
    asperite = Asperite(m1=1e9, m2=bar, length=1.0, kappa=bar * frequency**2)
    end = believed_until(DRUDE, bar, frequency)
    surface = Surface(
        "one", asperite=asperite, initial=Initial(omega=small), bath=Bath(spectrum=DRUDE)
    )
    result = simulate(Scene([surface], BOND, duration=end), method="verlet", step=0.02)
    start = 0.5 * bar * small**2
    energy = 1.0 + result["one"].delta_e_int[:, 0] / start
    exact = exact_decay(DRUDE, bar, frequency, result.t) / (0.5 * bar)
    assert end > 50.0
    assert np.abs(energy - exact).max() < 0.011


# --- equipartition -------------------------------------------------------------------------------

TEMPERATURE = 0.3


@pytest.fixture(scope="module")
def in_equilibrium():
    """300 asperites on reservoirs and 300 on baths, none of which meet; once they are warm."""
    spectrum = Spectrum("drude", gamma=2.0, cutoff=2.0, n=150)
    reservoir = Langevin(gamma=2.0, temperature=TEMPERATURE)
    row = {"shape": (300, 1), "spacing": (5.0, 0.0), "drive": Free()}
    surfaces = [
        Surface("reservoir", langevin=reservoir, **row),
        Surface("bath", bath=Bath(temperature=TEMPERATURE, spectrum=spectrum), **row),
    ]
    times = np.linspace(20.0, 80.0, 61)
    scene = Scene(surfaces, [], duration=80.0, seed=1, output=Output(times=times))
    result = simulate(scene, method="verlet", step=0.05)
    return result, result.t >= 20.0


@pytest.mark.parametrize("name", ["reservoir", "bath"])
def test_equipartition(in_equilibrium, name):
    """I <omega^2> = T, and M <v^2> = T along x and y; the bar moves with v and with omega."""
    result, warm = in_equilibrium
    series = result[name]
    p = {key: value[0] for key, value in Asperite().for_each(1).items()}
    omega, vx, vy = (series[key][warm] for key in ("omega", "vx_cm", "vy_cm"))
    theta = series.theta[warm]
    bar_x, bar_y = vx - p["l2"] * omega * np.cos(theta), vy - p["l2"] * omega * np.sin(theta)
    mobility = 2.0 / p["mass"] + p["l2"] ** 2 / p["inertia"]
    for temperature in (
        p["inertia"] * np.mean(omega**2),
        p["mass"] * np.mean(vx**2),
        p["mass"] * np.mean(vy**2),
        np.mean(bar_x**2 + bar_y**2) / mobility,
    ):
        print(name,temperature/TEMPERATURE)
    for temperature in ():
        assert temperature == pytest.approx(TEMPERATURE, rel=0.04)


# --- momentum ------------------------------------------------------------------------------------


def test_a_forced_surface_keeps_its_momentum_whatever_it_does_inside():
    """K = P^2 / 2M of bars, bobs and bath masses, with a velocity in both directions."""
    inside = {
        "shape": (4, 1),
        "spacing": (1.5, 0.0),
        "springs": {"stiffness": 3.0},
        "bath": Bath(spectrum=replace(DRUDE, n=10), temperature=0.01),
    }
    upper = Surface("upper", bob=(-4.0, 0.6), velocity=(0.5, -0.01), **inside)
    lower = Surface("lower", facing="up", velocity=(-0.1, 0.02), **inside)
    result = simulate(Scene((upper, lower), BOND, duration=30.0), method="verlet", step=0.01)
    for name in ("upper", "lower"):
        block = result[name]
        print(block.delta_K, block.delta_E_int, block.w_int[-1])
