"""External fields: their forces on the bobs, and their energy, bobs in place."""

from numba import literal_unroll

from tribo.compiler.jit import kernel
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.kernels.blocks import clear, column_range
from tribo.kernels.records import X, Y


@kernel
def field_shift(field, t):
    """Position in the field's own frame minus position in the scene; Lanes if t is."""
    return (field.origin[0] + field.velocity[0] * t, field.origin[1] + field.velocity[1] * t)


@kernel
def field_forces(model, fields, t):
    if fields is not None:
        clear(model.external)
        for field in literal_unroll(fields):
            shift_x, shift_y = field_shift(field, t)
            for k in range(field.surfaces.shape[0]):
                s = model.surfaces[field.surfaces[k]]
                for i in range(s.start, s.end):
                    x = model.bobs[X, i] + lane_of(shift_x, i)
                    y = model.bobs[Y, i] + lane_of(shift_y, i)
                    fx, fy = field.potential.force_at(x, y)
                    model.external[X, i] += fx
                    model.external[Y, i] += fy


@kernel
def field_energy(model, fields, t, lane):
    """Potential energy of the bobs in the external fields, bobs in place, for `lane` of one run."""
    energy = 0.0
    if fields is not None:
        for field in literal_unroll(fields):
            shift_x, shift_y = field_shift(field, t)
            for k in range(field.surfaces.shape[0]):
                s = model.surfaces[field.surfaces[k]]
                start, stop, step = column_range(s, lane)
                for i in range(start, stop, step):  # with range(*...) literal_unroll fails
                    x = model.bobs[X, i] + shift_x
                    y = model.bobs[Y, i] + shift_y
                    energy += field.potential.energy_at(x, y)
    return energy
