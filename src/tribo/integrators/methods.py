"""The table of methods: coefficients, use, source, cost, and the effects that each refuses."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from tribo.compiler.plugin_methods import recognize_class
from tribo.integrators import tableaux, time_loops
from tribo.integrators.coefficient_files import read
from tribo.integrators.collocation import Collocation
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.runge_kutta import RungeKutta
from tribo.integrators.splitting import Splitting, alternating, composed
from tribo.model.scene import Scene
from tribo.validation import InputError, choice

# Effects that a method refuses, and why: the end of a sentence that begins with its name.
_POSITIONS_ONLY = "needs forces that depend on positions only; "
_CUSTOM_FORCES = {
    "own drive": _POSITIONS_ONLY + "a custom drive may depend on velocities",
    "own ends": _POSITIONS_ONLY + "custom forces on the ends of bars may depend on velocities",
}
_RESERVOIRS = ("langevin", "swing langevin")
_FRICTION = dict.fromkeys(_RESERVOIRS, _POSITIONS_ONLY + "Langevin friction depends on velocities")
_NEGATIVE_SUBSTEPS = dict.fromkeys(
    _RESERVOIRS, "uses negative substeps, which are unstable with damping and undefined with noise"
)
_BLOCK_VELOCITIES = {
    "moved pendulums": (
        "has no velocities for the force that moves bars against the pull of their pendulums"
    ),
    "block of pendulums": _POSITIONS_ONLY + "pendulums pull at their block by the squares of rates",
    "tilting block": _POSITIONS_ONLY + "bars pull at a block that turns by the square of its rate",
    "damped block": _POSITIONS_ONLY + "the dampers of a block depend on velocities",
}
_BLOCK_IN_DRIFTS = {
    "moved pendulums": (
        "lets pendulums swing about bars that keep their velocity in its drifts: "
        '"gauss-radau-15" and "dop853" integrate a given motion of bars'
    ),
    "block of pendulums": (
        "lets pendulums swing one by one in its drifts; those of a block are coupled by it: "
        '"gauss-radau-15" and "dop853" integrate them, and any method does with kappa = inf'
    ),
    "tilting block": (
        "moves coordinates one by one in its drifts; those of a block that turns are coupled: "
        '"gauss-radau-15" and "dop853" integrate them'
    ),
    "damped block": "has no dampers of blocks; langevin damps their bars",
}
_BATH_IN_KICKS = dict.fromkeys(
    ("bath", "torsional bath"), "loses its order with a bath, which rotates within its kicks"
)

# First levels of methods with equal steps, whose errors are far below the level.  On cases A and C
# of the paper, levels ten times as high meet accuracies from 1e-3 to 1e-8 in the first round too;
# levels of 0.03 took 2 to 18 times as many evaluations.
_SECOND_ORDER = 10.0
_HIGHER_ORDER = 100.0
# Of order 2, and of higher ones.
FIRST_LEVELS = _SECOND_ORDER, _HIGHER_ORDER


class Cost(NamedTuple):
    """What a method takes, as `benchmarks/calibrate.py` measured it.

    Only ratios to other methods enter the choice of a method, see `accuracy.cost_model`.
    """

    evaluations: float  # per radian of the fastest pendulum, at an accuracy of 1e-6
    slope: float  # a tenth of the error takes 10^(1/slope) times as many evaluations
    run: float  # time of an evaluation, whatever the scene [ns]
    asperite: float  # and for each asperite [ns]
    oscillator: float  # and for each coordinate of a bath [ns]
    step: int  # evaluations of a step
    # Evaluations and slope with a fast bath, of methods that advance it exactly.
    fast_bath: tuple[float, float] = (math.nan, math.nan)


@dataclass(frozen=True)
class Method:
    """The coefficients of a method, and what it is good for."""

    name: str  # in scene files and on the command line
    order: int  # of convergence, of the motion and of the ledger
    # The time loop finds the method's functions by their class.
    coefficients: RungeKutta | Nystrom | Collocation | Splitting
    use: str  # what it is good for
    source: str  # where it was published
    adaptive: bool = False  # whether it chooses its steps by a tolerance; else they are equal
    first_level: float = 0.03  # ratio of the level that is tried first to the wanted accuracy
    remembers: int = 0  # rows, one number a coordinate, that it keeps of a step for the next
    # Effects that it cannot integrate, and why.
    refuses: Mapping[str, str] = field(default_factory=dict)
    # Whether it needs forces that depend on positions only: it takes drives that declare so.
    positions_only: bool = False
    smoothness: int = 1  # continuous derivatives of the potential that its order needs
    noise: bool = False  # whether it integrates thermal noise
    own: bool = False  # whether a user added it
    cost: Cost | None = None  # None where it was not measured: it is never chosen unnamed

    @property
    def splits(self) -> bool:
        """Whether it separates torsion springs, baths and reservoirs from the other forces."""
        return isinstance(self.coefficients, Splitting)

    @property
    def stages(self) -> int:
        """The force evaluations of a step of an explicit or splitting method."""
        own = self.coefficients
        return int(own.kicks.size if isinstance(own, Splitting) else own.b.size)

    @property
    def loop(self) -> Callable[..., int]:
        return time_loops.adaptive_steps if self.adaptive else time_loops.equal_steps


# What methods of one family share.
_NYSTROM: dict[str, Any] = {
    "source": "J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, IMA J. Numer. Anal. 7 (1987) 423",
    "adaptive": True,
    "refuses": _CUSTOM_FORCES | _FRICTION | _BLOCK_VELOCITIES,
    "positions_only": True,
    "smoothness": 0,
}
COMPOSITION: dict[str, Any] = {
    "remembers": 1,
    "refuses": _CUSTOM_FORCES | _NEGATIVE_SUBSTEPS | _BLOCK_IN_DRIFTS,
    "positions_only": True,
    "smoothness": 2,
    "first_level": _HIGHER_ORDER,
}
_KAHAN_LI = COMPOSITION | {"source": "W. Kahan, R.-C. Li, Math. Comput. 66 (1997) 1089"}
METHODS = {
    method.name: method
    for method in (
        Method(
            "midpoint",
            2,
            tableaux.MIDPOINT,
            "the method of the paper: forces and powers at the middle of every step",
            "C. Runge, Math. Ann. 46 (1895) 167",
            first_level=_SECOND_ORDER,
            cost=Cost(440.0, 2.0, 108.0, 34.2, 1.5, 2),
        ),
        Method(
            "rk4",
            4,
            tableaux.CLASSICAL,
            "comparison with other programs that use it",
            "W. Kutta, Z. Math. Phys. 46 (1901) 435",
            smoothness=2,
            first_level=_HIGHER_ORDER,
            cost=Cost(20.1, 4.0, 83.0, 31.2, 1.4, 4),
        ),
        Method(
            "dop853",
            8,
            tableaux.DOP853,
            "few asperites, any drive, accuracies from 1e-3 to 1e-12",
            "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), II.10",
            adaptive=True,
            smoothness=0,  # its steps become short at a jump of the force
            cost=Cost(5.91, 11.2, 92.5, 44.5, 2.4, 12),
        ),
        Method(
            "rkn8",
            8,
            tableaux.RKN8,
            "forces that depend on positions only, accuracies from 1e-3 to 1e-10",
            **_NYSTROM,
            cost=Cost(3.8, 12.1, 118.0, 47.5, 2.2, 9),
        ),
        Method(
            "rkn12",
            12,
            tableaux.RKN12,
            "forces that depend on positions only, accuracies from 1e-10 to 1e-13",
            **_NYSTROM,
            cost=Cost(8.0, 105.0, 108.0, 43.4, 2.6, 17),
        ),
        Method(
            "gauss-radau-15",
            15,
            tableaux.RADAU_15,
            "any drive, accuracies from 1e-8 to 1e-13",
            "E. Everhart (1985); H. Rein, D. S. Spiegel, Mon. Not. R. Astron. Soc. 446 (2015) 1424",
            adaptive=True,
            remembers=8,
            smoothness=3,
            first_level=100.0,  # its errors are far below its estimates
            cost=Cost(7.21, 26.7, 89.4, 38.8, 3.6, 18),
        ),
        Method(
            "gauss-8",
            8,
            tableaux.GAUSS_8,
            "checks: any drive, and a step back undoes a step exactly",
            "J. C. Butcher, Math. Comput. 18 (1964) 50",
            remembers=4,
            smoothness=2,
            first_level=_HIGHER_ORDER,
            cost=Cost(31.3, 26.9, 78.8, 30.2, 2.8, 28),
        ),
        Method(
            "verlet",
            2,
            composed(1.0),
            "many asperites, long runs, thousands of bath oscillators, Langevin reservoirs",
            "L. Verlet, Phys. Rev. 159 (1967) 98, with the torsion springs rotated exactly",
            remembers=2,
            first_level=_SECOND_ORDER,
            refuses=_BLOCK_IN_DRIFTS,
            noise=True,
            cost=Cost(90.6, 2.0, 69.3, 29.3, 0.5, 1, fast_bath=(108.0, 2.0)),
        ),
        Method(
            "kahan-li-6",
            6,
            composed(*read("kahan-li-6")["weights"]),
            "long runs without reservoirs at accuracies from 1e-5 to 1e-10",
            **_KAHAN_LI,
            cost=Cost(15.2, 6.25, 36.5, 29.0, 0.4, 9, fast_bath=(55.4, 4.25)),
        ),
        Method(
            "kahan-li-8",
            8,
            composed(*read("kahan-li-8")["weights"]),
            "long runs without reservoirs at accuracies beyond 1e-9",
            **_KAHAN_LI,
            cost=Cost(20.4, 14.4, 33.4, 28.6, 0.4, 17, fast_bath=(71.5, 5.79)),
        ),
        Method(
            "blanes-moan-6",
            6,
            alternating(**read("blanes-moan-6")),
            "long runs without baths or reservoirs at accuracies from 1e-3 to 1e-10",
            "S. Blanes, P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313",
            **COMPOSITION | {"refuses": COMPOSITION["refuses"] | _BATH_IN_KICKS},
            cost=Cost(13.3, 8.02, 35.7, 28.6, 0.0, 10),
        ),
    )
}

# The only method that integrates noise.
NOISY = next(name for name, method in METHODS.items() if method.noise)
# The loops find `step` and `trial` by these classes.
for _method in METHODS.values():
    recognize_class(type(_method.coefficients))


def refusal(method: Method, scene: Scene) -> str | None:
    """Why a method cannot run a scene, as the end of a sentence; None if it can run it."""
    if scene.is_noisy and not method.noise:
        return f'must be "{NOISY}" where a reservoir has thermal noise, got "{method.name}"'
    allowed = scene.effects_of_positions if method.positions_only else ()
    for effect, why in method.refuses.items():
        if effect in scene.effects and effect not in allowed:
            return f'"{method.name}" {why}'
    return None


def check(method: Method, scene: Scene) -> None:
    """Refuse a scene that a method cannot run.  Raises InputError."""
    why = refusal(method, scene)
    if why is not None:
        raise InputError("method", why)


def named(name: object) -> Method:
    """The method of that name.  Raises InputError."""
    return METHODS[choice("method", name, METHODS)]
