"""Bath oscillators: springs to their bars, m w^2 (displacement from the bar).

Those of one bar stand side by side: all x, all y, then the torsional.  Eight are computed at once.
"""

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import block, set_block
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.kernels.blocks import column_of_constants
from tribo.kernels.records import I2, NU_START, OSCILLATOR_FREQUENCY, OSCILLATOR_MASS, PHI_START


@kernel
def first_slot(s, i):
    """Slot of the first oscillator on bar i."""
    return s.dof_bath + (i - s.start) * (2 * s.oscillators + s.torsionals)


@kernel
def torsional_slot(s, i):
    """Slot of the first torsional oscillator on bar i."""
    return first_slot(s, i) + 2 * s.oscillators


@kernel
def bar_angle(model, s, i, t, q):
    """phi of one bar: a coordinate where it is free, uniform where it is clamped."""
    if s.dof_phi >= 0:
        return q[s.dof_phi + i - s.start]
    c = column_of_constants(s, i)
    return model.constants[PHI_START, c] + model.constants[NU_START, c] * lane_of(t, i)


@kernel
def pull(table, first, count, q, start, centre):
    """Force of oscillators `first` on of a table, from slot `start` on, on what is at `centre`."""
    force = broadcast(0.0)
    for m in range(0, count, LANES):
        w = block(table[OSCILLATOR_FREQUENCY], first + m)
        stiffness = block(table[OSCILLATOR_MASS], first + m) * w * w
        force = force + stiffness * (block(q, start + m) - centre)
    return sum_of_lanes(force)


@kernel
def oscillate(table, first, count, q, start, centre, acceleration):
    """Set q'' of oscillators about a place."""
    for m in range(0, count, LANES):
        w = block(table[OSCILLATOR_FREQUENCY], first + m)
        set_block(acceleration, start + m, -w * w * (block(q, start + m) - centre))


@kernel
def oscillator_energy(table, first, count, q, v, start, centre):
    """Energy of oscillators about a place."""
    energy = broadcast(0.0)
    for m in range(0, count, LANES):
        away = block(table[OSCILLATOR_FREQUENCY], first + m) * (block(q, start + m) - centre)
        rate = block(v, start + m)
        mass = block(table[OSCILLATOR_MASS], first + m)
        energy = energy + 0.5 * mass * (rate * rate + away * away)
    return sum_of_lanes(energy)


@kernel
def oscillator_kinetic(table, first, count, v, start):
    """Kinetic energy of oscillators."""
    energy = broadcast(0.0)
    for m in range(0, count, LANES):
        rate = block(v, start + m)
        energy = energy + 0.5 * block(table[OSCILLATOR_MASS], first + m) * rate * rate
    return sum_of_lanes(energy)


@kernel
def oscillator_momentum(table, first, count, v, start):
    """Momentum of oscillators."""
    momentum = broadcast(0.0)
    for m in range(0, count, LANES):
        mass = block(table[OSCILLATOR_MASS], first + m)
        momentum = momentum + mass * block(v, start + m)
    return sum_of_lanes(momentum)


@kernel
def bath_forces(model, bath, q, acceleration):
    """Set q'' of the bath oscillators, and add their forces on the bars."""
    if bath is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_oscillator
            count = s.oscillators
            if count > 0:
                for i in range(s.start, s.end):
                    for axis in range(2):
                        slot = first_slot(s, i) + axis * count
                        bar = model.displaced[axis, i]
                        model.internal[axis, i] += pull(bath, first, count, q, slot, bar)
                        oscillate(bath, first, count, q, slot, bar, acceleration)


@kernel
def torsional_torque(model, torsional, s, i, t, q):
    """Torque of the torsional oscillators on bar i."""
    phi = bar_angle(model, s, i, t, q)
    return pull(torsional, s.first_torsional, s.torsionals, q, torsional_slot(s, i), phi)


@kernel
def torsional_accelerations(model, torsional, t, q, acceleration):
    """Set q'' of the torsional oscillators, and add their torque on the bars."""
    if torsional is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_torsional
            count = s.torsionals
            if count > 0:
                for i in range(s.start, s.end):
                    phi = bar_angle(model, s, i, t, q)
                    oscillate(torsional, first, count, q, torsional_slot(s, i), phi, acceleration)
                    torque = torsional_torque(model, torsional, s, i, t, q)
                    inertia = model.constants[I2, column_of_constants(s, i)]
                    acceleration[s.dof_phi + i - s.start] += torque / inertia


@kernel
def set_bath_momenta(model, bath, v):
    """Set the momentum of the bath on each bar, in the surface's first frame."""
    if bath is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_oscillator
            count = s.oscillators
            if count > 0:
                for i in range(s.start, s.end):
                    slot = first_slot(s, i)
                    for axis in range(2):
                        momentum = oscillator_momentum(bath, first, count, v, slot + axis * count)
                        model.bath_momentum[axis, i] = momentum
