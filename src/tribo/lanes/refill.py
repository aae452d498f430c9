"""Members that wait for a lane, and how a lane whose member has ended takes the next one."""

from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, where_less
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.integrators import step_control as control
from tribo.kernels.encounters import next_encounter
from tribo.kernels.samples import State, write_row
from tribo.kernels.speeds import top_speeds
from tribo.kernels.status import CODE, COMPLETED, COUNTS, EVALUATIONS, PAUSED, STEPS

# Rows of a table of the steps that are tried, which has a column for each lane: the time at which a
# step begins, its length, the time at which it ends, 1 if that is at a sample, its error, and 1 if
# the step is taken.
BEGIN, LENGTH, END, LANDING, ERROR, TAKEN, TRIED = range(7)


class Queue(NamedTuple):
    """The members of a call, and how far it is with them."""

    held: np.ndarray  # (lanes,) the member in each lane; -1 where there is none
    waiting: np.ndarray  # (1,) the first member that has not been begun
    counts: np.ndarray  # (members, COUNTS) filled in; PAUSED of those that need another loop


def queue_of(members: int, lanes: int) -> Queue:
    """So many members, all of which wait, for Python."""
    counts = np.zeros((members, COUNTS), np.int64)
    return Queue(np.zeros(lanes, np.int64) - 1, np.zeros(1, np.int64), counts)


@kernel
def next_member(queue, lane):
    """Give a lane to the next member that waits; returns this member, -1 if there is none."""
    m = queue.waiting[0]
    if m == queue.counts.shape[0]:
        return -1
    queue.waiting[0] = m + 1
    queue.held[lane] = m
    return m


@kernel
def leave_member(queue, lane, code, steps, evaluations):
    """Let a lane be free, and note what its member took."""
    m = queue.held[lane]
    queue.held[lane] = -1
    queue.counts[m, CODE] = code
    queue.counts[m, STEPS] = steps
    queue.counts[m, EVALUATIONS] = evaluations


class MemberLanes(NamedTuple):
    """The clocks, states and tried steps of the members that are in lanes."""

    clocks: Any  # (lanes,) of CLOCK
    state: State
    new: State  # at the ends of the steps that are tried
    tried: np.ndarray  # (TRIED, lanes)
    speeds: np.ndarray  # (3, asperites) of the bobs


class Starts(NamedTuple):
    """Where members begin, and the numbers in which they differ."""

    y: np.ndarray  # (members, 2 coordinates) y at t = 0, in the numbering of samples
    places: np.ndarray  # (8, 2 coordinates) where each lane has them
    numbers: np.ndarray  # (members, numbers) in which they differ
    places_of_numbers: np.ndarray  # (8, numbers) where each lane has them
    memory: np.ndarray  # (k,) where they are
    first_step: float  # [time]


@kernel
def clear_lane(x, lane):
    """Set the numbers of a lane to zero."""
    for m in range(lane, x.size, LANES):
        x[m] = 0.0


@kernel
def load_member(clock, state, starts, m, lane):
    """Begin member m in a lane: its clock, its start, its own numbers, and empty accounts."""
    clock.t = 0.0
    clock.t_low = 0.0
    clock.h = starts.first_step
    clock.sample = 0
    clock.steps = 0
    clock.rejected = 0
    clock.after_rejection = 0
    clock.evaluations = 1
    for j in range(starts.places.shape[1]):
        state.y[starts.places[lane, j]] = starts.y[m, j]
    for j in range(starts.numbers.shape[1]):
        starts.memory[starts.places_of_numbers[lane, j]] = starts.numbers[m, j]
    clear_lane(state.y_low, lane)
    clear_lane(state.s, lane)
    clear_lane(state.s_low, lane)


@kernel
def write_due(model, neighbours, clock, state, times, record, queue, lane):
    """Record what is due of a member, bobs in place, and leave it at its end."""
    while control.time_left(clock, times[clock.sample]) <= 0.0:
        row = queue.held[lane] * times.size + clock.sample
        write_row(model, neighbours, clock.t, state, record, row, lane)
        clock.sample += 1
        if clock.sample == times.size:
            leave_member(queue, lane, COMPLETED, clock.steps, clock.evaluations)
            return


@inlined
def take_lanes(new, old, taken):
    """Let the numbers of members whose steps are taken be those of `new`."""
    for m in range(0, old.size, LANES):
        set_pack(old, m, where_less(0.5, taken, pack(new, m), pack(old, m)))


@kernel
def refill_lanes(model, neighbours, lanes, times, record, queue, starts):
    """Begin members in the lanes that are free; the others keep their rates."""
    clocks, state, new, tried, speeds = lanes
    first = queue.waiting[0]
    for lane in range(LANES):
        m = next_member(queue, lane) if queue.held[lane] < 0 else -1
        if m >= 0:
            load_member(clocks[lane], state, starts, m, lane)
        tried[BEGIN, lane] = clocks[lane].t
        tried[TAKEN, lane] = 1.0 if m >= 0 else 0.0
    if queue.waiting[0] == first:
        return
    t = pack(tried[BEGIN], 0)
    begun = pack(tried[TAKEN], 0)
    control.evaluate_rates(model, neighbours, t, state.y, new.acceleration, new.power)
    take_lanes(new.acceleration, state.acceleration, begun)
    take_lanes(new.power, state.power, begun)
    top_speeds(model, neighbours, t, state.y, speeds)
    for lane in range(LANES):
        if tried[TAKEN, lane] == 1.0:
            found = next_encounter(model, neighbours, speeds, lane)
            clocks[lane].encounter_rate = found.rate
            if found.closest == 0.0:
                leave_member(queue, lane, PAUSED, clocks[lane].steps, clocks[lane].evaluations)
            else:
                write_due(model, neighbours, clocks[lane], state, times, record, queue, lane)
