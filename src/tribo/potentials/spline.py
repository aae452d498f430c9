"""A table of points as a potential: the cubic spline through them, with two continuous derivatives.

Between r_k and r_k+1 = r_k + h, with t = (r - r_k)/h and s = 1 - t,

    U = s^2 (1 + 2 t) U_k + t^2 (3 - 2 t) U_k+1 + h t s (s U'_k - t U'_k+1),

where the slopes U'_k are those for which the second derivative is continuous ("not a knot" at the
ends).  C. de Boor, A Practical Guide to Splines, Springer 1978, chapter IV.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from tribo.validation import NOT_NEGATIVE, POSITIVE, InputError, as_path, number, vector

FEWEST = 4  # points, through which there is one cubic
MANY = 20_000  # points, by which a function should be followed to any accuracy
FIRST = 17  # points that a function is first looked at
PLACES = (0.25, 0.5, 0.75)  # of every interval, where a function and its table are compared
SAFETY = 2.0  # the error of a table is this times the largest found at those places
NARROW = 1e-9  # of the largest distance: intervals so narrow hide a jump or a kink
ROUND_OFF = 1e-12  # relative to the largest of its kind: what counts as zero at the end
WEAK = 1e-3  # of the largest force: changes of the force that no step need look for


class Table(NamedTuple):
    """A spline, zero from its last point on and not a number below its first."""

    r: Any  # (n,) places of the points, increasing [length]
    values: Any  # (n,) U [energy]
    slopes: Any  # (n,) dU/dr [energy / length]
    error: float  # of U between the points [energy]
    length: float  # over which the force changes [length]

    def energy(self, r):
        """U(r)."""
        k, h, t = self.interval(r)
        s = 1.0 - t
        ends = s * s * (1.0 + 2.0 * t) * self.values[k]
        ends = ends + t * t * (3.0 - 2.0 * t) * self.values[k + 1]
        bend = h * t * s * (s * self.slopes[k] - t * self.slopes[k + 1])
        return (r < self.r[-1]) * (ends + bend) + self.defined(r)

    def force(self, r):
        """-dU/dr."""
        k, h, t = self.interval(r)
        s = 1.0 - t
        rise = 6.0 * t * s * (self.values[k + 1] - self.values[k]) / h
        bend = s * (s - 2.0 * t) * self.slopes[k] + t * (t - 2.0 * s) * self.slopes[k + 1]
        return self.defined(r) - (r < self.r[-1]) * (rise + bend)

    def interval(self, r):
        """Which interval r is in, its length, and how far into it, from 0 to 1."""
        k = np.searchsorted(self.r, r, side="right") - 1
        k = np.minimum(np.maximum(k, 0), self.r.size - 2)
        h = self.r[k + 1] - self.r[k]
        return k, h, np.minimum(np.maximum((r - self.r[k]) / h, 0.0), 1.0)

    def defined(self, r):
        """0 from the first point on, not a number below it."""
        return np.sqrt(np.minimum(r - self.r[0], 0.0))

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return self.length, self.r[-1]

    def range(self):
        """The last point, from which U is zero."""
        return self.r[-1]

    def smoothness(self):
        """As the last point has it: the first of U, U' and U'' that is not zero there jumps."""
        ends = (self.values, self.slopes, curvatures(self.r, self.values, self.slopes))
        jumps = (abs(each[-1]) > ROUND_OFF * np.max(np.abs(each)) for each in ends)
        return next((order - 1 for order, jump in enumerate(jumps) if jump), 2)

    def smoothness_within(self):
        """How many derivatives of a spline are continuous."""
        return 2

    def domain(self):
        """From the first point to the last."""
        return float(self.r[0]), float(self.r[-1])

    def __eq__(self, other):
        """Whether the other is a table of the same numbers."""
        return isinstance(other, Table) and all(map(np.array_equal, self, other))

    def __ne__(self, other):
        """Whether it is not."""
        return not self == other

    def __hash__(self):
        """Of the numbers."""
        return hash((self.r.tobytes(), self.values.tobytes(), self.error))


def from_points(r: Any, energy: Any, error: float | None = None) -> Table:
    """The table of the energies (n,) at n distances `r`, of which there are four or more.

    `error` is by how much U may be off between the points [energy].  By default the table is
    compared with one through every other point, of which it is at least as good where the points
    are close enough to be a table at all.  Raises InputError.
    """
    r = vector("r", r, NOT_NEGATIVE)
    values = vector("energy", energy)
    if r.size < FEWEST:
        raise InputError("r", f"must be {FEWEST} numbers or more, got {r.size}")
    if values.size != r.size:
        raise InputError("energy", f"has {values.size} values for {r.size} distances")
    for k in np.flatnonzero(np.diff(r) <= 0.0).tolist():
        raise InputError(f"r[{k + 1}]", f"must be above r[{k}] = {r[k]:g}, got {r[k + 1]:g}")
    error = _left_out(r, values) if error is None else number("error", error, NOT_NEGATIVE)
    slopes = _slopes(r, values)
    return Table(r, values, slopes, error, _length(r, slopes, curvatures(r, values, slopes)))


def from_csv(path: Any, error: float | None = None) -> Table:
    """The table in a file of two columns, distance and energy, apart by a comma or by spaces.

    Lines that are empty or begin with # are passed over.  Raises InputError.
    """
    path = as_path(path)
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError("file", f"{path} cannot be read ({problem})") from None
    points = []
    for count, line in enumerate(lines, start=1):
        if not line.strip() or line.startswith("#"):
            continue
        try:
            r, energy = map(float, line.replace(",", " ").split())
        except ValueError:
            raise InputError(
                "file", f'{path} must have two numbers a line, got "{line}" in line {count}'
            ) from None
        points.append((r, energy))
    return from_points([r for r, _ in points], [energy for _, energy in points], error)


def tabulated(function: Callable[[Any], Any], low: float, high: float, accuracy: float) -> Table:
    """A table of `function` from `low` to `high` [length], whose error is at most `accuracy`.

    The function is U(r) [energy], called with arrays.  Points are added wherever it and the table
    are compared between two points and are too far apart; the error that the table states is
    twice the largest difference left.  Raises InputError if `accuracy` [energy] is out of reach.
    """
    low, high = number("low", low, NOT_NEGATIVE), number("high", high, POSITIVE)
    if high <= low:
        raise InputError("high", f"must be above low = {low:g}, got {high:g}")
    accuracy = number("accuracy", accuracy, POSITIVE)
    r = np.linspace(low, high, FIRST)
    while r.size <= MANY and np.min(np.diff(r)) > NARROW * high:
        table = from_points(r, function(r), 0.0)
        between = [r[:-1] + place * np.diff(r) for place in PLACES]
        off = np.max([np.abs(table.energy(x) - function(x)) for x in between], axis=0)
        if not np.all(np.isfinite(off)):
            place = r[np.argmin(np.isfinite(off))]
            raise InputError("function", f"must give finite numbers, not so above r = {place:g}")
        coarse = SAFETY * off > accuracy
        if not np.any(coarse):
            return table._replace(error=SAFETY * float(np.max(off)))
        r = np.union1d(r, between[1][coarse])
    worst = int(np.argmax(off))
    raise InputError(
        "accuracy",
        f"must be more than {accuracy:g}, or the function smoother: {r.size} points still miss it "
        f"by {off[worst]:.1e} near r = {r[worst]:g}",
    )


def curvatures(r: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """d2U/dr2 (n,) at the points."""
    h = np.diff(r)
    rise = 6.0 * np.diff(values) / h
    left = (rise - 4.0 * slopes[:-1] - 2.0 * slopes[1:]) / h
    last = (2.0 * slopes[-2] + 4.0 * slopes[-1] - rise[-1]) / h[-1]
    return np.append(left, last)


def _slopes(r: np.ndarray, values: np.ndarray) -> np.ndarray:
    """dU/dr (n,) at the points of the spline through them."""
    from scipy.interpolate import CubicSpline

    slopes = np.ascontiguousarray(CubicSpline(r, values)(r, 1))
    slopes.flags.writeable = False
    return slopes


def _left_out(r: np.ndarray, values: np.ndarray) -> float:
    """By how much the spline through every other point, and the last, misses the rest."""
    from scipy.interpolate import CubicSpline

    kept = np.union1d(np.arange(0, r.size, 2), [r.size - 1])
    spline = CubicSpline(r[kept], values[kept])
    return float(np.max(np.abs(spline(r) - values)))


def _length(r: np.ndarray, slopes: np.ndarray, curves: np.ndarray) -> float:
    """Length over which the force changes: its change, between two turns, over its steepest."""
    turns = np.flatnonzero(curves[1:] * curves[:-1] < 0.0) + 1
    marks = [0, *turns.tolist(), r.size - 1]
    weak = WEAK * np.max(np.abs(slopes))
    lengths = [r[-1] - r[0]]
    for one, other in pairwise(marks):
        change = abs(slopes[other] - slopes[one])
        if change > weak:
            lengths.append(change / np.max(np.abs(curves[one : other + 1])))
    return float(min(lengths))
