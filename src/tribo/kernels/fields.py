"""External fields: their forces on the bobs, and their energy, bobs in place."""

from numba import literal_unroll

from tribo.kernels.blocks import clear
from tribo.kernels.compiled import kernel
from tribo.kernels.records import ALONG_X, ALONG_Y, X, Y


@kernel
def field_shift(field, t):
    """Position in the field's own frame minus position in the scene."""
    return (
        field.origin[0] + field.velocity[0] * t,
        field.origin[1] + field.velocity[1] * t,
    )


@kernel
def field_forces(model, fields, t):
    """Set the force of the external fields on the bobs."""
    if fields is not None:
        clear(model.external)
        for field in literal_unroll(fields):
            shift_x, shift_y = field_shift(field, t)
            for k in range(field.surfaces.shape[0]):
                s = model.surfaces[field.surfaces[k]]
                for i in range(s.start, s.end):
                    x = model.bobs[X, i] + shift_x
                    y = model.bobs[Y, i] + shift_y
                    fx, fy = field.potential.force_at(x, y)
                    model.external[ALONG_X, i] += fx
                    model.external[ALONG_Y, i] += fy


@kernel
def field_energy(model, fields, t):
    """Potential energy of the bobs in the external fields, bobs in place."""
    energy = 0.0
    if fields is not None:
        for field in literal_unroll(fields):
            shift_x, shift_y = field_shift(field, t)
            for k in range(field.surfaces.shape[0]):
                s = model.surfaces[field.surfaces[k]]
                for i in range(s.start, s.end):
                    x = model.bobs[X, i] + shift_x
                    y = model.bobs[Y, i] + shift_y
                    energy += field.potential.energy_at(x, y)
    return energy
