"""Langevin at a bar: f_T = -gamma (v_bar - u) + noise, with u the velocity of the reservoir.

On the swing it is a torque, -gamma omega + noise.  Splitting methods use the exact solution over a
step, :func:`thermal_kick`; all others integrate the friction alone, and refuse noise.
"""

import math

from tribo.kernels.compiled import kernel


@kernel
def friction_force(gamma, vx, vy, reservoir_x, reservoir_y):
    """Friction on a bar with velocity (vx, vy)."""
    return -gamma * (vx - reservoir_x), -gamma * (vy - reservoir_y)


@kernel
def thermal_kick(gamma, temperature, mobility, relative, tau, noise):
    """Momentum that friction and noise give in tau to a degree of freedom of mass 1 / mobility."""
    kept = math.exp(-gamma * mobility * tau)
    change = (kept - 1.0) * relative
    if temperature > 0.0:
        change += math.sqrt(temperature * mobility * (1.0 - kept * kept)) * noise.standard_normal()
    return change / mobility
