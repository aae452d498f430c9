"""The two time loops of all methods: equal steps, and steps that follow from their errors.

A method is a NamedTuple of coefficients.  The loops find these functions by its class, when they
are compiled, as kernels find those of a plug-in:

    workspace(model, state)   for Python: the arrays that a step needs

For :func:`equal_steps`:

    begin(...)                at the start of a run and after a pause: what the first step needs;
                              returns COMPLETED, or the status with which the run stops
    step(...)                 advance the state in place to the time `end`; returns the same
    arrive(...)               complete the state where a sample is due
    stays_finite(...)         whether the state is finite after a step

For :func:`adaptive_steps`:

    trial(...)                try a step, an `Attempt`; returns its error in units of the tolerance,
                              and whether all is finite.  If the error is at most 1, the new state
                              is then that at its end.
    order, most_growth        with these, :func:`growth_factor` finds the next step from the error

A complete state has coordinates, accounts, their rates of change where the method needs them, and
what it keeps for the next step.
"""

from tribo.compiler.pointers import pointers
from tribo.integrators import step_control as control
from tribo.kernels.neighbours import crowded
from tribo.kernels.samples import Attempt, copy_state
from tribo.kernels.status import COMPLETED, NOT_FINITE, PAUSED


def equal_steps(
    model, neighbours, method, step, clocks, state, times, record, budget, noise, work, speeds
):
    """Integrate through the sample times in equal steps of at most `step`; return a status.

    Between two samples the steps are equal, and as few as `step` allows.  The run stops where a
    step would jump an encounter.  PAUSED after `budget` steps: call again to continue.  `noise` is
    the argument of a random generator, 0 for a method that draws nothing.
    """
    clock = clocks[0]
    method, times, speeds = pointers((method, times, speeds))
    last = times[times.size - 1]
    status = method.begin(model, neighbours, clock, state, work, speeds)
    if status != COMPLETED:
        return status
    for _ in range(budget):
        if crowded(neighbours):
            return PAUSED
        if clock.sample < times.size and control.time_left(clock, times[clock.sample]) <= 0.0:
            method.arrive(model, neighbours, clock, state, work)
        left = control.record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED if control.all_finite(state.y) else NOT_FINITE
        h, landing = control.equal_step(clock, left, step)
        status = control.equal_step_status(clock, h, last)
        if status != COMPLETED:
            return status
        goal = times[clock.sample]
        end = control.end_of_step(clock, goal, h, landing)
        status = method.step(model, neighbours, clock, h, end, state, work, noise)
        if status != COMPLETED:
            return status
        control.advance_equally(clock, goal, h, landing)
        updated = control.update_encounter(model, neighbours, clock, state.y, speeds, h)
        if not method.stays_finite(model, state, updated):
            return NOT_FINITE
    return PAUSED


def adaptive_steps(
    model, neighbours, method, tolerance, clocks, state, times, record, budget, work, speeds, new
):
    """Integrate through the sample times with local errors within `tolerance`; return a status.

    No step carries a pair of bobs farther towards its next encounter than the clock allows, by
    the speeds at its start, nor past it by the speeds at its end.  PAUSED after `budget` trials:
    call again to continue.
    """
    clock = clocks[0]
    method, times, speeds = pointers((method, times, speeds))
    last = times[times.size - 1]
    status = control.initialize(model, neighbours, clock, state, speeds)
    if status != COMPLETED:
        return status
    for _ in range(budget):
        if crowded(neighbours):
            return PAUSED
        left = control.record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED
        h, landing = control.next_step(clock, clock.encounter_rate, left)
        if control.step_underflows(h, landing, last):
            return control.underflow_status(clock)
        end = control.end_of_step(clock, times[clock.sample], h, landing)
        attempt = Attempt(clock.t, h, end, new)
        error, finite = method.trial(model, neighbours, clock, attempt, state, tolerance, work)
        clock.not_finite = 0 if finite else 1
        growth = control.growth_factor(error, method.order, method.most_growth)
        if not control.check_error(clock, h, error, growth):
            continue
        rate, _ = control.current_encounter(model, neighbours, end, new.y, speeds)
        if control.check_arrival(clock, h, rate, control.is_finite(new)):
            control.accept_step(clock, end, h, landing, growth)
            copy_state(new, state)
    return PAUSED
