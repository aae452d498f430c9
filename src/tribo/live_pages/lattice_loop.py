"""The time loops of rows and grids for a page, which go from leg to leg of schedules.

The rules are those of :mod:`tribo.loops.legs`; ``tests/live_pages`` compares both.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import apart, inlined, kernel
from tribo.integrators.methods import named
from tribo.kernels.schedule import COLUMNS
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.layout.layout import Layout
from tribo.layout.legs import SAME, legs_of


class Legs(NamedTuple):
    """The legs of a run of any duration; see :class:`tribo.layout.legs.Legs`."""

    kinks: Any  # (legs - 1,) [time]
    tables: Any  # (legs, 1 + schedules, COLUMNS)
    duration: Any  # (1,) [time]


def legs_of_page(layout: Layout) -> Legs:
    """The legs of a scene, also those that begin after its duration, which a page can change."""
    numbers = legs_of(layout.scene, layout.scheduled, layout.begun, np.inf)
    return Legs(numbers.kinks, numbers.tables, np.array([layout.scene.duration]))


@inlined
def same_time(legs):
    """Times that differ by less are one."""
    return SAME * legs.duration[0]


@kernel
def set_leg(model, legs, leg):
    """Let kernels read the numbers of a leg."""
    table = model.schedules
    for row in range(legs.tables.shape[1]):
        for column in range(COLUMNS):
            table[row, column] = legs.tables[leg, row, column]


@kernel
def leg_at(legs, t):
    """The leg at a time; at a kink the one that begins there."""
    leg = 0
    while leg < legs.kinks.size and t >= legs.kinks[leg] - same_time(legs):
        leg += 1
    return leg


@kernel
def set_stops(legs, leg, times, stops):
    """Set the times of a leg and of those before; how many, and whether the last is in `times`."""
    same = same_time(legs)
    count = times.size
    is_last = leg == legs.kinks.size or legs.kinks[leg] >= times[count - 1] - same
    kink = np.inf if is_last else legs.kinks[leg]
    after = 0
    while after < count and times[after] <= kink + same:
        stops[after] = times[after]
        after += 1
    if is_last or (after > 0 and times[after - 1] >= kink - same):
        return after, True
    stops[after] = kink
    return after + 1, False


@kernel
def trials(clock):
    return clock.steps + clock.rejected


@cache
def loop_of_page(name: str) -> Callable[..., int]:
    """The loop of a method, which has a name, for a page."""
    steps = apart(named(name).loop)
    keeps_rates = not named(name).splits

    def live_steps(step, of_scene, method, run, times, budget, legs, scratch):
        """Integrate through the times in equal steps of at most `step`; return a status.

        `run` has the clocks, the state and the record.  Scratch are the stops (times,) in a leg,
        and that of the method's loop.
        """
        stops = scratch[0]
        of_loop = scratch[1:]
        model, neighbours = of_scene
        clocks, state, record = run
        clock = clocks[0]
        while True:
            before = clock.leg
            leg = leg_at(legs, clock.t)
            set_leg(model, legs, leg)
            clock.leg = leg
            if keeps_rates and leg > before and clock.evaluations > 0:
                evaluations = clock.evaluations
                clock.evaluations = 0  # so that the loop begins as at the start of a run
                clock.last_step = 0.0
                steps(model, neighbours, method, step, clocks, state, times, record, 0, *of_loop)
                clock.evaluations += evaluations
            count, is_sample = set_stops(legs, leg, times, stops)
            left = budget - trials(clock)
            goals = stops[:count]
            code = steps(
                model, neighbours, method, step, clocks, state, goals, record, left, *of_loop
            )
            if code != COMPLETED or stops[count - 1] == times[times.size - 1]:
                return code
            if not is_sample:
                clock.sample -= 1
            if trials(clock) >= budget:
                return PAUSED

    return live_steps
