"""The methods that advance a scene in time: what each is, and what it is good for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.checks import choice
from tribo.kernels import runge_kutta, splitting, tableaux


@dataclass(frozen=True)
class Method:
    """A time loop, with its coefficients."""

    name: str
    order: int
    adaptive: bool  # chooses its own steps by a tolerance
    splits: bool  # takes the torsion springs, baths and reservoirs apart from the other forces
    loop: Callable[..., Any]
    coefficients: Any
    use: str
    source: str
    smoothness: int = 1  # continuous derivatives of U that its order needs


def _symmetric(*first: float) -> np.ndarray:
    """A palindrome of weights from its first half and its middle."""
    return np.array([*first, *reversed(first[:-1])])


METHODS = {
    method.name: method
    for method in (
        Method(
            "midpoint",
            2,
            False,
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
            False,
            runge_kutta.chosen_steps,
            tableaux.DOP853,
            "few asperites, any drive, accuracies from 1e-3 to 1e-12",
            "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), II.10",
            smoothness=0,  # its steps find a jump of the force, and shorten there
        ),
        Method(
            "verlet",
            2,
            False,
            True,
            splitting.composed_steps,
            np.array([1.0]),
            "many asperites, long runs, thousands of bath oscillators, Langevin reservoirs",
            "L. Verlet, Phys. Rev. 159 (1967) 98, with the torsion springs turned exactly",
        ),
        Method(
            "kahan-li-6",
            6,
            False,
            True,
            splitting.composed_steps,
            _symmetric(
                0.39216144400731413928,
                0.33259913678935943860,
                -0.70624617255763935981,
                0.08221359629355080023,
                0.79854399093482996340,
            ),
            "long runs without reservoirs at accuracies from 1e-5 to 1e-10",
            "W. Kahan, R.-C. Li, Math. Comput. 66 (1997) 1089",
            smoothness=2,
        ),
    )
}


def named(name: Any) -> Method:
    """The method of that name."""
    return METHODS[choice("method", name, METHODS)]
