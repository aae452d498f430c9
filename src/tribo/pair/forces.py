"""The contact force of two asperites at eight times and places at once.

The coordinates are the swings q1 and q2, and k with k'' = f_x, where f is the contact force on the
first bob.  k' = j is its impulse.  A centre of mass that is free to slide is displaced by k / mass
from its uniform motion, the second one by -k / mass, and a forced one not at all.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import (
    broadcast,
    lane,
    with_lane,
)
from tribo.compiler.lanes_functions import sine_cosine
from tribo.kernels.contact import separation
from tribo.pair.potential import clearance_between, energy_between, force_over_distance


class PairScene(NamedTuple):
    """Two asperites, by numbers; in Lanes those of scenes side by side."""

    gap_x: Any  # from the second centre of mass to the first, at t = 0
    gap_y: Any
    z_squared: Any  # square of the bobs' distance in z
    velocity_x: Any  # of the first surface relative to the second
    velocity_y: Any
    mobility: Any  # sum of 1 / mass of the free ones: k displaces the gap by mobility * k
    charge1: Any
    charge2: Any
    arm1: Any  # l1 times facing: the bob is at arm (sin q, -cos q) from r_cm
    arm2: Any
    lever_x1: Any  # q1'' = cos q1 lever_x1 f_x + sin q1 lever_y1 f_y - omega_squared1 q1
    lever_y1: Any
    omega_squared1: Any  # kappa / inertia
    lever_x2: Any  # here, too, f is the force on the first bob
    lever_y2: Any
    omega_squared2: Any


# A scene as the record of one of them.
PAIR = np.dtype([(name, "f8") for name in PairScene._fields], align=True)

# How many numbers it has in a table, before those of the potential.
PAIR_NUMBERS = len(PairScene._fields)


class PairContact(NamedTuple):
    """Directions of the rods, contact force on the first bob, and squared distance; all Lanes."""

    sin1: Any
    cos1: Any
    sin2: Any
    cos2: Any
    fx: Any
    fy: Any
    square: Any


@inlined
def bob_separation(pair, t, k, sin1, cos1, sin2, cos2):
    """Vector from the second bob to the first, in x and y; floats or Lanes.

    Of two positions by :func:`tribo.kernels.kinematics.rod_position` this is the difference,
    summed in the order that loses no digits where the bobs are close: the gap of the centres of
    mass is a coordinate here.
    """
    dx = (pair.gap_x + pair.velocity_x * t + pair.mobility * k) + (
        pair.arm1 * sin1 - pair.arm2 * sin2
    )
    dy = (pair.gap_y + pair.velocity_y * t) - (pair.arm1 * cos1 - pair.arm2 * cos2)
    return dx, dy


@inlined
def contact_at(pair, potential, t, q1, q2, k):
    """The contact force at eight times and places."""
    sin1, cos1 = sine_cosine(q1)
    sin2, cos2 = sine_cosine(q2)
    return contact_of(pair, potential, t, k, sin1, cos1, sin2, cos2)


@inlined
def contact_of(pair, potential, t, k, sin1, cos1, sin2, cos2):
    """The contact force at eight times and directions of the rods."""
    dx, dy = bob_separation(pair, t, k, sin1, cos1, sin2, cos2)
    square = dx * dx + (dy * dy + pair.z_squared)
    f = force_over_distance(potential, square, pair.charge1, pair.charge2)
    return PairContact(sin1, cos1, sin2, cos2, f * dx, f * dy, square)


@inlined
def accelerations_of(pair, contact, q1, q2):
    """q1'', q2'' and k''."""
    one = contact.cos1 * (pair.lever_x1 * contact.fx) + contact.sin1 * (pair.lever_y1 * contact.fy)
    two = contact.cos2 * (pair.lever_x2 * contact.fx) + contact.sin2 * (pair.lever_y2 * contact.fy)
    return one - pair.omega_squared1 * q1, two - pair.omega_squared2 * q2, contact.fx


@inlined
def encounter_rate_of(pair, potential, r, q1, q2, v1, v2, j):
    """Rate of encounters of bobs at a distance r [1 / time].

    See :func:`tribo.kernels.encounters.next_encounter`.
    """
    omega1 = math.sqrt(v1 * v1 + pair.omega_squared1 * q1 * q1)
    omega2 = math.sqrt(v2 * v2 + pair.omega_squared2 * q2 * q2)
    velocity_x = pair.velocity_x + pair.mobility * j
    speed = math.sqrt(velocity_x * velocity_x + pair.velocity_y * pair.velocity_y)
    speed += abs(pair.arm1) * omega1 + abs(pair.arm2) * omega2
    return speed / clearance_between(potential, r, pair.charge1, pair.charge2)


@kernel
def energy_at(pair, potential, t, q1, q2, k, lane):
    """The energy of the contact; of the potential of a lane if each has its own."""
    return energy_between(potential, distance(pair, t, q1, q2, k), pair.charge1, pair.charge2, lane)


@inlined
def distance(pair, t, q1, q2, k):
    sin, cos = sine_cosine(with_lane(broadcast(q1), 1, q2))
    dx, dy = bob_separation(pair, t, k, lane(sin, 0), lane(cos, 0), lane(sin, 1), lane(cos, 1))
    return separation(dx, dy, math.sqrt(pair.z_squared))
