"""Langevin reservoirs on the bars: friction and noise in place of a bath of oscillators."""

from __future__ import annotations

from dataclasses import dataclass

from tribo.validation import NOT_NEGATIVE, known_keys, number, vector


@dataclass(frozen=True)
class Langevin:
    """A thermal reservoir at every bar: damping, and noise at a temperature above zero.

        f_T = -gamma (v_bar - u) + sqrt(2 gamma T) xi(t)

    with u the reservoir's velocity and xi(t) white noise.  The heat given to the reservoir is minus
    the integral of f_T . (v_bar - u).

    Attributes
    ----------
    gamma : float
        Damping coefficient [mass / time].
    temperature : float
        Temperature T [energy], with k_B = 1.
    velocity : (float, float), optional
        Velocity u of the reservoir in the laboratory; None for the surface's initial velocity.
    """

    gamma: float
    temperature: float = 0.0
    velocity: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "gamma", number("gamma", self.gamma, NOT_NEGATIVE, "mass / time"))
        put(self, "temperature", number("temperature", self.temperature, NOT_NEGATIVE, "energy"))
        if self.velocity is not None:
            velocity = vector("velocity", self.velocity, size=2, unit="length / time")
            put(self, "velocity", tuple(velocity.tolist()))

    def __bool__(self) -> bool:
        return self.gamma > 0.0


def as_langevin(value: object) -> Langevin | None:
    """A reservoir from a table of a scene file, a Langevin unchanged, or None (no reservoir)."""
    if value is None or isinstance(value, Langevin):
        return value
    return Langevin(**known_keys(value, Langevin.__dataclass_fields__, ["gamma"]))
