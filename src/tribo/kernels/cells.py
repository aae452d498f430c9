"""Cells: which boxes around blocks of bobs are within reach of a box.

Boxes are sorted into cells in x and z by their centres.  A cell is at least as wide as the reach
and the widest boxes, so a box and those within its reach are in the same cell or in neighbouring
ones.  In a periodic scene the cells are, too.
"""

import math

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import LANES
from tribo.kernels.blocks import column_of, first_block, last_block
from tribo.kernels.kinematics import nearest_image
from tribo.kernels.records import X, Z


@kernel
def set_boxes(model, active, k, boxes):
    """Set the boxes around the active blocks of a surface."""
    s = model.surfaces[k]
    begin = first_block(active, s, k)
    boxes.count[0] = last_block(active, s, k) - begin
    for axis in range(3):
        places = model.each[Z] if axis == 2 else model.bobs[X + axis]
        for m in range(boxes.count[0]):
            first = column_of(active, begin + m)
            low = places[first]
            high = low
            for i in range(first + 1, min(first + LANES, s.end)):
                low = min(low, places[i])
                high = max(high, places[i])
            boxes.centres[axis, m] = 0.5 * (low + high)
            boxes.halves[axis, m] = 0.5 * (high - low)


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


@kernel
def sort_boxes(box, own, boxes, reach, cells):
    """Sort boxes into cells, so that :func:`near_blocks` finds those within reach of `own`."""
    box_x, box_z = periods(box)
    n = boxes.count[0]
    widest_x = largest(own.halves[0], own.count[0]) + largest(boxes.halves[0], n)
    widest_z = largest(own.halves[2], own.count[0]) + largest(boxes.halves[2], n)
    sizes = reach + widest_x, reach + widest_z
    sort_into_cells(boxes.centres[0], boxes.centres[2], n, *sizes, box_x, box_z, cells)


@kernel
def near_blocks(box, own, k, boxes, reach, cells, near):
    """Boxes within reach of the kth of `own` boxes, ascending; returns their number."""
    box_x, box_z = periods(box)
    nx, nz = cells.counts[0], cells.counts[1]
    place, half = own.centres, own.halves
    centres, halves = boxes.centres, boxes.halves
    cx = cell_of(place[0, k], cells.corner[0], cells.widths[0], nx, box_x)
    cz = cell_of(place[2, k], cells.corner[1], cells.widths[1], nz, box_z)
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
            for n in range(cells.first[c], cells.first[c + 1]):
                m = cells.order[n]
                dx = gap(place[0, k] - centres[0, m], half[0, k] + halves[0, m], box_x)
                dy = gap(place[1, k] - centres[1, m], half[1, k] + halves[1, m], 0.0)
                dz = gap(place[2, k] - centres[2, m], half[2, k] + halves[2, m], box_z)
                if dx * dx + dy * dy + dz * dz < reach * reach:
                    near[count] = m
                    count += 1
    sort_row(near, 0, count)
    return count


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


@kernel
def largest(values, count):
    """The largest of the first of some positive numbers."""
    found = 0.0
    for m in range(count):
        found = max(found, values[m])
    return found


@kernel
def range_of(values, count):
    """The smallest and the largest of the first of some numbers."""
    low = math.inf
    high = -math.inf
    for m in range(count):
        low = min(low, values[m])
        high = max(high, values[m])
    return low, high


@kernel
def sort_into_cells(xs, zs, n, size_x, size_z, box_x, box_z, cells):
    """Sort the first n points into cells of at least a size."""
    low_x, high_x = range_of(xs, n)
    low_z, high_z = range_of(zs, n)
    extent_x = box_x if box_x > 0.0 else high_x - low_x
    extent_z = box_z if box_z > 0.0 else high_z - low_z
    most = 2.0 * n + 16.0
    nx = cell_count(extent_x, size_x, most, box_x)
    nz = cell_count(extent_z, size_z, max(most / nx, 1.0), box_z)
    width_x = max(extent_x / nx, size_x)
    width_z = max(extent_z / nz, size_z)
    cells.corner[0], cells.corner[1] = low_x, low_z
    cells.widths[0], cells.widths[1] = width_x, width_z
    cells.counts[0], cells.counts[1] = nx, nz
    first = cells.first
    for c in range(nx * nz + 1):
        first[c] = 0
    for j in range(n):
        cx = min(max(cell_of(xs[j], low_x, width_x, nx, box_x), 0), nx - 1)
        cz = min(max(cell_of(zs[j], low_z, width_z, nz, box_z), 0), nz - 1)
        cells.cell[j] = cz * nx + cx
        first[cells.cell[j] + 1] += 1
    for c in range(nx * nz):
        first[c + 1] += first[c]
    # Each cell is filled from its end, so that its first place is left behind.
    for j in range(n - 1, -1, -1):
        c = cells.cell[j]
        first[c + 1] -= 1
        cells.order[first[c + 1]] = j
    for c in range(nx * nz):
        first[c] = first[c + 1]
    first[nx * nz] = n


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
