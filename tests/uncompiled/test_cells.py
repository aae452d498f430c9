"""Boxes in cells: each in the cell around its centre, and those within reach of a box are found."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from tribo.kernels.cells import near_packs, sort_boxes, sort_row
from tribo.kernels.model import Boxes, Cells


def empty_cells(room: int):
    """Cells for so many boxes."""
    numbers = (np.empty(size, np.int64) for size in (2 * room + 17, room, room))
    return Cells(np.zeros(2), np.zeros(2), np.zeros(2, np.int64), *numbers)


@pytest.mark.parametrize(
    ("sizes", "box", "expected"),
    [
        ((2.0, 3.0), (0.0, 0.0), "as many as fit"),
        ((2.0, 3.0), (0.9, 10.0), (1, 3)),  # below three cells there is one
        ((2.0, 3.0), (13.0, 5.9), (6, 1)),
        ((0.2, 0.3), (0.9, 0.8), (4, 1)),
        ((50.0, 40.0), (0.0, 0.0), (1, 1)),
        ((1e-3, 1e-3), (0.0, 0.0), "as many as points"),
    ],
)
def test_cells(sizes, box, expected):
    """Cells of at least a size, as many as fit, each box in the cell around its centre."""
    rng = np.random.default_rng(7)
    places = np.array([rng.uniform(3.0, 15.0, 60), rng.uniform(-9.0, 0.0, 60)])
    size_x, size_z = sizes
    reach = 0.5 * min(sizes)  # the rest is of boxes on either side
    halves = np.array([[size_x - reach], [0.0], [size_z - reach]])
    own = Boxes(np.array([1]), np.zeros((3, 1)), 0.75 * halves)
    centres = np.array([places[0], np.zeros(60), places[1]])
    theirs = Boxes(np.array([60]), centres, np.repeat(0.25 * halves, 60, axis=1))
    cells = empty_cells(60)
    sort_boxes(SimpleNamespace(x=box[0], z=box[1]), own, theirs, reach, cells)
    if expected == "as many as points":
        assert 60 <= np.prod(cells.counts) <= 2 * 60 + 16
    else:
        extents = np.ptp(places, axis=1)
        fitting = tuple((extents / sizes).astype(int))
        assert tuple(cells.counts) == (fitting if expected == "as many as fit" else expected)
        assert np.all(cells.widths >= sizes)
        assert expected == (1, 1) or np.all(cells.widths / sizes <= 3.0)
    n = []
    for place, length, width, count in zip(places, box, cells.widths, cells.counts, strict=True):
        inside = np.mod(place, length) if length else place - np.min(place)
        n.append(np.minimum((inside / width).astype(int), count - 1))
    cell = n[1] * cells.counts[0] + n[0]
    assert np.array_equal(cells.order, np.argsort(cell, kind="stable"))
    first = cells.first[: np.prod(cells.counts) + 1]
    assert first[0] == 0
    assert np.array_equal(np.diff(first), np.bincount(cell, minlength=first.size - 1))


BOXES = (
    (0.0, 0.0),
    (20.0, 0.0),
    (0.0, 30.0),
    (20.0, 30.0),
    (4.0, 0.9),
    (0.9, 4.0),
    (8.0, 17.0),
)


def test_boxes_within_reach():
    """Of boxes in cells, exactly those within reach of another box, in ascending order."""
    rng = np.random.default_rng(9)
    for (x, z), unit in itertools.product(BOXES, (1.0, 0.04)):
        reach = 1.5 * unit
        half_x = 0.5 * min(x or 1.0, 1.0)
        half_z = 0.5 * min(z or 4.0, 4.0)
        own, theirs = (
            Boxes(
                np.array([count]),
                rng.uniform(-5.0, 25.0, (3, 310)) * [[unit], [0.2 * unit], [1.2 * unit]],
                rng.uniform(0.0, unit, (3, 310)) * [[half_x], [0.2], [half_z]],
            )
            for count in (25, 300)
        )
        periods = x * unit, z * unit
        lengths = SimpleNamespace(x=periods[0], z=periods[1])
        cells = empty_cells(310)
        sort_boxes(lengths, own, theirs, reach, cells)
        away = theirs.centres[:, None, :300] - own.centres[:, :25, None]
        for axis, box in zip((0, 2), periods, strict=True):
            if box:
                away[axis] -= box * np.round(away[axis] / box)
        widths = theirs.halves[:, None, :300] + own.halves[:, :25, None]
        gaps = np.maximum(abs(away) - widths, 0.0)
        for k, near in enumerate(np.sum(gaps**2, axis=0) < reach**2):
            found = np.full(300, -1)
            count = near_packs(lengths, own, k, theirs, reach, cells, found)
            assert np.array_equal(found[:count], np.flatnonzero(near)), f"{periods}, box {k}"


@pytest.mark.parametrize("count", [0, 1, 2, 7, 9])
def test_short_rows(count):
    """The beginning of an array is sorted, and the rest is as it was."""
    row = np.random.default_rng(8).permutation(9)
    expected = np.concatenate([np.sort(row[:count]), row[count:]])
    sort_row(row, count)
    assert np.array_equal(row, expected)
