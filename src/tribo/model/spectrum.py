"""Friction from many oscillators: spectra of baths, and for how long a finite one is believed.

A bar of mass M on a spring of angular frequency w0 (0: a free bar) drags point oscillators along,
of stiffness k_j = m_j w_j^2, all released at the bar's place and at rest.  It obeys the generalised
Langevin equation (R. Zwanzig, J. Stat. Phys. 9, 215 (1973); U. Weiss, *Quantum Dissipative
Systems*, chapter 3), here at T = 0, without noise; velocities are relative to the surface's:

    M x'' = -M w0^2 x - integral_0^t Gamma(t - s) x'(s) ds ,    Gamma(t) = sum_j k_j cos(w_j t) .

A continuum of oscillators keeps the energy that it takes.  A finite number gives it back in the
end, and :func:`believed_until` measures when.  All of this is linear, so that the bar's motion is a
sum of exponentials: oscillating ones with n oscillators, decaying ones with the continuum.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tribo.model.modes import normal_modes
from tribo.model.recurrence import SIDE, Motion, swing, with_continuum, with_oscillators
from tribo.validation import MANY, NOT_NEGATIVE, POSITIVE, choice, number, vector, whole

KINDS = ("drude", "ohmic", "debye")

TOLERATED = 0.01  # of the bar's initial energy: how far off a bath may be and still be believed
RECURRENCES = 2.0  # recurrence times that the search for the end of belief covers at least,
AFFORDABLE = 2_500_000  # or as many as come to so many terms of a sum
SAMPLING = 0.4  # radians of the fastest oscillation that matters from one sample to the next


@dataclass(frozen=True)
class Spectrum:
    """A damping kernel to aim at, and the n oscillators that stand for it.

    With w_c the cutoff, x_j = (j - 1/2)/n for j = 1 ... n, and J(w) the spectral density, such that
    Gamma(t) = (2/pi) integral_0^inf J(w)/w cos(w t) dw (Weiss, chapter 3):

        drude   J = gamma w / (1 + (w/w_c)^2)       Gamma = gamma w_c exp(-w_c t)
                w_j = w_c tan(pi x_j / 2)           k_j = gamma w_c / n
        ohmic   J = gamma w exp(-w/w_c)             Gamma = (2/pi) gamma w_c / (1 + (w_c t)^2)
                w_j = -2 w_c log(1 - x_j)           k_j = (4/pi) gamma w_c (1 - x_j) / n
        debye   J = gamma w for w < w_c             Gamma = (2/pi) gamma sin(w_c t) / t
                w_j = w_c x_j                       k_j = (2/pi) gamma w_c / n

    Drude and debye oscillators share the stiffness Gamma(0) evenly, at the quantiles of J(w)/w.
    The ohmic ones sit at the quantiles of its square root: an even share leaves so few of them
    above the cutoff that strong damping (gamma = 10 M w_c) is believed 2 to 10 times less long;
    the price is up to half of the time where damping is weak and w0 far below the cutoff.
    """

    kind: str  # "drude", "ohmic" or "debye"
    gamma: float  # of the force -gamma v that slow motion meets [mass / time]
    cutoff: float  # w_c [rad / time]
    n: int  # how many oscillators

    def __post_init__(self) -> None:
        choice("kind", self.kind, KINDS)
        object.__setattr__(self, "gamma", number("gamma", self.gamma, POSITIVE))
        object.__setattr__(self, "cutoff", number("cutoff", self.cutoff, POSITIVE))
        object.__setattr__(self, "n", whole("n", self.n, 1, MANY))

    def oscillators(self) -> tuple[np.ndarray, np.ndarray]:
        """Masses (n,) and angular frequencies (n,)."""
        x = (np.arange(self.n) + 0.5) / self.n
        if self.kind == "drude":
            w, share = np.tan(np.pi / 2.0 * x), np.ones(self.n)
        elif self.kind == "ohmic":
            w, share = -2.0 * np.log1p(-x), 4.0 / np.pi * (1.0 - x)
        else:
            w, share = x, np.full(self.n, 2.0 / np.pi)
        return self.gamma / (self.cutoff * self.n) * share / w**2, self.cutoff * w

    def kernel(self, t: np.ndarray | float) -> np.ndarray:
        """Gamma(t) of the continuum [mass / time^2], in the shape of t."""
        wt = self.cutoff * np.abs(np.asarray(t, dtype=float))
        strength = self.gamma * self.cutoff
        if self.kind == "drude":
            return strength * np.exp(-wt)
        if self.kind == "ohmic":
            return 2.0 / np.pi * strength / (1.0 + wt**2)
        return 2.0 / np.pi * strength * np.sinc(wt / np.pi)


def exact_decay(spectrum: Spectrum, mass: float, frequency: float, t: np.ndarray) -> np.ndarray:
    """Energy (t.size,) at times t >= 0 of a bar that drags the continuum along.

    The bar, of mass `mass` on a spring of angular frequency `frequency`, starts with unit velocity;
    its energy mass/2 (v^2 + frequency^2 x^2) starts as mass/2.  Each exponential in the kernel
    (`recurrence`) is one more variable of a linear system without memory, whose matrix
    exponential is taken by its eigenvalues.  Errors, of the initial energy: 1e-10, growing like
    1e-12 w_c t for debye, where something always goes on oscillating beyond the cutoff.
    """
    mass, frequency, t = _checked(mass, frequency, t)
    friction = spectrum.gamma / (mass * spectrum.cutoff)
    motion = with_continuum(spectrum.kind, friction, frequency / spectrum.cutoff, 1e-12)
    return 0.5 * mass * motion.energy(spectrum.cutoff * t)


def discrete_decay(
    masses: np.ndarray, frequencies: np.ndarray, mass: float, frequency: float, t: np.ndarray
) -> np.ndarray:
    """The same energy (t.size,), of a bar that drags oscillators (n,) along."""
    mass, frequency, t = _checked(mass, frequency, t)
    masses = vector("masses", masses, POSITIVE)
    frequencies = vector("frequencies", frequencies, POSITIVE, size=masses.size)
    return 0.5 * mass * with_oscillators(masses / mass, frequencies, frequency).energy(t)


def believed_until(spectrum: Spectrum, mass: float, frequency: float) -> float:
    """The time up to which a spectrum's n oscillators do to a bar what the continuum would.

    Up to then the bar's energy, starting with unit velocity, is that of :func:`exact_decay`
    within 1 % of the initial energy.  Measured on the normal modes, from sample to sample.  Where
    the search, over two recurrences at least, finds no end, it returns how far it came.

    As a rule it is 2 pi over the spacing of the oscillators at the frequency w,
    w^2 = w0^2 + Gamma(0)/M:

        drude   4 n w_c / (w_c^2 + w^2)                 w^2 = w0^2 + gamma w_c / M
        ohmic   (pi n / w_c) exp(-w / (2 w_c))          w^2 = w0^2 + (2/pi) gamma w_c / M
        debye   2 pi n / w_c

    For gamma up to 10 M w_c, w0 up to 2 w_c and n of 100 or more it is 0.7 to 1.1 times that, or
    several times where the first recurrence does no harm; for n = 10 it may be a fifth of it.
    """
    mass, frequency, _ = _checked(mass, frequency, np.zeros(1))
    friction = spectrum.gamma / (mass * spectrum.cutoff)
    end = _end_of_belief(spectrum.kind, spectrum.n, friction, frequency / spectrum.cutoff)
    return end / spectrum.cutoff


def _checked(mass: float, frequency: float, t: np.ndarray) -> tuple[float, float, np.ndarray]:
    return (
        number("mass", mass, POSITIVE),
        number("frequency", frequency, NOT_NEGATIVE),
        vector("t", np.atleast_1d(t), NOT_NEGATIVE),
    )


@lru_cache(maxsize=256)
def _end_of_belief(kind: str, n: int, friction: float, frequency: float) -> float:
    """:func:`believed_until` for a bar of mass 1 and a cutoff of 1."""
    masses, frequencies = Spectrum(kind, friction, 1.0, n).oscillators()
    modes, weights = normal_modes(masses, frequencies, 1.0, frequency)
    discrete = swing(modes, weights, frequency).without_traces(1e-4)
    exact = with_continuum(kind, friction, frequency, 3e-8).without_traces(1e-4)
    step = SAMPLING / max(_fastest(discrete), _fastest(exact))
    horizon = max(RECURRENCES * _recurrence(discrete), step * AFFORDABLE / discrete.rates.size)
    pairs = zip(discrete.blocks(step), exact.blocks(step), strict=False)
    for first, (one, other) in enumerate(pairs):
        off = np.flatnonzero(np.abs(one - other) > TOLERATED)
        start = step * SIDE**2 * first
        if off.size:
            return _first_excess(discrete, exact, start + step * off[0], step)
        if start + step * SIDE**2 > horizon:
            break
    return horizon


def _fastest(motion: Motion) -> float:
    """The largest rate of the terms that matter [1 / time]."""
    return float(np.max(np.abs(motion.without_traces(TOLERATED).rates)))


def _recurrence(discrete: Motion) -> float:
    """2 pi over the closest spacing of modes; 0 where there is but one."""
    modes = discrete.rates.imag
    return float(2.0 * np.pi / np.min(np.diff(modes))) if modes.size > 1 else 0.0


def _first_excess(one: Motion, other: Motion, t: float, step: float) -> float:
    """The last time before the energies part, which they have done by the sample at t."""
    low, high = max(t - 8.0 * step, 0.0), t
    for _ in range(3):
        times = np.linspace(low, high, 129)
        parted = np.abs(one.energy(times) - other.energy(times)) > TOLERATED
        first = max(int(np.argmax(parted)), 1)
        low, high = times[first - 1], times[first]
    return float(low)
