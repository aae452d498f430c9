"""Baths and spectra: kernels, decays by independent methods, and the time of validity."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import exp1, expi

from tribo import Bath, InputError, Scene, Spectrum, Surface
from tribo.layout.layout import lay_out
from tribo.model.bath import as_bath, as_table
from tribo.model.spectrum import KINDS, discrete_decay, exact_decay, normal_modes, valid_until

DENSITY = {  # J(w) / (gamma w) at w_c = 1, and where it ends
    "drude": (lambda w: 1 / (1 + w**2), np.inf),
    "ohmic": (lambda w: np.exp(-w), np.inf),
    "debye": (lambda w: 1.0, 1.0),
}


# Kernels -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_kernel_is_that_of_its_spectral_density(kind):
    density, end = DENSITY[kind]
    gamma = 0.7
    cutoff = 3.0
    for t in (0.3, 2.0):
        tau = cutoff * t
        if np.isinf(end):
            integral = quad(density, 0, end, weight="cos", wvar=tau, epsabs=1e-10)[0]
        else:
            integral = quad(lambda w, tau=tau: density(w) * np.cos(w * tau), 0, end)[0]
        expected = 2 / np.pi * gamma * cutoff * integral
        assert Spectrum(kind, gamma, cutoff, 1).kernel(t) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("kind", KINDS)
def test_oscillators_sum_to_the_kernel(kind):
    t = np.linspace(0.0, 5.0, 401)
    errors = []
    for n in (50, 200, 800):
        spectrum = Spectrum(kind, 0.7, 3.0, n)
        masses, frequencies = spectrum.oscillators()
        stiffnesses = masses * frequencies**2
        assert np.sum(stiffnesses) == pytest.approx(spectrum.kernel(0.0), rel=1e-13, abs=0.0)
        total = stiffnesses @ np.cos(np.outer(frequencies, t))
        errors.append(np.max(np.abs(total - spectrum.kernel(t))) / spectrum.kernel(0.0))
    faster = 2 if kind == "drude" else 12  # per factor of 4 in n: its tail is long
    assert errors[0] > faster * errors[1] > faster**2 * errors[2]
    assert errors[2] < (0.02 if kind == "drude" else 1e-4)


def test_drude_oscillators_are_equal_springs_at_tangents():
    masses, frequencies = Spectrum("drude", 2.0, 3.0, 4).oscillators()
    np.testing.assert_allclose(frequencies, 3.0 * np.tan(np.pi * np.array([1, 3, 5, 7]) / 16))
    np.testing.assert_allclose(masses * frequencies**2, 2.0 * 3.0 / 4)


# Decays ------------------------------------------------------------------------------------------


def drawn_oscillators(n, seed=1):
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 2.0, n), rng.uniform(0.2, 4.0, n)


@pytest.mark.parametrize("frequency", [0.0, 0.4, 1.7])
@pytest.mark.parametrize("n", [0, 1, 2, 7])
def test_discrete_decay_against_the_equations_of_motion(n, frequency):
    """Coordinates x, x_1 ... x_n and their velocities, by a matrix exponential."""
    masses, frequencies = drawn_oscillators(n)
    mass = 1.3
    k = masses * frequencies**2
    matrix = np.zeros((2 * n + 2, 2 * n + 2))
    matrix[: n + 1, n + 1 :] = np.eye(n + 1)
    matrix[n + 1, 0] = -(frequency**2) - np.sum(k) / mass
    matrix[n + 1, 1 : n + 1] = k / mass
    matrix[n + 2 :, 0] = frequencies**2
    matrix[n + 2 :, 1 : n + 1] = -np.diag(frequencies**2)
    t = np.array([0.0, 0.3, 2.0, 11.0])
    states = np.array([expm(matrix * time)[:, n + 1] for time in t])
    expected = 0.5 * mass * (states[:, n + 1] ** 2 + frequency**2 * states[:, 0] ** 2)
    decay = discrete_decay(masses, frequencies, mass, frequency, t)
    np.testing.assert_allclose(decay, expected, atol=1e-12)


@pytest.mark.parametrize("frequency", [0.0, 1e-6, 0.5, 30.0])
@pytest.mark.parametrize("gamma", [1e-9, 0.1, 1e4])
@pytest.mark.parametrize("kind", KINDS)
def test_normal_modes_against_the_transform_of_the_motion(kind, gamma, frequency):
    """The Laplace transform of v(t) has a closed form, at every s > 0; modes interlace."""
    masses, frequencies = Spectrum(kind, gamma, 1.0, 60).oscillators()
    modes, weights = normal_modes(masses, frequencies, 1.0, frequency)
    for s in np.geomspace(1e-3, 1e3, 25):
        memory = np.sum(masses * frequencies**2 / (1.0 + (frequencies / s) ** 2))
        exact = s**2 / (s**2 + frequency**2 + memory)
        assert np.sum(weights / (1.0 + (modes / s) ** 2)) == pytest.approx(
            exact, rel=1e-11, abs=0.0
        )
    assert np.sum(weights) == pytest.approx(1.0, abs=1e-12)
    if frequency > 0.0:  # a constant force stretches the bar's own spring alone
        assert frequency**2 * np.sum(weights / modes**2) == pytest.approx(1.0, rel=1e-12, abs=0.0)
    poles = np.sort(np.append(frequencies, frequency))
    assert np.all(modes[1:] >= poles[:-1] * (1.0 - 1e-11))
    assert np.all(modes[:-1] <= np.sort(frequencies) * (1.0 + 1e-11))


def test_oscillators_of_one_frequency_are_one_oscillator():
    masses = np.array([1.0, 2.0, 0.5])
    frequencies = np.array([2.0, 1.0, 2.0])
    both = normal_modes(masses, frequencies, 1.5, 0.7)
    merged = normal_modes(np.array([2.0, 1.5]), np.array([1.0, 2.0]), 1.5, 0.7)
    np.testing.assert_allclose(both, merged, rtol=1e-14)


@pytest.mark.parametrize(("stiff", "expected"), [(1e9, 0.3), (1e-9, np.hypot(0.3, 1.0))])
def test_normal_modes_of_an_oscillator_far_off(stiff, expected):
    modes, weights = normal_modes(np.array([stiff**-2.0]), np.array([stiff]), 1.0, 0.3)
    assert modes[np.argmax(weights)] == pytest.approx(expected, rel=1e-12, abs=0.0)
    assert np.max(weights) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("gamma", "cutoff", "frequency"),
    [
        (1.0, 1.0, 1.0),
        (0.3, 2.0, 0.0),
        (5.0, 0.5, 2.0),
        (1.0, 4.0, 0.0),  # critical damping: a double rate
        (8 / 9, 3.0, 3**-0.5),  # a triple one
        (8 / 9, 3.0, 3**-0.5 + 1e-7),  # and nearly
    ],
)
def test_exact_decay_by_drude_against_a_matrix_exponential(gamma, cutoff, frequency):
    """x, v and the bath's force f: f' = -w_c f - (gamma w_c / m) v, per unit mass."""
    mass = 1.0
    t = np.linspace(0.0, 20.0, 41)
    matrix = np.array([[0, 1, 0], [-(frequency**2), 0, 1], [0, -gamma * cutoff / mass, -cutoff]])
    states = np.array([expm(matrix * time)[:, 1] for time in t])
    expected = 0.5 * mass * (states[:, 1] ** 2 + frequency**2 * states[:, 0] ** 2)
    decay = exact_decay(Spectrum("drude", gamma, cutoff, 1), mass, frequency, t)
    np.testing.assert_allclose(decay, expected, atol=2e-10)


def gauss_panels(edges):
    x, c = np.polynomial.legendre.leggauss(20)
    low, high = edges[:-1, None], edges[1:, None]
    return (0.5 * (low + high) + 0.5 * (high - low) * x).ravel(), (0.5 * (high - low) * c).ravel()


def response(kind, gamma):
    """Quadrature points and weights in w, and the kernel's Fourier-Laplace transform there."""
    fine = np.geomspace(1e-14, 0.5, 120)  # towards w = 0 and w = 1, where logarithms are
    if kind == "ohmic":
        w, dw = gauss_panels(np.concatenate([[0.0], fine[fine < 0.05], np.arange(0.05, 45, 0.05)]))
        lag = np.exp(-w) * expi(w) + np.exp(w) * exp1(w)
        return w, dw, gamma * (np.exp(-w) - 1j / np.pi * lag)
    w, dw = gauss_panels(np.concatenate([[0.0], fine, 1.0 - fine[-2::-1]]))
    return w, dw, gamma * (1.0 - 1j / np.pi * np.log((1.0 + w) / (1.0 - w)))


def decay_by_fourier(kind, gamma, frequency, t):
    """v(t) = (2/pi) integral of Re(i w / (w0^2 - w^2 + i w Gamma(w))) cos(w t), m = w_c = 1.

    For debye, and the oscillation that goes on for ever beyond the cutoff.
    """
    w, dw, damping = response(kind, gamma)
    density = (1j * w / (frequency**2 - w**2 + 1j * w * damping)).real * dw * 2.0 / np.pi
    v = np.cos(np.outer(t, w)) @ density
    stretch = np.sin(np.outer(t, w)) @ (density / w) * frequency
    if kind == "debye":

        def stiffness(w):
            return frequency**2 - w**2 + w * gamma / np.pi * np.log((w + 1.0) / (w - 1.0))

        w = brentq(stiffness, 1.0 + 1e-15, 50.0, xtol=1e-15)
        own = np.log((w + 1.0) / (w - 1.0)) - 2.0 * w / (w**2 - 1.0)
        weight = 2.0 * w / (2.0 * w - gamma / np.pi * own)
        v += weight * np.cos(w * t)
        stretch += weight * frequency / w * np.sin(w * t)
    return 0.5 * (v**2 + stretch**2)


@pytest.mark.parametrize(("gamma", "frequency"), [(0.3, 0.0), (0.3, 2.0), (3.0, 0.3)])
@pytest.mark.parametrize("kind", ["ohmic", "debye"])
def test_exact_decay_against_fourier_inversion(kind, gamma, frequency):
    t = np.linspace(0.0, 40.0, 101)
    expected = decay_by_fourier(kind, gamma, frequency, t)
    decay = exact_decay(Spectrum(kind, gamma, 1.0, 1), 1.0, frequency, t)
    np.testing.assert_allclose(decay, expected, atol=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_units_of_mass_and_time(kind):
    t = np.linspace(0.0, 10.0, 51)
    one = exact_decay(Spectrum(kind, 0.5, 1.0, 20), 1.0, 0.7, t)
    other = exact_decay(Spectrum(kind, 0.5 * 4.0 * 8.0, 8.0, 20), 4.0, 0.7 * 8.0, t / 8.0)
    np.testing.assert_allclose(other, 4.0 * one, rtol=1e-12)
    until = valid_until(Spectrum(kind, 0.5, 1.0, 20), 1.0, 0.7)
    other_until = valid_until(Spectrum(kind, 0.5 * 4.0 * 8.0, 8.0, 20), 4.0, 0.7 * 8.0)
    assert other_until == pytest.approx(until / 8.0, rel=1e-9)


# How long a bath is valid ------------------------------------------------------------------------


def deviation(spectrum, mass, frequency, t):
    """Of the energy with n oscillators from that with the continuum, in initial energies."""
    discrete = discrete_decay(*spectrum.oscillators(), mass, frequency, t)
    return np.abs(discrete - exact_decay(spectrum, mass, frequency, t)) / (0.5 * mass)


@pytest.mark.parametrize("n", [3, 40, 150])
@pytest.mark.parametrize("frequency", [0.0, 0.4, 1.5])
@pytest.mark.parametrize("gamma", [0.05, 1.0, 8.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_bath_is_valid_until_it_differs_from_the_continuum(kind, gamma, frequency, n):
    mass = 2.0
    cutoff = 3.0
    spectrum = Spectrum(kind, gamma * mass * cutoff, cutoff, n)
    until = valid_until(spectrum, mass, frequency * cutoff)
    before = np.linspace(0.0, until, 2500)
    assert np.max(deviation(spectrum, mass, frequency * cutoff, before)) < 0.0102
    soon = until + np.linspace(0.0, 1.0 / cutoff, 50)
    assert np.max(deviation(spectrum, mass, frequency * cutoff, soon)) > 0.0099


@pytest.mark.parametrize("kind", KINDS)
def test_more_oscillators_are_valid_longer(kind):
    until = [valid_until(Spectrum(kind, 0.2, 1.0, n), 1.0, 0.5) for n in (25, 50, 100, 200, 400)]
    ratios = np.divide(until[1:], until[:-1])
    assert np.all((ratios > 1.7) & (ratios < 2.3))


@pytest.mark.parametrize(
    ("gamma", "frequency"),
    [
        pytest.param(0.01, 0.5, marks=pytest.mark.thorough),
        (0.1, 0.0),
        pytest.param(1.0, 2.0, marks=pytest.mark.thorough),
    ],
)
@pytest.mark.parametrize("kind", KINDS)
def test_a_large_bath_is_valid_in_proportion_to_its_size(kind, gamma, frequency):
    """Beyond 400 oscillators the time is not compared; it is at most 3 % too long."""
    spectrum = Spectrum(kind, gamma, 1.0, 600)
    before = np.linspace(0.0, 0.97 * valid_until(spectrum, 1.0, frequency), 20_000)
    assert np.max(deviation(spectrum, 1.0, frequency, before)) < 0.0101
    assert valid_until(replace(spectrum, n=4000), 1.0, frequency) == pytest.approx(
        10.0 * valid_until(replace(spectrum, n=400), 1.0, frequency), rel=1e-12
    )


@pytest.mark.parametrize("frequency", [0.1, 1.0, 2.0])
@pytest.mark.parametrize("gamma", [0.3, 0.5])
def test_how_many_drude_oscillators_a_time_takes(gamma, frequency):
    """n = 1.2 to 1.7 times T (w_c^2 + w0^2) / (4 w_c)."""
    n = 100
    cutoff = 2.0
    until = valid_until(Spectrum("drude", gamma * cutoff, cutoff, n), 1.0, frequency * cutoff)
    assert 1.15 < n / (until * cutoff * (1.0 + frequency**2) / 4.0) < 1.75


@pytest.mark.parametrize("gamma", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("kind", KINDS)
def test_the_rule_for_the_time(kind, gamma):
    n = 150
    frequency = 0.5
    w = np.sqrt(frequency**2 + Spectrum(kind, gamma, 1.0, n).kernel(0.0))
    rule = {
        "drude": 4 * n / (1 + w**2),
        "ohmic": np.pi * n * np.exp(-w / 2),
        "debye": 2 * np.pi * n,
    }[kind]
    assert 0.7 < valid_until(Spectrum(kind, gamma, 1.0, n), 1.0, frequency) / rule < 1.1


def test_where_no_end_is_found_the_search_covers_two_recurrences():
    """A bar far beyond the cutoff of debye keeps its energy, with a continuum and with 10."""
    spectrum = Spectrum("debye", 0.01, 1.0, 10)
    until = valid_until(spectrum, 1.0, 10.0)
    assert until > 2 * 2 * np.pi * 10
    assert np.max(deviation(spectrum, 1.0, 10.0, np.linspace(0.0, until, 4000))) < 0.01


# Baths -------------------------------------------------------------------------------------------

LISTED = {
    "oscillators": [{"mass": 0.1, "frequency": 2.0}, {"mass": 0.2, "frequency": 1.0}],
    "torsional": [{"inertia": 0.3, "frequency": 4.0}],
    "temperature": 0.5,
}
DRUDE = {"spectrum": "drude", "gamma": 0.4, "cutoff": 3.0, "n": 8}


def test_a_bath_from_a_list():
    bath = as_bath(LISTED)
    np.testing.assert_array_equal(bath.masses, [0.1, 0.2])
    np.testing.assert_array_equal(bath.frequencies, [2.0, 1.0])
    np.testing.assert_array_equal(bath.inertias, [0.3])
    np.testing.assert_array_equal(bath.torsional_frequencies, [4.0])
    np.testing.assert_allclose(bath.stiffnesses, [0.4, 0.2])
    assert bath.temperature == 0.5
    assert bath.spectrum is None
    assert bath


def test_a_bath_from_a_spectrum():
    spectrum = Spectrum("drude", 0.4, 3.0, 8)
    for bath in (as_bath(DRUDE), Bath(spectrum=spectrum), Bath(*spectrum.oscillators())):
        np.testing.assert_array_equal((bath.masses, bath.frequencies), spectrum.oscillators())
    assert as_bath(DRUDE).spectrum == spectrum


@pytest.mark.parametrize("n", [1, 8, 40])
def test_the_mass_of_a_drude_bath_grows_with_n(n):
    """gamma (2n - 1) / w_c; a listed bath has the sum of its masses."""
    bath = Bath(spectrum=Spectrum("drude", 0.4, 3.0, n))
    assert bath.mass == pytest.approx(0.4 * (2 * n - 1) / 3.0, rel=1e-13, abs=0.0)
    assert as_bath(LISTED).mass == pytest.approx(0.3, rel=1e-15, abs=0.0)
    assert Bath().mass == 0.0


@pytest.mark.parametrize("nothing", [None, {}, {"oscillators": []}, {"temperature": 1.0}, Bath()])
def test_no_bath(nothing):
    assert not as_bath(nothing)


def test_a_bath_is_itself():
    bath = Bath([1.0], [2.0])
    assert as_bath(bath) is bath
    assert not bath.masses.flags.writeable


@pytest.mark.parametrize(
    "table",
    [
        LISTED,
        {"oscillators": []},
        {"oscillators": [], "torsional": LISTED["torsional"]},
        DRUDE,
        DRUDE | {"spectrum": "ohmic", "temperature": 2.0, "torsional": LISTED["torsional"]},
    ],
)
def test_tables_round_trip(table):
    assert as_table(as_bath(table)) == table
    assert as_table(as_bath(as_table(as_bath(table)))) == table


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (5, "must be a table, got 5"),
        ({"oscilators": []}, 'oscilators: is not a known key; did you mean "oscillators"?'),
        ({"oscillators": 5}, "oscillators: must be a list of {mass, frequency}, got 5"),
        ({"oscillators": [5]}, "oscillators[0]: must be a table, got 5"),
        ({"oscillators": [{"mass": 1}]}, "oscillators[0].frequency: is missing"),
        ({"oscillators": [{"frequency": 1}]}, "oscillators[0].mass: is missing"),
        (
            {"oscillators": [{"mass": -1, "frequency": 1}]},
            "oscillators[0].mass: must be positive [mass], got -1",
        ),
        (
            {"oscillators": [{"mass": 1, "frequency": 1}, {"mass": 1, "frequency": 0}]},
            "oscillators[1].frequency: must be positive [rad / time], got 0",
        ),
        (
            {"oscillators": [{"mass": 1, "frequency": 1, "gamma": 1}]},
            "oscillators[0].gamma: is not a known key; known here: mass, frequency",
        ),
        (
            {"torsional": [{"mass": 1, "frequency": 1}]},
            "torsional[0].mass: is not a known key; known here: inertia, frequency",
        ),
        (
            {"torsional": [{"inertia": "x", "frequency": 1}]},
            "torsional[0].inertia: must be a number [mass length^2], got 'x'",
        ),
        ({"temperature": -1.0}, "temperature: must not be negative [energy], got -1.0"),
        ({"gamma": 1.0}, "spectrum: is missing; gamma needs a spectrum"),
        (
            DRUDE | {"oscillators": []},
            "oscillators: cannot go with spectrum; give one or the other",
        ),
        (
            DRUDE | {"spectrum": "white"},
            'spectrum: must be "drude" or "ohmic" or "debye", got \'white\'',
        ),
        ({"spectrum": "drude", "gamma": 1.0, "n": 3}, "cutoff: is missing"),
        (DRUDE | {"gamma": 0.0}, "gamma: must be positive [mass / time], got 0.0"),
        (DRUDE | {"cutoff": float("inf")}, "cutoff: must be a finite number [rad / time], got inf"),
        (DRUDE | {"n": 0}, "n: must be an integer of at least 1, got 0"),
        (DRUDE | {"n": 2.5}, "n: must be an integer of at least 1, got 2.5"),
    ],
)
def test_wrong_tables(table, message):
    with pytest.raises(InputError) as caught:
        as_bath(table)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"masses": [1.0, -2.0], "frequencies": [1, 1]},
            "masses[1]: must be positive [mass], got -2.0",
        ),
        ({"masses": [1.0]}, "frequencies: must be 1 number [rad / time], got 0"),
        ({"inertias": [1.0]}, "torsional_frequencies: must be 1 number [rad / time], got 0"),
        ({"temperature": -2}, "temperature: must not be negative [energy], got -2"),
        ({"spectrum": "drude"}, "spectrum: must be a tribo.Spectrum, got 'drude'"),
        (
            {"masses": [1.0], "frequencies": [1.0], "spectrum": Spectrum("debye", 1.0, 1.0, 1)},
            "masses: cannot go with spectrum; give one or the other",
        ),
    ],
)
def test_wrong_baths(given, message):
    with pytest.raises(InputError) as caught:
        Bath(**given)
    assert str(caught.value) == message


def test_wrong_spectra_and_bars():
    with pytest.raises(InputError, match=r"^kind: must be "):
        Spectrum("white", 1.0, 1.0, 1)
    spectrum = Spectrum("drude", 1.0, 1.0, 1)
    with pytest.raises(InputError, match=r"^mass: must be positive \[mass\], got 0"):
        valid_until(spectrum, 0.0, 1.0)
    with pytest.raises(
        InputError, match=r"^frequency: must not be negative \[rad / time\], got -1"
    ):
        valid_until(spectrum, 1.0, -1.0)
    with pytest.raises(InputError, match=r"^t\[0\]: must not be negative \[time\], got -1"):
        exact_decay(spectrum, 1.0, 1.0, np.array([-1.0]))
    with pytest.raises(InputError, match=r"^frequencies: must be 1 number \[rad / time\], got 0"):
        discrete_decay([1.0], [], 1.0, 1.0, np.zeros(1))


# A warm start ------------------------------------------------------------------------------------


def start(bath, count, seed=5):
    """Displacements x, y and velocities x, y (count, n), and angles and rates (count, k)."""
    surface = Surface("a", shape=(count, 1), bars="free", bath=bath)
    layout = lay_out(Scene((surface,), (), 1.0, seed=seed))
    n = bath.masses.size
    q, v = layout.start.reshape(2, -1)[:, layout.core :].reshape(2, count, -1)
    places, velocities = (np.split(each, [n, 2 * n], axis=1) for each in (q, v))
    return (*places[:2], *velocities[:2]), (places[2], velocities[2])


def test_thermal_start_shares_the_energy_evenly():
    bath = as_bath(LISTED)
    count = 20_000
    drawn, _ = start(bath, count)
    variances = 0.5 / bath.stiffnesses, 0.5 / bath.masses
    error = np.sqrt(2.0 / count)  # standard deviation of a variance, relative
    for values, variance in zip(drawn, np.repeat(variances, 2, axis=0), strict=True):
        assert values.shape == (count, 2)
        assert np.all(np.abs(np.mean(values**2, axis=0) / variance - 1.0) < 4 * error)
        assert np.all(np.abs(np.mean(values, axis=0)) < 4 * np.sqrt(variance / count))
    columns = np.concatenate(drawn, axis=1)
    independent = np.corrcoef(columns, rowvar=False) - np.eye(columns.shape[1])
    assert np.max(np.abs(independent)) < 4.5 / np.sqrt(count)


def test_thermal_torsional_start():
    count = 20_000
    _, (angles, rates) = start(as_bath(LISTED), count)
    assert angles.shape == rates.shape == (count, 1)
    assert np.mean(angles**2) == pytest.approx(0.5 / (0.3 * 16.0), rel=4 * np.sqrt(2.0 / count))
    assert np.mean(rates**2) == pytest.approx(0.5 / 0.3, rel=4 * np.sqrt(2.0 / count))


def test_a_cold_start_is_at_rest():
    linear, torsional = start(as_bath(DRUDE | {"torsional": LISTED["torsional"]}), 3)
    for values in (*linear, *torsional):
        np.testing.assert_array_equal(values, 0.0)
    assert linear[0].shape == (3, 8)


def test_the_seed_decides_the_draw():
    one, same, other = (start(as_bath(LISTED), 2, seed)[0] for seed in (7, 7, 8))
    np.testing.assert_array_equal(one, same)
    assert not np.any(np.equal(one, other))
