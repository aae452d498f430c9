"""The contact force of two asperites at eight times and places at once.

Coordinates are the swings q1 and q2, and k with k'' = f_x, the contact force on the first bob:
k' = j is its impulse, and centres of mass that are free to slide are at ease * k from their
uniform motion, where ease is 1 / mass (of the second: minus that), and 0 for a forced one.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.errors import NumbaError
from numba.extending import overload

from tribo.kernels.compiled import inlined
from tribo.kernels.contact import separation
from tribo.kernels.simd import LANES, lane, lanes, lanes_of, put, root, sine_cosine, where_less

PAIR = np.dtype(
    [
        ("gap_x", "f8"),  # from the second centre of mass to the first, at t = 0
        ("gap_y", "f8"),
        ("square_z", "f8"),  # square of what the bobs are apart in z
        ("speed_x", "f8"),  # of the first surface, seen from the second
        ("speed_y", "f8"),
        ("ease", "f8"),  # both asperites': the gap is the given one and ease * k
        ("charge1", "f8"),
        ("charge2", "f8"),
        ("arm1", "f8"),  # l1 times facing: the bob is at arm (sin q, -cos q) from the centre
        ("arm2", "f8"),
        ("turn_x1", "f8"),  # q1'' = cos q1 turn_x1 f_x + sin q1 turn_y1 f_y - square1 q1
        ("turn_y1", "f8"),
        ("square1", "f8"),
        ("turn_x2", "f8"),  # with f_x and f_y on the first bob here too
        ("turn_y2", "f8"),
        ("square2", "f8"),
    ],
    align=True,
)


class Sight(NamedTuple):
    """What the forces at eight places come from, and they, in Lanes."""

    sin1: Any
    cos1: Any
    sin2: Any
    cos2: Any
    fx: Any
    fy: Any
    r: Any


def forces_at(potential, r, one, other):
    """The force at eight distances: as its formula stands where that is arithmetic alone."""
    return potential.force_between(r, one, other)


@overload(forces_at, strict=False)
def _forces_at(potential, r, one, other):
    formula = njit(error_model="numpy")(potential.instance_class.force_between)
    try:
        formula.compile((potential, lanes, types.float64, types.float64))
    except NumbaError:
        return _one_by_one
    return forces_at


def _one_by_one(potential, r, one, other):
    f = r
    for i in range(LANES):
        f = put(f, i, potential.force_between(lane(r, i), one, other))
    return f


@inlined
def pushes(pair, potential, r, inverse):
    """Contact force over distance."""
    end = potential.range()
    push = forces_at(potential, r, pair.charge1, pair.charge2) * inverse
    return where_less(r, end, push, 0.0)


@inlined
def seen(pair, potential, t, q1, q2, k):
    """The contact force at eight times and places."""
    sin1, cos1 = sine_cosine(q1)
    sin2, cos2 = sine_cosine(q2)
    dx = (pair.gap_x + pair.speed_x * t + pair.ease * k) + (pair.arm1 * sin1 - pair.arm2 * sin2)
    dy = (pair.gap_y + pair.speed_y * t) - (pair.arm1 * cos1 - pair.arm2 * cos2)
    square = dx * dx + (dy * dy + pair.square_z)
    r = root(square)
    f = pushes(pair, potential, r, r * (1.0 / square))
    return Sight(sin1, cos1, sin2, cos2, f * dx, f * dy, r)


@inlined
def slopes(pair, sight, q1, q2):
    """q1'' and q2''; k'' is f_x."""
    one = sight.cos1 * (pair.turn_x1 * sight.fx) + sight.sin1 * (pair.turn_y1 * sight.fy)
    two = sight.cos2 * (pair.turn_x2 * sight.fx) + sight.sin2 * (pair.turn_y2 * sight.fy)
    return one - pair.square1 * q1, two - pair.square2 * q2


@inlined
def encounter_of(pair, potential, r, q1, q2, v1, v2, j):
    """As :func:`tribo.kernels.contact.encounter_rate`, of bobs that are r apart."""
    swing1 = math.sqrt(v1 * v1 + pair.square1 * q1 * q1)
    swing2 = math.sqrt(v2 * v2 + pair.square2 * q2 * q2)
    speed_x = pair.speed_x + pair.ease * j
    speed = math.sqrt(speed_x * speed_x + pair.speed_y * pair.speed_y)
    speed += abs(pair.arm1) * swing1 + abs(pair.arm2) * swing2
    return speed / potential.clearance(r)


@inlined
def distance(pair, t, q1, q2, k):
    """Distance of the bobs."""
    sin, cos = sine_cosine(put(lanes_of(q1), 1, q2))
    dx = pair.gap_x + pair.speed_x * t + pair.ease * k
    dx += pair.arm1 * lane(sin, 0) - pair.arm2 * lane(sin, 1)
    dy = pair.gap_y + pair.speed_y * t
    dy -= pair.arm1 * lane(cos, 0) - pair.arm2 * lane(cos, 1)
    return separation(dx, dy, math.sqrt(pair.square_z))
