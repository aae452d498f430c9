"""What a page shows of rows and grids, from the samples of a time loop.

The formulas are those of :mod:`tribo.ledger`, summed over the asperites of a surface;
``tests/live_pages`` compares both.
"""

from typing import Any, NamedTuple

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import broadcast
from tribo.kernels import equations_of_motion as equations
from tribo.kernels.records import BARS
from tribo.kernels.samples import BATH, MOMENTUM_X, MOMENTUM_Y, SPRINGS, TORSIONAL, WITHIN
from tribo.live_pages.accounts import Energies, Powers, dimension_of
from tribo.live_pages.lattice_asperite import (
    OBSERVER_X,
    OBSERVER_Y,
    VELOCITIES,
    Frame,
    Works,
    quantities_of,
)
from tribo.live_pages.lattice_loop import leg_at, set_leg
from tribo.live_pages.limits import largest
from tribo.live_pages.program import pool, widen
from tribo.live_pages.quantities import put


class BarsAndBaths(NamedTuple):
    """Energies of a surface's bars, springs and bath.

    energy_bath is all energy of the bath in the observer's frame, k_bath + e_bath of a ledger.
    """

    k_bar: Any
    e_springs: Any
    energy_bath: Any
    heat_bath: Any


class OfWhole(NamedTuple):
    """Quantities of the system."""

    contact_energy: Any
    field_energy: Any
    total_energy_change: Any
    applied_work: Any


# Names of the quantities of a surface, in the order of rows: sums over its asperites.
OF_SURFACE = (*Works._fields, *Energies._fields, *Powers._fields, *BarsAndBaths._fields)
MEMBERS = len(OF_SURFACE)
WHOLE = len(OfWhole._fields)
W_PS, DELTA_K, DELTA_E_INT, K_BAR, E_SPRINGS, ENERGY_BATH, HEAT_BATH = (
    OF_SURFACE.index(name) for name in ("W_ps", "delta_K", "delta_E_int", *BarsAndBaths._fields)
)
# Those of which the change since the start is shown.
CHANGES = tuple(
    OF_SURFACE.index(name)
    for name in ("delta_k_trans", "delta_e_int", "W_ps", "delta_K", "delta_E_int", "heat_bath")
)
APPLIED = tuple(OF_SURFACE.index(name) for name in ("w2", "wL", "wR"))


def dimensions_of(surfaces: int) -> list[int]:
    """The places among DIMENSIONS of the quantities of so many surfaces and of the whole."""
    return list(map(dimension_of, (*surfaces * OF_SURFACE, *OfWhole._fields)))


@inlined
def add(values, series, place, k):
    """Add to rows from a place on in a sample; returns the place behind them."""
    for value in values:
        series[place, k] += value
        place += 1
    return place


@kernel
def add_surface(model, scene, samples, n, k, series, drawn):
    """Add the quantities of the asperites of the nth surface; returns their momentum.

    It is that in the surface's first frame; with it goes the observer's view of that frame.
    """
    at = VELOCITIES + 2 * n
    frame = Frame(
        scene.numbers[at] - scene.numbers[OBSERVER_X],
        scene.numbers[at + 1] - scene.numbers[OBSERVER_Y],
    )
    px = py = 0.0
    for i in range(scene.asperites.shape[0]):
        if scene.asperites[i].surface != n:
            continue
        each = quantities_of(model, scene, samples, i, k, frame)
        place = add(each.works, series, n * MEMBERS, k)
        place = add(each.energies, series, place, k)
        add(each.powers, series, place, k)
        series[n * MEMBERS + K_BAR, k] += each.k_bar
        for row, value in enumerate(each.drawn):
            drawn[row, k, i] = value
        px += each.momentum[0]
        py += each.momentum[1]
    return frame, (px, py)


@inlined
def boosted(stored, mass, vx, vy):
    """What a bath of a mass has more of energy where it moves faster by a velocity."""
    common = vx * stored[MOMENTUM_X] + vy * stored[MOMENTUM_Y]
    return common + 0.5 * mass * (vx * vx + vy * vy)


@kernel
def bulk(scene, samples, index, k, frame, momentum, first, series):
    """Set what a surface has as a whole, from the momentum of its asperites in its first frame."""
    surface = scene.surfaces[index]
    stored = samples.stored[k, index]
    mass = surface.total_mass
    lag_x = (momentum[0] + stored[MOMENTUM_X]) / mass
    lag_y = (momentum[1] + stored[MOMENTUM_Y]) / mass
    moving = 0.5 * mass * (lag_x * lag_x + lag_y * lag_y)
    bath = stored[BATH] + stored[TORSIONAL]
    series[first + DELTA_K, k] = mass * (frame.vx * lag_x + frame.vy * lag_y) + moving
    series[first + DELTA_E_INT, k] += stored[SPRINGS] + stored[WITHIN] + bath - moving
    series[first + E_SPRINGS, k] = stored[SPRINGS]
    mass_of_bath = mass - surface.mass
    series[first + ENERGY_BATH, k] = bath + boosted(stored, mass_of_bath, frame.vx, frame.vy)
    if surface.drive == BARS:
        series[first + HEAT_BATH, k] = bath
    else:  # in the motion with the surface
        series[first + HEAT_BATH, k] = bath + boosted(stored, mass_of_bath, -lag_x, -lag_y)
    if surface.acc_block >= 0:
        series[first + W_PS, k] += samples.s[k, surface.acc_block]
    elif surface.drive == BARS:  # a constraint provides the change of momentum
        series[first + W_PS, k] += moving


@apart
def set_forces(model, neighbours, legs, samples, k, q, v):
    """Set all forces in sample k."""
    places = samples.places
    half = places.size // 2
    for m in range(half):
        q[places[m]] = samples.y[k, m]
        v[places[m]] = samples.y[k, half + m]
    t = samples.times[k]
    set_leg(model, legs, leg_at(legs, t))
    now = broadcast(t)
    equations.update_neighbours(model, neighbours, now, q)
    equations.all_forces(model, neighbours, now, q, v)
    equations.join_blocks(model, now, q, v)


@kernel
def set_changes(series, surfaces, count):
    """Let quantities that are changes be zero at the start."""
    for n in range(surfaces):
        for name in CHANGES:
            row = series[n * MEMBERS + name]
            begin = row[0]
            for k in range(count):
                row[k] -= begin


@kernel
def whole_of(scene, samples, k, series):
    """The quantities of the system, from those of surfaces, whose changes are set."""
    change = samples.contact[k] - samples.contact[0] + samples.field[k] - samples.field[0]
    applied = 0.0
    for n in range(scene.surfaces.shape[0]):
        change += series[n * MEMBERS + DELTA_K, k] + series[n * MEMBERS + DELTA_E_INT, k]
        for name in APPLIED:
            applied += series[n * MEMBERS + name, k]
    for slot in scene.field_accounts:
        applied += samples.s[k, slot]
    return OfWhole(samples.contact[k], samples.field[k], change, applied)


def live_quantities(of_scene, scene, samples, scratch, clocks, reached, series, drawn):
    """Write all quantities of the samples that a run `reached` (1,) in `series` (rows, times).

    `of_scene` has the model and the neighbours.  `drawn` (rows of
    :class:`tribo.live_pages.lattice_asperite.Drawn`, times, asperites) has what is drawn.
    """
    model, neighbours = of_scene
    q, v = scratch
    count = clocks[0].sample
    reached[0] = count
    surfaces = scene.surfaces.shape[0]
    series[:] = 0.0
    for k in range(count):
        set_forces(model, neighbours, scene.legs, samples, k, q, v)
        for n in range(surfaces):
            frame, momentum = add_surface(model, scene, samples, n, k, series, drawn)
            bulk(scene, samples, n, k, frame, momentum, n * MEMBERS, series)
    set_changes(series, surfaces, count)
    for k in range(count):
        put(whole_of(scene, samples, k, series), series, surfaces * MEMBERS, k)
    return 0


def live_errors(series, other, reached, other_reached, dimension, errors, accuracy):
    """Set bounds on the errors from a run with steps twice as long, whose series are `other`.

    Returns 0 where none is above `accuracy` times the largest value of its dimension, else 1.

    A method of second order has three times less error than they differ, which
    :func:`tribo.live_pages.program.pool` takes three times, as for others.
    """
    errors[:] = 0.0
    count = reached[0]
    widen(series, other, count, other_reached[0], (1, 1), errors)
    pool(series, count, 1.0, dimension, other, errors)
    for name in range(series.shape[0]):
        scale = 0.0
        for each in range(series.shape[0]):
            if dimension[each] == dimension[name]:
                scale = max(scale, largest(series[each], count))
        if errors[name] > accuracy * scale:
            return 1
    return 0
