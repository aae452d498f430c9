"""The plan of a run: the method and all settings, fixed before the run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tribo.accuracy.cheapest_setting import cheapest_setting
from tribo.accuracy.choose_method import Choice
from tribo.accuracy.comparison import Accuracy
from tribo.accuracy.found_settings import FoundSettings
from tribo.accuracy.run_time import counted, evaluation_time
from tribo.accuracy.search import find_settings
from tribo.accuracy.search_runs import Announce
from tribo.accuracy.stop_times import PARTS, StopTimes
from tribo.accuracy.tolerance_scales import first_step
from tribo.integrators import methods
from tribo.layout.layout import Layout
from tribo.ledger.sinks import exceeds_memory, is_streamed
from tribo.loops.integrate import Progress, Setting
from tribo.loops.journal import Journal
from tribo.loops.select import Integrator
from tribo.loops.state import Origin
from tribo.validation import InputError


@dataclass(frozen=True, eq=False)
class Plan:
    """How a scene is run; it fits any other scene of the same kind.

    Attributes
    ----------
    method : str
        The name of the method.
    why : str
        The reason for the method; empty if it was given.
    setting : float or Tolerance
        Settings of the run that is delivered.
    times : ndarray, (times,)
        Times at which that run stops: those of the scene, and those of comparisons with coarser
        runs; the latter alone where samples are too many to hold.
    accuracy : float, mapping or None
        The relative error of everything, or of each observable named; None with a given step.
    tuned : Tuned or None
        The search for `setting` and for the setting of the two coarser runs that estimate the
        error; None with a given step.
    single : float, Tolerance or None
        Of a run without an error estimate, recorded at the scene's times alone; None where there
        is none that is cheaper than `setting`, or where it has not been looked for yet.
    automatic : bool
        Whether `setting` is a step that was chosen, and is halved where it passes an encounter.
    """

    method: str
    why: str
    setting: Setting
    times: np.ndarray
    accuracy: Accuracy | None = None
    tuned: FoundSettings | None = None
    single: Setting | None = None
    automatic: bool = False

    def without_runs(self, single: Setting | None) -> Plan:
        """The plan for other scenes: without the runs that found it, and with `single`."""
        tuned = None if self.tuned is None else replace(self.tuned, runs=(), errors=None)
        return replace(self, tuned=tuned, single=single)

    def at_half_step(self) -> Plan:
        """The same plan with half of its given step."""
        assert isinstance(self.setting, float)
        return replace(self, setting=0.5 * self.setting)


def integrator_for(
    layout: Layout,
    method: methods.Method,
    progress: Progress | None = None,
    origin: Origin | None = None,
    journal: Journal | None = None,
    threads: int = 1,
) -> Integrator:
    """A compiled loop with the usual first step.  Raises InputError."""
    return Integrator(layout, method, first_step(layout), progress, origin, journal, threads)


def make_plan(choice: Choice, integrator: Integrator, announce: Announce | None = None) -> Plan:
    """The plan of a run; looks for the settings that keep an accuracy.

    Parameters
    ----------
    choice : Choice
        The method, and the accuracy or the step.
    integrator : Integrator
        Runs the scene by that method.
    announce : callable, optional
        Called before each run: see :data:`tribo.accuracy.search_runs.Announce`.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        The accuracy is out of reach, or names quantities that the scene does not report.
    """
    layout, accuracy = integrator.layout, choice.accuracy
    name, times = choice.method.name, layout.times
    if accuracy is None:
        assert choice.step is not None
        if announce is not None:
            each = 1e-9 * evaluation_time(layout, choice.method)
            announce(1, 1, each * counted(layout, choice.method, choice.step, times))
        return Plan(name, choice.why, choice.step, times, automatic=choice.automatic)
    stops = StopTimes.for_samples(_compared(layout))
    tuned = find_settings(layout, choice.method, accuracy, stops, integrator, announce)
    tuned = replace(tuned, seconds=tuned.seconds + choice.seconds)
    return Plan(name, choice.why, tuned.fine, stops.fine, accuracy, tuned)


def single_setting(plan: Plan, integrator: Integrator) -> Setting | None:
    """The cheapest setting that keeps the plan's accuracy in runs without an error estimate.

    None where there is none that is cheaper than the plan's.
    """
    if plan.single is not None or plan.tuned is None or not plan.tuned.runs:
        return plan.single
    assert plan.accuracy is not None
    layout = integrator.layout
    return cheapest_setting(
        layout,
        integrator.method,
        plan.tuned,
        plan.accuracy,
        lambda setting: integrator(setting, layout.times),
    )


def _compared(layout: Layout) -> np.ndarray:
    """Times at which runs are compared: all that are recorded, or some where these are too many.

    Raises InputError where even these are too many to hold.
    """
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
