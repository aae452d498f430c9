"""Langevin damping at the bars: the cheap continuum alternative to a bath of oscillators.

f_T = -gamma (v_bar - u) + noise, with u the reservoir's velocity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tribo.validation import NOT_NEGATIVE, known_keys, number, vector


@dataclass(frozen=True)
class Langevin:
    """A reservoir at every bar; the heat it is given is minus the integral of f_T . (v_bar - u)."""

    gamma: float  # [force / velocity]
    temperature: float = 0.0  # [energy], k_B = 1
    velocity: tuple[float, float] | None = None  # u in the laboratory; None: the surface's first

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "gamma", number("gamma", self.gamma, NOT_NEGATIVE))
        put(self, "temperature", number("temperature", self.temperature, NOT_NEGATIVE))
        if self.velocity is not None:
            put(self, "velocity", tuple(vector("velocity", self.velocity, size=2).tolist()))

    def __bool__(self) -> bool:
        return self.gamma > 0.0


def as_langevin(value: Any) -> Langevin | None:
    """Langevin damping from a table of a scene file, None, or itself."""
    if value is None or isinstance(value, Langevin):
        return value
    return Langevin(**known_keys(value, Langevin.__dataclass_fields__, ["gamma"]))
