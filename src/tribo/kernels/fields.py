"""External fields: their forces on the bobs, and their energy, bobs in place."""

from numba import literal_unroll

from tribo.kernels.compiled import kernel


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
        bars = model.bars
        for i in range(bars.shape[0]):
            bars[i].ex = 0.0
            bars[i].ey = 0.0
        for field in literal_unroll(fields):
            shift_x, shift_y = field_shift(field, t)
            for k in range(field.surfaces.shape[0]):
                s = model.surfaces[field.surfaces[k]]
                for i in range(s.start, s.stop):
                    b = model.bobs[i]
                    fx, fy = field.potential.force_at(b.x + shift_x, b.y + shift_y)
                    d = model.bars[i]
                    d.ex += fx
                    d.ey += fy


@kernel
def field_energy(model, fields, t):
    """Potential energy of the bobs in the external fields, bobs in place."""
    energy = 0.0
    if fields is not None:
        for field in literal_unroll(fields):
            shift_x, shift_y = field_shift(field, t)
            for k in range(field.surfaces.shape[0]):
                s = model.surfaces[field.surfaces[k]]
                for i in range(s.start, s.stop):
                    b = model.bobs[i]
                    energy += field.potential.energy_at(b.x + shift_x, b.y + shift_y)
    return energy
