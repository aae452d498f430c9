"""Normal modes of a bar and the oscillators that it drags along: roots of a secular equation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

CACHED = 2**14  # numbers that stay near the processor while modes are found


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
