"""Positions, velocities and forces on one asperite, each equation written once.

These are plain functions of numbers.  Kernels compile them; other modules may call them with
arrays, which broadcast.  The direction (t_x, t_y) = facing (cos s, sin s), where s = theta - rest,
is the unit vector along which a growing theta moves the bob.
"""

from typing import Any

import numpy as np
from numba.extending import register_jitable

from tribo.compiler.jit import KERNEL

Number = Any  # a float, or in calls from Python an array
Vector = tuple[Number, Number]

equation = register_jitable(**KERNEL)


def versine(angle: Number) -> Number:
    """1 - cos(angle), without the cancellation at small angles."""
    return 2.0 * np.sin(0.5 * angle) ** 2


@equation
def nearest_image(difference: Number, period: Number) -> Number:
    """The difference, from -period/2 up to and excluding period/2 where there is a period."""
    if period > 0.0:
        return difference - period * np.floor(difference / period + 0.5)
    return difference


@equation
def rod_position(x: Number, y: Number, arm: Number, tx: Number, ty: Number) -> Vector:
    """Position of a point of the rod, r = r_cm + arm (sin theta, -cos theta).

    `arm` is l1 at the bob and -l2 at the bar's centre.
    """
    return x + arm * ty, y - arm * tx


@equation
def rod_velocity(
    vx: Number, vy: Number, omega: Number, arm: Number, tx: Number, ty: Number
) -> Vector:
    """Velocity of a point of the rod, v = v_cm + arm omega t."""
    return vx + arm * omega * tx, vy + arm * omega * ty


@equation
def end_force(torque: Number, inverse_length: Number, sin_phi: Number, cos_phi: Number) -> Vector:
    """Force on the left end of a clamped bar, f_L = -f_R = (torque / length) (-sin phi, cos phi).

    `torque` is that of the torsion spring on the pendulum, kappa (theta - phi - rest) where the
    bar is at an angle phi.  An angular impulse instead gives the impulse on the end.  The length
    comes as its inverse, since eight divisions take as long as fifty products.
    """
    force = torque * inverse_length
    return -force * sin_phi, force * cos_phi


@equation
def rotational_power(
    arm: Number, omega: Number, tx: Number, ty: Number, fx: Number, fy: Number
) -> Number:
    """Power of a force about the centre of mass, on a point of the rod."""
    return arm * omega * (tx * fx + ty * fy)
