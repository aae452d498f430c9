"""The methods that advance a scene in time: what each is, and what it is good for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from tribo.integrators import (
    collocation,
    collocation_tableaux,
    nystrom,
    nystrom_tableaux,
    runge_kutta,
    splitting,
    tableaux,
)
from tribo.integrators.splitting import alternating, composed
from tribo.model.scene import Scene
from tribo.validation import choice

# Effects that a method refuses, and why, as the end of a sentence that begins with its name.
_PLACES = "is for forces of places alone; "
_OWN_FORCES = {
    "own drive": _PLACES + "a drive of the user's own may depend on velocities",
    "own ends": _PLACES + "forces of the user's own on the ends of bars may depend on velocities",
}
_ONE_WAY = {"langevin": "steps back in time, which no reservoir can"}
_NO_FRICTION = {"langevin": _PLACES + "a reservoir's friction depends on velocities"}
_BARE_KICKS = dict.fromkeys(
    ("bath", "torsional bath"), "loses its order with a bath, which turns within its kicks"
)


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
    splits: bool = False  # takes the torsion springs, baths and reservoirs apart from other forces
    first_level: float = 0.03  # of settings first tried, in units of the accuracy
    remembers: int = 0  # vectors of a last step, by which the next is begun
    refuses: Mapping[str, str] = field(default_factory=dict)  # effect -> why
    smoothness: int = 1  # continuous derivatives of U that its order needs


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
            "rk4",
            4,
            False,
            runge_kutta.fixed_steps,
            tableaux.CLASSICAL,
            "comparison with other programs, of which it is the commonest method",
            "W. Kutta, Z. Math. Phys. 46 (1901) 435",
            smoothness=2,
        ),
        Method(
            "dop853",
            8,
            True,
            runge_kutta.chosen_steps,
            tableaux.DOP853,
            "few asperites, any drive, accuracies from 1e-3 to 1e-12",
            "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), II.10",
            smoothness=0,  # its steps find a jump of the force, and shorten there
        ),
        Method(
            "rkn8",
            8,
            True,
            nystrom.nystrom_steps,
            nystrom_tableaux.RKN8,
            "forces of places, accuracies from 1e-3 to 1e-8",
            "J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, IMA J. Numer. Anal. 7 (1987) 423",
            refuses=_OWN_FORCES | _NO_FRICTION,
            smoothness=0,
        ),
        Method(
            "rkn12",
            12,
            True,
            nystrom.nystrom_steps,
            nystrom_tableaux.RKN12,
            "forces of places, accuracies from 1e-8 to 1e-13",
            "J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, IMA J. Numer. Anal. 7 (1987) 423",
            refuses=_OWN_FORCES | _NO_FRICTION,
            smoothness=0,
        ),
        Method(
            "gauss-radau-15",
            15,
            True,
            collocation.chosen_collocation,
            collocation_tableaux.RADAU_15,
            "any drive, accuracies from 1e-8 to 1e-13",
            "E. Everhart (1985); H. Rein, D. S. Spiegel, Mon. Not. R. Astron. Soc. 446 (2015) 1424",
            remembers=8,
            smoothness=3,
            first_level=100.0,  # its errors are far below what its controller fears
        ),
        Method(
            "gauss-8",
            8,
            False,
            collocation.equal_collocation,
            collocation_tableaux.GAUSS_8,
            "checks: any drive, and a step back undoes a step",
            "J. C. Butcher, Math. Comput. 18 (1964) 50",
            remembers=4,
            smoothness=2,
        ),
        Method(
            "verlet",
            2,
            False,
            splitting.composed_steps,
            composed(1.0),
            "many asperites, long runs, thousands of bath oscillators, Langevin reservoirs",
            "L. Verlet, Phys. Rev. 159 (1967) 98, with the torsion springs turned exactly",
            splits=True,
            refuses=_OWN_FORCES,
        ),
        Method(
            "kahan-li-6",
            6,
            False,
            splitting.composed_steps,
            composed(
                0.39216144400731413928,
                0.33259913678935943860,
                -0.70624617255763935981,
                0.08221359629355080023,
                0.79854399093482996340,
            ),
            "long runs without reservoirs at accuracies from 1e-5 to 1e-10",
            "W. Kahan, R.-C. Li, Math. Comput. 66 (1997) 1089",
            splits=True,
            refuses=_OWN_FORCES | _ONE_WAY,
            smoothness=2,
        ),
        Method(
            "kahan-li-8",
            8,
            False,
            splitting.composed_steps,
            composed(
                0.13020248308889008088,
                0.56116298177510838456,
                -0.38947496264484728641,
                0.15884190655515560090,
                -0.39590389413323757734,
                0.18453964097831570709,
                0.25837438768632204729,
                0.29501172360931029887,
                -0.60550853383003451170,
            ),
            "long runs without reservoirs at accuracies beyond 1e-9",
            "W. Kahan, R.-C. Li, Math. Comput. 66 (1997) 1089",
            splits=True,
            refuses=_OWN_FORCES | _ONE_WAY,
            smoothness=2,
        ),
        Method(
            "blanes-moan-6",
            6,
            False,
            splitting.composed_steps,
            alternating(
                (
                    0.0502627644003922,
                    0.413514300428344,
                    0.0450798897943977,
                    -0.188054853819569,
                    0.541960678450780,
                ),
                (
                    0.148816447901042,
                    -0.132385865767784,
                    0.067307604692185,
                    0.432666402578175,
                ),
            ),
            "long runs without baths or reservoirs at accuracies from 1e-3 to 1e-10",
            "S. Blanes, P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313",
            splits=True,
            refuses=_OWN_FORCES | _ONE_WAY | _BARE_KICKS,
            smoothness=2,
        ),
    )
}


def noisy(scene: Scene) -> bool:
    """Whether a reservoir's noise acts somewhere."""
    return any(s.langevin and s.langevin.temperature > 0.0 for s in scene.surfaces)


def refusal(method: Method, scene: Scene) -> str | None:
    """Why a method cannot run a scene, as the end of a sentence; None if it can."""
    if noisy(scene) and method.name != "verlet":
        return f'must be "verlet" for noise from a reservoir, got "{method.name}"'
    for effect, why in method.refuses.items():
        if effect in scene.effects:
            return f'"{method.name}" {why}'
    return None


def named(name: Any) -> Method:
    """The method of that name."""
    return METHODS[choice("method", name, METHODS)]
