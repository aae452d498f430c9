"""Prepared scenes: compiled and planned once, and run again and again."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from tribo.accuracy import comparison
from tribo.accuracy.levels import fine_level
from tribo.accuracy.plan import Plan, single_setting
from tribo.accuracy.search import FoundSettings, missed_note
from tribo.accuracy.search_runs import StopTimes
from tribo.integrators.own_method import coefficients_of
from tribo.interrupts import Interrupted
from tribo.kernels.status import Status
from tribo.layout.initial_state import InitialState, Start
from tribo.ledger.guards import MOST_MISSED, facing, missed_energy, passing_notes
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.reporter import Reporter
from tribo.ledger.separation import separation_notes
from tribo.ledger.sinks import StreamedLedger, Watched, is_streamed, is_watched
from tribo.loops.integrate import Integration
from tribo.loops.origin import digest_of
from tribo.loops.saved_state import state_of
from tribo.loops.select import Integrator, up_to_passing
from tribo.loops.setting import Setting
from tribo.model.identity import changes, settings_of, version
from tribo.result import Result
from tribo.results import notes as notes_on
from tribo.results.run_result import Cost, itself
from tribo.validation import InputError, TriboWarning

# A run whose step was chosen is repeated so often at most, each time with half the step or less: a
# thousandth of it resolves no other scenes.
MOST_REPEATS = 10
# The same of a run that completed, but gave the motion energy that no work accounts for.
MOST_REPEATS_FOR_ENERGY = 3
# Ends of runs whose step is too long.
REPEATED = (
    Status.ENCOUNTER_JUMPED,
    Status.NOT_FINITE,
    Status.ENERGY_RUNAWAY,
    Status.STEP_TOO_LONG,
)
# Of a streamed ledger of all quantities.
ENDS_ALONE = ("of the asperites' series only the first and the last sample are kept",)
# Of a run whose errors are not estimated.
NO_BOUNDS: Mapping[str, float] = {}
# A run, what makes its ledger, and what notes need of samples that memory does not hold.
Delivered = tuple[Integration, Callable[[], Ledger], Watched | None]


class Simulation:
    """A scene with its plan, and with everything compiled; :func:`prepare` makes one.

    Several threads can run it at the same time.  It can be copied, and pickled without its function
    for progress; copies and pickles give the same bits.

    `scene`, `method`, `accuracy` (None with a given step), `why` (the reason for the method; empty
    if it was given) and `compile_seconds` (to compile the time loop, or to load it from disk) say
    what it runs.
    """

    def __init__(self, plan: Plan, integrator: Integrator) -> None:
        """Take over a plan, and find what all runs of it share, notes among them."""
        self.plan = plan
        self.layout = integrator.layout
        self.scene = self.layout.scene
        self.method = integrator.method
        self.accuracy = plan.accuracy
        self.why = plan.why
        self.compile_seconds = integrator.compile_seconds
        self.integrator = integrator
        step = plan.setting.step if plan.accuracy is None else None
        start = digest_of(integrator.origin)
        self._settings = settings_of(plan.method, plan.accuracy, step, start)
        self._settings |= coefficients_of(plan.method)
        taken = () if integrator.origin is None else integrator.origin.notes
        self._notes = (*taken, *notes_on.run_notes(self.layout, self.method, step))
        self._streams = is_streamed(self.layout, self.layout.times.size)
        self._may_pass = bool(facing(self.layout))
        self._noisy = self.scene.is_noisy
        self._reporter = Reporter(self.layout, plan.times)
        self.initial_state = InitialState(self.layout, integrator.origin is not None)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the settings and what to lay out and compile again."""
        return Simulation, (self.settings, self.integrator)

    def __copy__(self) -> Simulation:
        """A simulation that shares everything with this one, as runs change nothing of it."""
        other = object.__new__(Simulation)
        other.__dict__.update(self.__dict__)
        return other

    def __deepcopy__(self, memo: object) -> Simulation:
        return self.__copy__()

    def run(self, initial: Start | None = None, estimate: bool = True) -> Result:
        """Run from the scene's start, or with some initial values changed.

        Parameters
        ----------
        initial : mapping, optional
            "surface.theta" (or swing, phi, omega, nu, and x, y, vx, vy of asperites that can move;
            ``"*.theta"`` of all surfaces) -> a number, or one for each asperite [rad, rad/time,
            length, length/time].
        estimate : bool
            False omits the two coarser runs that estimate the error.

        Raises
        ------
        InputError
            If a name or a value in `initial` cannot be used.
        KeyboardInterrupt
            The run was interrupted; the attribute ``result`` contains it so far.

        Warns
        -----
        TriboWarning
            The run stops early, or its error estimates exceed the accuracy.
        """
        return with_warning(self.compute(initial, estimate))

    def first_result(self) -> Result:
        """The result of the runs that found the settings, or of a run if none were needed.

        Raises and warns as :meth:`run`.
        """
        return with_warning(self.compute_first())

    def compute(self, initial: Start | None = None, estimate: bool = True) -> Result:
        """As :meth:`run`, without warnings: for callers that report what falls short.

        An interrupted run is returned with its status.
        """
        y = self.initial_state({} if initial is None else initial)
        tuned = self.plan.tuned is not None
        result = self._estimated_run(y) if tuned and estimate else self._single_run(y)
        if initial or (tuned and not estimate):
            result.settings = result.settings | changes(initial or {}, estimate or not tuned)
        return result

    def _estimated_run(self, y: np.ndarray) -> Result:
        """A run with an error estimate, from two coarser ones."""
        tuned = self.plan.tuned
        assert tuned is not None
        few, many, fine = self._stops
        runs: list[Integration] = []
        for setting, times, rounded in (
            (tuned.coarse, few, False),
            (tuned.coarse, many, True),
            (self.plan.setting, fine, False),
        ):
            if not runs or runs[-1].status not in comparison.ABORTED:
                runs.append(self.integrator(setting, times, y, rounded=rounded))
        return self._estimated_result(runs, y)

    def compute_first(self) -> Result:
        """As :meth:`first_result`, without warnings: for callers that report what falls short.

        An interrupted run is returned with its status.
        """
        runs = self.plan.tuned.runs if self.plan.tuned is not None else ()
        if not runs:
            return self.compute()
        return self._estimated_result(runs, self.initial_state({}), self.plan.tuned)

    @property
    def settings(self) -> Plan:
        """The plan for other scenes of this kind, for :func:`from_settings`; it can be pickled."""
        return self.plan.without_runs(self._single_setting)

    @property
    def finest(self) -> Integration:
        """The run that found the settings, or that shows the scales of members.

        Raises InputError if there was none, as the step was given.
        """
        if self.plan.pilot is not None:
            return self.plan.pilot.run
        if self.plan.tuned is None or not self.plan.tuned.runs:
            raise InputError("accuracy", "is missing; with a given step, no run finds the settings")
        return self.plan.tuned.runs[-1]

    @cached_property
    def _stops(self) -> StopTimes:
        """When the runs stop whose difference estimates the error."""
        return StopTimes.split(self.plan.times)

    @cached_property
    def _single_setting(self) -> Setting | None:
        """The plan's `single`, found when first needed."""
        return single_setting(self.plan, self.integrator)

    @cached_property
    def _single(self) -> tuple[Setting, np.ndarray]:
        """The setting and the times of a run without an error estimate."""
        if self._streams or self._single_setting is None:
            return self.plan.setting, self.plan.times
        return self._single_setting, self.layout.times

    def _single_run(self, y: np.ndarray) -> Result:
        """A run without an error estimate; where steps were chosen, they resolve its motion."""
        layout = self.layout
        seconds = self.compile_seconds
        ratio = self._digit_ratio
        setting, times = self._single
        notes: tuple[str, ...] = ()
        if self.plan.automatic:
            delivered, setting, notes = self._deliver_resolved(setting, times, y)
        else:
            delivered = self._deliver(setting, times, y)
        run, ledger, watched = delivered
        if run.passages[0] > 0:
            notes = (*notes, *notes_on.passage_notes(layout, run))
        if self._noisy and run.stiffness is not None:
            step = setting.of_equal_steps()
            notes += tuple(notes_on.excess_note(float(run.stiffness.excess(step)), step))
            if not self.plan.automatic:
                notes += tuple(notes_on.missed_note(self._missed_energy(delivered), step))
        if self._streams or self.plan.tuned is None:
            notes += self._sliding_notes(run, watched)
        if self._streams:
            notes += () if ledger().kept else ENDS_ALONE
        # The ledger and the cost are left for later: a run of a pair takes ten microseconds.
        cost = partial(cost_of, run, [run], seconds, ratio)
        return self._result(run, ledger, cost, notes, setting=setting)

    def _deliver_resolved(
        self, setting: Setting, times: np.ndarray, y: np.ndarray
    ) -> tuple[Delivered, Setting, tuple[str, ...]]:
        """A run whose step is shortened until it is not too long, its step, and a note on that."""
        notes: tuple[str, ...] = ()
        tries = MOST_REPEATS
        for_energy = MOST_REPEATS_FOR_ENERGY
        while True:
            delivered = self._deliver(setting, times, y, resolved=tries > 0)
            run = delivered[0]
            step = setting.of_equal_steps()
            if tries > 0 and run.status in REPEATED:
                tries -= 1
                shorter = 0.5 * step if run.stiffness is None else run.stiffness.shorter(step)
                why = notes_on.too_long(self.layout, run)
            else:
                missed = self._missed_energy(delivered)
                if not missed or for_energy == 0:
                    return delivered, setting, (*notes, *notes_on.missed_note(missed, step))
                for_energy -= 1
                shorter = 0.5 * step
                why = f"give the motion energy: {missed}"
            shorter = self.plan.divided(shorter)
            notes = (notes_on.repeat_note(step, why, shorter),)
            setting = Setting(step=shorter)

    def _missed_energy(self, delivered: Delivered) -> str:
        """A sentence where no work accounts for too much of the energy of a run, or nothing."""
        run, ledger, _ = delivered
        if run.status != Status.COMPLETED:
            return ""
        layout = self.layout
        ends = ledger() if self._streams else assemble(layout, run.samples.ends())
        missed, through = (float(each[0]) for each in missed_energy(layout, ends))
        return notes_on.missed_energy(missed, through) if missed > MOST_MISSED * through else ""

    def _deliver(
        self, setting: Setting, times: np.ndarray, y: np.ndarray, resolved: bool = False
    ) -> Delivered:
        """A run, its ledger, and what notes need of samples that memory does not hold.

        One whose steps have to be `resolved` stops where they are too long.
        """
        layout = self.layout
        reporter = self._reporter
        if self._noisy and setting.step is not None:
            layout = replace(layout, noisy_step=setting.step)
            reporter = reporter.with_noisy_step(setting.step)
        if not self._streams:
            run = self.integrator(setting, times, y, resolved=resolved)
            if self._may_pass:
                run = up_to_passing(layout, run)
            return run, partial(reporter.ledger, run.samples), None
        streamed = StreamedLedger(layout, guarded=not self.method.adaptive)
        run = self.integrator(setting, layout.times, y, streamed, resolved=resolved)
        return run, partial(itself, streamed.whole(run.samples)), streamed.watched

    def _estimated_result(
        self, runs: Sequence[Integration], y: np.ndarray, search: FoundSettings | None = None
    ) -> Result:
        """The last run as a result, its error estimated from the two before it.

        Its cost is that of the search, if this found it, or else of the runs.  Where the scene has
        more samples than these runs, one with the same setting from `y` is the result.
        """
        fine = runs[-1]
        met = False
        notes: tuple[str, ...] = ()
        bounds: dict[str, float] = {}
        if fine.status == Status.COMPLETED and len(runs) > 1:
            errors = self._errors(runs[-3:], search)
            bounds = errors.bounds
            scales = errors.scales
            met = errors.excess <= 1.0
            assert self.accuracy is not None and self.plan.tuned is not None
            if not met:
                missed = missed_note(self.plan.tuned, self.accuracy, errors.excess)
                notes = (*notes_on.approach_notes(self.layout, fine), missed)
            ledger = assemble(self.layout, fine.samples)
            open_budget = notes_on.budget_notes(self.layout, ledger, bounds)
            weak = comparison.weak_notes(scales.work, scales.energy, self.accuracy) if met else []
            met = met and not open_budget
            notes = (*notes, *filter(None, weak), *open_budget)
        fine = up_to_passing(self.layout, fine)
        notes = (*self._sliding_notes(fine), *notes)
        known = met if len(runs) > 1 or fine.status != Status.COMPLETED else None
        layout = self.layout
        seconds = self.compile_seconds
        ratio = self._digit_ratio
        spent = runs if search is None else [search]
        if self._streams and fine.status == Status.COMPLETED:
            run, streamed, _ = self._deliver(self.plan.setting, layout.times, y)
            notes += (f"errors are estimated at {self.plan.times.size} times",)
            notes += () if streamed().kept else ENDS_ALONE
            known = known if run.status == Status.COMPLETED else False
            cost = partial(cost_of, run, [*spent, run], seconds, ratio)
            return self._result(run, streamed, cost, notes, known, bounds)
        cost = partial(cost_of, runs[-1], spent, seconds, ratio)
        reported = partial(self._reporter.ledger, fine.samples)
        return self._result(fine, reported, cost, notes, known, bounds)

    def _sliding_notes(self, run: Integration, watched: Watched | None = None) -> tuple[str, ...]:
        """Notes on drives, and on surfaces that pass through each other, part, or never meet."""
        layout = self.layout
        samples = run.samples
        notes = (*notes_on.drive_notes(layout, samples), *passing_notes(layout, samples))
        if not is_watched(layout):
            return notes
        watched = Watched.of(layout, samples) if watched is None else watched
        return (
            *notes,
            *separation_notes(layout, watched.looks, watched.touching),
            *notes_on.pumping_notes(layout, watched),
        )

    def _errors(
        self, runs: Sequence[Integration], search: FoundSettings | None
    ) -> comparison.Errors:
        """Bounds on the last run's errors, which the search knows if it made the runs."""
        assert self.accuracy is not None and self.plan.tuned is not None
        tuned = self.plan.tuned
        known = None if search is None else search.errors
        if known is not None and known.amplification == tuned.amplification:
            return known
        return comparison.error_bounds(
            self.layout, runs[-1], runs[:-1], tuned.amplification, self.accuracy, tuned.rough
        )

    def _result(
        self,
        run: Integration,
        assemble_ledger: Callable[[], Ledger],
        add_up_cost: Callable[[], Cost],
        notes: tuple[str, ...],
        met: bool | None = None,
        bounds: Mapping[str, float] = NO_BOUNDS,
        setting: Setting | None = None,
    ) -> Result:
        """A result, with what all results of the simulation share."""
        layout = self.layout
        method = self.method.name
        keep = self.scene.output.keep
        if keep is not None:  # the result does not refer to samples
            ledger = assemble_ledger().only(keep)
            cost = add_up_cost()
            assemble_ledger = partial(itself, ledger)
            add_up_cost = partial(itself, cost)
            names = {*ledger.names, *ledger.kept}  # and observables, as "upper.W"
            bounds = {name: b for name, b in bounds.items() if name in names or "." in name}
        settings = self._settings
        if self.plan.automatic and setting is not None:
            settings = {**settings, "step": setting.step}
        if run.status != Status.COMPLETED:
            notes = (*notes_on.stop_notes(layout, run), *notes)
        if keep is not None:
            run = run.without_samples()
        return Result(
            scene=self.scene,
            status=run.status,
            method=method,
            why=self.why,
            accuracy=self.accuracy,
            met=met,
            notes=self._notes + notes,
            bounds=bounds,
            assemble=assemble_ledger,
            add_up=add_up_cost,
            take_state=lambda: state_of(layout, method, run),
            settings=settings,
            version=version(),
        )

    @cached_property
    def _digit_ratio(self) -> float | None:
        """What an accuracy ten times better costs, in units of the present cost; None if unknown.

        Samples shorten the steps of one run more than those of the other, so the ratio of their
        costs is bounded by what the order of the method lets a digit cost.
        """
        runs = () if self.plan.tuned is None else self.plan.tuned.runs
        if len(runs) < 3 or runs[-1].status != Status.COMPLETED or runs[-2].evaluations <= 0:
            return None
        ratios_per_digit = -1.0 / np.log10(fine_level(self.method))
        seen = (runs[-1].evaluations / runs[-2].evaluations) ** ratios_per_digit
        return float(min(seen, 10.0 ** (2.0 / self.method.order)))


def cost_of(
    run: Integration,
    spent: Sequence[Integration | FoundSettings],
    compile_seconds: float,
    ratio: float | None,
) -> Cost:
    """What a run and all that was spent on it cost, and a digit more or less, by `ratio`."""
    seconds = sum(each.seconds for each in spent)
    return Cost(
        steps=run.steps,
        force_evaluations=sum(each.evaluations for each in spent),
        wall_seconds=seconds,
        compile_seconds=compile_seconds,
        digit_more=None if ratio is None else seconds * ratio,
        digit_fewer=None if ratio is None else seconds / ratio,
    )


def with_warning(result: Result) -> Result:
    """Return a result; warn the caller's caller if it falls short, raise if it was interrupted."""
    if result.status == Status.INTERRUPTED:
        raise Interrupted(result)
    if result.status != Status.COMPLETED or result.met is False:
        warnings.warn(result.shortcoming, TriboWarning, stacklevel=3)
    return result
