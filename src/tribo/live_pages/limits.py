"""The tolerances of a run in a page, from the scales of a coarse one.

The rules are those of :func:`tribo.accuracy.levels.tolerances` for one asperite on one, without
what the rounding of forces loses.
"""

import math
from typing import Any, NamedTuple

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import LANES
from tribo.live_pages.quantities import MEMBERS, OF_ASPERITE
from tribo.pair import step_rows as rows
from tribo.pair.bodies import slide_of

# Motion with less than this part of the energy of the contact is round-off.
UNRESOLVED = 256.0 * 2.0**-52
TINY = 2.2250738585072014e-308
# The method's order, and the first step in units of the one that is usual.
ORDER = 15.0
FIRST_STEP = 8.0
WORKS = tuple(
    OF_ASPERITE.index(name)
    for name in ("w1", "w2", "wL", "wR", "w", "w1_ps", "w2_ps", "w_ps", "delta_e_int")
)
OMEGA = OF_ASPERITE.index("omega")
CONTACT_ENERGY = 2 * MEMBERS


class Scales(NamedTuple):
    """The scales of a run: see :class:`tribo.accuracy.levels.ToleranceScales`."""

    velocity: Any
    energy: Any
    impulse: Any
    rate: Any
    twist: Any


@kernel
def speed_apart(one, other):
    """Half of the surfaces' relative speed: that of each in the frame of their mean."""
    return 0.5 * math.sqrt((one.vx - other.vx) ** 2 + (one.vy - other.vy) ** 2)


@kernel
def guess(bodies, start):
    """Scales of a coarse run, from the start alone."""
    one, other = bodies
    length = max(one.l1, other.l1)
    omega = max(abs(start[2]), abs(start[3]))
    frequency = math.sqrt(max(one.kappa / one.inertia, other.kappa / other.inertia))
    velocity = speed_apart(one, other) + length * omega
    if velocity == 0.0:
        velocity = frequency * length
    if velocity == 0.0:
        velocity = 1.0
    energy = max(one.mass, other.mass) * velocity * velocity
    rate = max(max(omega, frequency), velocity / length)
    return Scales(velocity, energy, energy / velocity, rate, 1.0)


@kernel
def largest(values, count):
    top = 0.0
    for k in range(count):
        top = max(top, abs(values[k]))
    return top


@kernel
def measured(bodies, record, series, count, before):
    """Scales of a run whose quantities are those in the frame of the mean velocity."""
    one, other = bodies
    work = impulse = spin = twist = speed = 0.0
    for name in WORKS:
        work = max(work, max(largest(series[name], count), largest(series[MEMBERS + name], count)))
    for k in range(count):
        impulse = max(impulse, abs(record[k, rows.J]))
        impulse = max(impulse, abs(record[k, rows.J + 1 + rows.J_Y]))
        twist = max(twist, max(abs(record[k, rows.Q1]), abs(record[k, rows.Q2])))
    spin = max(largest(series[OMEGA], count), largest(series[MEMBERS + OMEGA], count))
    speed = max(before.velocity, speed_apart(one, other) + max(one.l1, other.l1) * spin)
    potential = 0.5 * largest(series[CONTACT_ENERGY], count)
    energy = work if work > UNRESOLVED * potential else potential
    turning = math.sqrt(potential / max(one.inertia, other.inertia))
    rate = spin if spin > UNRESOLVED * turning else turning
    return Scales(
        speed,
        energy if 0.0 < energy < math.inf else before.energy,
        impulse if 0.0 < impulse < math.inf else before.impulse,
        rate if 0.0 < rate < math.inf else before.rate,
        twist if 0.0 < twist < math.inf else before.twist,
    )


@kernel
def set_limits(bodies, bar_lengths, scales, duration, level, memory):
    """Write the limits of a level into the loop's memory."""
    one, other = bodies
    energy = level * scales.energy
    impulse = level * min(scales.impulse, scales.energy / scales.velocity)
    for m in range(rows.LIMITS, rows.STATE):
        for i in range(LANES):
            memory[m, i] = 0.0
    own = impulse
    fastest = 0.0
    for i, body in enumerate((one, other)):
        spin = max(scales.rate, math.sqrt(energy / body.inertia))
        rate = min(level * scales.rate, energy / max(body.inertia * spin, TINY))
        memory[rows.LIMITS, rows.OF_V1 + i] = rate
        if body.free == 1.0:
            slow = min(level * scales.velocity, energy / (body.mass * scales.velocity))
            own = min(own, body.mass * slow)
        fastest = max(fastest, body.kappa / body.inertia)
    memory[rows.LIMITS, rows.OF_J] = own
    memory[rows.LIMITS, rows.LEVEL] = level
    usual = 1e-3 * duration
    if fastest > 0.0:
        usual = min(usual, 0.05 / math.sqrt(fastest))
    memory[rows.LIMITS, rows.FIRST] = FIRST_STEP * usual * level ** (1.0 / ORDER)
    slide = abs(slide_of(one, 1.0)) + abs(slide_of(other, 1.0))
    rod1 = one.l1 + one.l2
    rod2 = other.l1 + other.l2
    memory[rows.ALLOWED, rows.J_Y] = 1.0 / impulse
    memory[rows.ALLOWED, rows.X1] = memory[rows.ALLOWED, rows.Y1] = rod1 / energy
    memory[rows.ALLOWED, rows.X2] = memory[rows.ALLOWED, rows.Y2] = rod2 / energy
    memory[rows.ALLOWED, rows.T1] = one.kappa / bar_lengths[0] / impulse
    memory[rows.ALLOWED, rows.T2] = other.kappa / bar_lengths[1] / impulse
    memory[rows.ALLOWED, rows.S] = slide / energy
