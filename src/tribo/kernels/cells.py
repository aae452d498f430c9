"""Cells: which boxes around packs of bobs are within reach of a box.

Boxes are sorted into cells in x and z by their centres.  A cell is at least as wide as the reach
and the widest boxes, so a box and those within its reach are in the same cell or in neighbouring
ones.  In a periodic scene the cells are, too.
"""

import math

import numpy as np

from tribo.compiler.jit import apart, kernel
from tribo.compiler.lanes import LANES
from tribo.kernels.kinematics import nearest_image
from tribo.kernels.packs import active_range, column_of
from tribo.kernels.records import X, Z


@apart
def set_boxes(model, active, k, boxes):
    """Set the boxes around the active packs of a surface."""
    s = model.surfaces[k]
    begin, end = active_range(active, s, k)
    boxes.count[0] = end - begin
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
    return box.x, box.z


@kernel
def set_cells(own, boxes, reach, axis, period, most, cells):
    """Set number and width of the cells along an axis, whose neighbours contain all within reach.

    There is one cell where a period has fewer than three: two would be neighbours twice.
    """
    low = math.inf
    high = -math.inf
    widest = 0.0
    own_widest = 0.0
    for m in range(boxes.count[0]):
        low = min(low, boxes.centres[2 * axis, m])
        high = max(high, boxes.centres[2 * axis, m])
        widest = max(widest, boxes.halves[2 * axis, m])
    for m in range(own.count[0]):
        own_widest = max(own_widest, own.halves[2 * axis, m])
    extent = period if period > 0.0 else high - low
    size = reach + (own_widest + widest)
    count = int(min(max(extent / size, 1.0), most))
    if period > 0.0 and count < 3:
        count = 1
    cells.corner[axis] = low
    cells.counts[axis] = count
    cells.widths[axis] = max(extent / count, size)


@apart
def sort_boxes(box, own, boxes, reach, cells):
    """Sort boxes into cells, so that :func:`near_packs` finds those within reach of `own`."""
    box_x, box_z = periods(box)
    n = boxes.count[0]
    most = 2.0 * n + 16.0  # cells, for which `first` has room
    set_cells(own, boxes, reach, 0, box_x, most, cells)
    set_cells(own, boxes, reach, 1, box_z, max(most / cells.counts[0], 1.0), cells)
    nx = cells.counts[0]
    nz = cells.counts[1]
    first = cells.first
    for c in range(nx * nz + 1):
        first[c] = 0
    for j in range(n):
        cx = min(max(cell_of(cells, 0, boxes.centres[0, j], box_x), 0), nx - 1)
        cz = min(max(cell_of(cells, 1, boxes.centres[2, j], box_z), 0), nz - 1)
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


@apart
def near_packs(box, own, k, boxes, reach, cells, near):
    """Boxes within reach of the kth of `own` boxes, ascending; returns their number."""
    box_x, box_z = periods(box)
    nx = cells.counts[0]
    nz = cells.counts[1]
    place = own.centres
    half = own.halves
    centres = boxes.centres
    halves = boxes.halves
    cx = cell_of(cells, 0, place[0, k], box_x)
    cz = cell_of(cells, 1, place[2, k], box_z)
    count = np.int64(0)  # not the literal, for which sort_row would be compiled once more
    for kz in range(*adjacent(cz, nz, box_z)):
        for kx in range(*adjacent(cx, nx, box_x)):
            c = kz % nz * nx + kx % nx
            for n in range(cells.first[c], cells.first[c + 1]):
                m = cells.order[n]
                dx = gap(place[0, k] - centres[0, m], half[0, k] + halves[0, m], box_x)
                dy = gap(place[1, k] - centres[1, m], half[1, k] + halves[1, m], 0.0)
                dz = gap(place[2, k] - centres[2, m], half[2, k] + halves[2, m], box_z)
                if dx * dx + dy * dy + dz * dz < reach * reach:
                    near[count] = m
                    count += 1
    sort_row(near, count)
    return count


@kernel
def adjacent(cell, count, period):
    """The range of a cell and its neighbours along one axis; modulo `count` with a period."""
    if period > 0.0:
        return (cell, cell + 1) if count == 1 else (cell - 1, cell + 2)
    return max(cell - 1, 0), min(cell + 2, count)


@kernel
def cell_of(cells, axis, place, period):
    """Number of the cell of a coordinate; negative or >= count outside of the extent."""
    if period > 0.0:
        place = place - period * math.floor(place / period)
        return min(int(place / cells.widths[axis]), cells.counts[axis] - 1)
    return int(math.floor((place - cells.corner[axis]) / cells.widths[axis]))


@kernel
def sort_row(index, count):
    """Sort the first of some numbers in ascending order, in place; they are few."""
    for k in range(1, count):
        value = index[k]
        m = k
        while m > 0 and index[m - 1] > value:
            index[m] = index[m - 1]
            m -= 1
        index[m] = value
