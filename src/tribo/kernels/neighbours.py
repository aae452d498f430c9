"""Lists of the bobs that may be within a cutoff.

Bobs are sorted into cells in x and z.  The list reaches a skin farther than the cutoff.  At each
evaluation of the forces it is rebuilt if two bobs together can have crossed the skin, so it never
lacks a pair, however far surfaces slide.
"""

import math

import numpy as np

from tribo.kernels.compiled import kernel, owning_kernel
from tribo.kernels.kinematics import nearest_image
from tribo.kernels.records import X, Y, Z


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
def sort_into_cells(xs, zs, start, stop, reach, box_x, box_z):
    """Sort bobs start <= j < stop into cells.

    Returns the cells' geometry (low x, low z, widths, numbers), the first place of each cell in the
    order, and the order.
    """
    n = stop - start
    low_x = math.inf
    low_z = math.inf
    high_x = -math.inf
    high_z = -math.inf
    for j in range(start, stop):
        low_x = min(low_x, xs[j])
        high_x = max(high_x, xs[j])
        low_z = min(low_z, zs[j])
        high_z = max(high_z, zs[j])
    extent_x = box_x if box_x > 0.0 else high_x - low_x
    extent_z = box_z if box_z > 0.0 else high_z - low_z
    most = 2.0 * n + 16.0
    nx = cell_count(extent_x, reach, most, box_x)
    nz = cell_count(extent_z, reach, max(most / nx, 1.0), box_z)
    width_x = max(extent_x / nx, reach)
    width_z = max(extent_z / nz, reach)
    first = np.zeros(nx * nz + 1, np.int64)
    cell = np.empty(n, np.int64)
    for j in range(n):
        cx = min(max(cell_of(xs[start + j], low_x, width_x, nx, box_x), 0), nx - 1)
        cz = min(max(cell_of(zs[start + j], low_z, width_z, nz, box_z), 0), nz - 1)
        cell[j] = cz * nx + cx
        first[cell[j] + 1] += 1
    for c in range(nx * nz):
        first[c + 1] += first[c]
    order = np.empty(n, np.int64)
    fill = first[:-1].copy()
    for j in range(n):
        order[fill[cell[j]]] = start + j
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


@owning_kernel
def list_pair(model, box, neighbours, one, other, k, used):
    """Fill the rows of the kth pair of surfaces; returns the length of the list that it needs.

    Within one surface every pair of bobs is listed once, in the row of the first.
    """
    xs = model.bobs[X]
    ys = model.bobs[Y]
    zs = model.asperites[Z]
    species = model.species
    kinds = neighbours.species[k]
    reach = neighbours.reach[k]
    row = neighbours.pairs[k, 2]
    start = neighbours.start
    index = neighbours.index
    box_x = 0.0
    box_z = 0.0
    if box is not None:
        box_x = box.x
        box_z = box.z
    cells, first, order = sort_into_cells(xs, zs, other.start, other.end, reach, box_x, box_z)
    low_x, low_z, width_x, width_z, nx, nz = cells
    for i in range(one.start, one.end):
        start[row] = used
        partners = partner_species(species, kinds, i)
        cx = cell_of(xs[i], low_x, width_x, nx, box_x)
        cz = cell_of(zs[i], low_z, width_z, nz, box_z)
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
                for m in range(first[c], first[c + 1]):
                    j = order[m]
                    if j <= i or not is_partner(species, partners, j):
                        continue
                    dx = nearest_image(xs[i] - xs[j], box_x)
                    dy = ys[i] - ys[j]
                    dz = nearest_image(zs[i] - zs[j], box_z)
                    if dx * dx + dy * dy + dz * dz < reach * reach:
                        if used < index.size:
                            index[used] = j
                        used += 1
        if used <= index.size:
            sort_row(index, start[row], used)
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
