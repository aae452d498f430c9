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

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tribo.checks import MANY, NOT_NEGATIVE, POSITIVE, choice, number, vector, whole

KINDS = ("drude", "ohmic", "debye")

TOLERATED = 0.01  # of the bar's initial energy: how far off a bath may be and still be believed
RECURRENCES = 2.0  # recurrence times that the search for the end of belief covers at least,
AFFORDABLE = 2_500_000  # or as many as come to so many terms of a sum
SAMPLING = 0.4  # radians of the fastest oscillation that matters from one sample to the next
SIDE = 64  # samples are taken in blocks of SIDE x SIDE
CACHED = 2**14  # numbers that stay near the processor while modes are found


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
    (:func:`_exponentials`) is one more variable of a linear system without memory, whose matrix
    exponential is taken by its eigenvalues.  Errors, of the initial energy: 1e-10, growing like
    1e-12 w_c t for debye, where something always goes on oscillating beyond the cutoff.
    """
    mass, frequency, t = _checked(mass, frequency, t)
    friction = spectrum.gamma / (mass * spectrum.cutoff)
    motion = _with_continuum(spectrum.kind, friction, frequency / spectrum.cutoff, 1e-12)
    return 0.5 * mass * motion.energy(spectrum.cutoff * t)


def discrete_decay(
    masses: np.ndarray, frequencies: np.ndarray, mass: float, frequency: float, t: np.ndarray
) -> np.ndarray:
    """The same energy (t.size,), of a bar that drags oscillators (n,) along."""
    mass, frequency, t = _checked(mass, frequency, t)
    masses = vector("masses", masses, POSITIVE)
    frequencies = vector("frequencies", frequencies, POSITIVE, size=masses.size)
    return 0.5 * mass * _with_oscillators(masses / mass, frequencies, frequency).energy(t)


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


def normal_modes(
    masses: np.ndarray, frequencies: np.ndarray, mass: float, frequency: float
) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequencies W and weights a of the normal modes of a bar and oscillators (n,).

    A bar that starts with unit velocity has v(t) = sum of a cos(W t); the weights sum to 1.
    There are n + 1 modes, less those in which the bar does not move because oscillators share a
    frequency.  With kappa_j = k_j / mass, the W are the roots of the secular equation

        S(W^2) = 1 + sum_j kappa_j / (w_j^2 - W^2) = 0 ,     a = 1 / (W^2 S'(W^2)) ,

    where the bar's own spring counts as an oscillator of frequency 0 (infinitely heavy, with
    kappa = frequency^2); without that spring, W = 0 is a mode too.  Right to round-off, mode by
    mode, where an eigenvalue routine's errors are relative to the highest frequency.
    """
    poles, which = np.unique(np.append(frequencies, 0.0), return_inverse=True)
    kappa = np.bincount(which, np.append(masses / mass * frequencies**2, frequency**2))
    roots: list[tuple[np.ndarray, np.ndarray]] = []
    if kappa[0] == 0.0:
        poles, kappa = poles[1:], kappa[1:]
        roots.append((np.zeros(1), np.array([1.0 / (1.0 + np.sum(kappa / poles**2))])))
    portions = 1 + poles.size**2 // CACHED
    for portion in np.array_split(np.arange(poles.size), portions) if poles.size else ():
        roots.append(_roots_above(poles, kappa, portion))
    modes, weights = zip(*roots, strict=True)
    return np.concatenate(modes), np.concatenate(weights)


def _checked(mass: float, frequency: float, t: np.ndarray) -> tuple[float, float, np.ndarray]:
    return (
        number("mass", mass, POSITIVE),
        number("frequency", frequency, NOT_NEGATIVE),
        vector("t", np.atleast_1d(t), NOT_NEGATIVE),
    )


@dataclass(frozen=True, eq=False)
class _Motion:
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

    def without_traces(self, total: float) -> _Motion:
        """Without the smallest terms, which come to `total` together."""
        size = np.abs(self.velocity) + np.abs(self.stretch)
        order = np.argsort(size)
        kept = np.sort(order[np.searchsorted(np.cumsum(size[order]), total) :])
        return _Motion(self.rates[kept], self.velocity[kept], self.stretch[kept])

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


# The end of belief ------------------------------------------------------------------------------


@lru_cache(maxsize=256)
def _end_of_belief(kind: str, n: int, friction: float, frequency: float) -> float:
    """:func:`believed_until` for a bar of mass 1 and a cutoff of 1."""
    masses, frequencies = Spectrum(kind, friction, 1.0, n).oscillators()
    modes, weights = normal_modes(masses, frequencies, 1.0, frequency)
    discrete = _swing(modes, weights, frequency).without_traces(1e-4)
    exact = _with_continuum(kind, friction, frequency, 3e-8).without_traces(1e-4)
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


def _fastest(motion: _Motion) -> float:
    """The largest rate of the terms that matter [1 / time]."""
    return float(np.max(np.abs(motion.without_traces(TOLERATED).rates)))


def _recurrence(discrete: _Motion) -> float:
    """2 pi over the closest spacing of modes; 0 where there is but one."""
    modes = discrete.rates.imag
    return float(2.0 * np.pi / np.min(np.diff(modes))) if modes.size > 1 else 0.0


def _first_excess(one: _Motion, other: _Motion, t: float, step: float) -> float:
    """The last time before the energies part, which they have done by the sample at t."""
    low, high = max(t - 8.0 * step, 0.0), t
    for _ in range(3):
        times = np.linspace(low, high, 129)
        parted = np.abs(one.energy(times) - other.energy(times)) > TOLERATED
        first = max(int(np.argmax(parted)), 1)
        low, high = times[first - 1], times[first]
    return float(low)


# With n oscillators: the secular equation -------------------------------------------------------


def _with_oscillators(masses: np.ndarray, frequencies: np.ndarray, frequency: float) -> _Motion:
    """Motion of a bar of mass 1."""
    return _swing(*normal_modes(masses, frequencies, 1.0, frequency), frequency)


def _swing(modes: np.ndarray, weights: np.ndarray, frequency: float) -> _Motion:
    """v = sum a cos(W t), and so w0 x = sum (a w0 / W) sin(W t)."""
    lag = np.divide(frequency, modes, out=np.zeros_like(modes), where=modes > 0.0)
    return _Motion(1j * modes, weights.astype(complex), -1j * weights * lag)


def _secular(
    squares: np.ndarray, kappa: np.ndarray, rise: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """S and its slope in W^2, with W^2 and w_j^2 counted from a base: `rise` and `squares`."""
    inverse = squares - rise[:, None]
    np.reciprocal(inverse, out=inverse)
    value = 1.0 + inverse @ kappa
    inverse *= inverse
    return value, inverse @ kappa


def _squares_above(poles: np.ndarray, base: np.ndarray) -> np.ndarray:
    """poles^2 - base^2 (bases, poles): a pole at the base costs no digits."""
    return (poles - base[:, None]) * (poles + base[:, None])


def _roots_above(
    poles: np.ndarray, kappa: np.ndarray, chosen: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The root W of S between each of the chosen poles and the next, and its weight.

    S rises from -inf to inf in each gap; above the last pole it rises to 1, and a pole of no
    strength is put where the root cannot be.  A root is told by its shift from the nearer pole,
    its base, so that it keeps its digits however near that is.
    """
    last = chosen == poles.size - 1
    room = 2.0 * np.sum(kappa)
    widths = np.append(np.diff(poles), room / (poles[-1] + np.sqrt(poles[-1] ** 2 + room)))
    half = 0.5 * widths[chosen]
    lower = poles[chosen]
    value, _ = _secular(_squares_above(poles, lower), kappa, half * (2.0 * lower + half))
    upward = (value > 0.0) | last  # from base to root
    near, far = np.where(upward, chosen, chosen + 1), np.where(upward, chosen + 1, chosen)
    strengths = np.append(kappa, 0.0)
    gaps = _Gaps(poles[near], np.where(upward, 2.0, -2.0) * half, strengths[near])
    middle = 0.5 * gaps.gap
    low, high = np.minimum(middle, 0.0), np.maximum(np.where(last, gaps.gap, middle), 0.0)
    shift = _between(low, high, middle + gaps.step(middle, value, strengths[far]))
    return _refined(gaps, _squares_above(poles, gaps.base), kappa, shift, low, high)


def _refined(
    gaps: _Gaps,
    squares: np.ndarray,
    kappa: np.ndarray,
    shift: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The roots, and their weights, from guesses at their shifts that lie between low and high."""
    slope = np.ones(shift.size)
    rest = np.arange(shift.size)  # of the roots that are yet to be found
    for _ in range(60):
        part, at = gaps.of(rest), shift[rest]
        value, slope[rest] = _secular(squares[rest], kappa, at * (2.0 * part.base + at))
        step = part.step(at, value, part.far_strength(at, slope[rest]))
        low[rest] = np.where(value < 0.0, at, low[rest])
        high[rest] = np.where(value < 0.0, high[rest], at)
        done = np.abs(step) <= 1e-13 * np.abs(at) + 2e-16 * part.base
        shift[rest] = np.where(done, at + step, _between(low[rest], high[rest], at + step))
        rest = rest[~done]
        if rest.size == 0:
            break
    roots = gaps.base + shift
    return roots, 1.0 / (roots**2 * slope)


def _between(low: np.ndarray, high: np.ndarray, guess: np.ndarray) -> np.ndarray:
    """The guess where it lies between, else the middle."""
    return np.where((guess > low) & (guess < high), guess, 0.5 * (low + high))


@dataclass(frozen=True, eq=False)
class _Gaps:
    """Gaps between poles (m,), each as seen from its base: the pole that the root is nearer to."""

    base: np.ndarray
    gap: np.ndarray  # from the base to the pole at the other end, with its sign
    strength: np.ndarray  # of the pole at the base

    def of(self, some: np.ndarray) -> _Gaps:
        """Some of the gaps."""
        return _Gaps(self.base[some], self.gap[some], self.strength[some])

    def _squares(self, shift: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Both poles squared, less W^2."""
        double = 2.0 * self.base + shift
        return -shift * double, (self.gap - shift) * (double + self.gap)

    def far_strength(self, shift: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Of the pole at the other end, when it stands for all that the base leaves of S'."""
        near, far = self._squares(shift)
        return np.maximum(slope - self.strength / near**2, 0.0) * far**2

    def step(self, shift: np.ndarray, value: np.ndarray, far_strength: np.ndarray) -> np.ndarray:
        """From here to where a constant and the two poles vanish, the constant fitted to S.

        With the far strength fitted to S' this is the "fixed weight" step of R.-C. Li, LAPACK
        Working Note 89; it converges quadratically and takes 2 to 4 steps.
        """
        near, far = self._squares(shift)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            constant = value - self.strength / near - far_strength / far
            b = constant * (near + far) + self.strength + far_strength
            root = np.sqrt(np.maximum(b**2 - 4.0 * constant * near * far * value, 0.0))
            rise = np.where(b > 0.0, 2.0 * near * far * value / (b + root), (b - root) / 2.0)
            rise = np.where(b > 0.0, rise, rise / constant)  # in W^2
            omega = self.base + shift
            return rise / (omega + np.sqrt(np.maximum(omega**2 + rise, 0.0)))


# With the continuum: a kernel of exponentials ---------------------------------------------------


@lru_cache(maxsize=256)
def _with_continuum(kind: str, friction: float, frequency: float, tolerance: float) -> _Motion:
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
    return _Motion(
        np.append(more.rates, less.rates),
        0.5 * np.append(more.velocity, less.velocity),
        0.5 * np.append(more.stretch, less.stretch),
    )


def _decay(kind: str, friction: float, frequency: float, tolerance: float) -> _Motion:
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
    return _Motion(*(term[kept].astype(complex) for term in terms))


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
