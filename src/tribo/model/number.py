"""Numbers of scenes that may follow a schedule: their check, and what is asked of both kinds."""

from collections.abc import Mapping
from typing import Any, TypeGuard

from tribo import validation as check
from tribo.model.schedule import Schedule, as_schedule
from tribo.validation import Check, Condition, InputError, is_list

Number = float | Schedule


def number_or_schedule(condition: Condition = check.ANY, unit: str = "") -> Check:
    """The check of a field that is a number, or a schedule of numbers that meet the condition."""

    def checked(field: str, value: Any) -> Number:
        """The number, or the schedule that a table or a list of points describes."""
        if not (isinstance(value, (Schedule, Mapping)) or is_list(value)):
            return check.number(field, value, condition, unit)
        with check.inside(field):
            schedule = as_schedule(value)
            if schedule.is_sine and not condition[1](schedule.low):
                raise InputError("", f"{condition[0]}, got {schedule.low:g} at its lowest")
            for i, (_, each) in enumerate(schedule.points):
                check.number(f"[{i}][1]", each, condition, unit)
        return schedule

    return checked


def changes(number: Any) -> TypeGuard[Schedule]:
    """Whether a number changes with time by a schedule."""
    return isinstance(number, Schedule)


def constant(number: Number) -> float:
    """A number that does not change; 0 in place of a schedule."""
    return 0.0 if isinstance(number, Schedule) else number


def largest(number: Number | None) -> float:
    """The largest magnitude of a number at any time; 0 of None."""
    if isinstance(number, Schedule):
        return number.largest
    return abs(number or 0.0)


def highest(number: Number) -> float:
    """The largest value of a number at any time."""
    return number.high if isinstance(number, Schedule) else number


def at_time(number: Number, t: Any) -> Any:
    """The value of a number at times t."""
    return number.at(t) if isinstance(number, Schedule) else number
