"""Baths on frozen bars, in the substep of splitting methods between two half kicks.

Every oscillator rotates exactly about its bar, which takes up the opposite momentum.  The bath adds
its own work, by the mean of the velocities before and after.  Reservoirs act between two halves of
these rotations; see `reservoirs`.
"""

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes, with_lane
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.integrators.bar_pushes import push_bars
from tribo.integrators.jumps import add_bath_works_of_jumps, reservoirs_of
from tribo.integrators.rotations import changes, rotation_of, set_rotations
from tribo.kernels.accounts import place_of
from tribo.kernels.baths import oscillators_of
from tribo.kernels.packs import absent, column_of_constants, halves, set_vectors, vectors
from tribo.kernels.records import I2, OSCILLATOR_FREQUENCY, OSCILLATOR_MASS, X, Y


@inlined
def rotate_oscillators(q, v, k, centre, turn):
    """Rotate eight oscillators about a place; returns their rates, and how these changed."""
    x = pack(q, k)
    rate = pack(v, k)
    change, change_of_rate = changes(x - centre, rate, turn)
    rate = rate + change_of_rate
    set_pack(q, k, x + change)
    set_pack(v, k, rate)
    return rate, change_of_rate


@inlined
def rotate_along_axis(bath, oscillators, place, q, v, rotations):
    """Rotate a bar's oscillators along an axis about its place there; their momentum after it."""
    first, count, slot = oscillators
    momentum = broadcast(0.0)
    for m in range(0, count, LANES):
        turn = rotation_of(rotations, first + m)
        rate, _ = rotate_oscillators(q, v, slot + m, place, turn)
        momentum = momentum + pack(bath[OSCILLATOR_MASS], first + m) * rate
    return sum_of_lanes(momentum)


@kernel
def rotate_bath_of(model, bath, s, i, q, v, rotations):
    """Rotate the oscillators of bar i; returns their momentum after it.

    One axis after the other: the processor has too few registers for both.
    """
    first, count, slot = oscillators_of(s, i, 0)
    along_x = first, count, slot
    along_y = first, count, slot + count
    px = rotate_along_axis(bath, along_x, model.displaced[X, i], q, v, rotations)
    py = rotate_along_axis(bath, along_y, model.displaced[Y, i], q, v, rotations)
    return px, py


@apart
def rotate_bath(model, bath, reservoirs, tau, q, v, accounts, rotations):
    """Rotate the oscillators of all bars, which take up the opposite momentum."""
    if not absent(bath):
        set_rotations(bath[OSCILLATOR_FREQUENCY], tau, rotations)
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.oscillators > 0:
                for first in range(s.start, s.stop, LANES):
                    after_x = broadcast(0.0)
                    after_y = broadcast(0.0)
                    for i in range(first, min(first + LANES, s.end)):
                        px, py = rotate_bath_of(model, bath, s, i, q, v, rotations)
                        after_x = with_lane(after_x, i - first, px)
                        after_y = with_lane(after_y, i - first, py)
                    before_x, before_y = vectors(model.bath_momentum, first)
                    set_vectors(model.bath_momentum, first, after_x, after_y)
                    lost_x, lost_y = before_x - after_x, before_y - after_y
                    push_bars(model, s, first, lost_x, lost_y, v, accounts, s.acc_internal)
                    add_bath_works_of_jumps(model, reservoirs, s, first, lost_x, lost_y, accounts)


@apart
def rotate_torsional(model, torsional, tau, q, v, accounts, rotations):
    """Rotate all torsional oscillators exactly; the bars take up the opposite angular momentum."""
    if not absent(torsional):
        set_rotations(torsional[OSCILLATOR_FREQUENCY], tau, rotations)
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.torsionals > 0:
                account = s.acc_internal + 2 * s.account_stride
                for i in range(s.start, s.end):
                    first, count, slot = oscillators_of(s, i, 2)
                    j = s.dof_phi + i - s.start
                    gain = broadcast(0.0)
                    for m in range(0, count, LANES):
                        turn = rotation_of(rotations, first + m)
                        _, change = rotate_oscillators(q, v, slot + m, q[j], turn)
                        gain = gain + pack(torsional[OSCILLATOR_MASS], first + m) * change
                    gained = sum_of_lanes(gain)
                    nu = v[j]
                    v[j] -= gained / model.constants[I2, column_of_constants(s, i)]
                    if s.acc_internal >= 0:
                        accounts[place_of(s, account, i)] -= gained * 0.5 * (nu + v[j])


def rotate_baths(model, tau, part, state, work, m):
    """Rotate the oscillators of baths for a `part` of the mth kick, which lasts `tau`.

    Oscillators of bars and torsional ones have no coordinate in common: their order is arbitrary.
    """
    q, v = halves(state.y)
    reservoirs = reservoirs_of(work.before, state, tau)
    rotate_bath(model, model.bath, reservoirs, part, q, v, state.s, work.bath[m])
    rotate_torsional(model, model.torsional, part, q, v, state.s, work.torsional[m])
    return 0.0
