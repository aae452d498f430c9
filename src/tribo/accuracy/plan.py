"""The plan of a run, fixed before it: the method and all settings, also those of single runs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from tribo.accuracy.choose_method import Choice
from tribo.accuracy.comparison import Accuracy, error_bounds, strictest
from tribo.accuracy.cost_model import counted, evaluation_time
from tribo.accuracy.decision import LONG_RUN
from tribo.accuracy.levels import ToleranceScales, setting_at, tolerance_scales, work
from tribo.accuracy.noisy_step import resolving_step
from tribo.accuracy.search import TIGHT, FoundSettings, find_settings
from tribo.accuracy.search_runs import PARTS, Announce, SearchRuns, StopTimes
from tribo.integrators.step_control import count_of_steps
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.sinks import exceeds_memory, is_streamed
from tribo.loops.integrate import Integration
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting
from tribo.validation import InputError

# Longest step of a run that is compared with no other, relative to the time to an encounter.
NEAR_ALONE = 0.75
# First factor by which the level is raised for a run that is compared with no other.
LOOSER = 16.0
# Most runs that try such a level.
TRIES = 8
# Largest error estimate of such a run, relative to the request: the estimate is three times a
# difference that is nearly the error.
LOOSE_EXCESS = 1.875
# A try with more evaluations than this times the fewest so far is no cheaper; fewer is chance.
MORE = 1.05


class Pilot(NamedTuple):
    """A run that shows the scales of a scene, and the scales."""

    run: Integration
    scales: ToleranceScales


@dataclass(frozen=True, eq=False)
class Plan:
    """How a scene is run; it fits any other scene of the same kind."""

    method: str
    why: str  # the reason for the method; empty if it was given
    setting: Setting  # of the run that is delivered
    times: np.ndarray  # at which it stops: to record, if memory holds these, and to compare
    accuracy: Accuracy | None = None  # None with a given step
    # The search for it, and for the setting of two coarser runs; None with a given step.
    tuned: FoundSettings | None = None
    # Of a run without an error estimate, at the scene's times alone; None if none is cheaper.
    single: Setting | None = None
    automatic: bool = False  # whether a step was chosen, and is shortened if it is too long
    # Of members that are compared with finer runs of their own.
    pilot: Pilot | None = None
    # Steps divide it: members that record no samples take the steps of those that do [time].
    interval: float | None = None

    def without_runs(self, single: Setting | None) -> Plan:
        """The plan for other scenes: without the runs that found it, and with `single`."""
        tuned = None if self.tuned is None else replace(self.tuned, runs=(), errors=None)
        return replace(self, tuned=tuned, single=single, pilot=None)

    def with_step(self, step: float) -> Plan:
        """The plan with another step, or the next shorter one that divides its interval."""
        return replace(self, setting=Setting(step=self.divided(step)))

    def divided(self, step: float) -> float:
        """A step, or the next shorter one that divides the plan's interval."""
        if self.interval is None:
            return step
        return float(self.interval / count_of_steps(self.interval, step))

    def at_half_step(self) -> Plan:
        """The plan with half of its step."""
        return replace(self, setting=Setting(step=0.5 * self.setting.of_equal_steps()))


def make_plan(choice: Choice, integrator: Integrator, announce: Announce | None = None) -> Plan:
    """The plan of a run, with settings that keep its accuracy.  Raises InputError."""
    layout = integrator.layout
    accuracy = choice.accuracy
    name = choice.method.name
    times = layout.times
    if accuracy is None:
        assert choice.step is not None
        step = resolving_step(integrator, choice.step) if choice.automatic else choice.step
        if announce is not None:
            each = 1e-9 * evaluation_time(layout, choice.method)
            announce(1, 1, each * counted(layout, choice.method, step, times))
        return Plan(name, choice.why, Setting(step=step), times, automatic=choice.automatic)
    stops = StopTimes.for_samples(_compared(layout))
    tuned = find_settings(integrator, accuracy, stops, announce)
    tuned = replace(tuned, seconds=tuned.seconds + choice.seconds)
    return Plan(name, choice.why, tuned.fine, stops.fine, accuracy, tuned)


def plan_of_members(choice: Choice, integrator: Integrator) -> Plan | None:
    """A plan without a search, for members that are compared with finer runs of their own.

    None where a search has to tell first whether the accuracy can be kept: the step is given, the
    accuracy is so small that rounding matters, or the pilot run stops.
    """
    accuracy = choice.accuracy
    layout = integrator.layout
    if accuracy is None or strictest(accuracy) < TIGHT:
        return None
    stops = StopTimes.for_samples(_compared(layout))
    setting, run, scales = SearchRuns(integrator, None).pilot(stops.fine)
    if run.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    if run.status != Status.COMPLETED:
        return None
    name = choice.method.name
    return Plan(name, choice.why, setting, stops.fine, accuracy, pilot=Pilot(run, scales))


def _compared(layout: Layout) -> np.ndarray:
    """Times at which runs are compared: some, where memory does not hold all that are recorded."""
    times = layout.times
    if not is_streamed(layout, times.size):
        return times
    if exceeds_memory(layout, PARTS + 1):
        raise InputError(
            "accuracy",
            f"cannot be kept with {layout.scene.count} asperites, too many to compare runs; give a "
            "method and a step",
        )
    return times[np.unique(np.linspace(0, times.size - 1, PARTS + 1).astype(int))]


def single_setting(plan: Plan, integrator: Integrator) -> Setting | None:
    """The cheapest setting whose run agrees with the finest one within the plan's accuracy.

    Runs that are compared with no other need not differ in their steps, and stop at samples only.
    None if no try agrees, or if the finest run is long.
    """
    layout = integrator.layout
    found = plan.tuned
    if plan.single is not None or found is None or not found.runs:
        return plan.single
    assert plan.accuracy is not None
    finest = found.runs[-1]
    grown = found.amplification
    if finest.status != Status.COMPLETED or work(layout, finest) > LONG_RUN:
        return None
    scales = tolerance_scales(layout, finest.samples)
    best = None
    fewest = np.inf
    level = found.level
    factor = LOOSER
    spent = 0.0
    for _ in range(TRIES):
        if spent > LONG_RUN:
            break
        setting = setting_at(layout, integrator.method, scales, level, NEAR_ALONE)
        run = integrator(setting, layout.times)
        spent += work(layout, run)
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        good = run.status == Status.COMPLETED and run.evaluations <= MORE * fewest
        if good:
            errors = error_bounds(layout, finest, [run], grown, plan.accuracy)
            good = errors.excess <= LOOSE_EXCESS
        if not good:
            level = level / factor
            factor = factor**0.5
        elif run.evaluations < fewest:
            best = setting
            fewest = run.evaluations
        level *= factor
    return best
