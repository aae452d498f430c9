"""Physics that is known, each fact by one number."""

from dataclasses import replace

import numpy as np
import pytest

from support.examples import example
from tribo import (
    Asperite,
    Bath,
    Free,
    Initial,
    Langevin,
    Morse,
    Output,
    Scene,
    Spectrum,
    Surface,
    simulate,
)
from tribo.model.spectrum import exact_decay, valid_until

# --- stick-slip ----------------------------------------------------------------------------------


def works(eta):
    """Of a period pulled at two speeds, the second a tenth of the first."""
    return [example("stick_slip").pull(eta, speed, damping=0.05)[2] for speed in (8e-3, 8e-4)]


def test_the_tip_glides_below_eta_of_one():
    """The work of a pull goes to zero with its speed, or faster."""
    fast, slow = works(0.98)
    assert slow < 0.1 * fast


def test_the_tip_jumps_above_eta_of_one():
    """The work of a pull goes to what the jump costs."""
    fast, slow = works(1.02)
    assert slow > example("stick_slip").jump_energy(1.02)
    assert slow > 0.15 * fast


# --- rows ----------------------------------------------------------------------------------------


def assert_static_friction(sizes):
    """F_N is F_1 for rows that fit; N F_N is a rigid row's for the others, within 2 % of F_1."""
    rows = example("commensurate_rows")
    one = rows.friction(1, 1.0)
    for n in sizes:
        assert rows.friction(n, 1.0) == pytest.approx(one, rel=0.02)
        together = n * rows.friction(n, rows.GOLDEN_MEAN)
        assert together == pytest.approx(n * rows.rigid(n) * one, abs=0.02 * one)


@pytest.mark.slow
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
    """A bob too heavy to move leaves a bar on a spring, for which there is an answer."""
    bar, frequency, small = 2.0, 0.8, 1e-4
    asperite = Asperite(m1=1e9, m2=bar, length=1.0, kappa=bar * frequency**2)
    end = valid_until(DRUDE, bar, frequency)
    surface = Surface(
        "one", asperite=asperite, initial=Initial(omega=small), bath=Bath(spectrum=DRUDE)
    )
    result = simulate(Scene([surface], BOND, duration=end), method="verlet", step=0.02)
    start = 0.5 * bar * small**2
    energy = 1.0 + result["one"].delta_e_int[:, 0] / start
    exact = exact_decay(DRUDE, bar, frequency, result.t) / (0.5 * bar)
    assert end > 50.0
    assert np.abs(energy - exact).max() < 0.01


# --- equipartition -------------------------------------------------------------------------------

TEMPERATURE = 0.3


def warm():
    """Rows of asperites that do not meet: on reservoirs, and on baths as warm as they."""
    spectrum = Spectrum("drude", gamma=2.0, cutoff=2.0, n=150)
    bath = Bath(temperature=TEMPERATURE, spectrum=spectrum)
    row = {"spacing": (5.0, 0.0), "drive": Free()}
    surfaces = [
        Surface("reservoir", shape=(1000, 1), langevin=Langevin(2.0, TEMPERATURE), **row),
        Surface("bath", shape=(300, 1), bath=bath, **row),
    ]
    output = Output(times=np.arange(20.0, 121.0))
    result = simulate(Scene(surfaces, [], 120.0, output=output), method="verlet", step=0.1)
    for surface in surfaces:  # the start is cold
        yield {key: values[1:] for key, values in result[surface.name].items()}


def test_equipartition():
    """I <omega^2> = M <v^2> = T, and bars, which move with v and omega, have T / mobility.

    Asperites are independent, which gives the standard error; what the cold pendulums took from a
    bath of 300 degrees of freedom at first is 1 % of its warmth.
    """
    mass, inertia, l2 = (Asperite().for_each(1)[key][0] for key in ("mass", "inertia", "l2"))
    mobility = 2.0 / mass + l2**2 / inertia
    for series in warm():
        omega, theta, vx, vy = (series[key] for key in ("omega", "theta", "vx_cm", "vy_cm"))
        bar = (vx - l2 * omega * np.cos(theta)) ** 2 + (vy - l2 * omega * np.sin(theta)) ** 2
        for squares in (inertia * omega**2, mass * vx**2, mass * vy**2, bar / mobility):
            each = squares.mean(axis=0) / TEMPERATURE
            error = each.std() / np.sqrt(each.size)
            assert error < 0.02
            assert each.mean() == pytest.approx(1.0, abs=4.0 * error + 0.01)


# --- momentum ------------------------------------------------------------------------------------


def test_a_forced_surface_keeps_its_momentum_whatever_it_does_inside():
    """K = P^2 / 2M, P the momentum of bars, bobs and bath masses, stays to round-off."""
    velocity = (0.5, -0.01)
    settings = {
        "shape": (4, 1),
        "spacing": (1.5, 0.0),
        "springs": {"stiffness": 3.0},
        "bath": Bath(spectrum=replace(DRUDE, n=10), temperature=0.01),
    }
    upper = Surface("upper", bob=(-4.0, 0.6), velocity=velocity, **settings)
    lower = Surface("lower", facing="up", **settings)
    result = simulate(Scene((upper, lower), BOND, duration=30.0), method="verlet", step=0.01)
    block = result["upper"]
    assert block.delta_E_int[-1] > 1.0
    assert np.abs(block.w_int).max() > 0.1
    assert np.abs(block.delta_K).max() < 1e-13
