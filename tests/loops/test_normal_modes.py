"""One bar with oscillators is linear at small swing: its motion is a matrix exponential."""

import numpy as np
import pytest
from scipy.linalg import expm

import tribo

SMALL = 1e-5
ASPERITE = tribo.Asperite(m1=1.0, m2=2.0, kappa=2.0, length=2.0, i2=5.0)
MASSES, FREQUENCIES = np.array([0.3, 0.1, 0.5]), np.array([0.7, 1.9, 3.1])
INERTIAS, TURNS = np.array([0.4, 1.5]), np.array([1.1, 2.3])
TIME = 20.0


def alone(**settings) -> tribo.Scene:
    """A single asperite, started with a small swing and rate."""
    surface = tribo.Surface(
        "upper",
        asperite=ASPERITE,
        initial=tribo.Initial(theta=SMALL, omega=-0.4 * SMALL),
        **settings,
    )
    return tribo.Scene((surface,), (), TIME, output=tribo.Output(samples=9))


def modes(mass: np.ndarray, stiffness: np.ndarray, x: np.ndarray, v: np.ndarray, t: float):
    """(x, v) at t of M x'' = -K x."""
    n = len(x)
    generator = np.zeros((2 * n, 2 * n))
    generator[:n, n:] = np.eye(n)
    generator[n:, :n] = -np.linalg.solve(mass, stiffness)
    return np.split(expm(generator * t) @ np.concatenate([x, v]), 2)


def along_x():
    """Mass and stiffness matrices of (centre of mass, theta, oscillators), linearised.

    The bar is at x - l2 theta, and every oscillator pulls on it.
    """
    each = ASPERITE.for_each(1)
    l2, inertia, mass = each["l2"][0], each["inertia"][0], each["mass"][0]
    m = np.diag([mass, inertia, *MASSES])
    k = np.zeros_like(m)
    k[1, 1] = 2.0
    for n, stiffness in enumerate(MASSES * FREQUENCIES**2):
        stretch = np.zeros(len(m))
        stretch[[0, 1, 2 + n]] = -1.0, l2, 1.0
        k += stiffness * np.outer(stretch, stretch)
    x = np.array([0.0, SMALL, *(-l2 * SMALL * np.ones(3))])
    v = np.array([0.0, -0.4 * SMALL, 0.0, 0.0, 0.0])
    return m, k, x, v


@pytest.mark.parametrize(
    ("settings", "bound"),
    [({"accuracy": 1e-9}, 1e-7), ({"method": "kahan-li-6", "step": 0.05}, 1e-7)],
    ids=["dop853", "splitting"],
)
def test_a_bar_with_a_bath(settings, bound):
    """Swing and centre of mass follow the normal modes to what is left of the nonlinearity."""
    bath = tribo.Bath(masses=MASSES, frequencies=FREQUENCIES)
    result = tribo.simulate(alone(bath=bath), **settings)
    for k, t in enumerate(result.t):
        x, v = modes(*along_x(), t)
        upper = result["upper"]
        assert abs(upper.theta[k, 0] - x[1]) < bound * SMALL
        assert abs(upper.omega[k, 0] - v[1]) < bound * SMALL
        assert abs(upper.vx_cm[k, 0] - v[0]) < bound * SMALL


@pytest.mark.parametrize(
    "settings", [{"accuracy": 1e-9}, {"method": "kahan-li-6", "step": 0.05}], ids=str
)
def test_a_free_bar_with_torsional_oscillators(settings):
    """theta, phi and the oscillators turn linearly at any amplitude; no force moves the rest."""
    bath = tribo.Bath(inertias=INERTIAS, torsional_frequencies=TURNS)
    result = tribo.simulate(alone(bath=bath, bars="free"), **settings)
    inertia = ASPERITE.for_each(1)["inertia"][0]
    m = np.diag([inertia, 5.0, *INERTIAS])
    k = np.zeros_like(m)
    k[:2, :2] = [[2.0, -2.0], [-2.0, 2.0]]
    for n, stiffness in enumerate(INERTIAS * TURNS**2):
        twist = np.zeros(4)
        twist[[1, 2 + n]] = -1.0, 1.0
        k += stiffness * np.outer(twist, twist)
    start = np.array([SMALL, 0.0, 0.0, 0.0]), np.array([-0.4 * SMALL, 0.0, 0.0, 0.0])
    upper = result["upper"]
    for row, t in enumerate(result.t):
        x, v = modes(m, k, *start, t)
        assert abs(upper.theta[row, 0] - x[0]) < 1e-7 * SMALL
        assert abs(upper.phi[row, 0] - x[1]) < 1e-7 * SMALL
        assert abs(upper.nu[row, 0] - v[1]) < 1e-7 * SMALL
    assert np.max(np.abs(upper.W_ps)) == 0.0
    energy = upper.delta_E_int
    assert np.max(np.abs(energy)) < 1e-7 * SMALL**2


def test_thousands_of_oscillators_have_no_stability_limit():
    """Frequencies thousands of times above 1 / step are turned exactly.

    The bar moves in steps under them, which feeds them energy in proportion to the step, but
    nothing blows up, and the ledger closes.
    """
    bath = tribo.Bath(spectrum=tribo.Spectrum("drude", gamma=0.5, cutoff=20.0, n=2000))
    start = 0.5 * 2.0 * SMALL**2
    gains = []
    for step in (0.05, 0.0125):
        assert np.max(bath.frequencies) * step > 300.0
        result = tribo.simulate(alone(bath=bath), method="verlet", step=step)
        assert result.status == "completed"
        upper = result["upper"]
        gains.append(np.max(np.abs(upper.delta_E_int)) / start)
        assert np.max(np.abs(upper.w - upper.w_ps - upper.delta_e_int)) < 1e-11 * start
    assert gains[0] < 0.2
    assert gains[1] < 0.5 * gains[0]
