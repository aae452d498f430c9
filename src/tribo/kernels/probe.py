"""Contacts and accelerations at given positions: nothing moves."""

from tribo.kernels.contact import contact_energy
from tribo.kernels.contact_forces import contact_forces
from tribo.kernels.equations_of_motion import equations_of_motion, update_neighbours
from tribo.kernels.neighbours import crowded, rebuild
from tribo.kernels.records import CHARGE, FX, FY, X, Y, Z


def contact_probe(model, neighbours, begin, columns, positions, charges, energies, forces):
    """Compute the contact energy, and the force on every bob, of arrangements from `begin` on.

    Returns the number of those that are done: fewer than all where the neighbour list needs more
    room.  columns (n,) of the bobs, positions (k, n, 3), charges (k, n), energies (k,), forces
    (k, n, 2).
    """
    bobs = model.bobs
    for k in range(begin, positions.shape[0]):
        for m in range(columns.size):
            i = columns[m]
            bobs[X, i] = positions[k, m, 0]
            bobs[Y, i] = positions[k, m, 1]
            model.each[Z, i] = positions[k, m, 2]
            model.each[CHARGE, i] = charges[k, m]
            bobs[FX, i] = 0.0
            bobs[FY, i] = 0.0
        if neighbours is not None:
            rebuild(model, neighbours)
        if crowded(neighbours):
            return k
        contact_forces(model, neighbours)
        energies[k] = contact_energy(model, neighbours, None)
        for m in range(columns.size):
            forces[k, m, 0] = bobs[FX, columns[m]]
            forces[k, m, 1] = bobs[FY, columns[m]]
    return positions.shape[0]


def acceleration_probe(model, neighbours, begin, t, q, v, acceleration):
    """Compute q'' of all coordinates.

    Returns 1, or `begin`, which is 0, where the neighbour list needs more room.
    """
    if not update_neighbours(model, neighbours, t, q):
        return begin
    equations_of_motion(model, neighbours, t, q, v, acceleration)
    return 1
