"""The methods that advance a scene in time: what each is, and what it is good for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tribo.checks import choice
from tribo.kernels import runge_kutta, tableaux


@dataclass(frozen=True)
class Method:
    """A time loop, with its coefficients."""

    name: str
    order: int
    adaptive: bool  # chooses its own steps by a tolerance
    loop: Callable[..., Any]
    coefficients: Any
    use: str
    source: str


METHODS = {
    method.name: method
    for method in (
        Method(
            "midpoint",
            2,
            False,
            runge_kutta.fixed_steps,
            tableaux.MIDPOINT,
            "the paper's own: forces and powers at the middle of every step",
            "C. Runge, Math. Ann. 46 (1895) 167",
        ),
        Method(
            "dop853",
            8,
            True,
            runge_kutta.chosen_steps,
            tableaux.DOP853,
            "few asperites, any drive, accuracies from 1e-3 to 1e-12",
            "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), II.10",
        ),
    )
}


def named(name: Any) -> Method:
    """The method of that name."""
    return METHODS[choice("method", name, METHODS)]
