"""Bath oscillators: springs to their bars, m w^2 (displacement from the bar).

Those of one bar stand side by side: all x, all y, then the torsional.  Eight are computed at once.
"""

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.compiler.units import call_unit
from tribo.kernels.packs import absent, column_of_constants
from tribo.kernels.records import (
    BATH_MOMENTA,
    I2,
    NU_START,
    OSCILLATOR_FREQUENCY,
    OSCILLATOR_MASS,
    PHI_START,
)


@kernel
def oscillators_of(s, i, axis):
    """First row, number and first slot of a bar's oscillators: along x, y, or torsional."""
    slot = s.dof_bath + (i - s.start) * (2 * s.oscillators + s.torsionals)
    if axis == 2:
        return s.first_torsional, s.torsionals, slot + 2 * s.oscillators
    return s.first_oscillator, s.oscillators, slot + axis * s.oscillators


@kernel
def bar_angle(model, s, i, t, q):
    """phi of one bar: a coordinate where it is free, uniform where it is clamped."""
    if s.dof_phi >= 0:
        return q[s.dof_phi + i - s.start]
    c = column_of_constants(s, i)
    return model.constants[PHI_START, c] + model.constants[NU_START, c] * lane_of(t, i)


@kernel
def place_of_bar(model, displaced, s, i, axis, t, q):
    """The place on a bar about which its oscillators along an axis move: x, y, or its angle."""
    if axis < 2:
        return displaced[axis, i]
    return bar_angle(model, s, i, t, q)


@kernel
def pull(table, oscillators, q, centre):
    """Force of a bar's oscillators, by :func:`oscillators_of`, on what is at `centre`."""
    first, count, slot = oscillators
    force = broadcast(0.0)
    for m in range(0, count, LANES):
        w = pack(table[OSCILLATOR_FREQUENCY], first + m)
        stiffness = pack(table[OSCILLATOR_MASS], first + m) * w * w
        force = force + stiffness * (pack(q, slot + m) - centre)
    return sum_of_lanes(force)


@kernel
def oscillate(table, oscillators, q, centre, acceleration):
    """Set q'' of a bar's oscillators about a place."""
    first, count, slot = oscillators
    for m in range(0, count, LANES):
        w = pack(table[OSCILLATOR_FREQUENCY], first + m)
        set_pack(acceleration, slot + m, -w * w * (pack(q, slot + m) - centre))


@kernel
def oscillator_energy(table, oscillators, q, v, centre):
    """Energy of a bar's oscillators about a place, and the kinetic part of it."""
    first, count, slot = oscillators
    energy = broadcast(0.0)
    kinetic = broadcast(0.0)
    for m in range(0, count, LANES):
        away = pack(table[OSCILLATOR_FREQUENCY], first + m) * (pack(q, slot + m) - centre)
        rate = pack(v, slot + m)
        mass = pack(table[OSCILLATOR_MASS], first + m)
        energy = energy + 0.5 * mass * (rate * rate + away * away)
        kinetic = kinetic + 0.5 * mass * rate * rate
    return sum_of_lanes(energy), sum_of_lanes(kinetic)


@kernel
def oscillator_momentum(table, oscillators, v):
    first, count, slot = oscillators
    momentum = broadcast(0.0)
    for m in range(0, count, LANES):
        mass = pack(table[OSCILLATOR_MASS], first + m)
        momentum = momentum + mass * pack(v, slot + m)
    return sum_of_lanes(momentum)


def bath_forces(model, q, acceleration):
    """Set q'' of the bath oscillators, and add their forces on the bars."""
    bath = model.bath
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.oscillators > 0:
            for i in range(s.start, s.end):
                for axis in range(2):
                    oscillators = oscillators_of(s, i, axis)
                    bar = model.displaced[axis, i]
                    model.internal[axis, i] += pull(bath, oscillators, q, bar)
                    oscillate(bath, oscillators, q, bar, acceleration)
    return 0.0


@kernel
def torsional_torque(model, torsional, s, i, t, q):
    return pull(torsional, oscillators_of(s, i, 2), q, bar_angle(model, s, i, t, q))


def torsional_accelerations(model, t, q, acceleration):
    """Set q'' of the torsional oscillators, and add their torque on the bars."""
    torsional = model.torsional
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.torsionals > 0:
            for i in range(s.start, s.end):
                phi = bar_angle(model, s, i, t, q)
                oscillate(torsional, oscillators_of(s, i, 2), q, phi, acceleration)
                torque = torsional_torque(model, torsional, s, i, t, q)
                inertia = model.constants[I2, column_of_constants(s, i)]
                acceleration[s.dof_phi + i - s.start] += torque / inertia
    return 0.0


def bath_momenta(model, v):
    """Set the momentum of the bath on each bar, in the surface's first frame."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.oscillators > 0:
            for i in range(s.start, s.end):
                for axis in range(2):
                    momentum = oscillator_momentum(model.bath, oscillators_of(s, i, axis), v)
                    model.bath_momentum[axis, i] = momentum
    return 0.0


@inlined
def set_bath_momenta(model, v):
    """The same, if there is a bath, from outside of the unit."""
    if not absent(model.bath):
        call_unit(model.units[BATH_MOMENTA], (model, v))
