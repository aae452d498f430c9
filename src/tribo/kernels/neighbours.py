"""Lists of the blocks of eight bobs that may be within a cutoff of a bob.

A block is computed as a whole, with loads of neighbours in memory; the bobs of a block are
neighbours in their surface.  Blocks are sorted into cells in x and z by the centres of the boxes
around them.  The list reaches a skin farther than the cutoff.  At each evaluation of the forces it
is rebuilt if two bobs together can have crossed the skin, so it never lacks a pair, however far
surfaces slide.
"""

import math

import numpy as np

from tribo.kernels.compiled import kernel, owning_kernel
from tribo.kernels.kinematics import nearest_image
from tribo.kernels.records import X, Y, Z
from tribo.kernels.simd import LANES


@kernel
def image(difference, box, axis):
    """Separation from the nearest image along x (axis 0) or z (axis 1) of a scene's box."""
    if box is None:
        return difference
    return nearest_image(difference, box.x if axis == 0 else box.z)


@kernel
def outdated(surfaces, bobs, neighbours):
    """Whether any two bobs can have crossed the skin since the list was built."""
    limit = 0.25 * neighbours.skin * neighbours.skin
    for k in range(surfaces.shape[0]):
        for i in range(surfaces[k].start, surfaces[k].end):
            dx = bobs[X, i] - neighbours.place[i, 0]
            dy = bobs[Y, i] - neighbours.place[i, 1]
            if not dx * dx + dy * dy < limit:
                return True
    return False


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
def boxes_of(model, s):
    """Centres and half widths of the boxes around the blocks of a surface, in x, y and z.

    Both are (3, blocks).
    """
    count = (s.end - s.start + LANES - 1) // LANES
    centres = np.empty((3, count))
    halves = np.empty((3, count))
    for axis in range(3):
        places = model.asperites[Z] if axis == 2 else model.bobs[X + axis]
        for m in range(count):
            first = s.start + LANES * m
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
def near_blocks(centres, halves, own, k, reach, cells, first, order, box_x, box_z, near):
    """Blocks whose box is within reach of the kth of some boxes, ascending; returns their number.

    `own` are the centres and half widths of those boxes.
    """
    low_x, low_z, width_x, width_z, nx, nz = cells
    place, half = own
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


@owning_kernel
def list_pair(model, box, neighbours, one, other, k, used):
    """Fill the rows of the kth pair of surfaces; returns the length of the list that it needs.

    Within one surface a pair of bobs belongs to the row of the first.
    """
    xs = model.bobs[X]
    ys = model.bobs[Y]
    zs = model.asperites[Z]
    reach = neighbours.reach[k]
    row = neighbours.pairs[k, 2]
    start = neighbours.start
    index = neighbours.index
    box_x = 0.0
    box_z = 0.0
    if box is not None:
        box_x = box.x
        box_z = box.z
    own = boxes_of(model, one)
    centres, halves = boxes_of(model, other)
    size_x = reach + largest(own[1][0]) + largest(halves[0])
    size_z = reach + largest(own[1][2]) + largest(halves[2])
    cells, first, order = sort_into_cells(centres[0], centres[2], size_x, size_z, box_x, box_z)
    near = np.empty(order.size, np.int64)
    for block in range(own[0].shape[1]):
        count = near_blocks(
            centres, halves, own, block, reach, cells, first, order, box_x, box_z, near
        )
        begin = one.start + LANES * block
        for i in range(begin, min(begin + LANES, one.end)):
            start[row] = used
            if partner_species(model.species, neighbours.species[k], i) != -2:
                for n in range(count):
                    m = near[n]
                    last = other.start + LANES * m + LANES - 1
                    dx = gap(xs[i] - centres[0, m], halves[0, m], box_x)
                    dy = gap(ys[i] - centres[1, m], halves[1, m], 0.0)
                    dz = gap(zs[i] - centres[2, m], halves[2, m], box_z)
                    if last > i and dx * dx + dy * dy + dz * dz < reach * reach:
                        if used < index.size:
                            index[used] = last // LANES
                        used += 1
            row += 1
    return used


@kernel
def refresh(model, neighbours):
    """Rebuild the list if bobs have moved too far.

    For rows that do not fit, all pairs are computed until the list is given more room.
    """
    if neighbours is not None:
        bobs = model.bobs
        if not outdated(model.surfaces, bobs, neighbours):
            return
        start = neighbours.start
        used = 0
        for k in range(neighbours.reach.size):
            one = model.surfaces[neighbours.pairs[k, 0]]
            other = model.surfaces[neighbours.pairs[k, 1]]
            used = list_pair(model, model.box, neighbours, one, other, k, used)
        start[start.size - 1] = used
        for i in range(bobs.shape[1]):
            neighbours.place[i, 0] = bobs[X, i]
            neighbours.place[i, 1] = bobs[Y, i]
        neighbours.made[0] += 1


@kernel
def crowded(neighbours):
    """Whether the list needs more room than it has."""
    if neighbours is None:
        return False
    start = neighbours.start
    return start[start.size - 1] > neighbours.index.size
