"""Lists of the packs of eight bobs that may be within a cutoff of a bob.

A pack is computed as a whole, with loads of neighbours in memory; the bobs of a pack are
neighbours in their surface.  The list reaches a skin farther than the cutoff.  At each evaluation
of the forces it is rebuilt if two bobs together can have crossed the skin, so it never lacks a
pair, however far surfaces slide.

Threads share the rows of each pair of surfaces.  The rows are divided into chunks, whose number
depends on the scene alone.  Each chunk has an equal part of the room; the rows are then moved
together.  If a part is too small, one thread fills the rows again.
"""

import math

import numpy as np

from tribo.compiler.jit import apart, inlined, kernel, owning_kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.team import LISTS, PAIR, begin_phase, continue_phase, part_of
from tribo.compiler.units import call_unit
from tribo.kernels.cells import gap, near_packs, periods, set_boxes, sort_boxes
from tribo.kernels.kinematics import nearest_image
from tribo.kernels.packs import active_range, column_of, vectors
from tribo.kernels.records import REBUILD, X, Y, Z


@inlined
def image(difference, box, axis):
    """Separations from the nearest images along x (axis 0) or z (axis 1) of a box, if any."""
    if box is None:
        return difference
    return nearest_image(difference, box.x if axis == 0 else box.z)


@apart
def have_crossed(model, active, place, width, elapsed):
    """Whether two bobs can have moved by `width` towards each other since they were at `place`.

    Inactive packs move with their surface for the time `elapsed`.
    """
    crossed = broadcast(0.0)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for n in range(*active_range(active, s, k)):
            crossed = crossed + have_moved(model, place, width, column_of(active, n))
    return sum_of_lanes(crossed) > 0.0 or inactive_have_crossed(model, active, width, elapsed)


@inlined
def have_moved(model, place, width, i):
    """1 in the lanes of bobs of a pack that are not within half of `width` of `place`, else 0."""
    x, y = vectors(model.bobs, i)
    old_x, old_y = vectors(place, i)
    dx, dy = x - old_x, y - old_y
    return 1.0 - (dx * dx + dy * dy < 0.25 * width * width)


@apart
def inactive_have_crossed(model, active, width, elapsed):
    """Whether inactive packs have moved by half of `width` with their surfaces."""
    if active.packs.size > 0:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if active.eligible[k] == 1:
                if not (s.vx * s.vx + s.vy * s.vy) * (elapsed * elapsed) < 0.25 * width * width:
                    return True
    return False


@kernel
def keep_places(model, place):
    """Copy the places of all bobs, from which :func:`have_moved` measures."""
    for i in range(place.shape[1]):
        place[X, i] = model.bobs[X, i]
        place[Y, i] = model.bobs[Y, i]


@inlined
def has_lists(neighbours):
    """Whether any neighbours are listed."""
    return neighbours.reach.size > 0


@kernel
def is_empty(neighbours):
    """Whether the list has not been made since it was given room."""
    return neighbours.reach.size > 0 and math.isnan(neighbours.place[0, 0])


@kernel
def partner_species(species, kinds, i):
    """Species that bob i interacts with in a contact of two kinds: -1 is any, -2 none."""
    if species.size == 0 or kinds[0] < 0:
        return -1
    if species[i] == kinds[0]:
        return kinds[1]
    return kinds[0] if species[i] == kinds[1] else -2


@kernel
def is_partner(species, partners, j):
    """Whether bob j is of a species by `partner_species`."""
    return partners == -1 or species[j] == partners


@kernel
def fill_rows(start, row, stop, used):
    """Let rows up to `stop` begin at a place of the list; returns `stop`."""
    for empty in range(row, stop):
        start[empty] = used
    return stop


@owning_kernel
def list_rows(model, box, neighbours, k, begin, end, used, room):
    """Fill the rows of some active packs of the kth pair of surfaces, from `used` up to `room`.

    Returns the end of the list that they need.  Rows of inactive bobs before them are filled too:
    these are empty.  Within one surface a pair of bobs belongs to the row of the first.
    """
    mine = neighbours.pairs[k, 0]
    theirs = neighbours.pairs[k, 1]
    one = model.surfaces[mine]
    other = model.surfaces[theirs]
    active = neighbours.active
    xs = model.bobs[X]
    ys = model.bobs[Y]
    zs = model.each[Z]
    reach = neighbours.reach[k]
    start = neighbours.start
    box_x, box_z = periods(box)
    own = neighbours.own
    boxes = neighbours.others
    centres = boxes.centres
    halves = boxes.halves
    row = first_row(model, neighbours, k, begin)
    top = neighbours.pairs[k, 2] - one.start
    near = np.empty(boxes.count[0], np.int64)
    for own_pack in range(begin, end):
        count = near_packs(box, own, own_pack, boxes, reach, neighbours.cells, near)
        column = column_of(active, active_range(active, one, mine)[0] + own_pack)
        row = fill_rows(start, row, top + column, used)
        for i in range(column, min(column + LANES, one.end)):
            start[row] = used
            if partner_species(model.species, neighbours.species[k], i) != -2:
                for n in range(count):
                    m = near[n]
                    place = active_range(active, other, theirs)[0] + m
                    last = column_of(active, place) + LANES - 1
                    dx = gap(xs[i] - centres[0, m], halves[0, m], box_x)
                    dy = gap(ys[i] - centres[1, m], halves[1, m], 0.0)
                    dz = gap(zs[i] - centres[2, m], halves[2, m], box_z)
                    if last > i and dx * dx + dy * dy + dz * dz < reach * reach:
                        if used < room:
                            neighbours.index[used] = last // LANES
                        used += 1
            row += 1
    fill_rows(start, row, first_row(model, neighbours, k, end), used)
    return used


@kernel
def first_row(model, neighbours, k, n):
    """The first row that :func:`list_rows` fills with the nth active pack of a pair, if any."""
    one = model.surfaces[neighbours.pairs[k, 0]]
    row = neighbours.pairs[k, 2]
    if n == 0:
        return row
    if n == neighbours.own.count[0]:
        return row + one.end - one.start
    active = neighbours.active
    place = active_range(active, one, neighbours.pairs[k, 0])[0] + n
    return row + column_of(active, place) - one.start


@apart
def list_pair(model, team, neighbours, k, used):
    """Fill the rows of the kth pair of surfaces; returns the length of the list that it needs."""
    own = neighbours.own
    others = neighbours.others
    set_boxes(model, neighbours.active, neighbours.pairs[k, 0], own)
    set_boxes(model, neighbours.active, neighbours.pairs[k, 1], others)
    if own.count[0] == 0 or others.count[0] == 0:
        one = model.surfaces[neighbours.pairs[k, 0]]
        row = neighbours.pairs[k, 2]
        fill_rows(neighbours.start, row, row + one.end - one.start, used)
        return used
    sort_boxes(model.box, own, others, neighbours.reach[k], neighbours.cells)
    if team.counters.size > 0:
        if share_rows(model, team, neighbours, k, used):
            return join_chunks(model, team, neighbours, k, used)
    packs = own.count[0]
    first = np.int64(0)
    return list_rows(model, model.box, neighbours, k, first, packs, used, neighbours.index.size)


@apart
def share_rows(model, team, neighbours, k, used):
    """Fill the rows of a pair in chunks; whether the list has room for all of them.

    Chunks have equal parts of the room, or, where one of them needs more, as much as each needs.
    """
    team.counters[PAIR] = k
    chunks = team.lengths.size
    part = max(neighbours.index.size - used, 0) // chunks
    for chunk in range(chunks + 1):
        team.begins[chunk] = used + chunk * part
    while team.begins[chunks] <= neighbours.index.size:
        chunk = begin_phase(team, LISTS, chunks)
        while chunk >= 0:
            list_chunk(model, team, neighbours, chunk)
            chunk = continue_phase(team)
        fits = True
        for chunk in range(chunks):
            fits = fits and team.lengths[chunk] <= team.begins[chunk + 1] - team.begins[chunk]
        if fits:
            return True
        for chunk in range(chunks):
            team.begins[chunk + 1] = team.begins[chunk] + team.lengths[chunk]
    return False


@apart
def list_chunk(model, team, neighbours, chunk):
    """Fill the rows of a chunk of a pair's active packs; note their length."""
    k = team.counters[PAIR]
    begin, end = part_of(0, neighbours.own.count[0], chunk, team.lengths.size)
    first = team.begins[chunk]
    room = team.begins[chunk + 1]
    last = list_rows(model, model.box, neighbours, k, begin, end, first, room)
    team.lengths[chunk] = last - first


@apart
def join_chunks(model, team, neighbours, k, used):
    """Move the rows of all chunks together; returns the end of the list."""
    end = used
    for chunk in range(team.lengths.size):
        first = team.begins[chunk]
        for n in range(team.lengths[chunk]):
            neighbours.index[end + n] = neighbours.index[first + n]
        begin, stop = part_of(0, neighbours.own.count[0], chunk, team.lengths.size)
        last = first_row(model, neighbours, k, stop)
        for row in range(first_row(model, neighbours, k, begin), last):
            neighbours.start[row] -= first - end
        end += team.lengths[chunk]
    return end


@apart
def refresh(model, neighbours):
    """Rebuild the list if bobs have moved too far; all packs are active."""
    if have_crossed(model, neighbours.active, neighbours.place, neighbours.skin, 0.0):
        call_unit(model.units[REBUILD], (model, neighbours))


def rebuild(model, neighbours):
    """Build the list for the bobs where they are.

    For rows that do not fit, all pairs are computed until the list is given more room.
    """
    start = neighbours.start
    used = np.int64(0)  # not the literal, for which all of this would be compiled once more
    for k in range(neighbours.reach.size):
        used = list_pair(model, model.team, neighbours, k, used)
    start[start.size - 1] = used
    keep_places(model, neighbours.place)
    neighbours.crossed[0] = 0
    neighbours.made[0] += 1
    return 0.0


@kernel
def crowded(neighbours):
    """Whether the list needs more room than it has."""
    start = neighbours.start
    return start[start.size - 1] > neighbours.index.size
