"""Inactive packs of asperites: out of reach of all others, and not stepped.

Where bars keep their uniform motion and nothing but contact acts, an asperite without contact
swings on its torsion spring alone, and one drift is exact for any time.  Such packs are left out
of the loops over packs; they drift before they can come within reach, and for each sample.

A pack is inactive while its bobs, wherever they may swing, are farther from all others than the
list of neighbours reaches, by a margin.  When the list is rebuilt, and two bobs can have moved by
the margin towards each other, the active packs are selected again.
"""

import numpy as np

from tribo.compiler.jit import apart, inlined, kernel, owning_kernel
from tribo.compiler.lanes import LANES, broadcast, maximum, sqrt, where_less
from tribo.compiler.lanes_memory import pack
from tribo.compiler.units import call_unit
from tribo.integrators.drift import drift_pack
from tribo.integrators.rotations import rotation
from tribo.kernels.cells import near_packs, set_boxes, sort_boxes
from tribo.kernels.equations_of_motion import bar_angles
from tribo.kernels.neighbours import have_crossed, inactive_have_crossed, keep_places
from tribo.kernels.packs import constant, halves
from tribo.kernels.records import ADVANCE_INACTIVE, FREQUENCY, L1, MAKE_LISTS, REBUILD


@apart
def update_lists(model, neighbours, active, t, state):
    """Rebuild the list of neighbours after a drift in which bobs have moved too far."""
    if neighbours.reach.size > 0:
        age = t - neighbours.listed[0]
        crossed = neighbours.crossed[0] == 1
        if crossed or inactive_have_crossed(model, active, neighbours.skin, age):
            make_lists(model, neighbours, t, state)


@inlined
def make_lists(model, neighbours, t, state):
    """Build the list of neighbours for the bobs where they are."""
    call_unit(model.units[MAKE_LISTS], (model, neighbours, t, state))


def make_lists_unit(model, neighbours, t, state):
    """The unit of :func:`make_lists`; selects active packs again if bobs have moved too far."""
    active = neighbours.active
    if active.packs.size > 0:
        if have_crossed(model, active, active.place, active.margin, t - active.selected[0]):
            advance_inactive(model, neighbours, t, state)
            set_active(model, neighbours, active, t, *halves(state.y))
            keep_places(model, active.place)
            active.selected[0] = t
    call_unit(model.units[REBUILD], (model, neighbours))
    neighbours.listed[0] = t
    return 0.0


@inlined
def advance_inactive(model, neighbours, t, state):
    """Let all inactive packs, if there are any, drift to the time t."""
    if neighbours.active.packs.size > 0:
        call_unit(model.units[ADVANCE_INACTIVE], (model, neighbours, t, state))


def advance_inactive_unit(model, neighbours, t, state):
    """The unit of :func:`advance_inactive`."""
    active = neighbours.active
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if active.eligible[k] == 1:
            for i in range(s.start, s.stop, LANES):
                tau = t - active.since[i // LANES]
                if abs(tau) > 0.0:  # nan for active packs
                    turn = rotation(constant(model, FREQUENCY, s, i), tau)
                    drift_pack(model, s, i, t, tau, state, turn)
                    active.since[i // LANES] = t
    return 0.0


@owning_kernel
def set_active(model, neighbours, active, t, q, v):
    """Set the active packs: those within reach of others, and those that cannot be inactive."""
    wanted = np.zeros(active.since.size, np.int8)
    for k in range(neighbours.reach.size):
        mark_pair(model, neighbours, active, k, t, q, v, wanted)
    n = 0
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        active.first[k] = n
        for m in range(s.start // LANES, s.stop // LANES):
            active.since[m] = t
            if wanted[m] == 1 or active.eligible[k] == 0:
                active.since[m] = np.nan
                active.packs[n] = m
                n += 1
    active.first[model.surfaces.shape[0]] = n


@owning_kernel
def mark_pair(model, neighbours, active, k, t, q, v, wanted):
    """Mark the packs of the kth pair of surfaces that are within reach of each other."""
    one = model.surfaces[neighbours.pairs[k, 0]]
    other = model.surfaces[neighbours.pairs[k, 1]]
    reach = neighbours.reach[k] + active.margin
    own = neighbours.own
    boxes = neighbours.others
    cells = neighbours.cells
    set_boxes_of_paths(model, active, neighbours.pairs[k, 0], t, q, v, own)
    set_boxes_of_paths(model, active, neighbours.pairs[k, 1], t, q, v, boxes)
    sort_boxes(model.box, own, boxes, reach, cells)
    near = np.empty(active.since.size, np.int64)
    for m in range((one.stop - one.start) // LANES):
        count = near_packs(model.box, own, m, boxes, reach, cells, near)
        for n in range(count):
            wanted[one.start // LANES + m] = 1
            wanted[other.start // LANES + near[n]] = 1


@kernel
def set_boxes_of_paths(model, active, k, t, q, v, boxes):
    """Set boxes around all packs of a surface, and around the paths of inactive bobs."""
    set_boxes(model, None, k, boxes)
    if active.eligible[k] == 1:
        s = model.surfaces[k]
        for m in range(boxes.count[0]):
            path = maximum(longest_paths(model, s, s.start + LANES * m, t, q, v))
            boxes.halves[0, m] += path
            boxes.halves[1, m] += path


@kernel
def longest_paths(model, s, i, t, q, v):
    """Bounds on the distances that free swings carry a pack of bobs from where they are.

    A swing of amplitude A goes by an angle of up to 2 A, and no bob goes farther than the diameter
    of its circle, as it may without a torsion spring.
    """
    if s.fixed > 0:
        return broadcast(0.0)
    diameter = 2.0 * constant(model, L1, s, i)
    if s.dof_phi >= 0:
        return diameter
    frequency = constant(model, FREQUENCY, s, i)
    twist = pack(q, i) - bar_angles(model, s, i, t, q)
    rate = where_less(0.0, frequency, pack(v, i) / frequency, 1.0)
    amplitude = sqrt(twist * twist + rate * rate)
    return diameter * where_less(amplitude, 1.0, amplitude, 1.0)
