"""Lists of the blocks of eight bobs that may be within a cutoff of a bob.

A block is computed as a whole, with loads of neighbours in memory; the bobs of a block are
neighbours in their surface.  Blocks are sorted into cells in x and z by the centres of the boxes
around them.  The list reaches a skin farther than the cutoff.  At each evaluation of the forces it
is rebuilt if two bobs together can have crossed the skin, so it never lacks a pair, however far
surfaces slide.
"""

import math

import numpy as np

from tribo.kernels.blocks import column_of, first_block, last_block
from tribo.kernels.compiled import kernel, owning_kernel
from tribo.kernels.kinematics import nearest_image
from tribo.kernels.records import ALONG_X, ALONG_Y, X, Y, Z
from tribo.kernels.simd import LANES, broadcast, sum_of_lanes
from tribo.kernels.simd_arrays import block


@kernel
def image(difference, box, axis):
    """Separation from the nearest image along x (axis 0) or z (axis 1) of a scene's box."""
    if box is None:
        return difference
    return nearest_image(difference, box.x if axis == 0 else box.z)


@kernel
def have_crossed(model, active, place, width, elapsed):
    """Whether two bobs can have moved by `width` towards each other since they were at `place`.

    Inactive blocks move with their surface for the time `elapsed`.
    """
    limit = 0.25 * width * width
    crossed = broadcast(0.0)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if not moved_with_surface(active, s, k, elapsed) < limit:
            return True
        for n in range(first_block(active, s, k), last_block(active, s, k)):
            i = column_of(active, n)
            dx = block(model.bobs[X], i) - block(place[ALONG_X], i)
            dy = block(model.bobs[Y], i) - block(place[ALONG_Y], i)
            crossed = crossed + (1.0 - (dx * dx + dy * dy < limit))
    return sum_of_lanes(crossed) > 0.0


@kernel
def moved_with_surface(active, s, k, elapsed):
    """Square of the distance that inactive blocks of a surface have moved with it."""
    if active is not None:
        if active.eligible[k] == 1:
            return (s.vx * s.vx + s.vy * s.vy) * (elapsed * elapsed)
    return 0.0


@kernel
def keep_places(model, place):
    """Set `place` to the positions of all bobs."""
    for i in range(place.shape[1]):
        place[ALONG_X, i] = model.bobs[X, i]
        place[ALONG_Y, i] = model.bobs[Y, i]


@kernel
def is_empty(neighbours):
    """Whether the list has not been made since it was given room."""
    if neighbours is None:
        return False
    return math.isnan(neighbours.place[0, 0])


@kernel
def cell_count(extent, size, most, period):
    """Number of cells of at least `size` in an extent; one where a period has fewer than three."""
    count = int(min(max(extent / size, 1.0), most))
    return 1 if period > 0.0 and count < 3 else count


@kernel
def cell_of(place, low, width, count, period):
    """Number of the cell of a coordinate; negative or >= count outside of the extent."""
    if period > 0.0:
        place = place - period * math.floor(place / period)
        return min(int(place / width), count - 1)
    return int(math.floor((place - low) / width))


@owning_kernel
def boxes_of(model, active, k):
    """Centres and half widths of the boxes around the active blocks of a surface, in x, y and z.

    Both are (3, blocks).
    """
    s = model.surfaces[k]
    begin = first_block(active, s, k)
    count = last_block(active, s, k) - begin
    centres = np.empty((3, count))
    halves = np.empty((3, count))
    for axis in range(3):
        places = model.asperites[Z] if axis == 2 else model.bobs[X + axis]
        for m in range(count):
            first = column_of(active, begin + m)
            low = places[first]
            high = low
            for i in range(first + 1, min(first + LANES, s.end)):
                low = min(low, places[i])
                high = max(high, places[i])
            centres[axis, m] = 0.5 * (low + high)
            halves[axis, m] = 0.5 * (high - low)
    return centres, halves


@kernel
def largest(values):
    """The largest of some positive numbers."""
    found = 0.0
    for m in range(values.size):
        found = max(found, values[m])
    return found


@kernel
def range_of(values):
    """The smallest and the largest of some numbers."""
    low = math.inf
    high = -math.inf
    for m in range(values.size):
        low = min(low, values[m])
        high = max(high, values[m])
    return low, high


@owning_kernel
def sort_into_cells(xs, zs, size_x, size_z, box_x, box_z):
    """Sort points into cells of at least a size.

    Returns the cells' geometry (low x, low z, widths, numbers), the first place of each cell in the
    order, and the order.
    """
    n = xs.size
    low_x, high_x = range_of(xs)
    low_z, high_z = range_of(zs)
    extent_x = box_x if box_x > 0.0 else high_x - low_x
    extent_z = box_z if box_z > 0.0 else high_z - low_z
    most = 2.0 * n + 16.0
    nx = cell_count(extent_x, size_x, most, box_x)
    nz = cell_count(extent_z, size_z, max(most / nx, 1.0), box_z)
    width_x = max(extent_x / nx, size_x)
    width_z = max(extent_z / nz, size_z)
    first = np.zeros(nx * nz + 1, np.int64)
    cell = np.empty(n, np.int64)
    for j in range(n):
        cx = min(max(cell_of(xs[j], low_x, width_x, nx, box_x), 0), nx - 1)
        cz = min(max(cell_of(zs[j], low_z, width_z, nz, box_z), 0), nz - 1)
        cell[j] = cz * nx + cx
        first[cell[j] + 1] += 1
    for c in range(nx * nz):
        first[c + 1] += first[c]
    order = np.empty(n, np.int64)
    fill = first[:-1].copy()
    for j in range(n):
        order[fill[cell[j]]] = j
        fill[cell[j]] += 1
    return (low_x, low_z, width_x, width_z, nx, nz), first, order


@kernel
def sort_row(index, start, end):
    """Sort a short row in ascending order, in place."""
    for k in range(start + 1, end):
        value = index[k]
        m = k
        while m > start and index[m - 1] > value:
            index[m] = index[m - 1]
            m -= 1
        index[m] = value


@kernel
def partner_species(species, kinds, i):
    """Species that bob i interacts with in a contact of two kinds: -1 is any, -2 none."""
    if species is None:
        return -1
    if kinds is None:
        return -1
    if kinds[0] < 0:
        return -1
    if species[i] == kinds[0]:
        return kinds[1]
    return kinds[0] if species[i] == kinds[1] else -2


@kernel
def is_partner(species, partners, j):
    """Whether bob j is of a species by `partner_species`."""
    if species is None:
        return True
    return partners == -1 or species[j] == partners


@kernel
def gap(distance, width, period):
    """Distance of a point from an interval of half width `width`, from their centres' distance."""
    return max(abs(nearest_image(distance, period)) - width, 0.0)


@kernel
def periods(box):
    """Lengths of a scene's box along x and z; 0 where it is not periodic."""
    if box is None:
        return 0.0, 0.0
    return box.x, box.z


@owning_kernel
def sort_boxes(box, own, boxes, reach):
    """Sort boxes into cells, so that :func:`near_blocks` finds those within reach of `own`."""
    box_x, box_z = periods(box)
    centres, halves = boxes
    size_x = reach + largest(own[1][0]) + largest(halves[0])
    size_z = reach + largest(own[1][2]) + largest(halves[2])
    return sort_into_cells(centres[0], centres[2], size_x, size_z, box_x, box_z)


@kernel
def near_blocks(box, own, k, boxes, reach, sorted_boxes, near):
    """Boxes within reach of the kth of `own` boxes, ascending; returns their number.

    Both are centres and half widths.
    """
    cells, first, order = sorted_boxes
    box_x, box_z = periods(box)
    low_x, low_z, width_x, width_z, nx, nz = cells
    place, half = own
    centres, halves = boxes
    cx = cell_of(place[0, k], low_x, width_x, nx, box_x)
    cz = cell_of(place[2, k], low_z, width_z, nz, box_z)
    count = 0
    for kz in range(cz - 1, cz + 2):
        if box_z > 0.0:
            if nz == 1 and kz != cz:
                continue
            kz = kz % nz
        elif kz < 0 or kz >= nz:
            continue
        for kx in range(cx - 1, cx + 2):
            if box_x > 0.0:
                if nx == 1 and kx != cx:
                    continue
                kx = kx % nx
            elif kx < 0 or kx >= nx:
                continue
            c = kz * nx + kx
            for n in range(first[c], first[c + 1]):
                m = order[n]
                dx = gap(place[0, k] - centres[0, m], half[0, k] + halves[0, m], box_x)
                dy = gap(place[1, k] - centres[1, m], half[1, k] + halves[1, m], 0.0)
                dz = gap(place[2, k] - centres[2, m], half[2, k] + halves[2, m], box_z)
                if dx * dx + dy * dy + dz * dz < reach * reach:
                    near[count] = m
                    count += 1
    sort_row(near, 0, count)
    return count


@kernel
def fill_rows(start, row, stop, used):
    """Let rows up to `stop` begin at a place of the list; returns `stop`."""
    for empty in range(row, stop):
        start[empty] = used
    return stop


@owning_kernel
def list_pair(model, box, neighbours, k, used):
    """Fill the rows of the kth pair of surfaces; returns the length of the list that it needs.

    Within one surface a pair of bobs belongs to the row of the first.  Rows of inactive bobs are
    empty.
    """
    mine = neighbours.pairs[k, 0]
    theirs = neighbours.pairs[k, 1]
    one = model.surfaces[mine]
    other = model.surfaces[theirs]
    active = neighbours.active
    xs = model.bobs[X]
    ys = model.bobs[Y]
    zs = model.asperites[Z]
    reach = neighbours.reach[k]
    row = neighbours.pairs[k, 2]
    start = neighbours.start
    index = neighbours.index
    box_x, box_z = periods(box)
    own = boxes_of(model, active, mine)
    boxes = boxes_of(model, active, theirs)
    centres, halves = boxes
    top = row - one.start
    if centres.shape[1] == 0:
        fill_rows(start, row, top + one.end, used)
        return used
    sorted_boxes = sort_boxes(box, own, boxes, reach)
    near = np.empty(centres.shape[1], np.int64)
    for own_block in range(own[0].shape[1]):
        count = near_blocks(box, own, own_block, boxes, reach, sorted_boxes, near)
        begin = column_of(active, first_block(active, one, mine) + own_block)
        row = fill_rows(start, row, top + begin, used)
        for i in range(begin, min(begin + LANES, one.end)):
            start[row] = used
            if partner_species(model.species, neighbours.species[k], i) != -2:
                for n in range(count):
                    m = near[n]
                    place = first_block(active, other, theirs) + m
                    last = column_of(active, place) + LANES - 1
                    dx = gap(xs[i] - centres[0, m], halves[0, m], box_x)
                    dy = gap(ys[i] - centres[1, m], halves[1, m], 0.0)
                    dz = gap(zs[i] - centres[2, m], halves[2, m], box_z)
                    if last > i and dx * dx + dy * dy + dz * dz < reach * reach:
                        if used < index.size:
                            index[used] = last // LANES
                        used += 1
            row += 1
    fill_rows(start, row, top + one.end, used)
    return used


@kernel
def refresh(model, neighbours):
    """Rebuild the list if bobs have moved too far.

    All blocks are active.
    """
    if neighbours is not None:
        if have_crossed(model, None, neighbours.place, neighbours.skin, 0.0):
            rebuild(model, neighbours)


@kernel
def rebuild(model, neighbours):
    """Build the list for the bobs where they are.

    For rows that do not fit, all pairs are computed until the list is given more room.
    """
    start = neighbours.start
    used = 0
    for k in range(neighbours.reach.size):
        used = list_pair(model, model.box, neighbours, k, used)
    start[start.size - 1] = used
    keep_places(model, neighbours.place)
    neighbours.made[0] += 1


@kernel
def crowded(neighbours):
    """Whether the list needs more room than it has."""
    if neighbours is None:
        return False
    start = neighbours.start
    return start[start.size - 1] > neighbours.index.size
