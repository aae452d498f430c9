"""Schedules that numbers follow: functions of time by points, in steps, or as a sine.

Between two points a schedule is linear, or it keeps the value of the earlier one; outside of them
it is constant.  Where its value or its slope changes it has a kink, at which steps of runs end.
Between two kinks, a schedule and its integral over time are

    c0 + c1 u + c2 u^2 + amplitude sin(frequency u + phase),   u = t - since,

whose numbers kernels read; see `tribo.kernels.schedule`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from tribo import validation as check
from tribo.validation import InputError, is_list, known_keys, must_be

KINDS = ("linear", "steps")
SINE = "sine"
# The keys of a sine, of which the first three are required.
OF_SINE = ("mean", "amplitude", "period", "phase")


class Piece(NamedTuple):
    """The numbers of a schedule, or of its integral, between two kinks."""

    since: float  # [time]
    c0: float = 0.0
    c1: float = 0.0
    c2: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0  # [rad / time]
    phase: float = 0.0  # [rad]


class _Pieces(NamedTuple):
    """The pieces of a schedule by points; the first also holds before it begins."""

    start: np.ndarray  # (n,) [time]
    value: np.ndarray  # (n,) at the start
    slope: np.ndarray  # (n,)
    integral: np.ndarray  # (n,) from the first start on


@dataclass(frozen=True)
class Schedule:
    """A number that changes with time: by points, in steps, or as a sine.

    Attributes
    ----------
    points : list of (t, value)
        Times, which increase, and the values there.  Two equal times make a step.  Before the
        first point and after the last one the number is constant.
    kind : str
        "linear": straight lines from point to point; "steps": each value lasts until the next
        point; "sine": as :meth:`sine` makes it.
    mean, amplitude, period, phase : float, optional
        Of a sine, instead of points.

    Raises
    ------
    InputError
        If there is no point, a number is not finite, or times decrease.

    See Also
    --------
    Schedule.sine : a number that oscillates.
    """

    points: tuple[tuple[float, float], ...] = ()
    kind: str = "linear"
    mean: float | None = None
    amplitude: float | None = None
    period: float | None = None
    phase: float | None = None

    def __post_init__(self) -> None:
        """Check the points, whose times never decrease, or the numbers of a sine."""
        if self.kind == SINE:
            self._check_sine()
            return
        check.choice("kind", self.kind, KINDS)
        for name in OF_SINE:
            if getattr(self, name) is not None:
                raise InputError(name, f'cannot go with kind = "{self.kind}"')
        if not is_list(self.points) or len(self.points) == 0:
            raise must_be("points", "a list of [t, value]", self.points)
        rows = [check.vector(f"[{i}]", row, size=2) for i, row in enumerate(self.points)]
        points = tuple((float(t), float(value)) for t, value in rows)
        times = [t for t, _ in points]
        for i in range(1, len(times)):
            if times[i] < times[i - 1]:
                problem = f"must not be before the time of the point before, {times[i - 1]:g}"
                raise InputError(f"[{i}][0]", f"{problem}, got {times[i]:g}")
            if i > 1 and times[i] == times[i - 2]:
                problem = "is the time of two points before; two equal times make a step"
                raise InputError(f"[{i}][0]", problem)
        object.__setattr__(self, "points", points)

    def _check_sine(self) -> None:
        """Check the numbers of a sine.  Raises InputError."""
        if len(self.points):
            raise InputError("points", "cannot go with a sine")
        phase = 0.0 if self.phase is None else self.phase
        object.__setattr__(self, "phase", check.number("phase", phase))
        for name in ("mean", "amplitude"):
            object.__setattr__(self, name, check.number(name, getattr(self, name)))
        period = check.number("period", self.period, check.POSITIVE, "time")
        object.__setattr__(self, "period", period)

    @classmethod
    def sine(cls, mean: float, amplitude: float, period: float, phase: float = 0.0) -> Schedule:
        """The number mean + amplitude sin(2 pi t / period + phase).

        Parameters
        ----------
        mean, amplitude : float
            Values, in the unit of the number that the schedule stands for.
        period : float
            Period, above zero [time].
        phase : float
            Phase at t = 0 [rad].
        """
        return cls((), SINE, mean, amplitude, period, phase)

    def __repr__(self) -> str:
        if self.kind == SINE:
            own = ", ".join(f"{name}={getattr(self, name):g}" for name in OF_SINE)
            return f"Schedule.sine({own})"
        points = ", ".join(f"[{t:g}, {value:g}]" for t, value in self.points[:4])
        more = f", ... ({len(self.points)} points)" if len(self.points) > 4 else ""
        kind = "" if self.kind == "linear" else f', kind="{self.kind}"'
        return f"Schedule([{points}{more}]{kind})"

    def __format__(self, spec: str) -> str:
        return repr(self)

    @property
    def is_sine(self) -> bool:
        return self.kind == SINE

    @property
    def low(self) -> float:
        """The smallest value at any time."""
        if self.is_sine:
            return self._sine[0] - abs(self._sine[1])
        return min(value for _, value in self.points)

    @property
    def high(self) -> float:
        """The largest value at any time."""
        if self.is_sine:
            return self._sine[0] + abs(self._sine[1])
        return max(value for _, value in self.points)

    @property
    def largest(self) -> float:
        """The largest magnitude at any time."""
        return max(abs(self.low), abs(self.high))

    @property
    def frequency(self) -> float:
        """The angular frequency of a sine [rad / time]; 0 of others."""
        return self._sine[2] if self.is_sine else 0.0

    @property
    def _sine(self) -> tuple[float, float, float, float]:
        """Mean, amplitude, angular frequency and phase."""
        assert self.mean is not None and self.amplitude is not None
        assert self.period is not None and self.phase is not None
        return self.mean, self.amplitude, 2.0 * math.pi / self.period, self.phase

    @cached_property
    def _pieces(self) -> _Pieces:
        """The pieces of points: where each begins, with its value and its slope there."""
        starts: list[float] = []
        values: list[float] = []
        slopes: list[float] = []
        for i, (t, value) in enumerate(self.points):
            following = self.points[i + 1] if i + 1 < len(self.points) else None
            jumps = following is not None and following[0] == t
            slope = 0.0
            if following is not None and not jumps and self.kind == "linear":
                slope = (following[1] - value) / (following[0] - t)
            if not starts and (jumps or slope != 0.0):
                # Before the first point the value is constant.
                starts.append(_before(t))
                values.append(value)
                slopes.append(0.0)
            if jumps:  # only a piece before this point has the value before the jump
                continue
            starts.append(t)
            values.append(value)
            slopes.append(slope)
        start = np.array(starts)
        value_at = np.array(values)
        slope_at = np.array(slopes)
        lengths = np.diff(start)
        areas = lengths * (value_at[:-1] + 0.5 * slope_at[:-1] * lengths)
        integral = np.concatenate([[0.0], np.cumsum(areas)])
        return _Pieces(start, value_at, slope_at, integral)

    def _place(self, t: Any) -> Any:
        """The piece that holds at times from t on."""
        return np.maximum(np.searchsorted(self._pieces.start, t, side="right") - 1, 0)

    def at(self, t: Any) -> Any:
        """The value at times t, after a step that happens then; an array or a number."""
        if self.is_sine:
            mean, amplitude, frequency, phase = self._sine
            return mean + amplitude * np.sin(frequency * np.asarray(t) + phase)
        pieces = self._pieces
        k = self._place(t)
        return pieces.value[k] + pieces.slope[k] * (np.asarray(t) - pieces.start[k])

    def integral(self, t: Any) -> Any:
        """The integral of the value from 0 to times t."""
        return self._from_start(t) - self._from_start(0.0)

    def _from_start(self, t: Any) -> Any:
        """An antiderivative of the value at t."""
        if self.is_sine:
            mean, amplitude, frequency, phase = self._sine
            t = np.asarray(t)
            return mean * t - amplitude / frequency * np.cos(frequency * t + phase)
        pieces = self._pieces
        k = self._place(t)
        u = np.asarray(t) - pieces.start[k]
        return pieces.integral[k] + (pieces.value[k] + 0.5 * pieces.slope[k] * u) * u

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """The times at which the value or its slope changes, which increase."""
        if self.is_sine:
            return ()
        pieces = self._pieces
        found = []
        for k in range(1, pieces.start.size):
            length = pieces.start[k] - pieces.start[k - 1]
            before = pieces.value[k - 1] + pieces.slope[k - 1] * length
            jumps = not math.isclose(before, pieces.value[k], rel_tol=1e-14, abs_tol=0.0)
            if jumps or pieces.slope[k] != pieces.slope[k - 1]:
                found.append(float(pieces.start[k]))
        return tuple(found)

    @property
    def jumps(self) -> bool:
        """Whether its value changes in steps."""
        if self.is_sine:
            return False
        pieces = self._pieces
        before = pieces.value[:-1] + pieces.slope[:-1] * np.diff(pieces.start)
        return not np.allclose(before, pieces.value[1:], rtol=1e-12, atol=0.0)

    def times(self, factor: float) -> Schedule:
        """The schedule with all values multiplied by a factor."""
        return self._of_values(lambda value: factor * value, factor)

    def shifted(self, constant: float) -> Schedule:
        """The schedule with a constant added to all values."""
        return self._of_values(lambda value: value + constant, 1.0)

    def _of_values(self, change: Callable[[float], float], factor: float) -> Schedule:
        if self.is_sine:
            mean, amplitude, _, phase = self._sine
            assert self.period is not None
            return Schedule.sine(change(mean), factor * amplitude, self.period, phase)
        return Schedule(tuple((t, change(value)) for t, value in self.points), self.kind)

    def piece(self, inside: float) -> Piece:
        """The numbers of the value between the two kinks around a time."""
        if self.is_sine:
            mean, amplitude, frequency, phase = self._sine
            return Piece(0.0, mean, 0.0, 0.0, amplitude, frequency, phase)
        pieces = self._pieces
        k = self._place(inside)
        return Piece(float(pieces.start[k]), float(pieces.value[k]), float(pieces.slope[k]))

    def integral_piece(self, inside: float) -> Piece:
        """The same of the integral from 0 on."""
        if self.is_sine:
            mean, amplitude, frequency, phase = self._sine
            swing = amplitude / frequency
            start = swing * math.cos(phase)
            return Piece(0.0, start, mean, 0.0, swing, frequency, phase - 0.5 * math.pi)
        since, value, slope, *_ = self.piece(inside)
        return Piece(since, float(self.integral(since)), value, 0.5 * slope)

    def as_table(self) -> list[list[float]] | dict[str, Any]:
        """The list or the table of a scene file."""
        points = [[t, value] for t, value in self.points]
        if self.kind == "linear":
            return points
        if self.is_sine:
            return {name: getattr(self, name) for name in OF_SINE}
        return {"points": points, "kind": self.kind}


def _before(t: float) -> float:
    """A time before t, where a constant piece begins."""
    return t - max(1.0, abs(t))


def as_schedule(value: Any) -> Schedule:
    """A schedule from points, from its table in a scene file, or one that was made before."""
    if isinstance(value, Schedule):
        return check.as_parent(value, [Schedule])  # type: ignore[no-any-return]
    if isinstance(value, Mapping):
        if "points" not in value:
            table = known_keys(value, ("points", "kind", *OF_SINE), OF_SINE[:3])
            if "kind" in table:
                check.choice("kind", table.pop("kind"), [SINE])
            return Schedule.sine(**table)
        table = known_keys(value, ("points", "kind"))
        check.choice("kind", table.get("kind", "linear"), KINDS)
        return Schedule(**table)
    return Schedule(value)


def with_component(number: Any, keys: list[str], value: Any) -> Schedule:
    """The schedule with another number: of a point, as ["1", "0"], or of a sine, as ["period"].

    Raises InputError where there is none such.
    """
    if not isinstance(number, Schedule):
        raise InputError("", "is no schedule, and has no points")
    if number.is_sine:
        if len(keys) != 1 or keys[0] not in OF_SINE:
            raise InputError(".".join(keys), f"must be one of {', '.join(OF_SINE)} of a sine")
        table = {name: getattr(number, name) for name in OF_SINE}
        return Schedule.sine(**table | {keys[0]: check.number(keys[0], value)})
    if len(keys) != 2 or keys[1] not in ("0", "1") or not keys[0].isdecimal():
        known = "the number of a point and 0 (its time) or 1 (its value), as 1.1"
        raise InputError(".".join(keys), f"must be {known}")
    place = int(keys[0])
    if place >= len(number.points):
        raise InputError(keys[0], f"must be below the number of points, {len(number.points)}")
    points = [list(point) for point in number.points]
    points[place][int(keys[1])] = check.number(".".join(keys), value)
    return Schedule(tuple(map(tuple, points)), number.kind)  # type: ignore[arg-type]


def component_of(number: Any, keys: list[str]) -> float | None:
    """The number of a schedule that keys name; None if there is none such."""
    if not isinstance(number, Schedule):
        return None
    if number.is_sine:
        return getattr(number, keys[0]) if len(keys) == 1 and keys[0] in OF_SINE else None
    known = len(keys) == 2 and keys[1] in ("0", "1") and keys[0].isdecimal()
    if not known or int(keys[0]) >= len(number.points):
        return None
    return number.points[int(keys[0])][int(keys[1])]
