"""Tables as potentials: the cubic spline through points, with two continuous derivatives.

Between r_k and r_k+1 = r_k + h, with t = (r - r_k)/h and s = 1 - t,

    U = s^2 (1 + 2 t) U_k + t^2 (3 - 2 t) U_k+1 + h t s (s U'_k - t U'_k+1),

where the slopes U'_k are those for which the second derivative is continuous ("not a knot" at the
ends).  C. de Boor, A Practical Guide to Splines, Springer 1978, chapter IV.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Self

import numpy as np

from tribo.potentials.columns import read_columns
from tribo.potentials.potential import Potential
from tribo.validation import NOT_NEGATIVE, POSITIVE, InputError, as_path, must_be, number, vector

# Smallest number of points: a "not a knot" spline through four points is one cubic.
FEWEST = 4
# Largest number of points of `tabulated`, enough for any smooth function at round-off.
MOST = 20_000
# Number of points with which `tabulated` begins.
FIRST = 17
# Fractions of every interval at which a function and its table are compared.
COMPARED_AT = (0.25, 0.5, 0.75)
# Stated error of a table, as a multiple of the largest difference found there.
SAFETY = 2.0
# Shortest interval, as a fraction of the largest distance; a shorter one hides a jump or a kink.
NARROWEST = 1e-9
# Values at the last point are zero below this fraction of the largest value of their kind in the
# outer half.  The values of a core may be larger by any factor, and are not reached.
ROUND_OFF = 1e-12
# Changes of the force below this fraction of the largest force there do not limit steps.
WEAK = 1e-3
# Energies, in units of the largest in the outer half, beyond which the error of a table of points
# is not counted: of Lennard-Jones from r to 2 sigma those below 0.8 sigma or so.
COUNTED = 100.0


class Table(Potential):
    """A cubic spline, zero from its last point on and nan below its first.

    Made by :func:`from_points`, :func:`from_csv`, :func:`tabulated` or :func:`from_dimer`.

    Attributes
    ----------
    r : (n,) array
        Increasing distances of the points [length].
    values : (n,) array
        U at the points [energy].
    slopes : (n,) array
        dU/dr at the points [energy / length].
    error : float
        Largest error of U between the points [energy].
    length : float
        Shortest length over which the force changes [length].
    clearances : (n,) array
        Distance that a pair at each point may move before its force changes considerably [length].
    """

    r: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    error: float
    length: float
    clearances: np.ndarray

    def energy(self, r):
        k, h, t = self.interval(r)
        s = 1.0 - t
        ends = s * s * (1.0 + 2.0 * t) * self.values[k]
        ends = ends + t * t * (3.0 - 2.0 * t) * self.values[k + 1]
        bend = h * t * s * (s * self.slopes[k] - t * self.slopes[k + 1])
        return (r < self.r[-1]) * (ends + bend) + self.defined(r)

    def force(self, r):
        k, h, t = self.interval(r)
        s = 1.0 - t
        rise = 6.0 * t * s * (self.values[k + 1] - self.values[k]) / h
        bend = s * (s - 2.0 * t) * self.slopes[k] + t * (t - 2.0 * s) * self.slopes[k + 1]
        return self.defined(r) - (r < self.r[-1]) * (rise + bend)

    def interval(self, r):
        """Index of the interval of r, its length, and the position of r in it from 0 to 1."""
        k = np.searchsorted(self.r, r, side="right") - 1
        k = np.minimum(np.maximum(k, 0), self.r.size - 2)
        h = self.r[k + 1] - self.r[k]
        return k, h, np.minimum(np.maximum((r - self.r[k]) / h, 0.0), 1.0)

    def defined(self, r):
        """0 from the first point on, nan below it."""
        return np.sqrt(np.minimum(r - self.r[0], 0.0))

    def feature(self):
        return self.length, self.r[-1]

    def clearance(self, r):
        """Distance that a pair at r may move before the force changes considerably.

        It is shorter the deeper r is in a core.
        """
        k, _, _ = self.interval(r)
        return max(self.clearances[k], r - self.r[-1])

    def range(self):
        """Distance of the last point, from which U is zero [length]."""
        return self.r[-1]

    def smoothness(self):
        """Number of continuous derivatives of U, with the jump to zero at the last point."""
        ends = (self.values, self.slopes, curvatures(self.r, self.values, self.slopes))
        outer = _outer(self.r, self.values)
        jumps = (abs(each[-1]) > ROUND_OFF * np.max(np.abs(each[outer])) for each in ends)
        return next((order - 1 for order, jump in enumerate(jumps) if jump), 2)

    def smoothness_within(self):
        """Number of continuous derivatives of U before the last point: those of a cubic spline."""
        return 2

    def domain(self):
        """Smallest and largest valid r [length]: the first and the last point."""
        return float(self.r[0]), float(self.r[-1])

    def tabulated_points(self) -> tuple[np.ndarray, np.ndarray]:
        """Distances [length] and energies [energy] of the points, which were given."""
        return self.r, self.values

    def with_checked_fields(self) -> Self:
        """The same, made from its points again.  Raises InputError, also for derived classes."""
        if type(self) is not Table:
            problem = f"{type(self).__name__} derives from Table, which runs replace by its points"
            raise InputError("potential", f"{problem}; derive from tribo.Potential")
        return from_points(self.r, self.values, self.error)  # type: ignore[return-value]

    def __eq__(self, other):
        """Whether the other is a table of the same numbers."""
        if not isinstance(other, Table) or self.error != other.error:
            return False
        return np.array_equal(self.r, other.r) and np.array_equal(self.values, other.values)

    def __hash__(self):
        return hash((self.r.tobytes(), self.values.tobytes(), self.error))


def from_points(r: object, energy: object, error: float | None = None) -> Table:
    """A table through points.

    Parameters
    ----------
    r : (n,) array
        Increasing distances, at least four [length].
    energy : (n,) array
        U at these distances [energy].
    error : float, optional
        Largest error of U between the points [energy].  By default the table is compared with a
        spline through every other point, whose error is larger where the points resolve U.  Where
        U exceeds 100 times the largest U in the outer half, as deep in a core, its error does not
        count.

    Raises
    ------
    InputError
        If there are too few points, or they do not increase.
    """
    r = vector("r", r, NOT_NEGATIVE, unit="length")
    values = vector("energy", energy, unit="energy")
    if r.size < FEWEST:
        raise must_be("r", f"at least {FEWEST} numbers", r.size)
    if values.size != r.size:
        raise InputError("energy", f"has {values.size} values for {r.size} distances")
    for k in np.flatnonzero(np.diff(r) <= 0.0).tolist():
        raise InputError(f"r[{k + 1}]", f"must be above r[{k}] = {r[k]:g}, got {r[k + 1]:g}")
    if error is None:
        error = _error_of_half(r, values)
    error = number("error", error, NOT_NEGATIVE, "energy")
    slopes = np.ascontiguousarray(_spline(r, values)(r, 1))
    lengths = _lengths(r, values, slopes)
    clearances = _clearances(r, lengths)
    for each in (slopes, clearances):
        each.flags.writeable = False
    return Table(r, values, slopes, error, float(lengths[0]), clearances)


def from_csv(
    path: object, error: float | None = None, columns: object = None, section: object = None
) -> Table:
    """A table from a text file with columns of numbers.

    Parameters
    ----------
    path : str or path-like
        A file with a distance [length] and an energy [energy] in each line, or a table of LAMMPS's
        ``pair_style table``; see :mod:`tribo.potentials.columns`.
    error : float, optional
        As for :func:`from_points`.
    columns : (int, int) or (str, str), optional
        Numbers, from 1, or headings of the columns of distances and energies.  Required where a
        file has more columns than two and no headings "r" and "energy".
    section : str, optional
        The keyword of the section of a LAMMPS file; required if it has several.

    Raises
    ------
    InputError
        If the file cannot be read, a line is not a row of numbers, or it is not clear which columns
        are meant.
    """
    r, energy = read_columns(as_path(path), columns, section)
    return from_points(r, energy, error)


def tabulated(
    function: Callable[[np.ndarray], np.ndarray], low: float, high: float, tolerance: float
) -> Table:
    """A table of a function, with as many points as a tolerance needs.

    Points are added where the function and the table differ too much between two points.

    Parameters
    ----------
    function : callable
        U(r) [energy] for an array of distances.
    low, high : float
        Smallest and largest distance of the table [length].
    tolerance : float
        Largest error of the table [energy]; its stated error is twice the largest difference that
        remains.

    Raises
    ------
    InputError
        If the tolerance is out of reach, or the function is not finite.
    """
    low = number("low", low, NOT_NEGATIVE, "length")
    high = number("high", high, POSITIVE, "length")
    if high <= low:
        raise must_be("high", f"above low = {low:g} [length]", high)
    tolerance = number("tolerance", tolerance, POSITIVE, "energy")
    r = np.linspace(low, high, FIRST)
    while r.size <= MOST and np.min(np.diff(r)) > NARROWEST * high:
        table = from_points(r, function(r), 0.0)
        between = [r[:-1] + fraction * np.diff(r) for fraction in COMPARED_AT]
        differences = np.max([np.abs(table.energy(x) - function(x)) for x in between], axis=0)
        if not np.all(np.isfinite(differences)):
            place = r[np.argmin(np.isfinite(differences))]
            raise InputError("function", f"must be finite, and is not just above r = {place:g}")
        coarse = SAFETY * differences > tolerance
        if not np.any(coarse):
            return table._replace(error=SAFETY * float(np.max(differences)))
        r = np.union1d(r, between[1][coarse])
    worst = int(np.argmax(differences))
    raise InputError(
        "tolerance",
        f"must be more than {tolerance:g} [energy], or the function smoother: a table of {r.size} "
        f"points is off by {differences[worst]:.1e} near r = {r[worst]:g}",
    )


def curvatures(r: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """d2U/dr2 (n,) at the points."""
    h = np.diff(r)
    rise = 6.0 * np.diff(values) / h
    left = (rise - 4.0 * slopes[:-1] - 2.0 * slopes[1:]) / h
    last = (2.0 * slopes[-2] + 4.0 * slopes[-1] - rise[-1]) / h[-1]
    return np.append(left, last)


def _spline(r: np.ndarray, values: np.ndarray) -> Callable[..., np.ndarray]:
    """The spline through points, a function of r and the order of a derivative."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(r, values)  # type: ignore[no-any-return]


def _outer(r: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Whether each point is in the outer half of the distances where U is not zero, or beyond."""
    last = r[np.flatnonzero(values)[-1]] if np.any(values) else r[-1]
    return np.asarray(r >= 0.5 * (r[0] + last))


def _error_of_half(r: np.ndarray, values: np.ndarray) -> float:
    """Largest error of the spline through every other point, and the last, at the others."""
    kept = np.union1d(np.arange(0, r.size, 2), [r.size - 1])
    errors = np.abs(_spline(r[kept], values[kept])(r) - values)
    most = COUNTED * np.max(np.abs(values[_outer(r, values)]))
    return float(np.max(errors, where=np.abs(values) <= most, initial=0.0))


def _lengths(r: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """(n,) the shortest length over which the force changes from each point on.

    Between two extrema it is the change of the force over its steepest slope.  A part of the way
    counts as the whole, since near an extremum both are small.
    """
    curves = curvatures(r, values, slopes)
    extrema = np.flatnonzero(curves[1:] * curves[:-1] < 0.0) + 1
    ends = [0, *extrema.tolist(), r.size - 1]
    weak = WEAK * np.max(np.abs(slopes[_outer(r, values)]))
    lengths = np.full(r.size, r[-1] - r[0])
    for one, other in reversed(list(pairwise(ends))):
        changes = np.abs(slopes[other] - slopes[one : other + 1])
        lengths[one:other] = lengths[other]
        if changes[0] > weak:
            curved = np.abs(curves[one : other + 1])
            steepest = np.maximum.accumulate(curved[::-1])[::-1]
            on_the_way = np.maximum.accumulate(changes[:-1] / steepest[:-1])
            lengths[one:other] = np.minimum(on_the_way, lengths[other])
    return lengths


def _clearances(r: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """(n,) the largest distance from each point that is no longer than the length at its end."""
    first = np.searchsorted(r + lengths, r)
    return np.maximum(lengths[np.maximum(first - 1, 0)], r - r[first])
