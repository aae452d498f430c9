"""Three numbers, those of q1, q2 and k, and where they are in the memory of a loop."""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import lane, with_lane
from tribo.compiler.lanes_memory import load, store


@inlined
def three_in(work, row, column):
    """Three numbers of a row, from a column on."""
    return work[row, column], work[row, column + 1], work[row, column + 2]


@inlined
def load_three(work, row):
    return load(work, row), load(work, row + 1), load(work, row + 2)


@inlined
def store_three(work, row, values):
    store(work, row, values[0])
    store(work, row + 1, values[1])
    store(work, row + 2, values[2])


@inlined
def set_three_in(work, row, values):
    """Set the first three numbers of a row to those in lane 0."""
    work[row, 0] = lane(values[0], 0)
    work[row, 1] = lane(values[1], 0)
    work[row, 2] = lane(values[2], 0)


@inlined
def with_first(values, first):
    """Three Lanes with other numbers in lane 0."""
    one = with_lane(values[0], 0, first[0])
    return one, with_lane(values[1], 0, first[1]), with_lane(values[2], 0, first[2])


@inlined
def plus(one, other):
    """The sum of three numbers and three others."""
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


@inlined
def times(factor, values):
    return factor * values[0], factor * values[1], factor * values[2]
