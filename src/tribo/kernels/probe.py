"""A look at contacts by themselves: bobs are put in given places, and nothing moves."""

from tribo.kernels.contact import contact_energy, contact_forces


def contact_probe(model, places, charges, energies, forces):
    """Fill in the contact energy, and the force on every bob, of one arrangement after another.

    places (k, n, 3), charges (k, n), energies (k,), forces (k, n, 2).
    """
    bobs = model.bobs
    for k in range(places.shape[0]):
        for i in range(bobs.shape[0]):
            b = bobs[i]
            b.x = places[k, i, 0]
            b.y = places[k, i, 1]
            b.z = places[k, i, 2]
            b.charge = charges[k, i]
            b.fx = 0.0
            b.fy = 0.0
        contact_forces(model, None)
        energies[k] = contact_energy(model, None)
        for i in range(bobs.shape[0]):
            forces[k, i, 0] = bobs[i].fx
            forces[k, i, 1] = bobs[i].fy
