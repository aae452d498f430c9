"""All forces, contacts and accelerations at given positions: nothing moves."""

from typing import NamedTuple

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, broadcast
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.units import call_unit
from tribo.kernels import equations_of_motion as equations
from tribo.kernels import records as rows
from tribo.kernels.contact import contact_energy
from tribo.kernels.contact_forces import contact_forces
from tribo.kernels.kinematics import end_force
from tribo.kernels.neighbours import crowded
from tribo.kernels.packs import ONE_RUN, absent, constant, set_vectors, vectors, vectors_if_any
from tribo.kernels.powers import held_torques
from tribo.kernels.samples import PULL_X, PULL_Y

# Tables of what is found, of vectors: contact, contact within, fields, drive, springs, bath, left
# and right end, friction, the acceleration of the swing in its first row, and the constraint of a
# rigid body.
F1, WITHIN, FIELD, F2, SPRING, BATH, LEFT, RIGHT, FRICTION, SWING, BLOCK = range(11)
TABLES = 11


@inlined
def add_bath(internal, found, baths, i):
    """Note the springs' forces on a pack of bars, and add the recorded ones of the bath."""
    x, y = vectors_if_any(internal, i)
    set_vectors(found[SPRING], i, x, y)
    if not absent(internal):
        if baths.shape[0] > 0:
            pull_x = pack(baths[PULL_X], i)
            pull_y = pack(baths[PULL_Y], i)
            set_vectors(found[BATH], i, pull_x, pull_y)
            set_vectors(internal, i, x + pull_x, y + pull_y)


@kernel
def set_ends(model, left, right, s, i, t, q, found):
    """Set f_L and f_R on a pack of bars: of clamps, or of a plug-in."""
    if s.dof_phi < 0:
        phi = equations.bar_angles(model, s, i, t, q)
        torque = held_torques(model, s, i, phi, q)
        x, y = end_force(torque, constant(model, rows.INVERSE_BAR_LENGTH, s, i), *sine_cosine(phi))
        set_vectors(found[LEFT], i, x, y)
        set_vectors(found[RIGHT], i, -x, -y)
    if not absent(left):
        if s.user_ends == 1:
            set_vectors(found[LEFT], i, *vectors(left, i))
            set_vectors(found[RIGHT], i, *vectors(right, i))


@kernel
def note_forces(model, s, i, t, q, acceleration, found):
    """Set what is found of a pack, forces and accelerations in place."""
    set_vectors(found[F1], i, *vectors(model.f1, i))
    set_vectors(found[WITHIN], i, *vectors_if_any(model.inner, i))
    set_vectors(found[FIELD], i, *vectors_if_any(model.external, i))
    set_vectors(found[F2], i, *vectors(model.drive, i))
    set_vectors(found[FRICTION], i, *vectors_if_any(model.friction, i))
    set_ends(model, model.left, model.right, s, i, t, q, found)
    set_pack(found[SWING, 0], i, pack(acceleration, i))
    if s.block > 0:
        x, y = vectors(model.internal, i)
        spring_x, spring_y = vectors(found[SPRING], i)
        bath_x, bath_y = vectors(found[BATH], i)
        set_vectors(found[BLOCK], i, x - spring_x - bath_x, y - spring_y - bath_y)


class Sampled(NamedTuple):
    """Samples in which forces are found."""

    times: np.ndarray  # (times,)
    y: np.ndarray  # (times, 2 coordinates), as in `kernels.samples.Record`
    baths: np.ndarray  # likewise
    places: np.ndarray  # (coordinates,) where kernels have them


class Motion(NamedTuple):
    """Scratch for the motion in one sample."""

    q: np.ndarray  # (coordinates of kernels,)
    v: np.ndarray
    acceleration: np.ndarray


def force_probe(model, neighbours, begin, samples, motion, found):
    """Find the forces in one sample after another, from `begin` on, (times, TABLES, 2, n).

    Returns the number of the samples that are done: fewer than all where the neighbour list needs
    more room.
    """
    places = samples.places
    q, v, acceleration = motion
    for k in range(begin, samples.times.size):
        t = broadcast(samples.times[k])
        for m in range(places.size):
            q[places[m]] = samples.y[k, m]
            v[places[m]] = samples.y[k, places.size + m]
        if not equations.update_neighbours(model, neighbours, t, q):
            return k
        equations.all_forces(model, neighbours, t, q, v)
        for j in range(model.surfaces.shape[0]):
            s = model.surfaces[j]
            for i in range(s.start, s.stop, LANES):
                add_bath(model.internal, found[k], samples.baths[k], i)
        equations.join_blocks(model, t, q, v)
        equations.accelerate(model, 1.0, t, q, acceleration)
        for j in range(model.surfaces.shape[0]):
            s = model.surfaces[j]
            for i in range(s.start, s.stop, LANES):
                note_forces(model, s, i, t, q, acceleration, found[k])
    return samples.times.size


def contact_probe(model, neighbours, begin, columns, positions, charges, energies, found):
    """Compute the contact energy, and the force on every bob, of arrangements from `begin` on.

    Returns the number of those that are done: fewer than all where the neighbour list needs more
    room.  columns (n,) of the bobs, positions (k, n, 3), charges (k, n), energies (k,), and
    the forces `found` (k, n, 2).
    """
    bobs = model.bobs
    for k in range(begin, positions.shape[0]):
        for m in range(columns.size):
            i = columns[m]
            bobs[rows.X, i] = positions[k, m, 0]
            bobs[rows.Y, i] = positions[k, m, 1]
            model.each[rows.Z, i] = positions[k, m, 2]
            model.each[rows.CHARGE, i] = charges[k, m]
            model.f1[rows.X, i] = 0.0
            model.f1[rows.Y, i] = 0.0
        if neighbours.reach.size > 0:
            call_unit(model.units[rows.REBUILD], (model, neighbours))
        if crowded(neighbours):
            return k
        contact_forces(model, neighbours)
        energies[k] = contact_energy(model, neighbours, ONE_RUN)
        for m in range(columns.size):
            found[k, m, 0] = model.f1[rows.X, columns[m]]
            found[k, m, 1] = model.f1[rows.Y, columns[m]]
    return positions.shape[0]


def acceleration_probe(model, neighbours, begin, t, q, v, acceleration):
    """Compute q'' of all coordinates; returns 1, or `begin`, 0, where the list needs more room."""
    if not equations.update_neighbours(model, neighbours, broadcast(t), q):
        return begin
    equations.equations_of_motion(model, neighbours, t, q, v, acceleration)
    return 1
