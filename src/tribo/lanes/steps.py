"""Steps of eight members of an ensemble side by side, one in each lane.

Nystrom steps have lengths of their own, splitting steps one for all members.  What is computed of a
member depends on that member alone.
"""

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import LANES, broadcast
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.pointers import pointers
from tribo.integrators import step_control as control
from tribo.integrators.drift import begin_end_works
from tribo.integrators.nystrom import try_step
from tribo.integrators.splitting import arrive, take_step
from tribo.kernels.baths import set_bath_momenta
from tribo.kernels.encounters import next_encounter
from tribo.kernels.equations_of_motion import place_bobs
from tribo.kernels.packs import clear, halves
from tribo.kernels.samples import Attempt, write_row
from tribo.kernels.speeds import top_speeds
from tribo.kernels.status import COMPLETED, PAUSED, STEP_UNDERFLOW
from tribo.lanes.refill import (
    BEGIN,
    END,
    ERROR,
    LANDING,
    LENGTH,
    TAKEN,
    MemberLanes,
    leave_member,
    refill_lanes,
    take_lanes,
    write_due,
)

# Steps and rejected steps after which a member is left to a run of its own, which is guarded
# against no progress.
MOST_TRIALS = 2048
# Rows of what is known of the members' encounters: their rate as it was last computed [1 / time],
# the time since then, and 1 where a step would have jumped one.
RATE, AGE, LOST, WATCHED = range(4)


@kernel
def plan_steps(clocks, times, queue, tried):
    """Plan the next step of each member; returns how many there are."""
    count = 0
    for lane in range(LANES):
        clock = clocks[lane]
        tried[BEGIN, lane] = clock.t
        tried[LENGTH, lane] = 0.0
        tried[END, lane] = clock.t
        if queue.held[lane] < 0:
            continue
        goal = times[clock.sample]
        h, landing = control.next_step(clock, clock.encounter_rate, control.time_left(clock, goal))
        trials = clock.steps + clock.rejected
        if trials >= MOST_TRIALS or control.step_underflows(h, landing, times[times.size - 1]):
            leave_member(queue, lane, PAUSED, clock.steps, clock.evaluations)
            continue
        tried[LENGTH, lane] = h
        tried[END, lane] = control.end_of_step(clock, goal, h, landing)
        tried[LANDING, lane] = 1.0 if landing else 0.0
        count += 1
    return count


@kernel
def is_taken(model, neighbours, clock, method, tried, speeds, lane):
    """Take or reject the step of a member, by its error and the encounters at its end."""
    h = tried[LENGTH, lane]
    error = tried[ERROR, lane]
    growth = control.growth_factor(error, method.order, method.most_growth)
    if not control.check_error(clock, h, error, growth):
        return False
    found = next_encounter(model, neighbours, speeds, lane)
    if not control.check_arrival(clock, h, found.rate, True):
        return False
    control.accept_step(clock, tried[END, lane], h, tried[LANDING, lane] == 1.0, growth)
    return True


@kernel
def take_steps(new, state, taken):
    """Let the states of members whose steps are taken be the new ones."""
    take_lanes(new.y, state.y, taken)
    take_lanes(new.y_low, state.y_low, taken)
    take_lanes(new.s, state.s, taken)
    take_lanes(new.s_low, state.s_low, taken)
    take_lanes(new.acceleration, state.acceleration, taken)
    take_lanes(new.power, state.power, taken)


def nystrom_members(
    model,
    neighbours,
    method,
    tolerance,
    clocks,
    state,
    times,
    record,
    budget,
    queue,
    starts,
    tried,
    work,
    speeds,
    new,
):
    """Integrate all members through the sample times; returns COMPLETED or PAUSED.

    Steps are those of :func:`tribo.integrators.time_loops.adaptive_steps`, at most `budget` for
    each lane in a call.  Each of the eight `clocks`, and each lane of states and tolerances, is a
    member's.  The record has the samples of the first member, then of the second, and so on.
    """
    method, times, tried, speeds = pointers((method, times, tried, speeds))
    lanes = MemberLanes(clocks, state, new, tried, speeds)
    for _ in range(budget):
        refill_lanes(model, neighbours, lanes, times, record, queue, starts)
        if plan_steps(clocks, times, queue, tried) == 0:
            if queue.waiting[0] == queue.counts.shape[0]:
                return COMPLETED
            continue
        end = pack(tried[END], 0)
        attempt = Attempt(pack(tried[BEGIN], 0), pack(tried[LENGTH], 0), end, new)
        error = try_step(method, model, neighbours, attempt, state, tolerance, work)
        set_pack(tried[ERROR], 0, error)
        top_speeds(model, neighbours, end, new.y, speeds)
        for lane in range(LANES):
            taken = False
            if queue.held[lane] >= 0:
                clocks[lane].evaluations += method.c.size
                taken = is_taken(model, neighbours, clocks[lane], method, tried, speeds, lane)
            tried[TAKEN, lane] = 1.0 if taken else 0.0
        take_steps(new, state, pack(tried[TAKEN], 0))
        for lane in range(LANES):
            if tried[TAKEN, lane] == 1.0:
                write_due(model, neighbours, clocks[lane], state, times, record, queue, lane)
    return PAUSED


@kernel
def watch_encounters(model, neighbours, t, y, speeds, watch, h, all_of_them):
    """Compute the encounter rates of members that can be near an encounter, or of all.

    What is computed of a member depends on that member alone.
    """
    known = False
    for lane in range(LANES):
        near = (watch[AGE, lane] + h) * watch[RATE, lane] > control.ENCOUNTER_UPDATE
        if not (near or all_of_them):
            continue
        if not known:
            top_speeds(model, neighbours, t, y, speeds)
            known = True
        found = next_encounter(model, neighbours, speeds, lane)
        watch[RATE, lane] = found.rate
        watch[AGE, lane] = 0.0
        if found.closest == 0.0:
            watch[LOST, lane] = 1.0


def splitting_members(
    model,
    neighbours,
    method,
    step,
    clocks,
    state,
    times,
    record,
    budget,
    watch,
    noise,
    work,
    speeds,
):
    """Integrate eight members through the sample times in equal steps of at most `step`.

    Returns COMPLETED, STEP_UNDERFLOW, or PAUSED after `budget` steps, for which `noise` has enough
    deviates: call again to continue.  No member is stopped: `watch` (WATCHED, 8) says which had an
    encounter that a step jumped.  The record has the samples of the first member, then of the
    second, and so on.
    """
    clock = clocks[0]
    method, times, watch, noise = pointers((method, times, watch, noise))
    last = times[times.size - 1]
    rows = record.contact.size // LANES  # of a member; `times` may end before them
    q, v = halves(state.y)
    clear(model.friction)
    clear(model.swing_friction)
    set_bath_momenta(model, v)
    if clock.evaluations == 0:
        place_bobs(model, broadcast(clock.t), q)
        watch_encounters(model, neighbours, clock.t, state.y, speeds, watch, 0.0, True)
        begin_end_works(model, q, state.memory[0])
    for done in range(budget + 1):
        left = control.time_left(clock, times[clock.sample])
        if left <= 0.0:
            arrive(model, neighbours, clock, state, work)
        while left <= 0.0:
            for lane in range(LANES):
                k = lane * rows + clock.sample
                write_row(model, neighbours, clock.t, state, record, k, lane)
            clock.sample += 1
            if clock.sample == times.size:
                return COMPLETED
            left = control.time_left(clock, times[clock.sample])
        if done == budget:
            break
        h, landing = control.equal_step(clock, left, step)
        if h < control.EPSILON * last:
            return STEP_UNDERFLOW
        for lane in range(LANES):
            if h * watch[RATE, lane] > 1.0:
                watch[LOST, lane] = 1.0
        take_step(model, neighbours, method, clock, h, state, work, noise)
        control.advance_equally(clock, times[clock.sample], h, landing)
        for lane in range(LANES):
            watch[AGE, lane] += h
        every = clock.steps % control.UPDATE_INTERVAL == 0
        watch_encounters(model, neighbours, clock.t, state.y, speeds, watch, h, every)
    return PAUSED
