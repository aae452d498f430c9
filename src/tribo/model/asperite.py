"""An asperite: a bar, and a pendulum on a torsion spring that swings from the bar's centre."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from tribo.validation import ANY, NOT_NEGATIVE, POSITIVE, InputError, number_or_each

Each = float | np.ndarray  # one number for all asperites of a surface, or one for each


@dataclass(frozen=True, eq=False)
class Asperite:
    """Parameters of the asperites of a surface: each a number, or one number per asperite.

    The defaults are those of the paper's case A.
    """

    m1: Each = 1.0  # mass of the bob
    m2: Each = 2.0  # mass of the bar
    kappa: Each = 2.0  # stiffness of the torsion spring [torque / rad]
    length: Each = 2.0  # of the massless rod from bar to bob
    bar_length: Each = 3.0
    i2: Each = 5.0  # the bar's moment of inertia about its centre
    charge: Each = 1.0  # of the bob; only charged potentials look at it

    def __post_init__(self) -> None:
        conditions = {"kappa": NOT_NEGATIVE, "charge": ANY}
        for field in fields(self):
            value = number_or_each(
                field.name, getattr(self, field.name), conditions.get(field.name, POSITIVE)
            )
            object.__setattr__(self, field.name, value)

    def for_each(self, count: int) -> dict[str, np.ndarray]:
        """Every parameter, and those that follow from it, as arrays of `count`."""
        each = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray) and value.size != count:
                raise InputError(
                    field.name,
                    f"has {value.size} values for {count} asperites; give one, or {count}",
                )
            each[field.name] = np.broadcast_to(np.asarray(value, dtype=float), (count,))
        m1, m2, length = each["m1"], each["m2"], each["length"]
        each["mass"] = m1 + m2
        each["l1"] = length * m2 / each["mass"]
        each["l2"] = length * m1 / each["mass"]
        each["inertia"] = m1 * each["l1"] ** 2 + m2 * each["l2"] ** 2
        return each
