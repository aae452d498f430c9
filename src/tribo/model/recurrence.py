"""Motion of a bar that drags oscillators along: a sum of exponentials.

They oscillate with n oscillators, one a normal mode, and decay with the continuum that
:class:`tribo.model.spectrum.Spectrum` stands for.  The bar is released with unit velocity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tribo.model.modes import normal_modes

SIDE = 64  # samples are taken in blocks of SIDE x SIDE


@dataclass(frozen=True, eq=False)
class Motion:
    """v = Re sum velocity exp(rates t) and w0 x = Re sum stretch exp(rates t), over k terms."""

    rates: np.ndarray  # (k,) complex [1 / time]
    velocity: np.ndarray  # (k,) complex
    stretch: np.ndarray  # (k,) complex [velocity]

    def energy(self, t: np.ndarray) -> np.ndarray:
        """v^2 + (w0 x)^2 at times t (m,); it starts as 1."""
        pieces = []
        for piece in np.array_split(t, 1 + t.size * self.rates.size // 500_000):
            waves = np.exp(np.outer(piece, self.rates))
            pieces.append((waves @ self.velocity).real ** 2 + (waves @ self.stretch).real ** 2)
        return np.concatenate(pieces)

    def without_traces(self, total: float) -> Motion:
        """Without the smallest terms, which come to `total` together."""
        size = np.abs(self.velocity) + np.abs(self.stretch)
        order = np.argsort(size)
        kept = np.sort(order[np.searchsorted(np.cumsum(size[order]), total) :])
        return Motion(self.rates[kept], self.velocity[kept], self.stretch[kept])

    def blocks(self, step: float) -> Iterator[np.ndarray]:
        """The energy at 0, step, 2 step and so on, for ever, SIDE^2 samples at a time.

        As exp(r (t + s)) = exp(r t) exp(r s), a block is a product of two small matrices.
        """
        rates, weights = self.rates, np.stack([self.velocity, self.stretch])
        fine = np.exp(np.outer(rates, step * np.arange(SIDE)))
        coarse = np.exp(np.outer(step * SIDE * np.arange(SIDE), rates))
        onward = np.exp(step * SIDE**2 * rates)
        while True:
            left = (weights[:, None, :] * coarse).reshape(2 * SIDE, -1)
            waves = left.real @ fine.real - left.imag @ fine.imag
            yield waves[:SIDE].ravel() ** 2 + waves[SIDE:].ravel() ** 2
            coarse = coarse * onward
            alive = np.abs(coarse[0]) > 1e-12
            if not alive.all():
                weights, fine = weights[:, alive], fine[alive]
                coarse, onward = coarse[:, alive], onward[alive]


def with_oscillators(masses: np.ndarray, frequencies: np.ndarray, frequency: float) -> Motion:
    """Motion of a bar of mass 1."""
    return swing(*normal_modes(masses, frequencies, 1.0, frequency), frequency)


def swing(modes: np.ndarray, weights: np.ndarray, frequency: float) -> Motion:
    """v = sum a cos(W t), and so w0 x = sum (a w0 / W) sin(W t)."""
    lag = np.divide(frequency, modes, out=np.zeros_like(modes), where=modes > 0.0)
    return Motion(1j * modes, weights.astype(complex), -1j * weights * lag)


@lru_cache(maxsize=256)
def with_continuum(kind: str, friction: float, frequency: float, tolerance: float) -> Motion:
    """Motion of a bar of mass 1 in a continuum with a cutoff of 1 and gamma = `friction`.

    At critical damping two rates coincide, and a sum of exponentials exists no more; next to it
    large terms cancel.  There, the mean of two motions with slightly more and less friction is
    taken, which differs in the second order, 1e-10.
    """
    motion = _decay(kind, friction, frequency, tolerance)
    if np.max(np.abs(motion.velocity)) < 1e3:
        return motion
    more = _decay(kind, friction * (1.0 + 1e-5), frequency, tolerance)
    less = _decay(kind, friction * (1.0 - 1e-5), frequency, tolerance)
    return Motion(
        np.append(more.rates, less.rates),
        0.5 * np.append(more.velocity, less.velocity),
        0.5 * np.append(more.stretch, less.stretch),
    )


def _decay(kind: str, friction: float, frequency: float, tolerance: float) -> Motion:
    """The same motion from eigenvalues, right or not.

    With Gamma(t) = friction Re sum c_j exp(-r_j t), the integral in the equation of motion is
    friction Re sum c_j y_j, where y_j' = -r_j y_j + v: linear equations for v, w0 x and all y_j.
    """
    c, r = _exponentials(kind, tolerance)
    real, imag = 2 + np.arange(c.size), 2 + c.size + np.arange(c.size)
    matrix = np.zeros((2 + 2 * c.size, 2 + 2 * c.size))
    matrix[0, 1], matrix[1, 0] = -frequency, frequency
    matrix[0, real], matrix[0, imag] = -friction * c.real, friction * c.imag
    matrix[real, 0] = 1.0
    matrix[real, real] = matrix[imag, imag] = -r.real
    matrix[real, imag], matrix[imag, real] = r.imag, -r.imag
    rates, vectors = np.linalg.eig(matrix)
    start = np.linalg.solve(vectors, np.eye(matrix.shape[0])[0])
    twice = np.where(rates.imag > 0.0, 2.0, 1.0) * start  # for its conjugate as well
    kept = rates.imag >= 0.0
    terms = (rates, vectors[0] * twice, vectors[1] * twice)
    return Motion(*(term[kept].astype(complex) for term in terms))


def _exponentials(kind: str, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """c and r with Gamma(t) = gamma w_c Re sum c_j exp(-r_j w_c t), at all t, to the tolerance.

    Drude is one exponential.  The others are (2/pi) Re integral of J(w)/(gamma w) exp(i w t) dw
    with the path of integration bent into the upper half-plane, where exp(i w t) decays: every
    point of a quadrature there is an exponential.  The trapezoidal rule in s is used on

        ohmic   w = i e^(2s) / (1 + e^(s + 0.9 i))          from 0 upward, then to infinity
        debye   w = exp(i pi/2 / (1 + exp(-s - e^s)))       from 1 to i on the unit circle

    with points that crowd towards the real axis as long times want it.  (What debye leaves out,
    the imaginary axis from i to 0, has no real part.)  About 40 exponentials do for 3e-8, 100
    for 1e-12.
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
    else:
        h = 8.4 / digits
        s = np.arange(np.log(digits), -digits - h, -h)
        x = 1.0 / (1.0 + np.exp(-s - np.exp(s)))
        w = np.exp(0.5j * np.pi * x)
        c = -0.5j * np.pi * w * x * (1.0 - x) * (1.0 + np.exp(s))
    return 2.0 / np.pi * h * c, -1j * w
