"""Splitting steps of eight members of an ensemble side by side, one in each lane."""

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import LANES
from tribo.compiler.pointers import pointers
from tribo.integrators.splitting import arrive, begin_works, take_step
from tribo.integrators.step_control import (
    ENCOUNTER_UPDATE,
    EPSILON,
    UPDATE_INTERVAL,
    advance_equally,
    equal_step,
    time_left,
)
from tribo.kernels.baths import set_bath_momenta
from tribo.kernels.blocks import clear
from tribo.kernels.encounters import next_encounter
from tribo.kernels.equations_of_motion import place_bobs, top_speeds
from tribo.kernels.samples import write_row
from tribo.kernels.status import COMPLETED, PAUSED, STEP_UNDERFLOW

# Rows of what is known of the members' encounters: their rate as it was last computed [1 / time],
# the time since then, and 1 where a step would have jumped one.
RATE, AGE, LOST, WATCHED = range(4)


@kernel
def watch_encounters(model, t, y, speeds, watch, h, all_of_them):
    """Compute the encounter rates of members that can be near an encounter, or of all.

    What is computed of a member depends on that member alone.
    """
    n = y.size // 2
    known = False
    for lane in range(LANES):
        near = (watch[AGE, lane] + h) * watch[RATE, lane] > ENCOUNTER_UPDATE
        if not (near or all_of_them):
            continue
        if not known:
            top_speeds(model, None, t, y[:n], y[n:], speeds)
            known = True
        found = next_encounter(model, None, speeds, lane)
        watch[RATE, lane] = found.rate
        watch[AGE, lane] = 0.0
        if found.closest == 0.0:
            watch[LOST, lane] = 1.0


def splitting_members(
    model, splitting, step, clocks, state, times, record, budget, watch, noise, work
):
    """Integrate eight members through the sample times in equal steps of at most `step`.

    Returns COMPLETED, STEP_UNDERFLOW, or PAUSED after `budget` steps, for which `noise` has enough
    deviates: call again to continue.  No member is stopped: `watch` (WATCHED, 8) says which had an
    encounter that a step jumped.  The record has the samples of the first member, then of the
    second, and so on.
    """
    clock = clocks[0]
    model, splitting, state, times, record, watch, noise, work = pointers(
        (model, splitting, state, times, record, watch, noise, work)
    )
    last = times[times.size - 1]
    n = state.y.size // 2
    clear(model.friction)
    clear(model.swing_friction)
    set_bath_momenta(model, model.bath, state.y[n:])
    if clock.evaluations == 0:
        place_bobs(model, clock.t, state.y[:n])
        watch_encounters(model, clock.t, state.y, work.speeds, watch, 0.0, True)
        begin_works(model, state, work)
    for done in range(budget + 1):
        left = time_left(clock, times[clock.sample])
        if left <= 0.0:
            arrive(model, None, clock, state, work)
        while left <= 0.0:
            for lane in range(LANES):
                k = lane * times.size + clock.sample
                write_row(model, None, clock.t, state, record, k, lane)
            clock.sample += 1
            if clock.sample == times.size:
                return COMPLETED
            left = time_left(clock, times[clock.sample])
        if done == budget:
            break
        h, landing = equal_step(clock, left, step)
        if h < EPSILON * last:
            return STEP_UNDERFLOW
        for lane in range(LANES):
            if h * watch[RATE, lane] > 1.0:
                watch[LOST, lane] = 1.0
        take_step(model, None, splitting, clock, h, state, work, noise)
        advance_equally(clock, times[clock.sample], h, landing)
        for lane in range(LANES):
            watch[AGE, lane] += h
        every = clock.steps % UPDATE_INTERVAL == 0
        watch_encounters(model, clock.t, state.y, work.speeds, watch, h, every)
    return PAUSED
