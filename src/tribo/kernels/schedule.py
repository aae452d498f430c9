"""Numbers that follow schedules: their values in the present leg of a run.

A leg is the time between two kinks.  A row of the table of schedules has the numbers of one
schedule in the present leg, which the caller of a loop sets before it begins; see
`tribo.layout.legs`.
"""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import broadcast
from tribo.compiler.lanes_functions import sine_cosine

# Columns of the table: value = C0 + C1 u + C2 u^2 + AMPLITUDE sin(FREQUENCY u + PHASE), where
# u = t - SINCE.
SINCE, C0, C1, C2, AMPLITUDE, FREQUENCY, PHASE = range(7)
COLUMNS = 7


@inlined
def scheduled(table, row, t):
    """The value of the schedule in a row, for a time or for Lanes of times, as Lanes."""
    u = broadcast(t - table[row, SINCE])
    value = (table[row, C2] * u + table[row, C1]) * u + table[row, C0]
    if table[row, AMPLITUDE] != 0.0:
        sin, _ = sine_cosine(table[row, FREQUENCY] * u + table[row, PHASE])
        value = value + table[row, AMPLITUDE] * sin
    return value


@inlined
def rate_of_schedule(table, row, t):
    """The derivative by time of the value of the schedule in a row."""
    u = broadcast(t - table[row, SINCE])
    rate = 2.0 * table[row, C2] * u + table[row, C1]
    if table[row, AMPLITUDE] != 0.0:
        _, cos = sine_cosine(table[row, FREQUENCY] * u + table[row, PHASE])
        rate = rate + table[row, AMPLITUDE] * table[row, FREQUENCY] * cos
    return rate


@inlined
def given_acceleration(model, s, t):
    """The acceleration of a motion whose velocities follow schedules, x and y, as Lanes."""
    ax = broadcast(0.0)
    ay = broadcast(0.0)
    if s.push_schedule > 0:
        ax = rate_of_schedule(model.schedules, s.push_schedule, t)
    if s.load_schedule > 0:
        ay = rate_of_schedule(model.schedules, s.load_schedule, t)
    return ax, ay


@inlined
def number_or_scheduled(table, row, number, t):
    """A number of a surface as Lanes, or the value of its schedule if it has one."""
    if row > 0:
        return scheduled(table, row, t)
    return number
