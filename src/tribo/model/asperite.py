"""An asperite: a bar, and a pendulum on a torsion spring that swings from the bar's centre."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.model.tables import ComparedByValue
from tribo.validation import InputError, is_list, must_be

# One number for all asperites of a surface, or an array with one number per asperite.
Each = float | np.ndarray

# Condition and unit of each parameter.
LIMITS = {
    "m1": (check.POSITIVE, "mass"),
    "m2": (check.POSITIVE, "mass"),
    "kappa": (check.NOT_NEGATIVE, "torque / rad"),
    "length": (check.POSITIVE, "length"),
    "bar_length": (check.POSITIVE, "length"),
    "i2": (check.POSITIVE, "mass length^2"),
    "charge": (check.ANY, "charge"),
}


def _are_infinite(kappa: object) -> bool:
    """Whether a stiffness is infinite; raises InputError if it is for some asperites only."""
    if isinstance(kappa, np.ndarray) and kappa.ndim > 0 and kappa.dtype.kind == "f":
        infinite = kappa == math.inf
    else:
        values = kappa if is_list(kappa) else [kappa]
        infinite = np.array([isinstance(each, float) and each == math.inf for each in values])
    if infinite.any() and not infinite.all():
        raise must_be("kappa", "inf for all asperites of a surface or for none", kappa)
    return bool(infinite.any())


def broadcast(field: str, value: Each, count: int) -> np.ndarray:
    """The value as an array of `count`.  Raises InputError for an array of another size."""
    if isinstance(value, np.ndarray) and value.size != count:
        problem = f"must be one number or an array of size {count}, got size {value.size}"
        raise InputError(field, problem)
    array = np.asarray(value, dtype=float)
    # As `np.broadcast_to`, in a tenth of its time.
    each = np.ndarray((count,), float, array, strides=(0,)) if array.ndim == 0 else array.view()
    each.flags.writeable = False
    return each


@dataclass(frozen=True, eq=False)
class Asperite(ComparedByValue):
    """Parameters of the asperites of a surface: each a number, or one number per asperite.

    The defaults are those of case A of the paper.

    Attributes
    ----------
    m1 : float or (n,) array
        Mass of the bob [mass].
    m2 : float or (n,) array
        Mass of the bar [mass].
    kappa : float or (n,) array
        Stiffness of the torsion spring [torque / rad]; inf for rigid asperites, whose pendulums do
        not swing.  Either all asperites of a surface are rigid, or none.
    length : float or (n,) array
        Length of the massless rod from the bar's centre to the bob [length].
    bar_length : float or (n,) array
        Length of the bar [length].
    i2 : float or (n,) array
        Moment of inertia of the bar about its centre [mass length^2].
    charge : float or (n,) array
        Charge of the bob; only charged potentials (Coulomb, Yukawa, Plummer) use it.

    Raises
    ------
    InputError
        If a parameter is no number, or is negative, or is zero (`kappa` and `charge` may be zero),
        or `kappa` is inf for some asperites only.
    """

    m1: Each = 1.0
    m2: Each = 2.0
    kappa: Each = 2.0
    length: Each = 2.0
    bar_length: Each = 3.0
    i2: Each = 5.0
    charge: Each = 1.0

    def __post_init__(self) -> None:
        for name, (condition, unit) in LIMITS.items():
            value = getattr(self, name)
            if name == "kappa" and _are_infinite(value):
                value = np.full(len(value), math.inf) if is_list(value) else math.inf
            else:
                value = check.number_or_array(name, value, condition, unit)
            object.__setattr__(self, name, value)

    @cached_property
    def is_rigid(self) -> bool:
        """Whether the pendulums are fixed to their bars, by `kappa` = inf."""
        return bool(np.isinf(self.kappa).all())

    def for_each(self, count: int) -> dict[str, np.ndarray]:
        """Every parameter, and derived quantities, as arrays of `count`.

        The derived quantities are `mass` M = m1 + m2, `l1` and `l2` (distances of bob and bar
        from the centre of mass), and `inertia` I = m1 l1^2 + m2 l2^2.
        """
        each = {name: broadcast(name, getattr(self, name), count) for name in LIMITS}
        names = ("mass", "l1", "l2", "inertia")
        derived = dict(zip(names, rod_of(self.m1, self.m2, self.length), strict=True))
        return each | {name: broadcast(name, value, count) for name, value in derived.items()}


def rod_of(m1: Any, m2: Any, length: Any) -> tuple[Any, Any, Any, Any]:
    """M, the distances of bob and bar from the centre of mass, and I, of numbers or arrays."""
    mass = m1 + m2
    l1 = length * m2 / mass
    l2 = length * m1 / mass
    return mass, l1, l2, m1 * (l1 * l1) + m2 * (l2 * l2)
