"""Langevin reservoirs: friction and noise in place of a bath of oscillators."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.model.asperite import broadcast
from tribo.model.number import Number, highest, number_or_schedule
from tribo.model.tables import ComparedByValue, from_table
from tribo.validation import InputError, inside, is_list

# Places where a reservoir acts, and the unit of its damping coefficient there.
PLACES = {"bar": "mass / time", "swing": "torque time"}


@dataclass(frozen=True, eq=False)
class Langevin(ComparedByValue):
    """A thermal reservoir at every asperite: damping, and noise at a temperature above zero.

    On the bars it is a force, on the swing a torque on each pendulum:

        force  = -gamma (v_bar - u) + sqrt(2 gamma T) xi(t)
        torque = -gamma omega       + sqrt(2 gamma T) xi(t)

    with u the reservoir's velocity and xi(t) white noise.  The heat given to the reservoir is minus
    the integral of force . (v_bar - u), or of torque times omega.

    Attributes
    ----------
    gamma : float or (n,) array
        Damping coefficient [mass / time], or of the swing [torque time]; or one for each asperite,
        of which zeros leave an asperite without a reservoir.
    temperature : float or Schedule or (n,) array
        Temperature T [energy], with k_B = 1; or one for each asperite.
    velocity : (float, float), optional
        Velocity u of the reservoir in the laboratory; None for the surface's initial velocity.
        A reservoir on the swing has none.
    on : str
        "bar" or "swing".

    Raises
    ------
    InputError
        If a value is out of range, or a reservoir on the swing is given a velocity.
    """

    gamma: float | np.ndarray
    temperature: Number | np.ndarray = 0.0
    velocity: tuple[float, float] | None = None
    on: str = "bar"

    def __post_init__(self) -> None:
        unit = PLACES[check.choice("on", self.on, PLACES)]
        given = check.number_or_array("gamma", self.gamma, check.NOT_NEGATIVE, unit)
        object.__setattr__(self, "gamma", given)
        check.fields(self, temperature=_temperature)
        if self.velocity is not None and self.on == "swing":
            raise InputError("velocity", 'cannot go with on = "swing"')
        check.fields(self, velocity=check.pair(unit="length / time"))

    def __bool__(self) -> bool:
        return bool(np.any(np.greater(self.gamma, 0.0)))

    @property
    def is_uniform(self) -> bool:
        """Whether it is the same for all asperites of its surface."""
        return not any(isinstance(each, np.ndarray) for each in (self.gamma, self.temperature))

    @property
    def strongest(self) -> float:
        """The largest damping coefficient of any asperite."""
        return float(np.max(self.gamma))

    def for_each(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Damping and temperature, the highest of a schedule, of each asperite, (count,) each.

        Raises InputError for lists of another size.
        """
        warmest = self.temperature if isinstance(self.temperature, np.ndarray) else self.warmest
        return broadcast("gamma", self.gamma, count), broadcast("temperature", warmest, count)

    @property
    def warmest(self) -> float:
        """The highest temperature at any time [energy]; there is noise where it is above 0."""
        if isinstance(self.temperature, np.ndarray):
            return float(np.max(self.temperature * np.greater(self.gamma, 0.0)))
        return highest(self.temperature)


def _temperature(field: str, value: Any) -> Number | np.ndarray:
    """A number, a schedule, or a list of numbers, one for each asperite."""
    numbers = check.is_list(value) and len(value) > 0 and not check.is_list(value[0])
    if numbers:
        return check.vector(field, value, check.NOT_NEGATIVE, unit="energy")
    checked: Number = number_or_schedule(check.NOT_NEGATIVE, "energy")(field, value)
    return checked


def as_langevin(value: object) -> Langevin | tuple[Langevin, Langevin] | None:
    """A Langevin, or those on the bars and swings, also from tables of scene files; or None."""
    if value is None or not is_list(value):
        return None if value is None else from_table(Langevin, value, ["gamma"])
    found: dict[str, Langevin] = {}
    for i, each in enumerate(value):
        with inside(f"[{i}]"):
            item = from_table(Langevin, each, ["gamma"])
            if item.on in found:
                raise InputError("on", f'cannot be "{item.on}" twice; one reservoir acts there')
            if len(value) > 1:
                check.number_or_array("gamma", item.gamma, check.POSITIVE, PLACES[item.on])
            found[item.on] = item
    if len(found) == 2:
        return found["bar"], found["swing"]
    return next(iter(found.values()), None)
