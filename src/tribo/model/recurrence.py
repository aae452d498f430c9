"""Motion of a bar coupled to oscillators, as a sum of exponentials.

With n oscillators each exponential is a normal mode.  With the continuum of a
:class:`tribo.model.spectrum.Spectrum` the exponentials decay.  The bar starts with unit velocity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

# The spectra whose continuum is known.
Kind = Literal["drude", "ohmic", "debye"]
KINDS = get_args(Kind)
# Side of the square blocks in which the energy is sampled: SIDE x SIDE samples a block.
SIDE = 64
# Elements of the matrix of exponentials that is held at a time: 8 MB of complex numbers.
CHUNK = 500_000
# Largest coefficient of a sum of exponentials; above it two rates nearly coincide and large terms
# cancel.
LARGEST_COEFFICIENT = 1e3
# Relative change of the friction by which nearly coinciding rates are separated.  The mean of two
# motions with more and with less friction is off by its square, 1e-10.
SEPARATION = 1e-5
# Exponentials that have decayed to this fraction are left out of further blocks.
DECAYED = 1e-12


def normal_modes(
    masses: np.ndarray, frequencies: np.ndarray, mass: float, frequency: float
) -> tuple[np.ndarray, np.ndarray]:
    """Normal modes of a bar with n oscillators, in a time that grows as n^3; n = 400 takes 0.1 s.

    The potential energy is half the square of B q, where q = (sqrt(m_j) x_j, ..., sqrt(M) x) are
    the mass-weighted coordinates of oscillators and bar.  The modes are the singular values of

        B = [ -diag(w_j)   w_j sqrt(m_j / M) ]
            [      0             w0          ] .

    With the fastest oscillator first and the bar last, each mode has a relative error below 1e-13,
    measured for the three spectra with n = 60 and 200.  With the bar first the slowest mode is off
    by 1e-10, and eigenvalues of B^T B lose digits in proportion to the squared frequencies.

    Parameters
    ----------
    masses, frequencies : (n,) arrays
        Masses m_j [mass] and angular frequencies w_j [rad / time] of the oscillators.
    mass, frequency : float
        Mass M of the bar [mass], and its angular frequency w0 on its own spring [rad / time].

    Returns
    -------
    modes, weights : (k,) arrays
        Angular frequencies W in increasing order [rad / time], and weights a that add up to 1: a
        bar that starts with unit velocity has v(t) = sum a cos(W t).  k is n + 1, less the modes
        in which the bar stands still because oscillators share a frequency.
    """
    from scipy.linalg import svd

    w, which = np.unique(-frequencies, return_inverse=True)
    n = w.size
    matrix = np.zeros((n + 1, n + 1))
    np.fill_diagonal(matrix[:n, :n], w)
    matrix[:n, n] = -w * np.sqrt(np.bincount(which, masses / mass, n))
    matrix[n, n] = frequency
    _, modes, rows = svd(matrix, overwrite_a=True)
    return modes[::-1], rows[::-1, n] ** 2


@dataclass(frozen=True, eq=False)
class Motion:
    """Velocity v = Re sum velocity exp(rates t) and w0 x = Re sum stretch exp(rates t)."""

    rates: np.ndarray
    velocity: np.ndarray
    stretch: np.ndarray

    def energy(self, t: np.ndarray) -> np.ndarray:
        """v^2 + (w0 x)^2 at times t (m,); 1 at t = 0."""
        pieces = []
        for piece in np.array_split(t, 1 + t.size * self.rates.size // CHUNK):
            waves = np.exp(np.outer(piece, self.rates))
            pieces.append((waves @ self.velocity).real ** 2 + (waves @ self.stretch).real ** 2)
        return np.concatenate(pieces)

    def without_small_terms(self, total: float) -> Motion:
        """The motion without its smallest terms, whose sizes add up to at most `total`."""
        size = np.abs(self.velocity) + np.abs(self.stretch)
        order = np.argsort(size)
        kept = np.sort(order[np.searchsorted(np.cumsum(size[order]), total) :])
        return Motion(self.rates[kept], self.velocity[kept], self.stretch[kept])

    def blocks(self, step: float) -> Iterator[np.ndarray]:
        """The energy at times 0, step, 2 step, ... without end, SIDE^2 samples at a time.

        As exp(r (t + s)) = exp(r t) exp(r s), a block is a product of two small matrices.
        """
        rates = self.rates
        weights = np.stack([self.velocity, self.stretch])
        fine = np.exp(np.outer(rates, step * np.arange(SIDE)))
        coarse = np.exp(np.outer(step * SIDE * np.arange(SIDE), rates))
        to_next_block = np.exp(step * SIDE**2 * rates)
        while True:
            left = (weights[:, None, :] * coarse).reshape(2 * SIDE, -1)
            waves = left.real @ fine.real - left.imag @ fine.imag
            yield waves[:SIDE].ravel() ** 2 + waves[SIDE:].ravel() ** 2
            coarse = coarse * to_next_block
            remaining = np.abs(coarse[0]) > DECAYED
            if not remaining.all():
                weights = weights[:, remaining]
                fine = fine[remaining]
                coarse = coarse[:, remaining]
                to_next_block = to_next_block[remaining]


def motion_with_oscillators(
    masses: np.ndarray, frequencies: np.ndarray, frequency: float
) -> Motion:
    """Motion of a bar of mass 1 with oscillators: v = sum a cos(W t), w0 x = sum (a w0/W) sin(W t).

    Masses (n,) are relative to the bar's; frequencies (n,) and `frequency` are in [rad / time].
    """
    modes, weights = normal_modes(masses, frequencies, 1.0, frequency)
    lag = np.divide(frequency, modes, out=np.zeros_like(modes), where=modes > 0.0)
    return Motion(1j * modes, weights.astype(complex), -1j * weights * lag)


@lru_cache(maxsize=256)
def motion_with_continuum(
    kind: Kind, friction: float, frequency: float, tolerance: float
) -> Motion:
    """Motion of a bar of mass 1 in a continuum with a cutoff of 1 and gamma = `friction`.

    At critical damping two rates coincide and no sum of exponentials exists.  There the mean of
    two motions with slightly more and slightly less friction is taken.
    """
    motion = _decay(kind, friction, frequency, tolerance)
    if np.max(np.abs(motion.velocity)) < LARGEST_COEFFICIENT:
        return motion
    more = _decay(kind, friction * (1.0 + SEPARATION), frequency, tolerance)
    less = _decay(kind, friction * (1.0 - SEPARATION), frequency, tolerance)
    return Motion(
        np.append(more.rates, less.rates),
        0.5 * np.append(more.velocity, less.velocity),
        0.5 * np.append(more.stretch, less.stretch),
    )


def _decay(kind: Kind, friction: float, frequency: float, tolerance: float) -> Motion:
    """The same motion from eigenvalues, also where they nearly coincide.

    With Gamma(t) = friction Re sum c_j exp(-r_j t), the integral in the equation of motion is
    friction Re sum c_j y_j, where y_j' = -r_j y_j + v: linear equations for v, w0 x and all y_j.
    """
    c, r = _exponentials(kind, tolerance)
    real = 2 + np.arange(c.size)
    imag = 2 + c.size + np.arange(c.size)
    matrix = np.zeros((2 + 2 * c.size, 2 + 2 * c.size))
    matrix[0, 1] = -frequency
    matrix[1, 0] = frequency
    matrix[0, real] = -friction * c.real
    matrix[0, imag] = friction * c.imag
    matrix[real, 0] = 1.0
    matrix[real, real] = matrix[imag, imag] = -r.real
    matrix[real, imag] = r.imag
    matrix[imag, real] = -r.imag
    rates, vectors = np.linalg.eig(matrix)
    start = np.linalg.solve(vectors, np.eye(matrix.shape[0])[0])
    # A rate above the real axis stands for its complex conjugate as well.
    coefficients = np.where(rates.imag > 0.0, 2.0, 1.0) * start
    kept = rates.imag >= 0.0
    terms = (rates, vectors[0] * coefficients, vectors[1] * coefficients)
    return Motion(*(term[kept].astype(complex) for term in terms))


def _exponentials(kind: Kind, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """c and r with Gamma(t) = gamma w_c Re sum c_j exp(-r_j w_c t), at all t, to the tolerance.

    Drude is one exponential.  The others are (2/pi) Re integral of J(w)/(gamma w) exp(i w t) dw
    with the path of integration moved into the upper half-plane, where exp(i w t) decays: every
    point of a quadrature there is an exponential.  The trapezoidal rule in s is used on

        ohmic   w = i e^(2s) / (1 + e^(s + 0.9 i))          from 0 upward, then to infinity
        debye   w = exp(i pi/2 / (1 + exp(-s - e^s)))       from 1 to i on the unit circle

    with points that become denser towards the real axis, for long times.  (The rest of debye's
    path, the imaginary axis from i to 0, contributes no real part.)  40 exponentials give 3e-8,
    100 give 1e-12.
    """
    if kind == "drude":
        return np.ones(1, complex), np.ones(1, complex)
    digits = np.log(1.0 / tolerance)
    if kind == "ohmic":
        h = 4.9 / digits
        s = np.arange(np.log(1.3 * digits), -0.5 * digits - h, -h)
        bend = np.exp(s + 0.9j)
        w = 1j * np.exp(2.0 * s) / (1.0 + bend)
        c = np.exp(-w) * w * (2.0 - bend / (1.0 + bend))
    else:  # debye
        h = 8.4 / digits
        s = np.arange(np.log(digits), -digits - h, -h)
        x = 1.0 / (1.0 + np.exp(-s - np.exp(s)))
        w = np.exp(0.5j * np.pi * x)
        c = -0.5j * np.pi * w * x * (1.0 - x) * (1.0 + np.exp(s))
    return 2.0 / np.pi * h * c, -1j * w
