"""Langevin at a bar: f_T = -gamma (v_bar - u) + noise, with u the velocity of the reservoir.

On the swing it is a torque, -gamma omega + noise.  Splitting methods use the exact motion under a
constant force, :func:`damped_motion`; all others integrate the friction alone, and refuse noise.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from tribo.compiler.jit import OVERLOAD, inlined
from tribo.compiler.lanes import broadcast, sqrt, where_less, with_lane
from tribo.compiler.lanes_functions import exponential
from tribo.compiler.lanes_memory import pack


class Deviates(NamedTuple):
    """Normal deviates of the members of an ensemble, drawn beforehand."""

    numbers: np.ndarray  # (n, 8) a column for each member
    place: np.ndarray  # (1,) the next row


@inlined
def decay_means(z):
    """What a velocity keeps after friction by z = gamma tau / mass, and two means.

    Returns exp(-z), (1 - exp(-z)) / z and (1 - (1 - exp(-z)) / z) / z: what is left of a velocity,
    its mean over tau, and the mean velocity that a constant force makes, in units of the velocity
    that it would give in tau without friction.
    """
    kept = exponential(-z)
    series = broadcast(1.0)
    for k in range(15, 2, -1):  # what is left out is below 1e-16 for z < 1/2
        series = 1.0 - z * series * (1.0 / k)
    series = 0.5 * series
    of_velocity = where_less(z, 0.5, 1.0 - z * series, (1.0 - kept) / z)
    return kept, of_velocity, where_less(z, 0.5, series, (1.0 - of_velocity) / z)


@inlined
def spread_of_travel(x, tangent):
    """(x - tanh x) / x^2 for x >= 0; `tangent` is tanh(x) / x."""
    y = x * x
    series = x * (1 / 3 + y * (-2 / 15 + y * (17 / 315 + y * (-62 / 2835))))
    return where_less(x, 0.05, series, (1.0 - tangent) / x)


class Damping(NamedTuple):
    """What friction and noise do to a degree of freedom in a step of some length; all Lanes."""

    z: Any  # gamma tau / mass
    of_velocity: Any  # means of a velocity, see `decay_means`
    of_gain: Any
    tangent: Any  # tanh(z / 2) / (z / 2)
    noise: Any  # standard deviation of the noise in the velocity
    spread: Any  # of the part of that in the displacement over tau which is independent of it


@inlined
def damping_of(gamma, temperature, mobility, tau):
    """What friction and noise do in a step to a degree of freedom of mass 1 / mobility."""
    z = gamma * tau * mobility
    kept, of_velocity, of_gain = decay_means(z)
    noise = sqrt(temperature * mobility * z * of_velocity * (1.0 + kept))
    tangent = 2.0 * of_velocity / (1.0 + kept)
    spread = sqrt(temperature * mobility * spread_of_travel(0.5 * z, tangent))
    return Damping(z, of_velocity, of_gain, tangent, noise, spread)


@inlined
def damped_motion(damping, mobility, velocity, gain, tau, one, other):
    """What friction and noise do in a step to a degree of freedom of mass 1 / mobility.

    A step is a drift, a kick and a drift.  In place of it, the velocity and the displacement are
    those of the exact solution under the force that is constant over the step, which are jointly
    Gaussian: D. L. Ermak, H. Buckholz, J. Comput. Phys. 35 (1980) 169; W. F. van Gunsteren,
    H. J. C. Berendsen, Mol. Phys. 45 (1982) 637.

    `velocity` is relative to the reservoir, in the middle of the kick; `gain` is what all other
    forces add to it in the step; `one` and `other` are normal deviates.  Returns the momentum that
    it takes up, and the displacement that the drifts leave out.
    """
    travel = damping.of_velocity * (velocity - 0.5 * gain) + damping.of_gain * gain
    noise = damping.noise * one
    change = noise - damping.z * travel
    travel = travel + 0.5 * damping.tangent * noise + damping.spread * other
    return change / mobility, tau * (travel - velocity - 0.5 * change)


def normals(noise, temperature, count, each):
    """Six normal deviates for each of the first `count` asperites of a pack.

    Only `each` of them are drawn, 2, 4 or 6; the others are 0, and all where no noise acts.  Those
    of one asperite come after those of another.
    """
    first = broadcast(0.0)
    second = broadcast(0.0)
    third = broadcast(0.0)
    fourth = broadcast(0.0)
    fifth = broadcast(0.0)
    sixth = broadcast(0.0)
    if temperature > 0.0:
        for i in range(count):
            first = with_lane(first, i, noise.standard_normal())
            second = with_lane(second, i, noise.standard_normal())
            if each > 2:
                third = with_lane(third, i, noise.standard_normal())
                fourth = with_lane(fourth, i, noise.standard_normal())
            if each > 4:
                fifth = with_lane(fifth, i, noise.standard_normal())
                sixth = with_lane(sixth, i, noise.standard_normal())
    return first, second, third, fourth, fifth, sixth


@inlined
def next_row(noise):
    """The next deviate of each member."""
    place = noise.place[0]
    noise.place[0] = place + 1
    return pack(noise.numbers[place], 0)


def _normals_of_members(noise, temperature, count, each):
    """As :func:`normals` where lanes are members, from rows that were drawn before."""
    first = broadcast(0.0)
    second = broadcast(0.0)
    third = broadcast(0.0)
    fourth = broadcast(0.0)
    fifth = broadcast(0.0)
    sixth = broadcast(0.0)
    if temperature > 0.0:
        first = next_row(noise)
        second = next_row(noise)
        if each > 2:
            third = next_row(noise)
            fourth = next_row(noise)
        if each > 4:
            fifth = next_row(noise)
            sixth = next_row(noise)
    return first, second, third, fourth, fifth, sixth


@overload(normals, **OVERLOAD)
def _normals(noise, temperature, count, each):
    """Let kernels call `normals` with a generator, or with Deviates."""
    return _normals_of_members if isinstance(noise, types.BaseNamedTuple) else normals
