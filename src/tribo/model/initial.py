"""How the asperites of a surface start: angles, displacements and rates, given or drawn."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from tribo import validation as check
from tribo.model.asperite import Each, broadcast
from tribo.model.tables import ComparedByValue
from tribo.validation import InputError

# Units of the initial angles and their rates.
UNITS = {"theta": "rad", "phi": "rad", "omega": "rad / time", "nu": "rad / time", "swing": "rad"}
# Units of the initial displacements of centres of mass and their rates.
DISPLACEMENTS = {"x": "length", "y": "length", "vx": "length / time", "vy": "length / time"}
# What a temperature draws, or gives a meaning that is drawn about.
DRAWN = ("theta", "swing", "omega", "nu", "vx", "vy")


@dataclass(frozen=True, eq=False)
class Initial(ComparedByValue):
    """Initial angles, displacements and rates: each a number, or one number per asperite.

    None stands for the equilibrium angle, and for a displacement or a rate of zero.

    Attributes
    ----------
    theta : float or (n,) array, optional
        Absolute angle of the pendulum [rad]; pi where an asperite that faces up is at rest.
        None for phi + the rest angle.
    phi : float or (n,) array, optional
        Angle of the bar [rad].
    omega : float or (n,) array, optional
        d theta / dt [rad / time].
    nu : float or (n,) array, optional
        d phi / dt [rad / time].
    swing : float or (n,) array, optional
        Angle of the pendulum from the rest angle, 0 (down) or pi (up) [rad]: an alternative to
        `theta`, with the same meaning for both facings.
    x, y : float or (n,) array, optional
        Displacement of the centre of mass from where the surface puts it [length]; springs keep
        their lengths at rest.  Only where asperites can move along x or y.
    vx, vy : float or (n,) array, optional
        Velocity of the centre of mass beyond the surface's `velocity` [length / time], likewise.
    temperature : float, optional
        Temperature T [energy], with k_B = 1, at which the start is drawn from the scene's seed:
        twists of torsion springs with variance T / kappa, rates omega with T / inertia, nu of bars
        that turn with T / i2, and velocities of centres of mass that can move with T / mass.
        Contact, fields and lattice springs do not bias it.

    Raises
    ------
    InputError
        If a value is no finite number, both `theta` and `swing` are given, or `temperature` goes
        with what it draws.
    """

    theta: Each | None = None
    phi: Each | None = None
    omega: Each | None = None
    nu: Each | None = None
    swing: Each | None = None
    x: Each | None = None
    y: Each | None = None
    vx: Each | None = None
    vy: Each | None = None
    temperature: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers, and that none of them is given twice or also drawn."""
        units = UNITS | DISPLACEMENTS
        each = {name: partial(check.number_or_array, unit=unit) for name, unit in units.items()}
        check.fields(self, **each, temperature=check.one(check.NOT_NEGATIVE, "energy"))
        if self.theta is not None and self.swing is not None:
            raise InputError("swing", "cannot go with theta; give one or the other")
        for name in DRAWN:
            if self.temperature and getattr(self, name) is not None:
                raise InputError(name, "cannot go with temperature, which draws the start")

    def for_each(self, count: int) -> dict[str, np.ndarray]:
        """Each angle, displacement and rate as an array of `count`; 0 if it is not given."""
        given = {name: getattr(self, name) for name in UNITS | DISPLACEMENTS}
        zeros = np.broadcast_to(0.0, (count,))  # which cannot be written to
        return {k: zeros if v is None else broadcast(k, v, count) for k, v in given.items()}
