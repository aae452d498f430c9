"""Simulations: from a scene and an accuracy to a result with error estimates."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np

from tribo.accuracy.choose_method import Choice, choose
from tribo.accuracy.comparison import (
    ABORTED,
    Accuracy,
    error_bounds,
    out_of_reach,
    strictest,
)
from tribo.accuracy.estimate import check_observables, excess_of_request
from tribo.accuracy.plan import Plan, integrator_for, make_plan, single_setting
from tribo.accuracy.search import fine_level
from tribo.accuracy.stop_times import StopTimes
from tribo.files import checked_target
from tribo.integrators import methods
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.run.identity import identity_of, refuse_other, settings_of, version
from tribo.run.initial_state import InitialState, Start
from tribo.run.integrate import Integration, Progress, Setting
from tribo.run.journal import PART, Journal
from tribo.run.layout import Layout, lay_out
from tribo.run.ledger import Ledger, assemble
from tribo.run.loop_selection import Integrator
from tribo.run.notes import calculator_notes, passage_notes, run_notes, stop_notes
from tribo.run.result import Cost, Known, Result, load_result
from tribo.run.state import Origin, State, continued, state_of
from tribo.run.streamed_ledger import StreamedLedger, exceeds_memory
from tribo.validation import InputError, TriboWarning, as_path, inside


class Simulation:
    """A scene with its plan, and with everything compiled; :func:`prepare` makes one.

    Parameters
    ----------
    plan : Plan
        The method and all settings.
    integrator : Integrator
        Runs the scene by that method.

    Attributes
    ----------
    scene : Scene
        What is run.
    method : Method
        How time advances.
    accuracy : float, mapping or None
        The relative error of everything, or of each observable named; None with a given step.
    why : str
        Why the method was chosen; empty where it was given.
    compile_seconds : float
        Time to compile the time loop, or to load it from disk [s].
    """

    def __init__(self, plan: Plan, integrator: Integrator) -> None:
        self.plan = plan
        self.layout = integrator.layout
        self.scene = self.layout.scene
        self.method = integrator.method
        self.accuracy = plan.accuracy
        self.why = plan.why
        self.compile_seconds = integrator.compile_seconds
        self._integrator = integrator
        step = plan.setting if isinstance(plan.setting, float) and plan.accuracy is None else None
        start = _digest(integrator.origin)
        self._settings = settings_of(plan.method, plan.accuracy, step, start)
        self._notes = run_notes(self.layout, self.method, step)
        self._streams = exceeds_memory(self.layout, plan.times.size)
        self._initial_state = InitialState(self.layout)

    def run(self, start: Start | None = None, estimate: bool = True) -> Result:
        """Run from the scene's start, or with some initial values changed.

        Parameters
        ----------
        start : mapping, optional
            "surface.theta" (or swing, phi, omega, nu) -> a number, or one for each asperite
            [rad, rad/time].
        estimate : bool
            False leaves out the two coarser runs that estimate the error.

        Returns
        -------
        Result

        Raises
        ------
        InputError
            A name or a value in `start` cannot be used.

        Warns
        -----
        TriboWarning
            The run stops early, or its error estimates exceed the accuracy.
        """
        return _with_warning(self.compute(start, estimate))

    def first_result(self) -> Result:
        """The result of the runs that found the settings, or of a run if none were needed.

        Returns
        -------
        Result

        Warns
        -----
        TriboWarning
            The run stops early, or its error estimates exceed the accuracy.
        """
        return _with_warning(self.compute_first())

    def compute(self, start: Start | None = None, estimate: bool = True) -> Result:
        """As :meth:`run`, without warnings: for callers that report what falls short."""
        y = self._initial_state({} if start is None else start)
        tuned = self.plan.tuned
        if not estimate or tuned is None:
            return self._single_run(y)
        settings = (tuned.coarse, tuned.coarse, self.plan.setting)
        runs: list[Integration] = []
        for setting, times in zip(settings, StopTimes.split(self.plan.times), strict=True):
            if not runs or runs[-1].status not in ABORTED:
                runs.append(self._integrator(setting, times, y))
        return self._estimated_result(runs)

    def compute_first(self) -> Result:
        """As :meth:`first_result`, without warnings: for callers that report what falls short."""
        runs = self.plan.tuned.runs if self.plan.tuned is not None else ()
        return self._estimated_result(runs) if runs else self.compute()

    @property
    def settings(self) -> Plan:
        """The plan for other scenes of this kind, for :func:`from_settings`; it can be pickled."""
        return self.plan.without_runs(self._single_setting)

    @property
    def finest(self) -> Integration:
        """The run that found the settings.

        Raises
        ------
        InputError
            There was no search, as the step was given.
        """
        if self.plan.tuned is None or not self.plan.tuned.runs:
            raise InputError("accuracy", "is missing; with a given step, no run finds the settings")
        return self.plan.tuned.runs[-1]

    @cached_property
    def _single_setting(self) -> Setting | None:
        """The plan's `single`, found when first needed."""
        return single_setting(self.plan, self._integrator)

    @cached_property
    def _single(self) -> tuple[Setting, np.ndarray]:
        """Setting and times of runs without an error estimate."""
        if self._single_setting is None:
            return self.plan.setting, self.plan.times
        return self._single_setting, self.layout.times

    def _single_run(self, y: np.ndarray) -> Result:
        """A run without an error estimate."""
        if self._streams:
            return self._streamed_run(y)
        layout, seconds, ratio = self.layout, self.compile_seconds, self._digit_ratio
        setting, times = self._single
        run = self._integrator(setting, times, y)
        # The ledger and the cost are left for later: a run of a pair takes ten microseconds.
        return self._result(
            run.status,
            None,
            passage_notes(layout, run),
            {},
            lambda: _reported(layout, run),
            lambda: _cost([run], seconds, ratio),
            run,
        )

    def _streamed_run(self, y: np.ndarray) -> Result:
        """A run without an error estimate, of which not all samples are kept."""
        streamed = StreamedLedger(self.layout)
        run = self._integrator(self.plan.setting, self.plan.times, y, streamed)
        note = "of the asperites' series only the first and the last sample are kept"
        notes = (*passage_notes(self.layout, run), note)
        ledger = streamed.with_ends(run.samples)
        cost = _cost([run], self.compile_seconds, self._digit_ratio)
        return self._result(run.status, None, notes, {}, Known(ledger), Known(cost), run)

    def _estimated_result(self, runs: Sequence[Integration]) -> Result:
        """The last run as a result, its error estimated from the two before it."""
        fine, met = runs[-1], False
        notes: tuple[str, ...] = ()
        bounds: dict[str, float] = {}
        if fine.status == Status.COMPLETED and len(runs) > 1:
            bounds, excess = self._errors(runs[-3:])
            met = excess <= 1.0
            notes = () if met else (self._missed(excess),)
        ledger = _reported(self.layout, fine)
        cost = _cost(runs, self.compile_seconds, self._digit_ratio)
        known = met if len(runs) > 1 or fine.status != Status.COMPLETED else None
        return self._result(fine.status, known, notes, bounds, Known(ledger), Known(cost), fine)

    def _errors(self, runs: Sequence[Integration]) -> tuple[dict[str, float], float]:
        """Bounds on the last run's errors, and the largest in units of the request."""
        assert self.accuracy is not None and self.plan.tuned is not None
        grown = self.plan.tuned.amplification
        found, scales = error_bounds(self.layout, runs[-1], runs[:-1], grown, self.accuracy)
        return found, excess_of_request(found, scales, self.accuracy)

    def _missed(self, excess: float) -> str:
        """By how much the request was missed, and why."""
        tuned = self.plan.tuned
        assert self.accuracy is not None and tuned is not None
        if tuned.met:
            why = "the settings were found from the scene's own start, which kept it"
        elif tuned.amplification is None:
            why = "the search for settings was interrupted"
        else:
            why = out_of_reach(strictest(self.accuracy), tuned.amplification)
        return f"errors are estimated at {excess:.1e} of the request; {why}"

    def _result(
        self,
        status: Status,
        met: bool | None,
        notes: tuple[str, ...],
        bounds: Mapping[str, float],
        assemble_ledger: Callable[[], Ledger],
        add_up_cost: Callable[[], Cost],
        run: Integration,
    ) -> Result:
        """A result, with what all results of the simulation share."""
        layout, method = self.layout, self.method.name
        notes = stop_notes(layout, run) + notes
        if self.layout.calculator_calls:
            notes = calculator_notes(self.layout) + notes
        return Result(
            self.scene,
            status,
            method,
            self.why,
            self.accuracy,
            met,
            self._notes + notes,
            bounds,
            assemble_ledger,
            add_up_cost,
            lambda: state_of(layout, method, run),
            self._settings,
            version(),
        )

    @cached_property
    def _digit_ratio(self) -> float | None:
        """What an accuracy ten times better costs, in units of the present cost; None if unknown.

        Samples shorten the steps of one run more than those of the other, so the ratio of their
        costs is bounded by what the order of the method lets a digit cost.
        """
        runs = () if self.plan.tuned is None else self.plan.tuned.runs
        if len(runs) < 3 or runs[-2].evaluations <= 0:
            return None
        ratios_per_digit = -1.0 / np.log10(fine_level(self.method))
        seen = (runs[-1].evaluations / runs[-2].evaluations) ** ratios_per_digit
        return float(min(seen, 10.0 ** (2.0 / self.method.order)))


def _reported(layout: Layout, run: Integration) -> Ledger:
    """The ledger of a run at the scene's times and at its end."""
    samples = run.samples
    wanted = np.intersect1d(samples.t, layout.times)
    ledger = assemble(layout, samples.at(np.union1d(wanted, samples.t[[0, -1]])))
    return ledger.rows(slice(int(np.searchsorted(ledger.t, layout.beginning)), None))


def _cost(runs: Sequence[Integration], compile_seconds: float, ratio: float | None) -> Cost:
    """What the runs cost, and what a digit more or less would cost, by `ratio`."""
    seconds = sum(run.seconds for run in runs)
    return Cost(
        steps=runs[-1].steps,
        force_evaluations=sum(run.evaluations for run in runs),
        wall_seconds=seconds,
        compile_seconds=compile_seconds,
        digit_more=None if ratio is None else seconds * ratio,
        digit_fewer=None if ratio is None else seconds / ratio,
    )


def _with_warning(result: Result) -> Result:
    """The result; warns the caller of the caller if it falls short."""
    if result.status != Status.COMPLETED or result.met is False:
        warnings.warn(result.shortcoming, TriboWarning, stacklevel=3)
    return result


def prepare(
    scene: Scene,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Progress | None = None,
    start: State | None = None,
) -> Simulation:
    """Compile and plan a scene once; method and settings are fixed here.

    Parameters
    ----------
    scene : Scene
        What is run.
    accuracy : float or mapping, optional
        The largest error of any reported quantity, relative to its scale, or of each observable
        that is named, as ``{"upper.W": 1e-3}``.  Without it and without a step, the accuracy or
        the step of the scene's numerics, else 1e-8.
    method : str, optional
        A method's name.  Without it, that of the scene's numerics; else a model of costs chooses
        the fastest.
    step : float, optional
        A step [time] in place of an accuracy; such runs have no error estimate.
    progress : callable, optional
        Called with the time reached, a few times a second.
    start : State, optional
        The state from which all runs begin, as that of a result, in place of the scene's start at
        t = 0.  In the scene that the state is of, works and changes go on from where they were; in
        one with other forces they are counted from the state.

    Returns
    -------
    Simulation

    Raises
    ------
    InputError
        The settings do not go together or do not suit the scene, the accuracy is out of reach, or
        a plug-in cannot be compiled.
    """
    layout, choice, origin = _chosen(scene, accuracy, method, step, start)
    integrator = integrator_for(layout, choice.method, progress, origin)
    return Simulation(make_plan(choice, integrator), integrator)


def _chosen(
    scene: Scene,
    accuracy: Accuracy | None,
    method: str | None,
    step: float | None,
    start: State | None,
) -> tuple[Layout, Choice, Origin | None]:
    """The layout of a run, its method and settings, and the state where it begins."""
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {scene!r}")
    layout, origin = lay_out(scene), None
    if start is not None:
        layout, origin = continued(layout, start)
    given = scene.numerics
    if accuracy is None and method is None and step is None:
        with inside("numerics"):
            choice = choose(layout, given.accuracy, given.method, given.step)
    else:
        if accuracy is None and step is None:
            accuracy, step = given.accuracy, given.step
        choice = choose(layout, accuracy, given.method if method is None else method, step)
    if isinstance(choice.accuracy, Mapping):
        check_observables(layout, choice.accuracy)
    return layout, choice, origin


def from_settings(scene: Scene, settings: Plan) -> Simulation:
    """A simulation of a scene by the settings of another of its kind, without a search.

    Parameters
    ----------
    scene : Scene
        Differs from the other in numbers, not in the effects that it calls for.
    settings : Plan
        :attr:`Simulation.settings` of the other.

    Returns
    -------
    Simulation
    """
    layout = lay_out(scene)
    return Simulation(settings, integrator_for(layout, methods.METHODS[settings.method]))


def simulate(
    scene: Scene,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Progress | None = None,
    start: State | None = None,
    out: str | Path | None = None,
    resume: bool = False,
) -> Result:
    """Run a scene once.

    Parameters
    ----------
    scene, accuracy, method, step, progress, start
        As for :func:`prepare`.  A run from ``result.state()`` by the same method and step gives bit
        for bit what a run without the pause gives that records the same times.
    out : str or Path, optional
        A NetCDF file for the result.  While the run goes on, ``out`` with ``.part`` behind its name
        keeps what is reached, also of a run that is interrupted.
    resume : bool
        Continue what ``out.part`` has, to the bits of a run without a pause; begin if there is no
        such file, and only read ``out`` if that is complete.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        As for :func:`prepare`.

    Warns
    -----
    TriboWarning
        The run stops early, or its error estimates exceed the accuracy.
    """
    if out is None:
        return _with_warning(
            prepare(scene, accuracy, method, step, progress, start).compute_first()
        )
    layout, choice, origin = _chosen(scene, accuracy, method, step, start)
    return _with_warning(_run_to_file(as_path(out), resume, layout, choice, origin, progress))


def _digest(origin: Origin | None) -> str | None:
    """What tells the state where a run begins from others; None for the scene's own start."""
    return None if origin is None else origin.state.digest


def _run_to_file(
    path: Path,
    resume: bool,
    layout: Layout,
    choice: Choice,
    origin: Origin | None,
    progress: Progress | None,
) -> Result:
    """Run with a journal beside a file, which the result replaces once it is complete."""
    path = checked_target("out", path)
    part = path.with_name(path.name + PART)
    settings = settings_of(choice.method.name, choice.accuracy, choice.step, _digest(origin))
    identity = identity_of(layout.scene, settings, version())
    if resume and path.exists() and not part.exists():
        result = load_result(path)
        refuse_other(path, identity_of(result.scene, result.settings, result.version), identity)
        return result
    with Journal(part, identity, resume) as journal:
        integrator = integrator_for(layout, choice.method, progress, origin, journal)
        result = Simulation(make_plan(choice, integrator), integrator).compute_first()
        if result.status != Status.INTERRUPTED:
            result.save(path)
            journal.remove()
    return result
