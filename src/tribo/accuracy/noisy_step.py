"""The step of a run with noise: found by short runs from its start, and shortened where needed.

The frequencies that a scene states bound it from above (`choose_method.bounded_step`).  What
contacts, fields, drives and end forces add depends on where the motion takes the bobs, so short
runs measure it.  The run itself goes on to measure it, and is repeated where it meets more.
"""

import numpy as np

from tribo.kernels.status import COMPLETED, PAUSED
from tribo.loops.driver import Chunks, drive
from tribo.loops.resolution import longest_step
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting
from tribo.loops.stiffness import AIMED_TURN, FIRST_LOOK, Stiffness
from tribo.loops.time_loop import TimeLoop

# Steps of a short run, at most: a quarter of them suffices for an error of the stiffness of 20 %.
TRIED_STEPS = 16 * FIRST_LOOK
# Work of a short run, at most [force evaluations x asperites]: some 0.05 s.
TRIED_WORK = 1e6
# The steps of the first short run, relative to the bound: they resolve what the bound does not.
FIRST = 1.0 / 64.0
# Short runs, at most: each has at most half the step of the one before.
TRIES = 10


def resolving_step(
    integrator: Integrator, longest: float, start: np.ndarray | None = None
) -> float:
    """A step of at most `longest` that resolves the stiffest motion after the start of a run."""
    layout = integrator.layout
    most = int(max(FIRST_LOOK, min(TRIED_STEPS, TRIED_WORK / layout.asperites.size)))
    start = layout.start if start is None else start
    found = _stiffness(integrator, FIRST * longest, start, FIRST_LOOK)
    step = longest if found is None else _resolving(longest, found)
    for _ in range(TRIES):
        found = _stiffness(integrator, step, start, most)
        if found is None:
            step = 0.5 * step
        elif found.exceeds(step):
            step = found.shorter(step)
        elif 2.0 * step * float(found.frequency) < AIMED_TURN and step < longest:
            # The start is stiffer than the motion after it.
            wanted = _resolving(longest, found)
            again = _stiffness(integrator, wanted, start, most)
            step = step if again is None or again.exceeds(wanted) else wanted
            break
        else:
            break
    return longest_step(layout, step)


def _resolving(longest: float, stiffness: Stiffness) -> float:
    """A step for a stiffness: the longest one, or one that resolves it with some room."""
    frequency = float(stiffness.frequency)
    return longest if longest * frequency <= AIMED_TURN else AIMED_TURN / frequency


class _FirstSteps(Chunks):
    """Chunks until a run has taken so many steps."""

    def __init__(self, loop: TimeLoop, count: int) -> None:
        self._loop = loop
        self._count = count

    def steps(self) -> int:
        return self._count

    def goes_on(self, code: int) -> bool:
        return int(self._loop.clocks["steps"][0]) < self._count


def _stiffness(
    integrator: Integrator, step: float, start: np.ndarray, steps: int
) -> Stiffness | None:
    """What a run meets in so many steps; None where it stops, or its numbers are not finite."""
    layout = integrator.layout
    loop = integrator.loop(layout, Setting(step=step), start)
    times = layout.times[[0, -1]]
    columns = loop.room(3)
    code = drive(lambda budget: loop.advance(times, columns, budget), _FirstSteps(loop, steps))
    failed = any(call.error is not None for call in loop.calls)
    if failed or code not in (PAUSED, COMPLETED):
        return None
    found = loop.stiffness()
    return found if found is not None and np.isfinite(found.frequency) else None
