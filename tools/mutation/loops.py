"""Checks of what completed runs of a time loop do not show: the rounding of time, and stops.

Each returns what is wrong, or nothing. They import the package when they run:
see `judge`.
"""

import math
from typing import NamedTuple

import numpy as np
from tools.mutation.scenes import SCENES


def loop_of(table, method, setting, first_step=0.0):
    """The time loop of a method for a table, and a function that takes steps and has its status."""
    from tribo.integrators.methods import METHODS
    from tribo.integrators.step_control import Tolerance
    from tribo.kernels.status import STATUS_OF_CODE
    from tribo.layout.layout import lay_out
    from tribo.loops.general import GeneralLoop
    from tribo.loops.setting import Setting
    from tribo.model.scene_file import scene_from

    layout = lay_out(scene_from(table))
    if METHODS[method].adaptive:
        sizes = layout.start.size, layout.accounts
        tolerance = Tolerance(*(np.full(size, setting) for size in sizes), setting)
        steps = Setting(tolerance=tolerance)
    else:
        steps = Setting(step=setting)
    loop = GeneralLoop(layout, METHODS[method], steps, layout.start, first_step)

    def advance(times, steps):
        return STATUS_OF_CODE.get(loop.advance(np.array(times), loop.room(len(times)), steps))

    return loop, advance


def time_of_equal_steps() -> str:
    """After steps of 0.1 from t = 1000, the time and what rounding took from it are exact."""
    for method in ("midpoint", "verlet"):
        loop, advance = loop_of(SCENES["slid"], method, 0.1)
        loop.clocks.t = 1000.0
        advance([1001.0], 5)
        (clock,) = loop.clocks
        if clock.steps != 5 or abs((clock.t - 1000.5) + clock.t_low) > 1e-16:
            return f"{method}: {clock.steps} steps to {clock.t} + {clock.t_low}"
        if abs(clock.last_step - 0.1) > 1e-15:
            return f"{method}: the last step is {clock.last_step}"
    return ""


class NoValue(NamedTuple):
    """No force, but nan below a distance."""

    end: float

    def energy(self, r):
        """U(r)."""
        return 0.0 if r > self.end else math.nan

    def force(self, r):
        """-dU/dr."""
        return self.energy(r)


def first_value_that_is_not_finite() -> str:
    """Equal steps end with the first rate that is not finite, though the state still is."""
    from tribo import Output, Scene, Surface, simulate

    surfaces = (
        Surface("upper", bob=(-2.0, 0.0), velocity=(1.0, 0.0)),
        Surface("lower", facing="up"),
    )
    for end in (0.8, 0.95):  # the middle of the fifth step is outside of the one, in the other
        scene = Scene(surfaces, NoValue(end), 4.0, output=Output(samples=2))
        result = simulate(scene, method="midpoint", step=0.25)
        if (result.status, result.cost.steps) != ("NotFinite", 5):
            return f"{result.status} after {result.cost.steps} steps"
    return ""


def shortest_step() -> str:
    """A step that is lost in the spacing of times stops the run, unless it ends at a sample."""
    for times, status, steps in (([1.0], "StepUnderflow", 0), ([1e-17, 1.0], None, 1)):
        loop, advance = loop_of(SCENES["slid"], "rkn8", 1e-3, first_step=1e-17)
        found = advance(times, 1)
        if (found, loop.clocks.steps[0]) != (status, steps):
            return f"{found} after {loop.clocks.steps[0]} steps"
    return ""


LOOPS = {
    "time of equal steps": time_of_equal_steps,
    "first value that is not finite": first_value_that_is_not_finite,
    "shortest step": shortest_step,
}
