"""External fields: their forces on the bobs, and their energy, bobs in place."""

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import broadcast
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.compiler.units import call_unit, fetched
from tribo.kernels.packs import clear, column_range
from tribo.kernels.records import X, Y
from tribo.kernels.schedule import number_or_scheduled


@inlined
def factor_of_field(model, n, t):
    """The factor on the nth field at a time, as Lanes."""
    return number_or_scheduled(model.schedules, model.fields.modulation[n], broadcast(1.0), t)


@kernel
def field_shift(fields, n, t):
    """Position in a field's own frame minus position in the scene; Lanes if t is."""
    x = fields.origin[n, X] + fields.velocity[n, X] * t
    y = fields.origin[n, Y] + fields.velocity[n, Y] * t
    return x, y


@inlined
def force_at(potential, t, x, y):
    return potential.force_at(x, y)


@inlined
def energy_at(potential, t, x, y):
    return potential.energy_at(x, y)


@inlined
def force_at_time(potential, t, x, y):
    return potential.force_at_time(t, x, y)


@inlined
def energy_at_time(potential, t, x, y):
    return potential.energy_at_time(t, x, y)


@inlined
def add_field_forces(model, potential, n, t, force):
    """Add the forces of the nth field on the bobs; `force` calls the method of the potential."""
    potential = fetched(potential)
    fields = model.fields
    shift_x, shift_y = field_shift(fields, n, t)
    factor = factor_of_field(model, n, t)
    for k in range(fields.first[n], fields.first[n + 1]):
        s = model.surfaces[fields.surfaces[k]]
        for i in range(s.start, s.end):
            x = model.bobs[X, i] + lane_of(shift_x, i)
            y = model.bobs[Y, i] + lane_of(shift_y, i)
            fx, fy = force(potential, lane_of(t, i) - fields.begun[n], x, y)
            if fields.modulation[n] > 0:
                now = lane_of(factor, i)
                fx = now * fx
                fy = now * fy
            model.external[X, i] += fx
            model.external[Y, i] += fy
    return 0.0


def field_forces_unit(model, potential, n, t):
    """Add the forces of the nth field on the bobs."""
    return add_field_forces(model, potential, n, t, force_at)


def timed_forces_unit(model, potential, n, t):
    """The same of a field that depends on time."""
    return add_field_forces(model, potential, n, t, force_at_time)


@inlined
def energy_in_field(model, potential, n, t, lane, energy_of):
    """Energy of the bobs of one member, or of all where `lane` is None, in the nth field."""
    potential = fetched(potential)
    energy = 0.0
    shift_x, shift_y = field_shift(model.fields, n, t)
    for k in range(model.fields.first[n], model.fields.first[n + 1]):
        s = model.surfaces[model.fields.surfaces[k]]
        for i in range(*column_range(s, lane)):
            x = model.bobs[X, i] + shift_x
            y = model.bobs[Y, i] + shift_y
            energy += energy_of(potential, t - model.fields.begun[n], x, y)
    if model.fields.modulation[n] > 0:
        energy = lane_of(factor_of_field(model, n, t), 0) * energy
    return energy


def field_energy_unit(model, potential, n, t, lane):
    """Energy of the bobs in the nth field, for `lane` of one member."""
    return energy_in_field(model, potential, n, t, lane, energy_at)


def timed_energy_unit(model, potential, n, t, lane):
    """The same of a field that depends on time."""
    return energy_in_field(model, potential, n, t, lane, energy_at_time)


@apart
def field_forces(model, t):
    """Set the forces of all external fields on the bobs."""
    fields = model.fields
    if fields.forces.size > 0:
        clear(model.external)
        for n in range(fields.forces.size):
            call_unit(fields.forces[n], (model, fields.numbers[n], n, t))


@kernel
def field_energy(model, t, lane):
    """Potential energy of the bobs in the external fields, bobs in place, for `lane` of one run."""
    fields = model.fields
    energy = 0.0
    for n in range(fields.energy.size):
        energy += call_unit(fields.energy[n], (model, fields.numbers[n], n, t, lane))
    return energy
