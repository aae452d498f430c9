"""Friction from many oscillators: spectra of baths, and how long a finite bath is valid.

A bar of mass M on a spring of angular frequency w0 (0: a free bar) is coupled to point oscillators
of stiffness k_j = m_j w_j^2, all released at the bar's position and at rest.  It obeys the
generalised Langevin equation (R. Zwanzig, J. Stat. Phys. 9, 215 (1973); U. Weiss, *Quantum
Dissipative Systems*, chapter 3), here at T = 0, without noise; velocities are relative to the
surface's:

    M x'' = -M w0^2 x - integral_0^t Gamma(t - s) x'(s) ds ,    Gamma(t) = sum_j k_j cos(w_j t) .

A continuum of oscillators keeps the energy that it absorbs.  A finite number returns it after a
recurrence time, which :func:`valid_until` computes.  The equations are linear, so the bar's motion
is a sum of exponentials: oscillating ones with n oscillators, decaying ones with the continuum.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tribo import validation as check
from tribo.model import recurrence
from tribo.model.recurrence import KINDS, SIDE, Kind, Motion, normal_modes

__all__ = ["Spectrum", "discrete_decay", "exact_decay", "normal_modes", "valid_until"]


# Largest difference between the bar's energy with n oscillators and with the continuum up to which
# the bath is valid, as a fraction of the initial energy.
VALID = 0.01
# Number of oscillators up to which `valid_until` compares the motions.  Beyond it the time is
# proportional to n.
LARGEST_COMPARED = 400
# Recurrence times that the comparison covers at least.
RECURRENCES = 2.0
# Terms (samples x exponentials) that the comparison may cost; it is longer than RECURRENCES where
# it costs less than that: about 0.1 s.
AFFORDABLE = 2_500_000
# Phase of the fastest oscillation between two samples [rad].
SAMPLING = 0.4
# Sum of the terms that the comparison leaves out, as a fraction of the initial velocity.
NEGLIGIBLE = 1e-4
# Sum of the terms whose oscillation the samples need not resolve, likewise.
UNRESOLVED = 0.01
# Tolerance of the continuum's kernel in the comparison.
KERNEL_TOLERANCE = 3e-8
# Tolerance of the continuum's kernel in `exact_decay`.
EXACT_KERNEL_TOLERANCE = 1e-12


@dataclass(frozen=True)
class Spectrum:
    """A damping kernel Gamma(t), discretised by n oscillators.

    With w_c the cutoff, x_j = (j - 1/2)/n for j = 1 ... n, and J(w) the spectral density, such that
    Gamma(t) = (2/pi) integral_0^inf J(w)/w cos(w t) dw (Weiss, chapter 3):

        drude   J = gamma w / (1 + (w/w_c)^2)       Gamma = gamma w_c exp(-w_c t)
                w_j = w_c tan(pi x_j / 2)           k_j = gamma w_c / n
        ohmic   J = gamma w exp(-w/w_c)             Gamma = (2/pi) gamma w_c / (1 + (w_c t)^2)
                w_j = -2 w_c log(1 - x_j)           k_j = (4/pi) gamma w_c (1 - x_j) / n
        debye   J = gamma w for w < w_c             Gamma = (2/pi) gamma sin(w_c t) / t
                w_j = w_c x_j                       k_j = (2/pi) gamma w_c / n

    Drude and debye oscillators have equal stiffnesses, Gamma(0)/n, at the quantiles of J(w)/w.
    Ohmic oscillators are at the quantiles of its square root. With equal stiffnesses too few
    would lie above the cutoff, and strong damping (gamma = 10 M w_c) would be valid for a time 2
    to 10 times shorter. In return, weak damping with w0 far below the cutoff is valid for down to
    half the time.

    Attributes
    ----------
    kind : str
        "drude", "ohmic" or "debye".
    gamma : float
        Damping coefficient of slow motion, whose friction force is -gamma v [mass / time].
    cutoff : float
        Cutoff w_c [rad / time].
    n : int
        Number of oscillators.

    Notes
    -----
    The slowest oscillators are heavy.  The masses m_j = k_j / w_j^2 add up to gamma (2n - 1) / w_c
    for drude, and for large n to about 1.6 n gamma / w_c for ohmic and 3.1 n gamma / w_c for debye:
    see `mass` of :class:`tribo.Bath`.
    """

    kind: Kind
    gamma: float
    cutoff: float
    n: int

    def __post_init__(self) -> None:
        check.choice("kind", self.kind, KINDS)
        gamma, cutoff = (check.one(check.POSITIVE, f"{unit} / time") for unit in ("mass", "rad"))
        check.fields(self, gamma=gamma, cutoff=cutoff, n=check.count(1, check.LARGEST_COUNT))

    def oscillators(self) -> tuple[np.ndarray, np.ndarray]:
        """The oscillators that stand for the continuum.

        Returns
        -------
        masses : ndarray, (n,)
            [mass].
        frequencies : ndarray, (n,)
            Angular frequencies [rad / time].
        """
        x = (np.arange(self.n) + 0.5) / self.n
        if self.kind == "drude":
            w = np.tan(np.pi / 2.0 * x)
            share = np.ones(self.n)
        elif self.kind == "ohmic":
            w = -2.0 * np.log1p(-x)
            share = 4.0 / np.pi * (1.0 - x)
        else:  # debye
            w = x
            share = np.full(self.n, 2.0 / np.pi)
        return self.gamma / (self.cutoff * self.n) * share / w**2, self.cutoff * w

    def kernel(self, t: np.ndarray | float) -> np.ndarray:
        """The memory kernel Gamma(t) of the continuum [mass / time^2], as an array like `t`."""
        wt = self.cutoff * np.abs(np.asarray(t, dtype=float))
        strength = self.gamma * self.cutoff
        if self.kind == "drude":
            return strength * np.exp(-wt)
        if self.kind == "ohmic":
            return 2.0 / np.pi * strength / (1.0 + wt**2)
        return 2.0 / np.pi * strength * np.sinc(wt / np.pi)  # debye


def exact_decay(spectrum: Spectrum, mass: float, frequency: float, t: np.ndarray) -> np.ndarray:
    """Energy of a bar coupled to the continuum of a spectrum, which starts with unit velocity.

    Each exponential in the kernel is one more variable of a linear system without memory, which is
    solved by its eigenvalues.

    Parameters
    ----------
    spectrum, mass, frequency
        As for :func:`valid_until`; the number of oscillators is not used.
    t : (m,) array
        Times, not negative [time].

    Returns
    -------
    (m,) array
        mass/2 (v^2 + w0^2 x^2) [mass velocity^2]; mass/2 at t = 0.  Its error is 1e-10 of that;
        for debye, where an oscillation beyond the cutoff remains, it grows as 1e-12 w_c t.
    """
    mass, frequency, t = _checked(mass, frequency, t)
    friction = spectrum.gamma / (mass * spectrum.cutoff)
    motion = recurrence.motion_with_continuum(
        spectrum.kind, friction, frequency / spectrum.cutoff, EXACT_KERNEL_TOLERANCE
    )
    return 0.5 * mass * motion.energy(spectrum.cutoff * t)


def discrete_decay(
    masses: np.ndarray, frequencies: np.ndarray, mass: float, frequency: float, t: np.ndarray
) -> np.ndarray:
    """Energy of a bar coupled to n oscillators, by normal modes.

    Parameters
    ----------
    masses, frequencies : (n,) arrays
        Masses [mass] and angular frequencies [rad / time] of the oscillators.
    mass, frequency, t
        As for :func:`exact_decay`.

    Returns
    -------
    (m,) array
        As of :func:`exact_decay`.
    """
    mass, frequency, t = _checked(mass, frequency, t)
    masses = check.vector("masses", masses, check.POSITIVE, unit="mass")
    count = masses.size
    unit = "rad / time"
    frequencies = check.vector("frequencies", frequencies, check.POSITIVE, count, unit)
    motion = recurrence.motion_with_oscillators(masses / mass, frequencies, frequency)
    return 0.5 * mass * motion.energy(t)


def valid_until(spectrum: Spectrum, mass: float, frequency: float) -> float:
    """The time up to which a spectrum's n oscillators damp a bar as the continuum would [time].

    Until then the bar's energy, starting with unit velocity, is that of :func:`exact_decay`
    within 1 % of the initial energy.  For up to 400 oscillators both energies are compared from
    sample to sample; where they agree over two recurrences at least, the time covered is returned.
    For more, it is the time of 400 oscillators times n / 400, at most 3 % too long (measured up to
    n = 2000 for gamma up to 10 M w_c and w0 up to 2 w_c).

    As a rule the time is 2 pi over the spacing of the oscillators at the frequency w,
    w^2 = w0^2 + Gamma(0)/M, 0.7 to 1.1 times this, or several times where the first recurrence is
    harmless (n of 100 or more; for n = 10 it may be a fifth of it):

        drude   4 n w_c / (w_c^2 + w^2)                 w^2 = w0^2 + gamma w_c / M
        ohmic   (pi n / w_c) exp(-w / (2 w_c))          w^2 = w0^2 + (2/pi) gamma w_c / M
        debye   2 pi n / w_c

    Parameters
    ----------
    spectrum : Spectrum
        The kernel and the number of oscillators.
    mass : float
        Mass M of the bar [mass].
    frequency : float
        Angular frequency w0 of the bar on its spring [rad / time]; 0 for a free bar.
    """
    mass, frequency, _ = _checked(mass, frequency, np.zeros(1))
    friction = spectrum.gamma / (mass * spectrum.cutoff)
    n = min(spectrum.n, LARGEST_COMPARED)
    end = _end_of_agreement(spectrum.kind, n, friction, frequency / spectrum.cutoff)
    return spectrum.n / n * end / spectrum.cutoff


def _checked(mass: float, frequency: float, t: np.ndarray) -> tuple[float, float, np.ndarray]:
    return (
        check.number("mass", mass, check.POSITIVE, "mass"),
        check.number("frequency", frequency, check.NOT_NEGATIVE, "rad / time"),
        check.vector("t", np.atleast_1d(t), check.NOT_NEGATIVE, unit="time"),
    )


@lru_cache(maxsize=256)
def _end_of_agreement(kind: Kind, n: int, friction: float, frequency: float) -> float:
    """:func:`valid_until` by comparison, for a bar of mass 1 and a cutoff of 1."""
    oscillators = Spectrum(kind, friction, 1.0, n).oscillators()
    discrete = recurrence.motion_with_oscillators(*oscillators, frequency).without_small_terms(
        NEGLIGIBLE
    )
    exact = recurrence.motion_with_continuum(kind, friction, frequency, KERNEL_TOLERANCE)
    exact = exact.without_small_terms(NEGLIGIBLE)
    step = SAMPLING / max(_fastest_rate(discrete), _fastest_rate(exact))
    # The first recurrence, after 2 pi over the closest spacing of modes; none of one mode.
    spacing = np.min(np.diff(discrete.rates.imag), initial=np.inf)
    recurrences = RECURRENCES * float(2.0 * np.pi / spacing)
    horizon = max(recurrences, step * AFFORDABLE / discrete.rates.size)
    pairs = zip(discrete.blocks(step), exact.blocks(step), strict=False)
    for index, (one, other) in enumerate(pairs):
        differing = np.flatnonzero(np.abs(one - other) > VALID)
        start = step * SIDE**2 * index
        if differing.size:
            return _first_difference(discrete, exact, start + step * differing[0], step)
        if start + step * SIDE**2 > horizon:
            break
    return horizon


def _fastest_rate(motion: Motion) -> float:
    """The largest rate among the terms that are not negligible [1 / time]."""
    return float(np.max(np.abs(motion.without_small_terms(UNRESOLVED).rates)))


def _first_difference(one: Motion, other: Motion, t: float, step: float) -> float:
    """The last time before the energies first differ, given a sample at t where they do."""
    low = max(t - 8.0 * step, 0.0)
    high = t
    for _ in range(3):
        times = np.linspace(low, high, 129)
        differing = np.abs(one.energy(times) - other.energy(times)) > VALID
        first = max(int(np.argmax(differing)), 1)
        low, high = times[first - 1], times[first]
    return float(low)
