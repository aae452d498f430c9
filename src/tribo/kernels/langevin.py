"""Langevin at a bar: f_T = -gamma (v_bar - u) + noise, with u the velocity of the reservoir.

On the swing it is a torque, -gamma omega + noise.  Splitting methods use the exact solution over a
step, :func:`thermal_kicks`; all others integrate the friction alone, and refuse noise.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.jit_options import KERNEL
from tribo.kernels.simd import broadcast, sqrt, with_lane
from tribo.kernels.simd_arrays import block
from tribo.kernels.simd_functions import exponential


class Deviates(NamedTuple):
    """Normal deviates of the members of an ensemble, drawn beforehand."""

    numbers: np.ndarray  # (n, 8) a column for each member
    place: np.ndarray  # (1,) the next row


@kernel
def friction_force(gamma, vx, vy, reservoir_x, reservoir_y):
    """Friction on a bar with velocity (vx, vy)."""
    return -gamma * (vx - reservoir_x), -gamma * (vy - reservoir_y)


@inlined
def thermal_kicks(gamma, temperature, mobility, relative, tau, normal):
    """Momenta that friction and noise give in tau to degrees of freedom of mass 1 / mobility."""
    kept = exponential(-gamma * tau * mobility)
    change = (kept - 1.0) * relative
    change = change + sqrt(temperature * mobility * (1.0 - kept * kept)) * normal
    return change / mobility


def normals(noise, temperature, count):
    """A normal deviate for each of the first asperites of a block; 0 where none is needed."""
    drawn = broadcast(0.0)
    if temperature > 0.0:
        for i in range(count):
            drawn = with_lane(drawn, i, noise.standard_normal())
    return drawn


def pairs_of_normals(noise, temperature, count):
    """Two of them for each, those of one asperite after those of another."""
    one, other = broadcast(0.0), broadcast(0.0)
    if temperature > 0.0:
        for i in range(count):
            one = with_lane(one, i, noise.standard_normal())
            other = with_lane(other, i, noise.standard_normal())
    return one, other


@inlined
def next_row(noise):
    """The next deviate of each member."""
    place = noise.place[0]
    noise.place[0] = place + 1
    return block(noise.numbers[place], 0)


def _normals_of_members(noise, temperature, count):
    return next_row(noise) if temperature > 0.0 else broadcast(0.0)


def _pairs_of_normals_of_members(noise, temperature, count):
    one, other = broadcast(0.0), broadcast(0.0)
    if temperature > 0.0:
        one = next_row(noise)
        other = next_row(noise)
    return one, other


_options: dict[str, Any] = {"jit_options": KERNEL}


def _find(function: Any, of_members: Any) -> None:
    """Let kernels call a function with a generator, or `of_members` with Deviates."""

    @overload(function, **_options)
    def find(noise, temperature, count):
        return of_members if isinstance(noise, types.BaseNamedTuple) else function


_find(normals, _normals_of_members)
_find(pairs_of_normals, _pairs_of_normals_of_members)
